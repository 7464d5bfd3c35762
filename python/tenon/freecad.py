"""Panels as solids in FreeCAD; to be used with FreeCAD's own Python.

    import FreeCAD, tenon, tenon.freecad
    panels = tenon.Graph.load("graphs/shell-256").evaluate("panels").check()["panels"]
    tenon.freecad.show(panels, FreeCAD.newDocument("Shell"))
"""

from __future__ import annotations

from importlib import import_module
from typing import Any, List

from ._values import Panels


def solid(panels: Panels, panel: int) -> Any:
    """A panel as a `Part.Solid`, whose faces are those of the panel; None for one that could not be made."""
    part, vector = import_module("Part"), import_module("FreeCAD").Vector
    points, faces = panels.solid(panel)
    if not len(points):
        return None
    corners = [vector(*map(float, p)) for p in points]
    shell = part.Shell([part.Face(part.makePolygon([corners[k] for k in [*face, face[0]]])) for face in faces])
    # Until then every face has edges of its own.
    shell.sewShape()
    whole = part.Solid(shell)
    if whole.Volume < 0:
        whole.reverse()
    return whole


def solids(panels: Panels) -> List[Any]:
    """All panels that could be made as `Part.Solid`s."""
    return [s for s in (solid(panels, i) for i in range(len(panels))) if s is not None]


def show(panels: Panels, document: Any) -> Any:
    """Puts the panels into a document as one group, each named by its address; gives the group."""
    group = document.addObject("App::DocumentObjectGroup", "Panels")
    for i in range(len(panels)):
        shape = solid(panels, i)
        if shape is not None:
            thing = document.addObject("Part::Feature", "Panel")
            thing.Label, thing.Shape = f"Panel {panels.name(i)}", shape
            group.addObject(thing)
    document.recompute()
    return group
