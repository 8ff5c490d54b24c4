"""Logs of other rigs: a CSV of times, raw load-cell counts and, where it has them, calibrated grams."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rig.calibrate import LineFit, fit_line
from rig.setup_file import LoadCellCalibration
from tentacle.errors import InputError
from tentacle.io.csv_table import read_csv
from tentacle.io.sound_recording import require_steps
from tentacle.signals import Array, LoadCellSignal
from tentacle.specimen import STANDARD_GRAVITY

GRAM_FORCE = 1e-3 * STANDARD_GRAVITY  # N


@dataclass(frozen=True)
class BenchLog:
    """t (N,) [s], counts (N,), force (N,) [N] by that rig's own calibration, None if the log has no such column."""

    file: Path
    t: Array
    counts: Array
    force: Array | None

    @property
    def rate(self) -> float:
        """Median rate [1/s]."""
        return 1.0 / float(np.median(np.diff(self.t)))

    @property
    def jitter(self) -> tuple[float, float]:
        """5th and 95th percentile of the time between samples [s]."""
        low, high = np.quantile(np.diff(self.t), (0.05, 0.95))
        return float(low), float(high)


@dataclass(frozen=True)
class LogColumns:
    """Names of the columns in the CSV; grams [gf] is optional."""

    time: str = "timestamp_s"
    counts: str = "thrust_raw"
    grams: str = "thrust_gf"


def read_bench_log(file: Path, columns: LogColumns | None = None) -> BenchLog:
    """The log in a CSV file. InputError names row and column: blank or bad cells, times that go back or repeat."""
    columns = columns or LogColumns()
    table = read_csv(file, (columns.time, columns.counts), optional=(columns.grams,), extra_allowed=True)
    table.require_rising(columns.time)
    t, counts = table[columns.time], table[columns.counts]
    if len(t) < 3:
        raise InputError(f"{len(t)} rows", file=file, expected="at least 3")
    require_steps(t, columns.time, file)
    wrong = (np.abs(counts) >= 2**23) | (counts != np.round(counts))
    if wrong.any():
        k = int(np.argmax(wrong))
        raise table.error(k, columns.counts, f"{counts[k]!r} is no HX711 reading", "a whole number within +-2^23")
    force = table[columns.grams] * GRAM_FORCE if columns.grams in table else None
    return BenchLog(file, t, counts, force)


def calibration_of(log: BenchLog) -> LineFit:
    """Offset and counts per newton from a log that has both counts and force; InputError where it has none."""
    if log.force is None:
        raise InputError("has no calibrated force", file=log.file, expected="a column in grams, or --counts-per-newton")
    return fit_line(log.force, log.counts)


def load_cell_signal(log: BenchLog, calibration: LoadCellCalibration) -> LoadCellSignal:
    """The log's counts as thrust [N] by this calibration."""
    return LoadCellSignal(log.t - log.t[0], np.asarray(calibration.to_newtons(log.counts), dtype=float))
