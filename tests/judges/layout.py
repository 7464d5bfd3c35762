"""Layouts judged with shapely: inside the board, clear of what is cut for others, no overlap, outlines true."""

import numpy as np
from shapely import MultiPoint, Polygon, STRtree, box

from outputs import apply

AREA = 1e-6  # mm², what rounding may make of two outlines that touch
LENGTH = 1e-6  # mm


def faults(outputs, inside="cleared"):
    """What is wrong with a layout, in words. `inside` is what must stay within the margin: "cleared" or "piece"."""
    layout, found = outputs.layout, []
    width, height = layout["size"]
    m = layout["margin"]
    usable = box(m, m, width - m, height - m)
    placed = [p["address"] for p in layout["pieces"]]
    if len(set(placed)) != len(placed):
        found.append("a piece is placed twice")
    missing = set(outputs.panels) - set(placed)
    if missing:
        found.append(f"{len(missing)} panels have no place: {sorted(missing)[:5]}")
    for board in range(layout["boards"]):
        pieces = [p for p in layout["pieces"] if p["board"] == board]
        if not pieces:
            found.append(f"board {board} is empty")
            continue
        outlines = [Polygon(p["piece"]) for p in pieces]
        cleared = [Polygon(p["cleared"]) for p in pieces]
        for p, outline, clear in zip(pieces, outlines, cleared):
            who = p["address"]
            if not outline.is_valid or outline.area == 0:
                found.append(f"{who}: the outline is no polygon")
            kept = clear if inside == "cleared" else outline
            if not usable.buffer(LENGTH).covers(kept):
                found.append(f"{who}: {kept.difference(usable).area:.3f} mm² beyond the usable board")
            if outline.difference(clear.buffer(LENGTH)).area > AREA:
                found.append(f"{who}: the outline is not inside what is cleared for it")
            found += untrue(outputs, p, outline)
        tree = STRtree(outlines)
        for i, clear in enumerate(cleared):
            for j in tree.query(clear):
                if i == j:
                    continue
                common = clear.intersection(outlines[j]).area
                if common > AREA:
                    found.append(f"{pieces[i]['address']} clears {common:.3f} mm² of {pieces[j]['address']}")
    return found


def untrue(outputs, placed, outline):
    """The outline against the shadow of the solid that panels.obj holds, and the solid against the board."""
    points = apply(outputs.to_board(placed), outputs.panels[placed["address"]].points)
    thickness = outputs.layout["thickness"]
    if abs(points[:, 2].min()) > LENGTH or abs(points[:, 2].max() - thickness) > LENGTH:
        yield f"{placed['address']}: lies between z = {points[:, 2].min()} and {points[:, 2].max()}, not in the board"
    shadow = MultiPoint(points[:, :2]).convex_hull
    if shadow.symmetric_difference(outline).area > 1e-4 + 1e-9 * shadow.area:
        yield f"{placed['address']}: the outline differs from the panel's shadow"
    frame = np.array(placed["frame"])[:, :3]
    if abs(frame @ frame.T - np.eye(3)).max() > 1e-12 or abs(np.linalg.det(frame) - 1) > 1e-12:
        yield f"{placed['address']}: the frame is no rigid motion"
