"""The judges themselves: they pass a sound program and catch each fault that they are there for."""

import pytest
import bench
from layout import faults
from machine import Machine
from outputs import Outputs
from removal import Sweeps, engraved_depth, gouge, leftover, undrilled
from rs274 import Refused, interpret


@pytest.fixture(scope="module")
def machine():
    return Machine()


def sweeps(tmp_path, machine, part, **faults):
    file = tmp_path / "p.ngc"
    file.write_text(bench.program(part, **faults))
    return Sweeps(interpret(file, machine), machine)


def test_a_sound_program_passes(tmp_path, machine):
    part = bench.part()
    s = sweeps(tmp_path, machine, part)
    assert gouge(part, s) <= 0.002
    assert leftover(part, s, bench.THICKNESS)[0] <= 0.003
    assert undrilled(part, s) == 0
    assert engraved_depth(part, s) == 0


def test_one_millimetre_too_deep_is_caught(tmp_path, machine):
    part = bench.part()
    found = gouge(part, sweeps(tmp_path, machine, part, deeper=1.0))
    # Sunk by 1 mm, the tool enters a side that is wider below by 1 mm times its normal's z.
    assert found == pytest.approx(part.normals[2:, 2].max(), abs=0.003)


def test_a_wrong_radius_leaves_or_takes_wood(tmp_path, machine):
    part = bench.part()
    assert leftover(part, sweeps(tmp_path, machine, part, radius=10.3), bench.THICKNESS)[0] == pytest.approx(0.3, abs=0.003)
    assert gouge(part, sweeps(tmp_path, machine, part, radius=9.7)) == pytest.approx(0.3, abs=0.003)


def test_a_gouge_of_six_microns_is_caught_and_one_of_two_is_not(tmp_path, machine):
    part = bench.part()
    assert gouge(part, sweeps(tmp_path, machine, part, radius=9.993)) > 0.005
    assert gouge(part, sweeps(tmp_path, machine, part, radius=9.998)) <= 0.005


def test_the_sign_of_a_is_caught(tmp_path, machine):
    part = bench.part()
    assert gouge(part, sweeps(tmp_path, machine, part, flip_a=True)) > 1


def test_a_side_that_was_forgotten_is_caught(tmp_path, machine):
    part = bench.part()
    height, face = leftover(part, sweeps(tmp_path, machine, part, only=[2, 3, 5]), bench.THICKNESS)
    assert height == pytest.approx(1.0) and face == 4


def test_a_hole_that_was_forgotten_is_caught(tmp_path, machine):
    part = bench.part()
    assert undrilled(part, sweeps(tmp_path, machine, part, drill=False)) == 1


def test_a_hole_beside_its_place_is_caught(tmp_path, machine):
    part = bench.part()
    s = sweeps(tmp_path, machine, part)
    entry, axis, depth, radius = part.holes[0]
    part.holes = [(entry + [1.0, 0, 0], axis, depth, radius)]
    assert gouge(part, s) > 0.5 and undrilled(part, s) > 0.1


@pytest.mark.parametrize(
    "line",
    ["G1 X1", "T99 M6", "G1 X1 X2 F100", "G1 Q5 X1 F100", "G2 X1 Y1 F100", "G0 Xabc", "M77", "G43.4", "(open comment", "G20"],
)
def test_the_interpreter_refuses_what_is_wrong(tmp_path, machine, line):
    file = tmp_path / "p.ngc"
    file.write_text(f"G21 G90\n{line}\nM30\n")
    with pytest.raises(Refused):
        interpret(file, machine)


def test_a_sound_layout_passes(tmp_path):
    bench.write(tmp_path, bench.part())
    assert faults(Outputs(tmp_path)) == []
    mesh = Outputs(tmp_path).panels["0.0"].mesh()
    assert mesh.is_watertight and mesh.volume > 0


@pytest.mark.parametrize(
    "fault, words",
    [
        ({"offset": [1, 0]}, "differs from the panel's shadow"),
        ({"cleared": [[0, 0], [1, 0], [1, 1]]}, "not inside what is cleared"),
        ({"frame": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 5]]}, "not in the board"),
        ({"frame": [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 1, 0]]}, "no rigid motion"),
        ({"cleared": [[0, 0], [900, 0], [900, 900], [0, 900]]}, "beyond the usable board"),
        ({"piece": [[0, 0], [1, 0], [1, 1]]}, "not inside what is cleared"),
        ({"board": 1}, "board 0 is empty"),
    ],
)
def test_each_fault_of_a_layout_is_caught(tmp_path, fault, words):
    bench.write(tmp_path, bench.part(), **fault)
    assert any(words in f for f in faults(Outputs(tmp_path)))


def test_clearing_a_neighbour_is_caught(tmp_path):
    bench.write(tmp_path, bench.part())
    made = Outputs(tmp_path)
    made.layout["pieces"].append(dict(made.layout["pieces"][0], address="0.1"))
    made.panels["0.1"] = made.panels["0.0"]
    assert any("0.0 clears" in f for f in faults(made))


def test_an_open_panel_is_caught(tmp_path):
    part = bench.part()
    part.faces = part.faces[:-1]
    bench.write(tmp_path, part)
    assert not Outputs(tmp_path).panels["0.0"].mesh().is_watertight
