"""The package beside others: compas, rhino3dm, a type checker. Each is skipped where the other is not installed, and must
be there if TENON_TEST_OTHERS says so."""

import importlib
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import tenon
import tenon.rhino
from test_tenon import SHELL, folded, thickened

HERE = Path(__file__).resolve().parent


def other(name):
    if os.environ.get("TENON_TEST_OTHERS"):
        return importlib.import_module(name)
    return pytest.importorskip(name)


def test_compas_meshes_come_in_and_go_out():
    structures = other("compas.datastructures")
    points, faces = folded().points.tolist(), [f.tolist() for f in folded().faces]
    mesh = structures.Mesh.from_vertices_and_faces(points, faces)
    result = thickened().give("order.mesh", mesh).evaluate("order.mesh", "thicken.panels").check()
    back = result["order.mesh"].to_compas()
    assert back.number_of_faces() == 2 and back.is_valid()
    assert back.area() == pytest.approx(mesh.area())
    panels = tenon.Graph.load(SHELL).evaluate("panels").check()["panels"]
    solids = panels.to_compas()
    assert len(solids) == 256 and solids[17].name == panels.name(17)
    assert all(s.is_closed() if hasattr(s, "is_closed") else not s.vertices_on_boundary() for s in solids)
    assert sum(s.volume() for s in solids) == pytest.approx(sum(abs(volume_of(panels, i)) for i in range(256)), rel=1e-9)


def volume_of(panels, i):
    points, faces = panels.solid(i)
    fans = [(f[0], a, b) for f in faces for a, b in zip(f[1:], f[2:])]
    return sum(np.dot(points[a], np.cross(points[b], points[c])) for a, b, c in fans) / 6


def test_rhino_files_hold_what_was_written(tmp_path):
    rhino = other("rhino3dm")
    result = tenon.Graph.load(SHELL).evaluate("panels", "arc.curve").check()
    panels, file = result["panels"], tmp_path / "shell.3dm"
    assert tenon.rhino.write(file, panels=panels, mesh=folded(), curve=result["arc.curve"]) == 258
    model = rhino.File3dm.Read(str(file))
    assert model.Settings.ModelUnitSystem == rhino.UnitSystem.Millimeters
    assert [layer.Name for layer in model.Layers] == ["panels", "mesh", "curve"]
    solids = [o for o in model.Objects if o.Attributes.LayerIndex == 0]
    assert len(solids) == 256 and solids[17].Attributes.Name == panels.name(17)
    assert all(o.Geometry.IsClosed for o in solids)
    corner = model.Objects[0].Geometry.Vertices[0]
    assert np.allclose([corner.X, corner.Y, corner.Z], panels.front[0], atol=1e-3)
    with pytest.raises(TypeError, match="no form"):
        tenon.rhino.write(file, number=3.0)
    with pytest.raises(OSError):
        tenon.rhino.write(tmp_path / "nowhere" / "shell.3dm", mesh=folded())


def test_types_are_sound():
    other("mypy")
    package, environment = Path(tenon.__file__).parent, dict(os.environ)
    if "site-packages" not in package.parts:
        environment["MYPYPATH"] = str(package.parent)
    # What the package promises, checked from inside and as a user's program sees it.
    for what in (["-p", "tenon"], [str(HERE / "typed_use.py")]):
        command = [sys.executable, "-m", "mypy", "--strict", *what]
        done = subprocess.run(command, capture_output=True, text=True, env=environment)
        assert done.returncode == 0, done.stdout
