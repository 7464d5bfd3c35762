"""Values as they come out of a graph: numpy arrays are views of the engine's memory."""

from __future__ import annotations

import ctypes as c
from dataclasses import dataclass
from importlib import import_module
from types import MappingProxyType
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import NDArray

from . import _c

NONE = 0xFFFFFFFF
Array = NDArray[Any]
Value = Union[Array, List[Any]]


def view(owner: Any, address: Optional[int], count: int, dtype: Any, width: int = 1) -> Array:
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

    homogeneous: Array
    strip_start: Array
    closed: bool

    @property
    def points(self) -> Array:
        """The points in space, mm (computed)."""
        return self.homogeneous[:, :3] / self.homogeneous[:, 3:]


@dataclass(frozen=True)
class Mesh:
    """A polygon mesh: loops in compressed rows."""

    points: Array
    face_start: Array
    face_vertices: Array
    addresses: Array

    @property
    def faces(self) -> List[np.ndarray]:
        """Vertex indices of each face."""
        return np.split(self.face_vertices, self.face_start[1:-1]) if len(self.face_start) > 1 else []

    @classmethod
    def from_faces(cls, points: Any, faces: Sequence[Sequence[int]]) -> "Mesh":
        """A mesh of points (n × 3, mm) and loops of vertex indices, counter-clockwise seen from the front."""
        start = np.cumsum([0] + [len(face) for face in faces]).astype("u4")
        vertices = np.array([v for face in faces for v in face], "u4")
        return cls(np.asarray(points, "f8").reshape(-1, 3), start, vertices, np.empty((0, 3), "u4"))

    @classmethod
    def from_compas(cls, mesh: Any) -> "Mesh":
        """A mesh of a `compas.datastructures.Mesh`, whose lengths are taken as mm."""
        points, faces = mesh.to_vertices_and_faces()
        return cls.from_faces(points, faces)

    def to_compas(self) -> Any:
        """The mesh as a `compas.datastructures.Mesh`; needs compas."""
        return _compas_mesh(self.points.tolist(), [f.tolist() for f in self.faces])


@dataclass(frozen=True)
class Panels:
    """A panel set: one row per panel, or per corner (and edge) as `corner_start` says."""

    thickness: float
    corner_start: Array
    address: Array
    normal: Array
    front: Array
    vertex: Array
    chamfer: Array
    neighbour: Array
    side: Array
    back_start: Array
    back_end: Array
    voided: Array

    def __len__(self) -> int:
        return max(len(self.corner_start) - 1, 0)

    def corners(self, panel: int) -> slice:
        """Rows of a panel's corners and edges; empty for a panel that could not be made."""
        return slice(int(self.corner_start[panel]), int(self.corner_start[panel + 1]))

    def solid(self, panel: int) -> Tuple[Array, List[List[int]]]:
        """A panel as a closed polyhedron: points and the loops of its faces, counter-clockwise seen from outside."""
        rows = self.corners(panel)
        front, start, end = self.front[rows], self.back_start[rows], self.back_end[rows]
        n = len(front)
        points = [tuple(p) for p in front]
        index = {p: i for i, p in enumerate(points)}

        def at(p: Array) -> int:
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


    def to_compas(self) -> List[Any]:
        """The panels that could be made as closed `compas.datastructures.Mesh`es named by their addresses; needs compas."""
        meshes = []
        for i in range(len(self)):
            points, faces = self.solid(i)
            if len(points):
                mesh = _compas_mesh(points.tolist(), faces)
                mesh.name = self.name(i)
                meshes.append(mesh)
        return meshes

    def name(self, panel: int) -> str:
        """A panel's row and column, behind its patch where there are several."""
        patch, row, column = (int(n) for n in self.address[panel])
        return f"{patch}/{row}/{column}" if self.address[:, 0].any() else f"{row}/{column}"


@dataclass(frozen=True)
class Vectors:
    """Vectors (n × 3), mm, to be given: an array alone would be points."""

    array: Any

    def __len__(self) -> int:
        return len(self.array)


@dataclass(frozen=True)
class Planes:
    """Planes (n × 4) to be given: a unit normal n and an offset d, mm; the points p with n·p = d."""

    array: Any

    def __len__(self) -> int:
        return len(self.array)


@dataclass(frozen=True)
class Opaque:
    """Values of a type that does not cross; `Result.json` shows them."""

    type_name: str
    count: int


@dataclass(frozen=True)
class Table:
    """A table of attributes: one value per row under each name, arrays for numbers, points, vectors and planes, lists for
    the rest. To be given, attributes may be whatever a list may be."""

    rows: int
    attributes: Mapping[str, Any]

    @classmethod
    def of(cls, **attributes: Any) -> "Table":
        """A table of lists or arrays that are as long as each other."""
        lengths = {name: len(items) for name, items in attributes.items()}
        if len(set(lengths.values())) > 1:
            raise ValueError(f"the attributes of a table have one value per row, but these have {lengths}")
        return cls(max(lengths.values(), default=0), attributes)

    def __len__(self) -> int:
        return self.rows

    def __getitem__(self, name: str) -> Any:
        return self.attributes[name]


@dataclass(frozen=True)
class Preview:
    """An output for a viewport. Triangles are counter-clockwise seen from outside; `parts` says per panel, face, curve or
    point where it stands: item, branch, element, patch, row, column."""

    node: str
    port: str
    origin: Array
    low: Array
    high: Array
    positions: Array
    normals: Array
    vertex_parts: Array
    triangles: Array
    lines: Array
    points: Array
    parts: Array


def _place(v: _c.Vec3) -> Array:
    return np.array([v.x, v.y, v.z])


PART = np.dtype(
    [("item", "u8"), ("branch", "u4"), ("element", "u4"), ("patch", "u4"), ("row", "u4"), ("column", "u4"), ("flags", "u4")]
)


def preview(owner: Any, x: _c.Preview) -> Preview:
    """The buffers as arrays that keep `owner` alive."""
    return Preview(
        str(x.node), str(x.port), _place(x.origin), _place(x.low), _place(x.high),
        view(owner, x.positions, x.vertex_count, "f4", 3),
        view(owner, x.normals, x.vertex_count, "f4", 3),
        view(owner, x.vertex_parts, x.vertex_count, "u4"),
        view(owner, x.triangles, x.triangle_count, "u4", 3),
        view(owner, x.lines, x.line_count, "u4", 2),
        view(owner, x.points, x.point_count, "u4"),
        view(owner, x.parts, x.part_count, PART),
    )


def _compas_mesh(points: Any, faces: Any) -> Any:
    return import_module("compas.datastructures").Mesh.from_vertices_and_faces(points, faces)


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
    line: Array
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


def _vec(v: _c.Vec3) -> Tuple[float, float, float]:
    return (v.x, v.y, v.z)


def _features(owner: Any, x: _c.Features) -> Features:
    features = []
    for i in range(x.feature_count):
        f = _c.Feature.from_address(x.features + i * x.feature_stride)
        features.append(
            Feature(
                KINDS[f.kind], f.panel, _some(f.edge), _some(f.joint), bool(f.by_hand), _vec(f.at), _vec(f.to), _vec(f.axis),
                f.depth, f.width, view(owner, f.line, f.line_count, "f8", 3), str(f.text), str(f.purpose),
            )
        )
    hardware = (_c.Hardware * x.hardware_count).from_address(x.hardware) if x.hardware_count else []
    return Features(features, [(str(h.name), h.count) for h in hardware])


def _file(_: Any, x: _c.File) -> File:
    content = c.string_at(x.bytes, x.byte_count) if x.byte_count else b""
    return File(str(x.name), content, str(x.withheld) or None)


def _table(owner: Any, x: _c.Table) -> Table:
    attributes = {}
    for i in range(x.attribute_count):
        a = _c.Attribute.from_address(x.attributes + i * x.attribute_stride)
        opaque = a.column.kind == OPAQUE
        attributes[str(a.name)] = Opaque(str(a.column.type_name), a.column.count) if opaque else column(owner, a.column)
    return Table(x.row_count, MappingProxyType(attributes))


OPAQUE = 65536
PLAIN = {1: ("?", 1), 2: ("i8", 1), 3: ("f8", 1), 5: ("f8", 3), 6: ("f8", 3), 7: ("f8", 4)}
STRUCTS: Dict[int, Tuple[Any, Callable[[Any, Any], Any]]] = {
    8: (_c.Curve, _curve),
    9: (_c.Mesh, _mesh),
    10: (_c.Panels, _panels),
    11: (_c.Features, _features),
    12: (_c.File, _file),
    14: (_c.Table, _table),
}


def column(owner: Any, x: _c.Column) -> Value:
    """A column: an array for numbers, points, vectors and planes (a copy with NaN at gaps, if there are any), otherwise a
    list with None at gaps."""
    if x.kind in PLAIN:
        array = view(owner, x.items, x.count, *PLAIN[x.kind])
        if not x.valid:
            return array
        good = view(owner, x.valid, x.count, "?")
        if array.dtype.kind != "f":
            return [item if there else None for item, there in zip(array.tolist(), good)]
        array = array.copy()
        array[~good] = np.nan
        return array
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
