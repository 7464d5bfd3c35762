"""Engine, graph and result."""

from __future__ import annotations

import ctypes as c
import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, List, Mapping, Optional, Sequence, Tuple, Union

from . import _c, _callbacks, _give
from ._c import LIB
from ._callbacks import Progress
from ._values import Preview, Value, column, preview

if TYPE_CHECKING:
    import numpy as np

PathLike = Union[str, "os.PathLike[str]"]


class TenonError(Exception):
    """A call was refused or a graph failed. `node` names the node concerned, if there is one."""

    def __init__(self, message: str, node: str = "") -> None:
        super().__init__(message)
        self.node = node


def _must(error: Optional[int]) -> None:
    if error:
        message, node = str(LIB.tenon_error_message(error)), str(LIB.tenon_error_node(error))
        LIB.tenon_error_free(error)
        raise TenonError(message, node)


def _text(call: Callable[..., Optional[int]], *arguments: Any) -> str:
    out = c.c_void_p()
    _must(call(*arguments, c.byref(out)))
    text = str(LIB.tenon_text_get(out))
    LIB.tenon_text_free(out)
    return text


def _texts(texts: Iterable[Union[str, bytes]]) -> Tuple[Any, int]:
    """Texts as C wants them, and how many."""
    encoded = [os.fsencode(text) for text in texts]
    return (c.c_char_p * len(encoded))(*encoded), len(encoded)


def version() -> Tuple[int, int]:
    """Major and minor version of the interface."""
    number = LIB.tenon_version()
    return number >> 16, number & 0xFFFF


def handle_count() -> int:
    """Handles that are alive: for tests of leaks."""
    return int(LIB.tenon_handle_count())


class _Owned:
    """A handle that is freed with its object."""

    _free: Callable[[Any], None]

    def __init__(self, handle: c.c_void_p) -> None:
        self._handle = handle

    def __del__(self) -> None:
        handle = getattr(self, "_handle", None)
        if handle:
            type(self)._free(handle)


class Engine(_Owned):
    """Node types and settings that graphs share."""

    _free = LIB.tenon_engine_free

    def __init__(
        self,
        threads: int = 0,
        plugins: Sequence[PathLike] = (),
        search: bool = False,
        folders: Sequence[PathLike] = (),
        isolate: Sequence[str] = (),
    ) -> None:
        """`plugins` are libraries, `folders` hold libraries, `search` looks where the user keeps them; `isolate` names plugins
        (or "all") that run in processes of their own whatever a graph says."""
        config = _c.Config(size=c.sizeof(_c.Config), threads=threads, search=int(search))
        config.plugins, config.plugin_count = _texts(map(os.fspath, plugins))
        config.folders, config.folder_count = _texts(os.path.abspath(folder) for folder in folders)
        config.isolate, config.isolate_count = _texts(isolate)
        out = c.c_void_p()
        _must(LIB.tenon_engine_new(c.byref(config), c.byref(out)))
        super().__init__(out)

    def describe(self, node_type: Optional[str] = None) -> Any:
        """A node type's description, or all of them."""
        name = None if node_type is None else node_type.encode()
        return json.loads(_text(LIB.tenon_engine_describe, self._handle, name))


@dataclass(frozen=True)
class Diagnostic:
    """What is wrong, and where."""

    severity: str
    code: str
    message: str
    hint: str
    node: str
    port: str
    item: Optional[int]

    def __str__(self) -> str:
        place = f" {self.node}.{self.port}" if self.port else f" {self.node}" if self.node else ""
        hint = f" ({self.hint})" if self.hint else ""
        return f"{self.severity}[{self.code}]{place}: {self.message}{hint}"


@dataclass(frozen=True)
class NodeReport:
    """What happened to a node in an evaluation."""

    node: str
    type_name: str
    happened: str
    seconds: float
    bytes: int


class Result(_Owned):
    """What an evaluation came to; values are views of it and keep it alive."""

    _free = LIB.tenon_result_free

    @property
    def ok(self) -> bool:
        """No diagnostic is an error, and nobody cancelled."""
        return int(LIB.tenon_result_status(self._handle)) == 0

    @property
    def cancelled(self) -> bool:
        """Somebody cancelled; there are no values."""
        return int(LIB.tenon_result_status(self._handle)) == 1

    @property
    def diagnostics(self) -> List[Diagnostic]:
        """Errors, warnings and notes."""
        found = []
        for i in range(LIB.tenon_result_diagnostic_count(self._handle)):
            d = _c.Diagnostic(size=c.sizeof(_c.Diagnostic))
            _must(LIB.tenon_result_diagnostic(self._handle, i, c.byref(d)))
            severity = ("note", "warning", "error")[d.severity]
            item = None if d.item == 2**64 - 1 else d.item
            found.append(
                Diagnostic(severity, str(d.code), str(d.message), str(d.hint), str(d.node), str(d.port), item)
            )
        return found

    @property
    def nodes(self) -> List[NodeReport]:
        """The nodes that were looked at."""
        found = []
        for i in range(LIB.tenon_result_node_count(self._handle)):
            n = _c.NodeReport(size=c.sizeof(_c.NodeReport))
            _must(LIB.tenon_result_node(self._handle, i, c.byref(n)))
            found.append(NodeReport(str(n.node), str(n.type_name), str(n.happened), n.nanoseconds * 1e-9, n.bytes))
        return found

    def tree(self, output: str) -> Dict[Tuple[int, ...], Value]:
        """An output's branches by path."""
        tree = _c.Tree(size=c.sizeof(_c.Tree))
        _must(LIB.tenon_result_output(self._handle, output.encode(), c.byref(tree)))
        branches = {}
        for i in range(tree.branch_count):
            branch = _c.Branch.from_address(tree.branches + i * tree.branch_stride)
            path = (c.c_int32 * branch.path_count).from_address(branch.path) if branch.path_count else ()
            branches[tuple(path)] = column(self, branch.column)
        return branches

    def __getitem__(self, output: str) -> Any:
        """An output: the item itself if there is one alone, else the list or array of the first branch."""
        branches = list(self.tree(output).values())
        if len(branches) != 1:
            raise TenonError(f"{output} has {len(branches)} branches; use Result.tree")
        items = branches[0]
        return items[0] if len(items) == 1 else items

    def json(self, output: str) -> Any:
        """An output as JSON, for types that do not cross."""
        return json.loads(_text(LIB.tenon_result_json, self._handle, output.encode()))

    def preview(self, output: str) -> Preview:
        """An output as triangles, lines and points for a viewport: views of the result's memory."""
        seen = _c.Preview(size=c.sizeof(_c.Preview))
        _must(LIB.tenon_result_preview(self._handle, output.encode(), c.byref(seen)))
        return preview(self, seen)

    def check(self) -> "Result":
        """Raises a TenonError if something is missing."""
        if not self.ok:
            errors = [d for d in self.diagnostics if d.severity == "error"]
            message = "\n".join(map(str, errors)) or "cancelled"
            raise TenonError(message, errors[0].node if errors else "")
        return self


class Graph(_Owned):
    """A graph being worked on."""

    _free = LIB.tenon_graph_free

    @classmethod
    def load(cls, path: PathLike, engine: Optional[Engine] = None) -> "Graph":
        """Loads a `*.tenon.json`, or the one that a folder holds."""
        file = Path(path)
        if file.is_dir():
            found = sorted(file.glob("*.tenon.json"))
            if len(found) != 1:
                raise TenonError(f"{file} holds {len(found)} graphs")
            file = found[0]
        return cls.from_text(file.read_bytes(), file.parent, engine)

    @classmethod
    def from_text(
        cls, text: Union[str, bytes, Mapping[str, Any]], folder: Optional[PathLike] = None, engine: Optional[Engine] = None
    ) -> "Graph":
        """A graph from its text or from a dict; `folder` is where the files that it names are looked for."""
        if isinstance(text, Mapping):
            text = json.dumps(text)
        data = text.encode() if isinstance(text, str) else text
        place = None if folder is None else os.fspath(Path(folder).resolve()).encode()
        engine = engine or Engine()
        out = c.c_void_p()
        _must(LIB.tenon_graph_load(engine._handle, data, len(data), place, c.byref(out)))
        return cls(out)

    def set(self, values: Optional[Mapping[str, Any]] = None, **named: Any) -> "Graph":
        """Sets inputs: interface names as keywords, `node.port` in a dict. None brings a default back."""
        for name, value in {**(values or {}), **named}.items():
            plain = value.tolist() if hasattr(value, "tolist") else value
            _must(LIB.tenon_graph_set(self._handle, name.encode(), json.dumps(plain).encode()))
        return self

    def add(self, node: str, node_type: str) -> "Graph":
        """Adds a node."""
        _must(LIB.tenon_graph_add_node(self._handle, node.encode(), node_type.encode()))
        return self

    def remove(self, node: str) -> "Graph":
        """Removes a node and its wires."""
        _must(LIB.tenon_graph_remove_node(self._handle, node.encode()))
        return self

    def connect(self, source: str, target: str) -> "Graph":
        """Wires `node.port` to `node.port`."""
        node, _, port = target.partition(".")
        _must(LIB.tenon_graph_connect(self._handle, source.encode(), node.encode(), port.encode()))
        return self

    def disconnect(self, source: str, target: str) -> "Graph":
        """Takes a wire away."""
        node, _, port = target.partition(".")
        _must(LIB.tenon_graph_disconnect(self._handle, source.encode(), node.encode(), port.encode()))
        return self

    @property
    def inputs(self) -> List[Dict[str, Any]]:
        """The interface's inputs: name, ports, doc, unit, type, access, min, max, choices, default, value."""
        found: List[Dict[str, Any]] = json.loads(_text(LIB.tenon_graph_interface, self._handle, 0))
        return found

    @property
    def outputs(self) -> List[Dict[str, Any]]:
        """The interface's outputs: name, ports, doc, unit, type, access."""
        found: List[Dict[str, Any]] = json.loads(_text(LIB.tenon_graph_interface, self._handle, 1))
        return found

    def save(self) -> str:
        """The graph's text with all values set so far."""
        return _text(LIB.tenon_graph_save, self._handle)

    def evaluate(self, *outputs: str, progress: Optional[Progress] = None) -> Result:
        """Brings outputs up to date, all of the interface if none is named. `progress` gets fraction and node; giving
        False cancels. Other Python threads go on meanwhile."""
        names = [name.encode() for name in outputs]
        array = (c.c_char_p * len(names))(*names)
        number = _callbacks.listen(progress, None)
        try:
            options = _c.Options(size=c.sizeof(_c.Options), context=number)
            if progress is not None:
                options.progress = _callbacks.progress
            out = c.c_void_p()
            _must(LIB.tenon_graph_evaluate(self._handle, array, len(names), c.byref(options), c.byref(out)))
        finally:
            _callbacks.forget(number)
        return Result(out)

    def start(
        self, *outputs: str, progress: Optional[Progress] = None, done: Optional[Callable[[], Any]] = None
    ) -> "Job":
        """The same on a thread of its own; returns at once. The job is of the graph as it stands now: what is set from then
        on is for the next one. `done` is called on the job's thread when it has ended, also when it was cancelled."""
        names = [name.encode() for name in outputs]
        array = (c.c_char_p * len(names))(*names)
        number = _callbacks.listen(progress, done)
        options = _c.Options(size=c.sizeof(_c.Options), context=number, done=_callbacks.done)
        if progress is not None:
            options.progress = _callbacks.progress
        out = c.c_void_p()
        try:
            _must(LIB.tenon_graph_start(self._handle, array, len(names), c.byref(options), c.byref(out)))
        except TenonError:
            _callbacks.forget(number)
            raise
        return Job(out)

    def give(self, name: str, value: Any) -> "Graph":
        """Sets an input to what a graph file cannot hold: an array of numbers or points (n × 3), `Vectors`, `Planes`, a `Mesh`
        or a compas mesh, a `Curve`, `Panels`, a `Table`, a list of one of these with None for gaps, or a dict of them by path.
        It is copied. It stands until the input is set otherwise and is not part of `save`."""
        tree, keep = _give.tree(value)
        _must(LIB.tenon_graph_give(self._handle, name.encode(), c.byref(tree)))
        del keep
        return self

    def share(self, name: str, array: "np.ndarray[Any, Any]") -> "Graph":
        """As `give`, without a copy of a contiguous array of float64 or int64: it is made read-only and kept as long as
        the engine looks at it."""
        tree, keep = _give.tree(array)
        array.flags.writeable = False
        number = _callbacks.lend(keep)
        try:
            _must(LIB.tenon_graph_share(self._handle, name.encode(), c.byref(tree), _callbacks.release, number))
        except TenonError:
            _callbacks.take_back(number)
            raise
        return self

    def cancel(self) -> None:
        """Stops the evaluation that runs, from another thread."""
        LIB.tenon_graph_cancel(self._handle)


class Job(_Owned):
    """An evaluation on a thread of its own. Dropping it cancels it."""

    _free = LIB.tenon_job_free

    def wait(self, timeout: Optional[float] = None) -> Optional[Result]:
        """The result, waiting for it `timeout` seconds at most (as long as it takes if None); None if it has not ended."""
        milliseconds = 2**64 - 1 if timeout is None else min(max(round(timeout * 1000), 0), 2**63)
        out = c.c_void_p()
        _must(LIB.tenon_job_wait(self._handle, milliseconds, c.byref(out)))
        return Result(out) if out.value else None

    def result(self) -> Result:
        """The result, waiting for it as long as it takes."""
        result = self.wait()
        if result is None:
            raise TenonError("the job has not ended")
        return result

    @property
    def done(self) -> bool:
        """It has ended."""
        return self.wait(0) is not None

    @property
    def progress(self) -> float:
        """How far it is, 0 to 1."""
        return float(LIB.tenon_job_progress(self._handle))

    def cancel(self) -> None:
        """Asks it to stop: its result says that it was cancelled, unless it has ended by itself."""
        LIB.tenon_job_cancel(self._handle)
