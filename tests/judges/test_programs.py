"""rs274 on every program; its moves swept with manifold3d around parts, against the proof's report."""

import numpy as np
import pytest
from conftest import RUNS
from machine import Machine
from outputs import apply, to_board_from_part
from removal import Part, Sweeps, engraved_depth, gouge, leftover, undrilled
from rs274 import interpret

GOUGE, LEFTOVER = 0.005, 0.05


@pytest.fixture(scope="module")
def machine():
    return Machine()


@pytest.mark.parametrize("graph", RUNS)
def test_every_program_is_accepted_and_clear_of_the_board_at_rapid(outputs, machine, graph):
    made = outputs(graph)
    assert list(made.programs) == list(range(made.layout["boards"]))
    assert not list(made.folder.glob("*.unproven"))
    top = made.layout["thickness"]
    for file in made.programs.values():
        moves = interpret(file, machine)
        assert len(moves) > 100
        for m in moves:
            if m.rapid and m.tool is not None:
                lowest = min(low_point(machine, m.tool, pose) for pose in (m.start, m.end))
                assert lowest > top, f"{file.name}: a rapid to {m.end} comes down to {lowest:.3f}"
            assert m.rapid or (m.spindle_on and m.feed > 0 and m.tool in machine.tools), f"{file.name}: {m}"


def low_point(machine, tool, pose):
    """Lowest point of a tilted flat tool end."""
    return pose[2] - machine.tools[tool].radius * abs(np.sin(np.radians(pose[4])))


def chosen(made, count):
    """Placed pieces to look at: spread over the boards, the most undercut ones among them."""
    pieces = made.layout["pieces"]
    spread = np.linspace(0, len(pieces) - 1, count).round().astype(int)

    def undercut(k):
        return max(e["chamfer_deg"] for e in made.piece_of[pieces[k]["address"]]["edges"])

    steepest = sorted(range(len(pieces)), key=lambda k: (-undercut(k), k))[: max(2, count // 5)]
    return [pieces[k] for k in sorted({*spread.tolist(), *steepest})]


def part_on_board(made, placed):
    address = placed["address"]
    panel, place = made.panels[address], to_board_from_part(placed)
    holes = [
        (apply(place, h["entry"]), place[:3, :3] @ h["axis"], h["depth"], h["diameter"] / 2)
        for h in made.piece_of[address]["holes"]
        if not h["by_hand"]
    ]
    return Part(address, apply(made.to_board(placed), panel.points), panel.faces, holes)


@pytest.mark.parametrize("graph", RUNS)
def test_swept_moves_agree_with_the_proof(outputs, machine, deep, graph):
    made = outputs(graph)
    proven = {made.address_of[p["part"]]: p for p in made.proof["panels"] if p}
    thickness = made.layout["thickness"]
    sweeps = {board: Sweeps(interpret(file, machine), machine) for board, file in made.programs.items()}
    rows = []
    for placed in chosen(made, len(made.layout["pieces"]) if deep else 12 if graph.startswith("shell") else 4):
        part, s = part_on_board(made, placed), sweeps[placed["board"]]
        rows.append((part.address, gouge(part, s), *leftover(part, s, thickness), undrilled(part, s), engraved_depth(part, s)))
    assert len(rows) >= (10 if graph.startswith("shell") else 4)
    print(f"\n{graph}: part, gouge (proof), leftover (proof) in mm")
    for address, g, left, *_ in rows:
        p = proven[address]
        print(f"{address:>6} {g:.4f} ({p['gouge']:.4f})  {left:.4f} ({p['leftover']:.4f})")
    for address, g, left, face, wood, engraved in rows:
        p = proven[address]
        assert g <= GOUGE and p["gouge"] <= GOUGE, f"{address}: gouge {g}, the proof says {p['gouge']}"
        assert left <= LEFTOVER and p["leftover"] <= LEFTOVER, f"{address}, face {face}: {left} mm left, proof {p['leftover']}"
        # Both are upper bounds of the same thing; the 256-gon, 3 decimals in the program and sampling part them.
        assert abs(g - p["gouge"]) <= GOUGE and abs(left - p["leftover"]) <= 0.01, address
        assert wood < 1e-6, f"{address}: a hole keeps {wood:.1%} of its wood"
        assert engraved <= 2.0, f"{address}: engraved {engraved} mm deep"
    undercuts = [e["chamfer_deg"] for p in made.pieces["pieces"] for e in p["edges"]]
    if graph == "shell-21mm":
        assert max(undercuts) > 1 and min(undercuts) < -1, "chamfers must lean both ways"


@pytest.mark.parametrize("graph", RUNS)
def test_every_proof_passed(outputs, graph):
    made = outputs(graph)
    assert made.proof["pass"] is True
    judged = [p for p in made.proof["panels"] if p]
    assert {made.address_of[p["part"]] for p in judged} == set(made.panels)
    for p in judged:
        assert p["pass"] and p["gouge"] <= GOUGE and p["leftover"] <= LEFTOVER, p
    assert [p["pass"] for p in made.proof["programs"]] == [True] * made.layout["boards"]
