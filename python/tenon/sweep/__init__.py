"""Rows of sweeps in Python: plans that `tenon sweep plan` has made, evaluated by a warm engine into a folder.

    plan = tenon.sweep.Plan.read("plan.jsonl")
    sweep = tenon.sweep.Sweep()
    for row in plan:
        result = sweep.row(row, plan.folder, "results")

`tenon.sweep.dask` does the same on many processes and machines.
"""

from __future__ import annotations

import ctypes as c
import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, Iterator, List, Optional

from .. import _c, _callbacks
from .._c import LIB
from .._callbacks import Progress
from .._graph import Engine, PathLike, TenonError, _must, _Owned


@dataclass(frozen=True)
class Row:
    """A line of a plan. Its key is a digest of the graph, the values and the program: it names one result for ever."""

    key: str
    line: str

    @property
    def values(self) -> Dict[str, Any]:
        """What it sets."""
        values: Dict[str, Any] = json.loads(self.line)["set"]
        return values


@dataclass(frozen=True)
class Plan:
    """The rows of a sweep and the folder in which their graph is looked for."""

    rows: List[Row]
    folder: Path

    @classmethod
    def read(cls, path: PathLike) -> "Plan":
        """Reads a plan; rows that stand twice count once."""
        file = Path(path).resolve()
        rows: Dict[str, Row] = {}
        for number, line in enumerate(file.read_text("utf-8").splitlines(), 1):
            if line.strip():
                try:
                    key = json.loads(line)["key"]
                except (ValueError, KeyError, TypeError):
                    raise TenonError(f"{file}, line {number}: not a row of a sweep") from None
                rows.setdefault(str(key), Row(str(key), line.strip()))
        return cls(list(rows.values()), file.parent)

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[Row]:
        return iter(self.rows)


class Sweep(_Owned):
    """Evaluates rows one after another and keeps what they have in common."""

    _free = LIB.tenon_sweep_free

    def __init__(self, engine: Optional[Engine] = None) -> None:
        out = c.c_void_p()
        engine = engine or Engine()
        _must(LIB.tenon_sweep_new(engine._handle, c.byref(out)))
        super().__init__(out)

    def row(
        self, row: Row, folder: PathLike, results: PathLike, progress: Optional[Progress] = None
    ) -> Optional[Dict[str, Any]]:
        """What a row comes to, from its result in the folder `results` if that is there, else evaluated and written there;
        None if `progress` has cancelled. Nodes that failed stand in `diagnostics`, and `ok` is then False."""
        number = _callbacks.listen(progress, None)
        try:
            options = _c.Options(size=c.sizeof(_c.Options), context=number)
            if progress is not None:
                options.progress = _callbacks.progress
            places = [os.fspath(place).encode() for place in (folder, results)]
            out = c.c_void_p()
            _must(LIB.tenon_sweep_row(self._handle, row.line.encode(), *places, c.byref(options), c.byref(out)))
        finally:
            _callbacks.forget(number)
        if not out.value:
            return None
        try:
            result: Dict[str, Any] = json.loads(str(LIB.tenon_text_get(out)))
        finally:
            LIB.tenon_text_free(out)
        return result
