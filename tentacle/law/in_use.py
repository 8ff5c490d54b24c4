"""The written laws that this process uses beside the catalogue, and the caches that depend on them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar, cast

from tentacle.law.written_law import WrittenLaw

_F = TypeVar("_F", bound=Callable[..., Any])
ENVIRONMENT = "TENTACLE_EFFECTS"  # effect files of this process and those that it starts, parted as in PATH
_laws: tuple[WrittenLaw, ...] | None = None
_following: list[Callable[[], None]] = []


def laws_in_use() -> tuple[WrittenLaw, ...]:
    """The laws in use, in the order in which they were given: at first those of the files in TENTACLE_EFFECTS."""
    global _laws
    if _laws is None:
        from tentacle.io.effect_file import read_effects

        _laws = read_effects([Path(file) for file in os.environ.get(ENVIRONMENT, "").split(os.pathsep) if file])
    return _laws


def follows_laws(function: _F) -> _F:
    """The function with its results kept until the laws in use change."""
    kept = lru_cache(maxsize=64)(function)
    _following.append(kept.cache_clear)
    return cast(_F, kept)


@contextmanager
def using(laws: Sequence[WrittenLaw]) -> Iterator[None]:
    """These laws are in use too, within the context. ValueError where two have one name."""
    before = laws_in_use()
    wanted = (*before, *laws)
    if len({law.name for law in wanted}) < len(wanted):
        raise ValueError("two laws have one name")
    try:
        _set(wanted)
        yield
    finally:
        _set(before)


def _set(laws: tuple[WrittenLaw, ...]) -> None:
    global _laws
    if laws != _laws:
        _laws = laws
        for forget in _following:
            forget()
