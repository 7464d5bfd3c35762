"""What a run of a graph leaves in its folder, read by other means than our own."""

import json
import re
from dataclasses import dataclass
from functools import cached_property
from io import BytesIO
from pathlib import Path

import numpy as np
import trimesh


@dataclass
class Panel:
    """A closed solid: points, loops of point indices that look outwards, and the lines that the points were read from."""

    points: np.ndarray
    faces: list
    lines: list

    def mesh(self):
        """The solid as trimesh reads it from its own part of the OBJ file."""
        text = "\n".join(self.lines + ["f " + " ".join(str(i + 1) for i in f) for f in self.faces])
        return trimesh.load_mesh(BytesIO(text.encode()), "obj", process=False, maintain_order=True)


class Outputs:
    """The folder of one run; see docs/outputs.md for the files in it."""

    def __init__(self, folder):
        self.folder = Path(folder)

    @cached_property
    def layout(self):
        return json.loads((self.folder / "layout.json").read_text())

    @cached_property
    def pieces(self):
        return json.loads((self.folder / "pieces.json").read_text())

    @cached_property
    def proof(self):
        return json.loads((self.folder / "proof.json").read_text())

    @cached_property
    def piece_of(self):
        return {p["address"]: p for p in self.pieces["pieces"]}

    @cached_property
    def address_of(self):
        return {p["part"]: p["address"] for p in self.pieces["pieces"]}

    @property
    def programs(self):
        """Board number from 0 -> program file."""
        files = {int(re.search(r"(\d+)$", f.stem).group(1)) - 1: f for f in self.folder.glob("*.ngc")}
        return dict(sorted(files.items()))

    @cached_property
    def panels(self):
        """Address -> panel in the model."""
        panels, vertices = {}, 0
        for block in (self.folder / "panels.obj").read_text().split("\no ")[1:]:
            address, *lines = block.splitlines()
            points = [line for line in lines if line.startswith("v ")]
            faces = [[int(i) - 1 - vertices for i in line.split()[1:]] for line in lines if line.startswith("f ")]
            vertices += len(points)
            panels[address] = Panel(np.array([[float(x) for x in p.split()[1:]] for p in points]), faces, points)
        return panels

    def to_board(self, placed):
        """4 x 4 matrix model -> board frame of a placed piece of the layout."""
        frame = np.vstack([np.array(placed["frame"]), [0, 0, 0, 1]])
        return to_board_from_part(placed) @ frame


def to_board_from_part(placed):
    turn = np.radians(placed["turn_deg"])
    c, s = np.cos(turn), np.sin(turn)
    x, y = placed["offset"]
    return np.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, 0], [0, 0, 0, 1]])


def apply(matrix, points):
    return np.asarray(points) @ matrix[:3, :3].T + matrix[:3, 3]
