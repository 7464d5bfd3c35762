"""A machine as its description file says, and where it holds the tool: written from the published rules, not from our
Rust. Angles in degrees as in programs, lengths in mm."""

import json
from math import cos, radians, sin, tan
from pathlib import Path

import numpy as np

MACHINES = Path(__file__).parents[2] / "nodes" / "machines"


class Machine:
    def __init__(self, name="maka-mm7s"):
        self.data = json.loads((MACHINES / f"{name}.json").read_text())
        self.tools = {t["number"]: Tool(t) for t in self.data["tools"]}
        self.spindle = self.data["spindle"]
        if self.data["primary"]["letter"] != "A" or self.data["secondary"]["letter"] != "B":
            raise ValueError("this judge knows the A/B head of the MAKA MM7s only")
        if not self.data["tip_control"]:
            raise ValueError("this judge knows programs in tip coordinates only")


def tool_axis(a, b):
    """Unit vector from tip to spindle: A turns about Z, from +Y, clockwise seen from above; B tilts from +Z."""
    a, b = radians(a), radians(b)
    return np.array([sin(a) * sin(b), cos(a) * sin(b), cos(b)])


class Tool:
    """Bodies of revolution about the tool axis as lists of (height above the tip, radius)."""

    def __init__(self, data):
        self.number = data["number"]
        self.radius = data["diameter"] / 2
        self.length = data["length"]
        self.cutting_length = data["cutting_length"]
        kind = data["kind"]
        self.kind = kind if isinstance(kind, str) else next(iter(kind))
        if self.kind == "drill":
            self.point = self.radius / tan(radians(kind["drill"]["point_angle"] / 2))
        elif self.kind == "engraver":
            self.point = self.radius / tan(radians(kind["engraver"]["tip_angle"] / 2))
        else:
            self.point = 0.0
        self.shank_radius = data["shank_diameter"] / 2
        self.holder = data["holder"]

    def cutter(self):
        tip = [(0.0, self.radius)] if self.point == 0 else [(0.0, 0.0), (self.point, self.radius)]
        return tip + [(self.cutting_length, self.radius)]

    def others(self, spindle):
        """Shank, holder and spindle: what must touch nothing."""
        bodies = [[(self.cutting_length, self.shank_radius), (self.length, self.shank_radius)]]
        bodies += [[(h["from"], h["radius_from"]), (h["to"], h["radius_to"])] for h in self.holder]
        nose = max([self.length] + [h["to"] for h in self.holder])
        bodies += [[(nose + s["from"], s["radius_from"]), (nose + s["to"], s["radius_to"])] for s in spindle]
        return bodies
