"""Material removal with manifold3d: sweeps of a program's moves against one part at a time.

Convex bodies of revolution become polygons: drawn around the tool for gouges and inside it for leftovers, so that they
err on the strict side (256 sides: 0.00075 mm at a radius of 10 mm; 64 sides: 0.0036 mm at the 3 mm of a drill)."""

from dataclasses import dataclass

import numpy as np
from manifold3d import Manifold, Mesh64, OpType

from machine import tool_axis

MILL_SIDES, DRILL_SIDES = 256, 64
TURN = 2.0  # degrees of turning per swept piece
REACH = 1.0  # mm above a designed face in which leftovers are looked for


@dataclass
class Part:
    """A convex part in its board's frame."""

    address: str
    points: np.ndarray
    faces: list
    holes: list  # (entry, axis, depth, radius), those that the machine makes

    def __post_init__(self):
        self.normals, self.offsets = [], []
        for loop in self.faces:
            p = self.points[loop]
            n = sum(np.cross(p[k] - p[0], p[k + 1] - p[0]) for k in range(1, len(p) - 1))
            n = n / np.linalg.norm(n)
            self.normals.append(n)
            self.offsets.append(float(np.mean(p @ n)))
        self.normals, self.offsets = np.array(self.normals), np.array(self.offsets)

    def depth(self, points):
        """How deep points lie in the part (negative outside), mm."""
        return (self.offsets - points @ self.normals.T).min(axis=1)


class Sweeps:
    """All moves of a program as pieces of constant or nearly constant tool axis, in columns."""

    def __init__(self, moves, machine):
        self.machine = machine
        rows = []
        for m in moves:
            if m.tool is None:
                continue
            a, b = np.array(m.start), np.array(m.end)
            n = max(1, int(np.ceil(np.abs(b[3:] - a[3:]).max() / TURN)))
            for k in range(n):
                rows.append(np.concatenate([a + (b - a) * (k / n), a + (b - a) * ((k + 1) / n), [m.tool]]))
        rows = np.array(rows).reshape(-1, 11)
        self.start, self.end, self.tool = rows[:, :3], rows[:, 5:8], rows[:, 10].astype(int)
        self.axis = [np.array([tool_axis(*q) for q in rows[:, c : c + 2]]).reshape(-1, 3) for c in (3, 8)]
        boxes = [self._box(t, u) for t, u in zip((self.start, self.end), self.axis)]
        self.low = np.minimum(boxes[0][0], boxes[1][0])
        self.high = np.maximum(boxes[0][1], boxes[1][1])

    def _box(self, tip, axis):
        """Boxes around whole tool, holder and spindle."""
        low, high = tip.copy(), tip.copy()
        for number, tool in self.machine.tools.items():
            mine = self.tool == number
            for h, r in sum([tool.cutter(), *tool.others(self.machine.spindle)], []):
                centre = tip[mine] + h * axis[mine]
                reach = r * np.sqrt(np.maximum(0, 1 - axis[mine] ** 2)) * 1.001
                low[mine] = np.minimum(low[mine], centre - reach)
                high[mine] = np.maximum(high[mine], centre + reach)
        return low, high

    def near(self, low, high, tools=None):
        """Indices of the pieces whose box meets the box low .. high."""
        hit = np.all((self.low <= high) & (self.high >= low), axis=1)
        if tools is not None:
            hit &= np.isin(self.tool, list(tools))
        return np.flatnonzero(hit)

    def rings(self, k, profile, outside, origin):
        """Points on a body of revolution at both ends of piece k; the sweep is their hull."""
        sides = DRILL_SIDES if self.machine.tools[self.tool[k]].kind == "drill" else MILL_SIDES
        ends = ((self.start[k], self.axis[0][k]), (self.end[k], self.axis[1][k]))
        travel = self.end[k] - self.start[k]
        along = travel @ ends[0][1]
        if np.array_equal(self.axis[0][k], self.axis[1][k]) and abs(along) > 0 and np.linalg.norm(travel - along * ends[0][1]) < 1e-9:
            # Along its own axis: a longer body of the same kind, without rings that lie on a line with others.
            low = self.start[k] if along > 0 else self.end[k]
            longer = profile[:-1] + [(profile[-1][0] + abs(along), profile[-1][1])]
            if profile[-1][1] == profile[-2][1]:
                return revolved(low - origin, ends[0][1], longer, sides, outside)
        return np.vstack([revolved(tip - origin, axis, profile, sides, outside) for tip, axis in ends])


def hull(points):
    """Convex hull, checked: manifold3d 3.5.4 can lose corners where many points lie in a plane or on a line."""
    solid = Manifold.hull_points(points)
    mesh = solid.to_mesh64()
    corners = np.asarray(mesh.vert_properties)[:, :3][np.asarray(mesh.tri_verts)]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normals, axis=1)
    sound = size > 1e-6
    normals, corners = normals[sound] / size[sound, None], corners[sound]
    outside = (points @ normals.T - np.sum(normals * corners[:, 0], axis=1)).max()
    if outside > 2e-4:
        raise ValueError(f"manifold3d's hull leaves out a point by {outside} mm")
    return solid


def revolved(foot, axis, profile, sides, outside):
    """Points of a body of revolution, its circles as polygons around them or inside."""
    x = np.cross(axis, [1, 0, 0] if abs(axis[0]) < 0.7 else [0, 1, 0])
    x /= np.linalg.norm(x)
    turn = np.arange(sides) * (2 * np.pi / sides)
    ring = np.outer(np.cos(turn), x) + np.outer(np.sin(turn), np.cross(axis, x))
    grow = 1 / np.cos(np.pi / sides) if outside else 1.0
    return np.vstack([foot + h * axis + (grow * r) * ring for h, r in profile])


def cylinder(foot, axis, length, radius):
    """A round cylinder's circumscribed prism."""
    return hull(revolved(foot, axis, [(0, radius), (length, radius)], DRILL_SIDES, True))


def closed(points, faces):
    """A manifold from loops; raises if they do not close."""
    triangles = np.array([[f[0], f[k], f[k + 1]] for f in faces for k in range(1, len(f) - 1)])
    solid = Manifold(Mesh64(np.asarray(points, dtype=np.float64), triangles.astype(np.uint64)))
    if solid.is_empty():
        raise ValueError(f"the solid does not close: {solid.status()}")
    return solid


def vertices(solid):
    return np.asarray(solid.to_mesh64().vert_properties)[:, :3]


def gouge(part, sweeps, exact=1e-4):
    """Deepest that any body enters the part outside its holes, mm, to within `exact`; engraving apart."""
    low, high = part.points.min(axis=0), part.points.max(axis=0)
    origin = (low + high) / 2
    local = Part(part.address, part.points - origin, part.faces, [])
    solid = closed(local.points, local.faces)
    holes = []
    for entry, axis, depth, radius in part.holes:
        slack = 0.005
        holes.append(cylinder(entry - origin - 100 * axis, axis, 100 + depth + slack, radius + slack))

    def core(depth):
        """The wood that lies deeper than this."""
        inner = solid
        for n, d in zip(local.normals, local.offsets):
            inner = inner.trim_by_plane(tuple(-n), float(depth - d))
        return Manifold.batch_boolean([inner, *holes], OpType.Subtract)

    deepest, below = 0.0, core(exact)
    for k in sweeps.near(low, high):
        tool = sweeps.machine.tools[sweeps.tool[k]]
        bodies = [] if tool.kind == "engraver" else [tool.cutter()]
        for profile in bodies + tool.others(sweeps.machine.spindle):
            rings = sweeps.rings(k, profile, True, origin)
            # Behind no face does it reach deeper than behind the one where it reaches least: often that settles it.
            most = float((local.offsets - rings @ local.normals.T).max(axis=0).min())
            if most <= deepest + exact:
                continue
            met = hull(rings) ^ below
            if met.volume() < 1e-9:
                continue
            # The corners of what is met all lie on the part's own faces when a body passes right through: halve.
            least = deepest
            while most - least > exact / 2:
                middle = (least + most) / 2
                if (met ^ core(middle)).volume() > 1e-9:
                    least = middle
                else:
                    most = middle
            deepest = least
            below = core(deepest + exact)
    return deepest


def engraved_depth(part, sweeps):
    """How deep the engraver's tip enters the part, mm."""
    low, high = part.points.min(axis=0), part.points.max(axis=0)
    deepest = 0.0
    for k in sweeps.near(low, high):
        if sweeps.machine.tools[sweeps.tool[k]].kind == "engraver":
            path = np.linspace(sweeps.start[k], sweeps.end[k], 20)
            deepest = max(deepest, float(part.depth(path).max()))
    return deepest


def leftover(part, sweeps, thickness):
    """Highest stock that still stands on a chamfer or node facet, measured along its normal, mm, up to `REACH`; and the
    face. Faces in the board's own two sides are not cut."""
    worst, where = 0.0, None
    middle = part.points.mean(axis=0)
    low, high = part.points.min(axis=0) - 2 * REACH, part.points.max(axis=0) + 2 * REACH
    cuts = []
    for k in sweeps.near(low, high):
        tool = sweeps.machine.tools[sweeps.tool[k]]
        if tool.kind == "end_mill":
            rings = sweeps.rings(k, tool.cutter(), False, middle)
            cuts.append((rings.min(axis=0), rings.max(axis=0), hull(rings)))
    for f, loop in enumerate(part.faces):
        n, d = part.normals[f], part.offsets[f]
        if abs(n[2]) > 1 - 1e-9:
            continue
        foot = part.points[loop] - middle
        around = np.vstack([foot, foot + REACH * n])
        low, high = around.min(axis=0), around.max(axis=0)
        stock = hull(around)
        stock = stock.trim_by_plane((0, 0, 1), float(-middle[2]))
        stock = stock.trim_by_plane((0, 0, -1), float(middle[2] - thickness))
        for least, most, cut in cuts:
            if np.all(least <= high) and np.all(most >= low) and not stock.is_empty():
                stock = stock - cut
        for piece in stock.decompose():
            if piece.volume() < 1e-9:
                continue
            height = vertices(piece) @ n - (d - middle @ n)
            if height.min() < 1e-4 and height.max() > worst:
                worst, where = float(height.max()), f
    return worst, where


def undrilled(part, sweeps):
    """Largest share of a hole's volume, less 0.05 mm at its wall and its point, that no drill has gone through."""
    worst = 0.0
    for entry, axis, depth, radius in part.holes:
        point = radius  # no drill of ours is blunter than 90 degrees nor as sharp as 45
        foot, length = entry - entry, depth - point - 0.05
        if length <= 0:
            continue
        wood = cylinder(foot, axis, length, radius - 0.05)
        whole = wood.volume()
        ends = np.array([entry, entry + depth * axis])
        for k in sweeps.near(ends.min(axis=0), ends.max(axis=0)):
            tool = sweeps.machine.tools[sweeps.tool[k]]
            if tool.kind == "drill" and not wood.is_empty():
                rings = sweeps.rings(k, tool.cutter(), False, entry)
                low, high = ends.min(axis=0) - entry, ends.max(axis=0) - entry
                if np.all(rings.min(axis=0) <= high) and np.all(rings.max(axis=0) >= low):
                    wood = wood - hull(rings)
        worst = max(worst, wood.volume() / whole)
    return worst
