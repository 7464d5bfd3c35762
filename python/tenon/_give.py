"""Python values as C trees, for inputs that a graph file cannot hold."""

from __future__ import annotations

import ctypes as c
from typing import Any, Callable, Dict, List, Mapping, Sequence, Tuple

import numpy as np

from . import _c
from ._values import Curve, Mesh, Panels, Planes, Table, Vectors

BOOLEAN, INTEGER, NUMBER, TEXT, POINT, VECTOR, PLANE, CURVE, MESH, PANELS, TABLE = 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 14

# The arrays of a panel set and their numbers.
PANEL_ARRAYS = {
    "corner_start": "u4", "address": "u4", "normal": "f8", "front": "f8", "vertex": "u4", "chamfer": "f8", "neighbour": "u4",
    "side": "u1", "back_start": "f8", "back_end": "f8", "voided": "u1",
}


def _address(array: "np.ndarray[Any, Any]") -> int:
    return int(array.ctypes.data)


def _plain(kind: int, array: "np.ndarray[Any, Any]", stride: int, keep: List[Any]) -> _c.Column:
    keep.append(array)
    return _c.Column(
        size=c.sizeof(_c.Column), kind=kind, items=_address(array) if len(array) else None, count=len(array), stride=stride
    )


def _structs(kind: int, structs: Sequence[Any], keep: List[Any]) -> _c.Column:
    array = (type(structs[0]) * len(structs))(*structs)
    keep.append(array)
    size = c.sizeof(type(structs[0]))
    return _c.Column(
        size=c.sizeof(_c.Column), kind=kind, items=c.addressof(array), count=len(structs), stride=size
    )


def _mesh(mesh: Any, keep: List[Any]) -> _c.Mesh:
    if not isinstance(mesh, Mesh):
        mesh = Mesh.from_compas(mesh)
    points = np.ascontiguousarray(mesh.points, "f8")
    start = np.ascontiguousarray(mesh.face_start, "u4")
    vertices = np.ascontiguousarray(mesh.face_vertices, "u4")
    keep.extend((points, start, vertices))
    made = _c.Mesh(size=c.sizeof(_c.Mesh), points=_address(points), point_count=len(points))
    made.face_start, made.face_count = _address(start), max(len(start) - 1, 0)
    made.face_vertices, made.face_vertex_count = _address(vertices), len(vertices)
    if len(mesh.addresses):
        addresses = np.ascontiguousarray(mesh.addresses, "u4")
        keep.append(addresses)
        made.addresses = _address(addresses)
    return made


def _curve(curve: Curve, keep: List[Any]) -> _c.Curve:
    points = np.ascontiguousarray(curve.homogeneous, "f8")
    keep.append(points)
    return _c.Curve(size=c.sizeof(_c.Curve), closed=int(curve.closed), points=_address(points), point_count=len(points))


def _panels(panels: Panels, keep: List[Any]) -> _c.Panels:
    made = _c.Panels(size=c.sizeof(_c.Panels), thickness=panels.thickness)
    made.panel_count, made.corner_count = len(panels), len(panels.front)
    for name, dtype in PANEL_ARRAYS.items():
        array = np.ascontiguousarray(getattr(panels, name), dtype)
        keep.append(array)
        setattr(made, name, _address(array) if array.size else None)
    return made


def _table(table: Table, keep: List[Any]) -> _c.Table:
    names = {name: name.encode() for name in table.attributes}
    keep.append(names)
    attributes = [
        _c.Attribute(name=_text(names[name], keep), column=column(items, keep)) for name, items in table.attributes.items()
    ]
    array = (_c.Attribute * len(attributes))(*attributes)
    keep.append(array)
    made = _c.Table(size=c.sizeof(_c.Table), attribute_stride=c.sizeof(_c.Attribute), row_count=table.rows)
    made.attributes, made.attribute_count = (c.addressof(array) if attributes else None), len(attributes)
    return made


def _text(data: bytes, keep: List[Any]) -> _c.Str:
    buffer = c.create_string_buffer(data, len(data) + 1)
    keep.append(buffer)
    return _c.Str(ptr=c.addressof(buffer), len=len(data))


# What is a struct in C: its kind and how it is made.
STRUCTS: Dict[str, Tuple[int, Callable[[Any, List[Any]], Any]]] = {
    "text": (TEXT, lambda text, keep: _text(text.encode(), keep)),
    "curve": (CURVE, _curve),
    "mesh": (MESH, _mesh),
    "panels": (PANELS, _panels),
    "table": (TABLE, _table),
}


def _type(item: Any) -> str:
    """The type of one item, as graphs call it; numbers, integers and points go together."""
    for kind, name in ((str, "text"), (Curve, "curve"), (Mesh, "mesh"), (Panels, "panels"), (Table, "table")):
        if isinstance(item, kind):
            return name
    if hasattr(item, "to_vertices_and_faces"):
        return "mesh"
    if isinstance(item, (bool, np.bool_)):
        return "boolean"
    return "point" if np.ndim(item) else "number"


def _list(items: Sequence[Any], keep: List[Any]) -> _c.Column:
    """Items of one type; None is a gap."""
    there = [item for item in items if item is not None]
    if items and not there:
        raise TypeError("a list of nothing but gaps has no type")
    first = _type(there[0]) if there else "number"
    for i, item in enumerate(items):
        if item is not None and _type(item) != first:
            raise TypeError(
                f"item {i} is a {_type(item)} in a list that begins with a {first}: the items of a list are of one type"
            )
    # What stands in a gap has to be sound, and is not looked at.
    filled = [there[0] if item is None else item for item in items]
    if first in STRUCTS:
        kind, make = STRUCTS[first]
        made = _structs(kind, [make(item, keep) for item in filled], keep)
    else:
        made = _array(np.asarray(filled), keep)
    if len(there) < len(items):
        valid = np.array([item is not None for item in items], "u1")
        keep.append(valid)
        made.valid = _address(valid)
    return made


def _array(array: "np.ndarray[Any, Any]", keep: List[Any]) -> _c.Column:
    if array.ndim == 2 and array.shape[1] == 3 and array.dtype.kind in "fiu":
        return _plain(POINT, np.ascontiguousarray(array, "f8"), 24, keep)
    if array.ndim <= 1 and array.dtype.kind in "fiub":
        array = np.atleast_1d(array)
        if array.dtype.kind == "b":
            return _plain(BOOLEAN, np.ascontiguousarray(array, "u1"), 1, keep)
        if array.dtype.kind == "f":
            return _plain(NUMBER, np.ascontiguousarray(array, "f8"), 8, keep)
        return _plain(INTEGER, np.ascontiguousarray(array, "i8"), 8, keep)
    raise TypeError(
        f"an array of {array.dtype} and shape {array.shape} cannot be given: numbers, points (n × 3), Vectors, Planes, texts, "
        "curves, meshes, panel sets and tables can"
    )


def column(value: Any, keep: List[Any]) -> _c.Column:
    """A column: an array of numbers or of points (n × 3), vectors, planes, one item, or a list of items of one type with None
    for gaps."""
    if isinstance(value, (Vectors, Planes)):
        kind, width = (VECTOR, 3) if isinstance(value, Vectors) else (PLANE, 4)
        array = np.ascontiguousarray(value.array, "f8").reshape(-1, width)
        return _plain(kind, array, 8 * width, keep)
    if isinstance(value, (list, tuple)):
        return _list(value, keep)
    if isinstance(value, np.ndarray):
        return _array(value, keep)
    return _list([value], keep)


def tree(value: Any) -> Tuple[_c.Tree, List[Any]]:
    """A C tree and what must live as long as it is looked at. A mapping from paths (tuples of integers) is a tree."""
    keep: List[Any] = []
    branches: List[_c.Branch] = []
    if isinstance(value, Mapping):
        for path, items in value.items():
            steps = (c.c_int32 * len(path))(*path)
            keep.append(steps)
            branches.append(_c.Branch(path=c.addressof(steps), path_count=len(path), column=column(items, keep)))
    else:
        branches.append(_c.Branch(path=None, path_count=0, column=column(value, keep)))
    array = (_c.Branch * len(branches))(*branches)
    keep.append(array)
    made = _c.Tree(size=c.sizeof(_c.Tree), branch_stride=c.sizeof(_c.Branch), branch_count=len(branches))
    made.branches = c.addressof(array)
    return made, keep
