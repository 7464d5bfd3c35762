"""LinuxCNC's interpreter `rs274` as judge of programs: refuses bad ones and says which moves the good ones make."""

import os
import re
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

TOOLS = Path(os.environ.get("TENON_TEST_TOOLS", Path(__file__).parents[2] / "target" / "tools"))
CALL = re.compile(r"N\.+ ([A-Z0-9_]+)\((.*)\)$")
# What a program of ours may make the interpreter do besides moving.
QUIET = {
    "COMMENT", "DWELL", "FINISH", "MESSAGE", "ON_RESET", "PALLET_SHUTTLE", "PROGRAM_END", "SELECT_PLANE", "SET_FEED_MODE",
    "SET_FEED_REFERENCE", "SET_G5X_OFFSET", "SET_G92_OFFSET", "SET_MOTION_CONTROL_MODE", "SET_SPINDLE_MODE",
    "SET_XY_ROTATION", "START_CHANGE", "USE_TOOL_LENGTH_OFFSET", "SET_SPINDLE_SPEED",
}  # fmt: skip


class Refused(Exception):
    """The interpreter refused the program; the text is its reason."""


@dataclass
class Move:
    """A straight move of the tool tip; a and b in degrees."""

    rapid: bool
    tool: int
    start: tuple  # x, y, z, a, b
    end: tuple
    feed: float
    spindle_on: bool


def interpret(program: Path, machine):
    """Moves of a program. Raises `Refused`."""
    root = TOOLS / "lcnc"
    env = dict(os.environ, LD_LIBRARY_PATH=f"{root}/usr/lib:{root}/usr/lib/x86_64-linux-gnu")
    with tempfile.TemporaryDirectory() as folder:
        table, variables = Path(folder, "tool.tbl"), Path(folder, "params.var")
        # The stand-alone interpreter reads tool tables in inches.
        rows = [f"T{t.number} P{t.number} D{2 * t.radius / 25.4:.6f} Z{t.length / 25.4:.6f}" for t in machine.tools.values()]
        table.write_text("\n".join(rows) + "\n")
        variables.write_text("5161\t0\n5220\t1\n")
        command = [root / "usr/bin/rs274", "-g", "-t", table, "-v", variables, program]
        run = subprocess.run(command, env=env, capture_output=True, text=True, cwd=folder, timeout=300)
    if run.returncode != 0:
        raise Refused(run.stderr.strip() or f"exit status {run.returncode}")
    return list(moves(run.stdout))


def moves(canonical: str):
    at, tool, selected, feed, spindle = (0.0,) * 5, None, None, 0.0, False
    for line in canonical.splitlines():
        call = CALL.search(line)
        if not call:
            raise Refused(f"the interpreter printed {line!r}")
        name, values = call.groups()
        if name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED"):
            to = tuple(float(v) for v in values.split(","))
            if to[5] != 0:
                raise Refused(f"a C axis moves: {line!r}")
            yield Move(name == "STRAIGHT_TRAVERSE", tool, at, to[:5], feed, spindle)
            at = to[:5]
        elif name == "SELECT_TOOL":
            selected = int(values)
        elif name == "CHANGE_TOOL":
            tool = selected
        elif name == "SET_FEED_RATE":
            feed = float(values)
        elif name == "START_SPINDLE_CLOCKWISE":
            spindle = True
        elif name == "STOP_SPINDLE_TURNING":
            spindle = False
        elif name == "USE_LENGTH_UNITS":
            if values != "CANON_UNITS_MM":
                raise Refused(f"units are not mm: {line!r}")
        elif name not in QUIET:
            raise Refused(f"the program does what no judge here understands: {line!r}")
        if name == "SET_G5X_OFFSET" and any(float(v) for v in values.split(",")[1:]):
            raise Refused(f"the work offset of the test bench is not zero: {line!r}")
