"""Functions of Python that the library calls: one C function for each kind, which lives as long as the process, and a
number that says whose it is. A C function that belonged to a job could be gone while it runs."""

from __future__ import annotations

import itertools
import threading
from typing import Any, Callable, Dict, Optional, Tuple

from . import _c

Progress = Callable[[float, str], Any]
Done = Callable[[], Any]

_numbers = itertools.count(1)
_lock = threading.Lock()
_listeners: Dict[int, Tuple[Optional[Progress], Optional[Done]]] = {}
_lent: Dict[int, Any] = {}


def _progress(context: int, fraction: float, node: _c.Str) -> int:
    """Hands progress on; a function that raises or gives False cancels."""
    hear = _listeners.get(context, (None, None))[0]
    return int(hear is None or hear(fraction, str(node)) is not False)


def _done(context: int, _status: int) -> None:
    """Hands the end on, after which nothing more comes."""
    hear = forget(context)[1]
    if hear is not None:
        hear()


def _release(context: int) -> None:
    """Lets go of arrays that were lent."""
    with _lock:
        _lent.pop(context, None)


progress = _c.PROGRESS(_progress)
done = _c.DONE(_done)
release = _c.RELEASE(_release)


def listen(hear: Optional[Progress], ended: Optional[Done]) -> int:
    """A number for two functions, until `forget`."""
    number = next(_numbers)
    with _lock:
        _listeners[number] = (hear, ended)
    return number


def forget(number: int) -> Tuple[Optional[Progress], Optional[Done]]:
    """Takes the functions back."""
    with _lock:
        return _listeners.pop(number, (None, None))


def lend(objects: Any) -> int:
    """A number for what must live until `release`."""
    number = next(_numbers)
    with _lock:
        _lent[number] = objects
    return number


def take_back(number: int) -> None:
    """When nobody wanted it."""
    with _lock:
        _lent.pop(number, None)


def lent_count() -> int:
    """Arrays that the library still looks at: for tests."""
    with _lock:
        return len(_lent)
