"""The host's clock. On hardware it is the monotonic clock. With an emulator at another rate it has the same rate."""

from __future__ import annotations

import time
from dataclasses import dataclass


@dataclass(frozen=True)
class HostTime:
    """rate: host-time seconds per real second; 1 except beside an emulator that was started with the same rate."""

    rate: float = 1.0

    def now(self) -> float:
        """Seconds, from an arbitrary zero, never going back."""
        return time.monotonic() * self.rate

    def wait(self, seconds: float) -> None:
        """Lets so many host-time seconds pass."""
        if seconds > 0:
            time.sleep(seconds / self.rate)
