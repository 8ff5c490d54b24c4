"""A sound run whose signals do not all begin in the first block, or pause in between, is read with every row equal."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks._rig_scene import DECLARED
from rig.clock import ClockFit
from rig.protocol import LoadSample, Sample, ServoSample
from rig.recorder import Recorder
from rig.run_file import read_run
from rig.setup_file import LoadCellCalibration
from rig.soundness import check_file
from tentacle.io.declaration_file import declaration_tables
from tentacle.io.recording_from_rrd import read_rrd

CELL = LoadCellCalibration(52000.0, 180000.0)
ZERO = 1_000_000  # us
# Each letter is a block: l(oad cell), s(ervo), b(oth); a block has 2, 3 or 5 checksums, with the recording's own more.
ORDERS = ("lsb", "slb", "llbs", "bls", "l", "s", "lllllb")


def _blocks(order: str) -> list[list[Sample]]:
    blocks: list[list[Sample]] = []
    number = 0
    for k, kind in enumerate(order):
        block: list[Sample] = []
        for j in range(3 + k):
            us = ZERO + 100_000 * k + 1000 * j
            if kind in "lb":
                block.append(LoadSample(number, us, 52000 + 7 * number))
                number += 1
            if kind in "sb":
                block.append(ServoSample(number, us, 1000 * number, 900 * number, 1500, 40 + number))
                number += 1
        blocks.append(block)
    return blocks


@pytest.mark.parametrize("order", ORDERS)
def test_every_row_of_an_uneven_run_is_read(order: str, tmp_path: Path) -> None:
    blocks = _blocks(order)
    start = {
        "name": "run", "recording": declaration_tables(DECLARED), "lead_s": 0.0, "waveform": {"kind": "rest"},
        "load_cell": {"offset_counts": CELL.offset, "counts_per_newton": CELL.slope}, "camera": None,
    }  # fmt: skip
    with Recorder(tmp_path / "run.rrd", start, CELL.to_newtons) as recorder:
        recorder.clock(ClockFit(0.0, 0.0, 0.0, 1e-4, 1e-3))
        recorder.begin(ZERO)
        for block in blocks:
            recorder.samples(block)
            recorder.flush()
        recorder.stop("complete", {"start_us": ZERO, "rest_n": 0.0, "camera": None})

    run = read_run(tmp_path / "run.rrd")
    sent = [sample for block in blocks for sample in block]
    loads = [sample for sample in sent if isinstance(sample, LoadSample)]
    servos = [sample for sample in sent if isinstance(sample, ServoSample)]
    assert (run.outcome, run.missing) == ("complete", "")
    # Counts are whole numbers and are stored as 64-bit floats: exact. So are the numbers of the samples.
    np.testing.assert_array_equal(run.load, [sample.counts for sample in loads])
    np.testing.assert_array_equal(run.load_number, [sample.number for sample in loads])
    np.testing.assert_array_equal(run.servo_number, [sample.number for sample in servos])
    # Times are whole microseconds, stored as whole nanoseconds; 1e-12 s is the rounding of the product with 1e-9.
    np.testing.assert_allclose(run.load_t, [1e-6 * sample.board_us for sample in loads], rtol=0, atol=1e-12)
    np.testing.assert_allclose(run.servo_t, [1e-6 * sample.board_us for sample in servos], rtol=0, atol=1e-12)
    np.testing.assert_array_equal(run.command, 1e-6 * np.array([sample.command_urad for sample in servos], float))
    np.testing.assert_array_equal(run.angle, 1e-6 * np.array([sample.angle_urad for sample in servos], float))
    assert check_file(tmp_path / "run.rrd")[0].sound
    recording = read_rrd(tmp_path / "run.rrd")
    assert (0 if recording.motor is None else len(recording.motor.t)) == len(servos)
    assert (0 if recording.load_cell is None else len(recording.load_cell.t)) == len(loads)
