"""Sweeps on Dask: the rows of a plan on the workers of a cluster, for users who outgrow one machine.

    from dask.distributed import Client
    from tenon.sweep import Plan, dask

    done = dask.run(Plan.read("plan.jsonl"), "/shared/results", Client("scheduler:8786"))

Each row is a task named by its key, so a row that somebody asks for twice is evaluated once. A worker keeps one warm engine
per thread; its results are written into the folder, which all machines share, and only references travel. When a worker
dies its rows run elsewhere: nothing half-written is ever taken for a result, and what was finished is not evaluated again.
"""

from __future__ import annotations

import os
import threading
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple

from .._graph import Engine, PathLike
from . import Plan, Row, Sweep

_own = threading.local()


@dataclass(frozen=True)
class Done:
    """A row that is finished: where its result is and whether nodes have failed."""

    key: str
    path: Path
    ok: bool
    worker: int
    """Process that has looked after it last."""


def _warm(threads: int, plugins: Tuple[str, ...]) -> Sweep:
    """The engine of this thread of this worker: made once."""
    sweeps: Dict[Tuple[int, Tuple[str, ...]], Sweep] = _own.__dict__.setdefault("sweeps", {})
    key = (threads, plugins)
    if key not in sweeps:
        sweeps[key] = Sweep(Engine(threads=threads, plugins=plugins))
    return sweeps[key]


def _row(row: Row, folder: str, results: str, threads: int, plugins: Tuple[str, ...]) -> Done:
    result = _warm(threads, plugins).row(row, folder, results)
    # Nobody cancels here.
    assert result is not None
    return Done(row.key, Path(results) / row.key, bool(result["ok"]), os.getpid())


def run(
    plan: Plan,
    results: PathLike,
    client: Any,
    threads: int = 1,
    plugins: Sequence[PathLike] = (),
    retries: int = 3,
    each: Optional[Callable[[Done], Any]] = None,
) -> List[Done]:
    """Evaluates every row of a plan that has no result yet, on the workers of a `distributed.Client`, and gives all rows in
    the plan's order. `results` and the plan's folder must be the same folders on every machine. `threads` are those of one
    row; `each` hears of every row as it is finished. A row whose workers died more often than `retries` times raises what
    Dask says of it, after all other rows have ended."""
    distributed = import_module("distributed")
    place, names = os.path.abspath(os.fspath(results)), tuple(os.path.abspath(os.fspath(p)) for p in plugins)
    os.makedirs(place, exist_ok=True)
    futures = [
        # The folder is part of the name: the same row may be wanted in two.
        client.submit(
            _row, row, str(plan.folder), place, threads, names, key=f"tenon-row-{row.key}-{place}", retries=retries, pure=True
        )
        for row in plan
    ]
    for future in distributed.as_completed(futures):
        if each is not None and future.status == "finished":
            each(future.result())
    done: List[Done] = client.gather(futures)
    return done
