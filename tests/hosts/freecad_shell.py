"""A CAD program as host: FreeCAD's own Python loads shell-256 through the package, builds its panels as exact solids and
compares their volumes with those of the piece list, which the graph makes without FreeCAD. Run by freecadcmd with tenon on
PYTHONPATH; ends with exit status 0 only if all is as it should be.

    PYTHONPATH=python TENON_LIBRARY=target/release/libtenon.so freecadcmd tests/hosts/freecad_shell.py
"""

import json
import os
import sys
import traceback
from pathlib import Path


def main():
    # freecadcmd reads PYTHONPATH only in some versions.
    sys.path[:0] = [path for path in os.environ.get("PYTHONPATH", "").split(os.pathsep) if path]
    import FreeCAD
    import tenon
    import tenon.freecad

    shell = Path(__file__).resolve().parents[2] / "graphs" / "shell-256"
    result = tenon.Graph.load(shell).evaluate("panels", "pieces_json.file")
    assert not [d for d in result.diagnostics if d.severity == "error"], result.diagnostics
    panels = result["panels"]
    pieces = json.loads(result["pieces_json.file"].content)["pieces"]
    solids = tenon.freecad.solids(panels)
    assert len(solids) == len(pieces) == 256, (len(solids), len(pieces))
    worst = 0.0
    for piece in pieces:
        solid = solids[piece["part"]]
        assert solid.isValid() and solid.isClosed() and solid.ShapeType == "Solid", piece["address"]
        worst = max(worst, abs(solid.Volume / piece["volume"] - 1))
    assert worst < 1e-9, f"a volume is {worst:.2e} of itself off"

    document = FreeCAD.newDocument("Shell")
    group = tenon.freecad.show(panels, document)
    assert len(group.Group) == 256 and group.Group[17].Label == f"Panel {panels.name(17)}"
    total = sum(s.Volume for s in solids)
    print(f"FreeCAD {'.'.join(FreeCAD.Version()[:3])}: 256 solids of {total:.0f} mm3, volumes off by {worst:.1e} at most")


try:
    main()
    code = 0
except BaseException:
    traceback.print_exc()
    code = 1
sys.stdout.flush()
sys.stderr.flush()
# freecadcmd would go on to its prompt, and gives 0 whatever has happened.
os._exit(code)
