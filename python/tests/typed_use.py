"""A program that uses the package with types: checked by mypy, never run."""

from typing import List, Optional, Tuple

import tenon
import tenon.sweep


def thickest(folder: str, values: List[float]) -> Optional[Tuple[float, int]]:
    graph = tenon.Graph.load(folder, tenon.Engine(threads=2))
    best: Optional[Tuple[float, int]] = None
    for value in values:
        job: tenon.Job = graph.set(thickness=value).start("panels", progress=lambda fraction, node: fraction < 2)
        result: tenon.Result = job.result().check()
        panels = result["panels"]
        assert isinstance(panels, tenon.Panels)
        seen: tenon.Preview = result.preview("panels")
        if best is None or panels.thickness > best[0]:
            best = (panels.thickness, len(seen.triangles))
    return best
