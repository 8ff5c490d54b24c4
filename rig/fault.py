"""Faults of a running rig. Bad input is a different error, tentacle.errors.InputError."""

from __future__ import annotations

from typing import Literal

FaultKind = Literal[
    "link_lost", "no_answer", "refused", "board_reset", "watchdog", "underrun", "overcurrent", "load_cell",
    "not_settled", "camera", "disk", "wrong_version", "interrupted",
]  # fmt: skip

RunEnd = Literal["complete"] | FaultKind  # how a run ended
NEEDS_A_PERSON: frozenset[FaultKind] = frozenset({"overcurrent", "disk", "wrong_version"})  # no attempt mends these


class Fault(RuntimeError):  # noqa: N818 (the rig has faults; an error is the input's)
    """A fault of the rig, by kind; the message is one line that says what to check."""

    def __init__(self, kind: FaultKind, message: str) -> None:
        self.kind: FaultKind = kind
        super().__init__(message)
