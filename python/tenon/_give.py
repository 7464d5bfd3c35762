"""Python values as C trees, for inputs that a graph file cannot hold."""

from __future__ import annotations

import ctypes as c
from typing import Any, List, Mapping, Sequence, Tuple

import numpy as np

from . import _c
from ._values import Curve, Mesh

BOOLEAN, INTEGER, NUMBER, TEXT, POINT, VECTOR, CURVE, MESH = 1, 2, 3, 4, 5, 6, 8, 9


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


def column(value: Any, keep: List[Any]) -> _c.Column:
    """A column: an array of numbers or of points (n × 3), a mesh, a curve, a text, or a list of one of these."""
    if isinstance(value, str):
        value = [value]
    if isinstance(value, (Mesh, Curve)) or hasattr(value, "to_vertices_and_faces"):
        value = [value]
    if isinstance(value, (list, tuple)) and value and isinstance(value[0], str):
        texts = [text.encode() for text in value]
        keep.append(texts)
        buffers = [c.create_string_buffer(text, len(text) + 1) for text in texts]
        keep.append(buffers)
        strs = [_c.Str(ptr=c.addressof(b), len=len(text)) for b, text in zip(buffers, texts)]
        return _structs(TEXT, strs, keep)
    if isinstance(value, (list, tuple)) and value and isinstance(value[0], Curve):
        return _structs(CURVE, [_curve(one, keep) for one in value], keep)
    if isinstance(value, (list, tuple)) and value and (
        isinstance(value[0], Mesh) or hasattr(value[0], "to_vertices_and_faces")
    ):
        return _structs(MESH, [_mesh(one, keep) for one in value], keep)
    array = np.asarray(value)
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
        f"{type(value).__name__} of shape {array.shape} cannot be given: numbers, points (n × 3), texts, curves and meshes can"
    )


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
