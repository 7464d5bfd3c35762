"""Sweeps from Python: the command line's results, on one engine and on a Dask cluster that loses a worker."""

import hashlib
import json
import os
import shutil
import signal
import subprocess
import threading
from pathlib import Path

import pytest
import tenon
from tenon.sweep import Plan, Sweep
from test_others import other
from test_tenon import ROOT

TENON = os.environ.get("TENON") or shutil.which("tenon") or str(ROOT / "target" / "release" / "tenon")
VALUES = "thickness=12:16:8"


@pytest.fixture
def plan(tmp_path):
    """Eight rows of shell-256 with 64 panels each."""
    graph = ROOT / "graphs" / "shell-256"
    command = [TENON, "sweep", "plan", graph, "--set", "iterations=3", "--vary", VALUES, "--out", tmp_path / "plan.jsonl"]
    subprocess.run(command, check=True, capture_output=True)
    return tmp_path / "plan.jsonl"


def digests(folder):
    files = [f for f in sorted(folder.rglob("*")) if f.is_file() and not f.name.startswith(".") and f.name != "results.jsonl"]
    return {str(f.relative_to(folder)): hashlib.sha256(f.read_bytes()).hexdigest() for f in files}


def test_rows_are_those_of_the_command_line(plan, tmp_path):
    rows, sweep = Plan.read(plan), Sweep()
    assert len(rows) == 8 and rows.rows[0].values["iterations"] == 3
    for row in rows.rows[:2]:
        result = sweep.row(row, rows.folder, tmp_path / "ours")
        assert result["ok"] and result["key"] == row.key and result["set"] == row.values
        done = [TENON, "sweep", "run-row", plan, row.key, "--out", tmp_path / "theirs"]
        subprocess.run(done, check=True, capture_output=True)
    assert digests(tmp_path / "ours") == digests(tmp_path / "theirs") and digests(tmp_path / "ours")
    # What is finished is not evaluated again; what is damaged is.
    heard = []
    assert sweep.row(rows.rows[0], rows.folder, tmp_path / "ours", lambda *told: heard.append(told))["ok"]
    assert not heard
    (tmp_path / "ours" / rows.rows[0].key / "result.json").write_text("{}")
    assert sweep.row(rows.rows[0], rows.folder, tmp_path / "ours")["ok"]
    assert digests(tmp_path / "ours") == digests(tmp_path / "theirs")
    # Cancelled: nothing is written.
    assert sweep.row(rows.rows[2], rows.folder, tmp_path / "ours", lambda *_: False) is None
    assert not (tmp_path / "ours" / rows.rows[2].key).exists()


def test_what_is_no_row_is_refused(plan, tmp_path):
    with pytest.raises(tenon.TenonError, match="line 1: not a row"):
        (tmp_path / "bad.jsonl").write_text("{}\n")
        Plan.read(tmp_path / "bad.jsonl")
    row, sweep = Plan.read(plan).rows[0], Sweep()
    changed = json.loads(row.line)
    changed["set"]["thickness"] = 11
    with pytest.raises(tenon.TenonError, match="another than when row"):
        sweep.row(tenon.sweep.Row(row.key, json.dumps(changed)), plan.parent, tmp_path / "out")
    with pytest.raises(tenon.TenonError, match="cannot be read"):
        sweep.row(tenon.sweep.Row(row.key, row.line.replace("shell-256", "shell-257")), tmp_path, tmp_path / "out")


def test_a_cluster_that_loses_a_worker_finishes_the_plan(plan, tmp_path):
    distributed = other("distributed")
    from tenon.sweep import dask

    rows = Plan.read(plan)
    killed = threading.Event()

    def each(done):
        # After the first result its worker dies as a machine does, in the middle of its next row.
        if not killed.is_set():
            killed.set()
            os.kill(done.worker, signal.SIGKILL)

    with distributed.LocalCluster(
        n_workers=3, threads_per_worker=1, processes=True, dashboard_address=None, local_directory=tmp_path / "dask"
    ) as cluster, distributed.Client(cluster) as client:
        before = set(client.run(os.getpid).values())
        done = dask.run(rows, tmp_path / "results", client, each=each)
        assert killed.is_set() and [d.key for d in done] == [r.key for r in rows] and all(d.ok for d in done)
        assert before - set(client.run(os.getpid).values()), "no worker has died"
        assert len({d.worker for d in done}) > 1
        # Again, by new tasks: found, not evaluated.
        stamps = {d.path: (d.path / "result.json").stat().st_mtime_ns for d in done}
        client.restart()
        again = dask.run(rows, tmp_path / "results", client)
        assert {d.path: (d.path / "result.json").stat().st_mtime_ns for d in again} == stamps
    # The same bytes as one machine makes.
    subprocess.run([TENON, "sweep", "run", plan, "--out", tmp_path / "alone"], check=True, capture_output=True)
    assert digests(tmp_path / "results") == digests(tmp_path / "alone")


def test_the_slurm_script_of_the_book_runs_a_row(plan, tmp_path):
    book = (ROOT / "docs" / "hosts.md").read_text()
    script = book.split("```bash\n#!/bin/bash\n#SBATCH", 1)[1].split("```", 1)[0]
    environment = {**os.environ, "PATH": f"{Path(TENON).parent}:{os.environ['PATH']}", "SLURM_ARRAY_TASK_ID": "3"}
    subprocess.run(["bash", "-ec", "#SBATCH" + script], check=True, cwd=plan.parent, env=environment, capture_output=True)
    assert (plan.parent / "results" / Plan.read(plan).rows[2].key / "result.json").exists()
