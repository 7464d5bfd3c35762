"""Values as a Rhino file, through the package rhino3dm.

    tenon.rhino.write("shell.3dm", panels=result["panels"], curve=result["curve.curve"])
"""

from __future__ import annotations

import os
from importlib import import_module
from typing import Any, Union

from ._values import Curve, Mesh, Panels


def write(path: Union[str, "os.PathLike[str]"], **values: Any) -> int:
    """Writes a `.3dm` in mm with a layer per value: panels as closed meshes named by their addresses, meshes and curves as
    they are. Gives the number of objects. Raises a TypeError for other values and an OSError if the file cannot be written;
    needs rhino3dm."""
    rhino = import_module("rhino3dm")
    model = rhino.File3dm()
    model.Settings.ModelUnitSystem = rhino.UnitSystem.Millimeters
    count = 0
    for name, value in values.items():
        layer = rhino.Layer()
        layer.Name = name
        index = model.Layers.Add(layer)
        for one in value if isinstance(value, list) else [value]:
            count += _add(rhino, model, index, one)
    if not model.Write(os.fspath(path), 7):
        raise OSError(f"{os.fspath(path)} cannot be written")
    return count


def _add(rhino: Any, model: Any, layer: int, value: Any) -> int:
    attributes = rhino.ObjectAttributes()
    attributes.LayerIndex = layer
    if isinstance(value, Panels):
        count = 0
        for i in range(len(value)):
            points, faces = value.solid(i)
            if len(points):
                attributes.Name = value.name(i)
                model.Objects.AddMesh(_mesh(rhino, points, faces), attributes)
                count += 1
        return count
    if isinstance(value, Mesh):
        model.Objects.AddMesh(_mesh(rhino, value.points, [f.tolist() for f in value.faces]), attributes)
        return 1
    if isinstance(value, Curve):
        starts = [int(s) for s in value.strip_start]
        for first, end in zip(starts, starts[1:]):
            strip = [rhino.Point3d(*map(float, p)) for p in value.points[first:end]]
            model.Objects.AddCurve(rhino.PolylineCurve(strip + strip[:1] if value.closed else strip), attributes)
        return len(starts) - 1
    raise TypeError(f"{type(value).__name__} has no form in a Rhino file: panels, meshes and curves have")


def _mesh(rhino: Any, points: Any, faces: Any) -> Any:
    """Faces of more than four corners are fans of triangles: the faces of panels are convex."""
    mesh = rhino.Mesh()
    for p in points:
        mesh.Vertices.Add(*map(float, p))
    for face in faces:
        if len(face) <= 4:
            mesh.Faces.AddFace(*face)
        else:
            for a, b in zip(face[1:], face[2:]):
                mesh.Faces.AddFace(face[0], a, b)
    mesh.Normals.ComputeNormals()
    return mesh
