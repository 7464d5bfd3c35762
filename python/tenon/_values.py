"""Values as they come out of a graph: numpy arrays are views of the engine's memory."""

from __future__ import annotations

import ctypes as c
from dataclasses import dataclass
from typing import Any, List, Optional, Tuple, Union

import numpy as np

from . import _c

NONE = 0xFFFFFFFF
Value = Union[np.ndarray, List[Any]]


def view(owner: Any, address: Optional[int], count: int, dtype: Any, width: int = 1) -> np.ndarray:
    """`count` rows of `width` numbers at an address, read-only; the array keeps `owner` alive."""
    dtype = np.dtype(dtype)
    if not address or not count:
        return np.empty((0, width) if width > 1 else 0, dtype)
    memory = (c.c_char * (count * width * dtype.itemsize)).from_address(address)
    memory._owner = owner
    array = np.frombuffer(memory, dtype)
    array.flags.writeable = False
    return array.reshape(count, width) if width > 1 else array


@dataclass(frozen=True)
class Curve:
    """A polyline in homogeneous coordinates, or several strips of one."""

    homogeneous: np.ndarray
    strip_start: np.ndarray
    closed: bool

    @property
    def points(self) -> np.ndarray:
        """The points in space, mm (computed)."""
        return self.homogeneous[:, :3] / self.homogeneous[:, 3:]


@dataclass(frozen=True)
class Mesh:
    """A polygon mesh: loops in compressed rows."""

    points: np.ndarray
    face_start: np.ndarray
    face_vertices: np.ndarray
    addresses: np.ndarray

    @property
    def faces(self) -> List[np.ndarray]:
        """Vertex indices of each face."""
        return np.split(self.face_vertices, self.face_start[1:-1]) if len(self.face_start) > 1 else []

    def to_compas(self) -> Any:
        """The mesh as a `compas.datastructures.Mesh`; needs compas."""
        from compas.datastructures import Mesh as CompasMesh

        return CompasMesh.from_vertices_and_faces(self.points.tolist(), [f.tolist() for f in self.faces])


@dataclass(frozen=True)
class Panels:
    """A panel set: one row per panel, or per corner (and edge) as `corner_start` says."""

    thickness: float
    corner_start: np.ndarray
    address: np.ndarray
    normal: np.ndarray
    front: np.ndarray
    vertex: np.ndarray
    chamfer: np.ndarray
    neighbour: np.ndarray
    side: np.ndarray
    back_start: np.ndarray
    back_end: np.ndarray
    voided: np.ndarray

    def __len__(self) -> int:
        return max(len(self.corner_start) - 1, 0)

    def corners(self, panel: int) -> slice:
        """Rows of a panel's corners and edges; empty for a panel that could not be made."""
        return slice(int(self.corner_start[panel]), int(self.corner_start[panel + 1]))

    def solid(self, panel: int) -> Tuple[np.ndarray, List[List[int]]]:
        """A panel as a closed polyhedron: points and the loops of its faces, counter-clockwise seen from outside."""
        rows = self.corners(panel)
        front, start, end = self.front[rows], self.back_start[rows], self.back_end[rows]
        n = len(front)
        points = [tuple(p) for p in front]
        index = {p: i for i, p in enumerate(points)}

        def at(p: np.ndarray) -> int:
            key = tuple(p)
            if key not in index:
                index[key] = len(points)
                points.append(key)
            return index[key]

        starts, ends = [at(p) for p in start], [at(p) for p in end]
        back: List[int] = []
        for k in range(n):
            back += [i for i in (starts[k], ends[k]) if not back or back[-1] != i]
        if len(back) > 1 and back[0] == back[-1]:
            back.pop()
        faces = [list(range(n)), back[::-1]]
        for k in range(n):
            following = (k + 1) % n
            faces.append([following, k, starts[k]] + ([ends[k]] if ends[k] != starts[k] else []))
            if ends[k - 1] != starts[k]:
                faces.append([k, ends[k - 1], starts[k]])
        return np.array(points), faces


@dataclass(frozen=True)
class Feature:
    """One machining feature on one panel; see tenon_feature in tenon_value.h."""

    kind: str
    panel: int
    edge: Optional[int]
    joint: Optional[int]
    by_hand: bool
    at: Tuple[float, float, float]
    to: Tuple[float, float, float]
    axis: Tuple[float, float, float]
    depth: float
    width: float
    line: np.ndarray
    text: str
    purpose: str


@dataclass(frozen=True)
class Features:
    """Features and the hardware that they take."""

    features: List[Feature]
    hardware: List[Tuple[str, int]]


@dataclass(frozen=True)
class File:
    """A file that the graph made; `withheld` says why it must not get its name unless a person insists."""

    name: str
    content: bytes
    withheld: Optional[str]


KINDS = ("drill", "slot", "pocket", "contour", "engraving")


def _curve(owner: Any, x: _c.Curve) -> Curve:
    return Curve(
        view(owner, x.points, x.point_count, "f8", 4),
        view(owner, x.strip_start, x.strip_count + 1, "u4"),
        bool(x.closed),
    )


def _mesh(owner: Any, x: _c.Mesh) -> Mesh:
    return Mesh(
        view(owner, x.points, x.point_count, "f8", 3),
        view(owner, x.face_start, x.face_count + 1, "u4"),
        view(owner, x.face_vertices, x.face_vertex_count, "u4"),
        view(owner, x.addresses, x.face_count, "u4", 3),
    )


def _panels(owner: Any, x: _c.Panels) -> Panels:
    n, k = x.panel_count, x.corner_count
    return Panels(
        x.thickness,
        view(owner, x.corner_start, n + 1, "u4"),
        view(owner, x.address, n, "u4", 3),
        view(owner, x.normal, n, "f8", 3),
        view(owner, x.front, k, "f8", 3),
        view(owner, x.vertex, k, "u4"),
        view(owner, x.chamfer, k, "f8", 4),
        view(owner, x.neighbour, k, "u4", 2),
        view(owner, x.side, k, "u1"),
        view(owner, x.back_start, k, "f8", 3),
        view(owner, x.back_end, k, "f8", 3),
        view(owner, x.voided, k, "?"),
    )


def _some(number: int) -> Optional[int]:
    return None if number == NONE else number


def _features(owner: Any, x: _c.Features) -> Features:
    features = []
    for i in range(x.feature_count):
        f = _c.Feature.from_address(x.features + i * x.feature_stride)
        vec = lambda v: (v.x, v.y, v.z)  # noqa: E731
        features.append(
            Feature(
                KINDS[f.kind], f.panel, _some(f.edge), _some(f.joint), bool(f.by_hand), vec(f.at), vec(f.to), vec(f.axis),
                f.depth, f.width, view(owner, f.line, f.line_count, "f8", 3), str(f.text), str(f.purpose),
            )
        )
    hardware = (_c.Hardware * x.hardware_count).from_address(x.hardware) if x.hardware_count else []
    return Features(features, [(str(h.name), h.count) for h in hardware])


def _file(_: Any, x: _c.File) -> File:
    content = c.string_at(x.bytes, x.byte_count) if x.byte_count else b""
    return File(str(x.name), content, str(x.withheld) or None)


PLAIN = {1: ("?", 1), 2: ("i8", 1), 3: ("f8", 1), 5: ("f8", 3), 6: ("f8", 3), 7: ("f8", 4)}
STRUCTS = {
    8: (_c.Curve, _curve),
    9: (_c.Mesh, _mesh),
    10: (_c.Panels, _panels),
    11: (_c.Features, _features),
    12: (_c.File, _file),
}


def column(owner: Any, x: _c.Column) -> Value:
    """A column: an array for numbers, points, vectors and planes, otherwise a list with None at gaps."""
    if x.kind in PLAIN:
        return view(owner, x.items, x.count, *PLAIN[x.kind])
    if x.kind == 4:
        items: List[Any] = [str(_c.Str.from_address(x.items + i * x.stride)) for i in range(x.count)]
    elif x.kind in STRUCTS:
        struct, make = STRUCTS[x.kind]
        items = [make(owner, struct.from_address(x.items + i * x.stride)) for i in range(x.count)]
    else:
        raise TypeError(f"values of type {x.type_name} do not cross; use Result.json")
    if x.valid:
        items = [item if good else None for item, good in zip(items, c.string_at(x.valid, x.count))]
    return items
