"""A hand-made part and program for trying the judges themselves: an independent contour by the published rules."""

import json
from math import atan2, degrees, hypot

import numpy as np
from shapely import MultiPoint

from removal import Part

THICKNESS = 21.0


def part(lean=(0.3, -0.2, 0.15, -0.35), turn=0.4):
    """A plate on the board z = 0 .. 21 whose four sides lean by these slopes (positive: wider below)."""
    c, s = np.cos(turn), np.sin(turn)
    corners = np.array([[0, 0], [180, 10], [190, 95], [-10, 80]]) @ np.array([[c, s], [-s, c]]) + [300, 200]
    top = np.column_stack([corners, np.full(4, THICKNESS)])
    normals = []
    for k in range(4):
        along = top[(k + 1) % 4] - top[k]
        n = np.cross(along / np.linalg.norm(along), [0, 0, 1]) + [0, 0, lean[k]]
        normals.append(n / np.linalg.norm(n))
    bottom = []
    for k in range(4):
        v = np.cross(normals[k - 1], normals[k])
        bottom.append(top[k] - v * (THICKNESS / v[2]))
    points = np.vstack([top, bottom])
    faces = [[0, 1, 2, 3], [7, 6, 5, 4]] + [[(k + 1) % 4, k, 4 + k, 4 + (k + 1) % 4] for k in range(4)]
    return Part("0.0", points, faces, [(np.array([330.0, 260.0, 21.0]), np.array([0, 0, -1.0]), 21.0, 2.0)])


def program(part, radius=10.0, deeper=0.0, flip_a=False, only=None, drill=True):
    """A contour in one pass with tool 10 around the part and its hole with tool 1, as text; `deeper` sinks every cut."""
    lines = ["G21 G90 G17 G40 G49 G80", "G54"]
    if drill:
        lines += ["T1 M6", "S12000 M3"]
        for entry, _, depth, _ in part.holes:
            x, y = entry[:2]
            lines += [f"G0 Z60 A0 B0", f"G0 X{x:.3f} Y{y:.3f}", f"G1 Z{21 - depth - 3:.3f} F1500", "G0 Z60"]
    lines += ["T10 M6", "S18000 M3", "G0 Z200"]
    for f in range(2, 6) if only is None else only:
        n = part.normals[f]
        along = np.cross([0, 0, 1], n)
        along /= np.linalg.norm(along)
        axis = np.cross(n, along)
        foot = part.points[part.faces[f]]
        low = min(foot, key=lambda p: p[2])
        ends = sorted(foot @ along)
        b = degrees(atan2(hypot(axis[0], axis[1]), axis[2]))
        a = degrees(atan2(axis[0], axis[1])) * (-1 if flip_a else 1)
        at = low + radius * n - 2 * axis - np.array([0, 0, deeper])
        first = at + along * (ends[0] - low @ along - 15)
        last = at + along * (ends[-1] - low @ along + 15)

        def xyz(p):
            return f"X{p[0]:.3f} Y{p[1]:.3f} Z{p[2]:.3f}"

        lines += [f"G0 {xyz(first + 90 * axis)} A{a:.3f} B{b:.3f}", f"G1 {xyz(first)} F1500"]
        lines += [f"G1 {xyz(last)} F3000", f"G1 {xyz(last + 90 * axis)} F4000", "G0 Z200"]
    return "\n".join(lines + ["M5", "M30", ""])


def write(folder, part, **faults):
    """The files of a run with this one part, for the judges of files."""
    outline = hull(part.points[:, :2])
    middle = outline.mean(axis=0)
    cleared = [list(middle + (p - middle) * 1.5) for p in outline]
    identity = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]
    piece = {"address": "0.0", "part": 0, "board": 0, "offset": [0, 0], "turn_deg": 0, "frame": identity}
    piece |= {"piece": [list(p) for p in outline], "cleared": cleared} | faults
    layout = {"size": [1500, 3000], "thickness": THICKNESS, "margin": 10, "boards": 1, "pieces": [piece]}
    (folder / "layout.json").write_text(json.dumps(layout))
    lines = ["# panels", "o 0.0"] + ["v " + " ".join(map(repr, map(float, p))) for p in part.points]
    lines += ["f " + " ".join(str(i + 1) for i in f) for f in part.faces]
    (folder / "panels.obj").write_text("\n".join(lines) + "\n")


def hull(points):
    return np.array(MultiPoint(points).convex_hull.exterior.coords)[-2::-1]
