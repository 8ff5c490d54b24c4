"""The paper's rule: the water is at rest if the scatter of the load cell's readings is below a threshold (section
III-A).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from tentacle.errors import InputError


@dataclass(frozen=True)
class SettleRule:
    """Settled when the last `samples` readings have a standard deviation below `threshold` [N]; within `timeout`
    [s].
    """

    threshold: float
    samples: int
    timeout: float

    def __post_init__(self) -> None:
        if not (np.isfinite(self.threshold) and self.threshold > 0):
            raise InputError(f"{self.threshold!r} is not usable", field="settle.threshold_n", expected="a number > 0")
        if self.samples < 3:
            raise InputError(f"{self.samples!r} is not usable", field="settle.samples", expected="at least 3")
        if not (np.isfinite(self.timeout) and self.timeout > 0):
            raise InputError(f"{self.timeout!r} is not usable", field="settle.timeout_s", expected="a number > 0")


class Settling:
    """Takes readings [N] one by one. Choose `samples` so that the window spans a slow swing of the water."""

    def __init__(self, rule: SettleRule) -> None:
        self.rule = rule
        self._window: deque[float] = deque(maxlen=rule.samples)

    def add(self, readings: Iterable[float]) -> None:
        """Readings [N], oldest first."""
        self._window.extend(readings)

    @property
    def deviation(self) -> float:
        """Standard deviation of the window [N]; infinite until it is full."""
        return float(np.std(self._window, ddof=1)) if len(self._window) == self.rule.samples else np.inf

    @property
    def level(self) -> float:
        """Mean of the window [N]: the reading at rest."""
        return float(np.mean(self._window)) if self._window else np.nan

    @property
    def settled(self) -> bool:
        """Whether the rule holds now."""
        return self.deviation < self.rule.threshold
