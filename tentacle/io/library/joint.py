"""The joint answer in a library's home: plain data of every arm, and what it says of each recording."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa

from tentacle.errors import InputError
from tentacle.io.written_file import written_file


def write_joint(arms: Sequence[Mapping[str, Any]], code: str, file: Path) -> None:
    """Write the arms' answers, whole or not at all."""
    file.parent.mkdir(parents=True, exist_ok=True)
    with written_file(file) as partial:
        partial.write_text(json.dumps({"code": code, "arms": list(arms)}, allow_nan=False) + "\n", encoding="utf-8")


def read_joint(file: Path) -> list[dict[str, Any]]:
    """The arms' answers; none where there is no such file. InputError where it is damaged."""
    if not file.exists():
        return []
    try:
        return list(json.loads(file.read_text(encoding="utf-8"))["arms"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"is damaged: {error}", file=file, expected="tentacle library joint writes it anew") from None


def joint_column(arms: Sequence[Mapping[str, Any]], contents: Sequence[str | None]) -> pa.Array:
    """What acts in each recording by the joint answer: names, "" for nothing, null where it was not taken in."""
    taken = {content for arm in arms for content in arm["recordings"]}
    acting: dict[str, list[str]] = {}
    for arm in arms:
        for effect in arm["effects"]:
            for content in effect["claimed"]:
                acting.setdefault(content, []).append("/".join(effect["names"]))
    words = [" ".join(acting.get(c, [])) if c is not None and c in taken else None for c in contents]
    return pa.array(words, pa.string())


def something_found(arms: Sequence[Mapping[str, Any]]) -> bool:
    """Whether an effect acts somewhere, or a parameter has changed."""
    return any(arm["effects"] or any(one["changed"] for one in arm["parameters"]) for arm in arms)
