"""Runs of the example graphs, each made once and then judged."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(Path(__file__).parent))
GRAPHS = ["shell-256", "shell-21mm", "quad-mesh"]
# Meshes that nobody here wrote, with the length of their unit in mm. They are not ours to ship.
MESHES = ROOT.parent / "shared" / "data" / "meshes"
FOREIGN = {"quadmesh": 1000, "rhinomesh": 1000, "faces": 500}
RUNS = GRAPHS + [f"quad-mesh of {name}" for name in FOREIGN]


def pytest_addoption(parser):
    parser.addoption("--deep", action="store_true", help="judge more parts and more thread counts; takes long")


@pytest.fixture(scope="session")
def deep(request):
    return request.config.getoption("--deep")


@pytest.fixture(scope="session")
def tenon():
    """The program as people get it."""
    if "TENON" in os.environ:
        return Path(os.environ["TENON"])
    subprocess.run(["cargo", "build", "--release", "--quiet"], cwd=ROOT, check=True)
    return ROOT / "target" / "release" / "tenon"


@pytest.fixture(scope="session")
def run(tenon, tmp_path_factory):
    """run(graph, *arguments) -> folder of a fresh run's files; fails if the graph has errors."""

    def go(graph, *arguments):
        out = tmp_path_factory.mktemp(graph)
        command = [tenon, "run", ROOT / "graphs" / graph, "--out", out, *arguments]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=1200)
        assert done.returncode == 0, f"{graph} ended with {done.returncode}:\n{done.stdout}\n{done.stderr}"
        return out

    return go


@pytest.fixture(scope="session")
def outputs(run):
    """outputs(name) -> the files of one of RUNS, made once."""
    from outputs import Outputs

    made = {}

    def of(name):
        graph, _, mesh = name.partition(" of ")
        if name not in made:
            made[name] = Outputs(run(graph, *foreign(mesh)) if mesh else run(graph))
        return made[name]

    return of


def foreign(mesh):
    file = MESHES / f"{mesh}.obj"
    if not file.exists() and "CI" not in os.environ:
        pytest.skip(f"there is no {file}")
    return ["--set", f"mesh={file}", "--set", f"unit={FOREIGN[mesh]}"]
