"""Host time against board time: a regression over round trips, of which the quickest are the most accurate."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

SKEW_SIGMA = 1e-4  # two crystals differ by tens of parts in a million; 100 is generous
QUICK_SHARE = 0.25  # of the round trips, the quickest, are used
LONGEST_MEMORY = 2400  # round trips: two minutes at 20 Hz, over which a crystal's warming is straight


@dataclass(frozen=True)
class ClockFit:
    """host = host_zero + (1 + skew) (board - board_zero), all in seconds; sigma [s] of a converted time.

    round_trip [s] is the quickest one; half of it is the largest error from unequal delays in the two directions.
    """

    host_zero: float
    board_zero: float
    skew: float
    sigma: float
    round_trip: float

    def to_board(self, host_s: float) -> float:
        """Host time [s] as board time [s]."""
        return self.board_zero + (host_s - self.host_zero) / (1.0 + self.skew)


class ClockEstimator:
    """Collects round trips; `fit` regresses the quickest of them, with outliers out."""

    def __init__(self) -> None:
        self._trips: deque[tuple[float, float, float]] = deque(maxlen=LONGEST_MEMORY)

    def __len__(self) -> int:
        return len(self._trips)

    def add(self, sent: float, received: float, board_s: float) -> None:
        """A ping sent and its pong received at these host times [s], with the board's clock [s] in between."""
        if received >= sent:
            self._trips.append((sent, received, board_s))

    @property
    def quickest(self) -> float:
        """The quickest round trip kept [s]; 10 ms before the first."""
        return min((received - sent for sent, received, _ in self._trips), default=0.01)

    def round_trips(self) -> np.ndarray:
        """All round-trip times kept (N,) [s]."""
        return np.array([received - sent for sent, received, _ in self._trips])

    def fit(self) -> ClockFit:
        """The regression; ValueError before the first round trip.

        The skew has a prior of 0 +- SKEW_SIGMA, because over a few seconds the round trips determine it less well than
        the crystals.
        """
        if not self._trips:
            raise ValueError("no round trip yet: the board has not answered a ping")
        sent, received, board = np.array(self._trips).T
        trip = received - sent
        keep = trip <= np.quantile(trip, QUICK_SHARE) if len(trip) > 8 else np.full(len(trip), True)
        host, board = 0.5 * (sent + received)[keep], board[keep]
        board_zero, host_zero = float(board.mean()), float(host.mean())
        x, y = board - board_zero, (host - host_zero) - (board - board_zero)
        weight = np.ones_like(x)
        offset = skew = spread = 0.0
        floor = max(float(trip.min()) / 4.0, 2e-5)  # the smallest possible spread of a round trip
        for _ in range(10):
            spread = max(float(np.sqrt(np.average((y - offset - skew * x) ** 2, weights=weight))), floor)
            prior = (spread / SKEW_SIGMA) ** 2
            mean_x, mean_y = np.average(x, weights=weight), np.average(y, weights=weight)
            moment = np.sum(weight * (x - mean_x) ** 2)
            skew = float(np.sum(weight * (x - mean_x) * (y - mean_y)) / (moment + prior))
            offset = float(mean_y - skew * mean_x)
            residual = np.abs(y - offset - skew * x)
            limit = max(3.0 * 1.4826 * float(np.median(residual)), floor)
            weight = np.where(residual <= limit, 1.0, 1e-6)
        sigma = float(np.hypot(spread / np.sqrt(weight.sum()), 0.25 * trip.min()))
        return ClockFit(host_zero + offset, board_zero, skew, sigma, float(trip.min()))
