"""Programs and screens for the tests of the window. TENON and TENON_EDITOR name the programs, built by scripts/test; TENON_WINDOW_PICTURES
a folder for a picture of the screen after every test."""

import os
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from window import Screen, Window

ROOT = Path(__file__).parents[2]


def program(variable, name):
    path = Path(os.environ.get(variable, ROOT / "target" / "debug" / name))
    assert path.is_file(), f"{path} is not built; {variable} may name another one"
    return path.resolve()


@pytest.fixture(scope="session")
def tenon():
    return program("TENON", "tenon")


@pytest.fixture(scope="session")
def screen():
    screen = Screen()
    yield screen
    screen.close()


@pytest.fixture
def window(request, screen, tmp_path):
    """window(graph) -> a window of a user of this test; all of them share their state folder, as a user's windows do."""
    opened = []

    def go(graph=None):
        opened.append(Window(program("TENON_EDITOR", "tenon-editor"), screen, tmp_path, graph))
        return opened[-1]

    yield go
    pictures = os.environ.get("TENON_WINDOW_PICTURES")
    for w in opened:
        if w.process.poll() is None:
            if pictures:
                w.picture(Path(pictures) / f"{request.node.name}.png")
            w.kill()
