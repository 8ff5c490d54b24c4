"""A recording from the log of another rig (CSV), with the load cell's calibration given or found in the log."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from rig.bench_log import LogColumns, calibration_of, load_cell_signal, read_bench_log
from rig.calibrate import load_cell_calibration
from rig.setup_file import LoadCellCalibration
from tentacle.errors import InputError
from tentacle.io.declaration_file import read_recording_file
from tentacle.io.recording_summary import gap_words
from tentacle.recording import Recording


@dataclass(frozen=True)
class LogOptions:
    """declaration: the recording.toml of the specimen on the load cell; columns: names of time, counts and grams.

    calibration: offset [counts] and counts per newton; None: from the column of grams.
    """

    declaration: Path | None
    columns: tuple[str, ...] | None = None
    calibration: tuple[float, float] | None = None


def bench_recording(log_file: Path, options: LogOptions) -> tuple[Recording, str]:
    """The recording, and a sentence about the log."""
    if options.declaration is None:
        raise InputError("is missing", field="--declare", expected="the recording.toml of what hung on the load cell")
    if options.columns is not None and len(options.columns) not in (2, 3):
        raise InputError(f"{len(options.columns)} names", field="--columns", expected="TIME COUNTS [GRAMS]")
    declared = read_recording_file(options.declaration)
    log = read_bench_log(log_file, LogColumns(*options.columns) if options.columns else None)
    low, high = (1e3 * x for x in log.jitter)
    apart = f"{low:.0f} to {high:.0f} ms apart (5 to 95 %){gap_words(log.t)}"
    words = f"{len(log.t)} readings at {log.rate:.1f} Hz, {apart}"
    if options.calibration is not None:
        calibration = LoadCellCalibration(*options.calibration)
    else:
        fit = calibration_of(log)
        calibration = load_cell_calibration(fit)
        words += (
            f"; {fit.slope:.1f} +- {fit.slope_sigma:.2g} counts/N, offset {fit.offset:.1f}, rms {1e3 * fit.rms:.3g} mN"
        )
    notes = {**declared.notes, "source": log_file.name}
    recording = Recording(
        declared.name or log_file.stem,
        declared.declaration,
        load_cell=load_cell_signal(log, calibration),
        notes=notes,
    )
    return recording, words
