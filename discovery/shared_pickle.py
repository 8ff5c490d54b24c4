"""Results from a forked process, in which what the parent has already is told by its place and not copied.

A forked process has its parent's objects at the same addresses. So a hypothesis that it returns need not carry the
recordings, filters and bases that it was made from: the parent puts its own objects there.
"""

from __future__ import annotations

import io
import pickle
from collections.abc import Iterable
from dataclasses import fields, is_dataclass
from functools import partial
from types import FunctionType
from typing import Any

import numpy as np


def reachable(roots: Iterable[Any]) -> dict[int, Any]:
    """The arrays, dataclasses and functions that can be reached from the roots, by their addresses. The dictionary
    keeps them alive, so that no address is used again.
    """
    found: dict[int, Any] = {}
    seen: set[int] = set()
    waiting = list(roots)
    while waiting:
        one = waiting.pop()
        if id(one) in seen:
            continue
        seen.add(id(one))
        if isinstance(one, np.ndarray):
            found[id(one)] = one
        elif is_dataclass(one) and not isinstance(one, type):
            found[id(one)] = one
            waiting += [getattr(one, field.name) for field in fields(one)]
            waiting += list(getattr(one, "__dict__", {}).values())  # cached properties too
        elif isinstance(one, dict):
            waiting += list(one.values())
        elif isinstance(one, list | tuple):
            waiting += list(one)
        elif isinstance(one, partial):
            waiting += [one.func, *one.args, *one.keywords.values()]
        elif isinstance(one, FunctionType):
            found[id(one)] = one
            waiting += [cell.cell_contents for cell in one.__closure__ or ()]
            waiting += list(one.__defaults__ or ()) + list((one.__kwdefaults__ or {}).values())
    return found


class _Sender(pickle.Pickler):
    def __init__(self, file: io.BytesIO, shared: dict[int, Any]) -> None:
        super().__init__(file, protocol=pickle.HIGHEST_PROTOCOL)
        self._shared = shared

    def persistent_id(self, obj: Any) -> int | None:
        return id(obj) if id(obj) in self._shared else None


class _Receiver(pickle.Unpickler):
    def __init__(self, file: io.BytesIO, shared: dict[int, Any]) -> None:
        super().__init__(file)
        self._shared = shared

    def persistent_load(self, pid: int) -> Any:
        return self._shared[pid]


def sent(result: Any, shared: dict[int, Any]) -> bytes:
    """The result as bytes, with addresses for what is shared."""
    file = io.BytesIO()
    _Sender(file, shared).dump(result)
    return file.getvalue()


def received(text: bytes, shared: dict[int, Any]) -> Any:
    """The result of `sent` in the process that has the shared objects. Only for bytes of an own process."""
    return _Receiver(io.BytesIO(text), shared).load()
