"""A run of the MuJoCo arm written as the rig writes it, without a rig: as fast as it is computed, pictures and all."""

from __future__ import annotations

import zlib
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks._rig_scene import DECLARED
from rig.arm_plant import ArmPlant
from rig.camera import compressed
from rig.clock import ClockFit
from rig.emulated_camera import EmulatedOptics, draw_picture
from rig.protocol import LoadSample, Sample, ServoSample
from rig.record import add_film
from rig.recorder import Recorder
from rig.setup_file import LoadCellCalibration
from tentacle.io.declaration_file import declaration_tables
from tentacle.model import Model
from tentacle.waveform import Waveform

CELL = LoadCellCalibration(52000.0, 180000.0)
NOISE = 60.0  # counts
STEP = 0.01  # s


def filmed_run(
    model: Model,
    hidden: dict[str, dict[str, float]],
    waveform: Waveform,
    seconds: float,
    path: Path,
    description: dict[str, Any],
) -> None:
    """Plays the waveform on the arm, which is at rest before, and writes the run as `tentacle rig record` does.
    The load cell's noise is another one for each name of a file.

    Board and host share one clock here, and the camera has no delay: their fits are tested where there are two.
    """
    plant, optics, source = (
        ArmPlant(model, hidden),
        EmulatedOptics.of(DECLARED),
        np.random.default_rng(zlib.crc32(path.stem.encode())),
    )
    camera = {"source": "emulated", "offset_s": 0.0, "offset_sigma_s": 1e-4}
    start = {
        "name": path.stem, "recording": declaration_tables(DECLARED), "lead_s": 0.0, "waveform": description,
        "load_cell": {"offset_counts": CELL.offset, "counts_per_newton": CELL.slope}, "camera": camera,
    }  # fmt: skip
    zero = 1_000_000  # us
    with Recorder(path, start, CELL.to_newtons) as recorder:
        recorder.clock(ClockFit(0.0, 0.0, 0.0, 1e-4, 1e-3))
        recorder.begin(zero)
        samples: list[Sample] = []
        frames, places = 0, np.linspace(0.0, 1.0, 24)
        points = plant.midline(places)
        for tick, t in enumerate(np.arange(0.0, seconds + STEP, STEP)):
            command = float(waveform(t)[0])
            before = points
            plant.advance(t, command, True)
            points = plant.midline(places)
            now = zero + round(1e6 * t)
            counts = round(CELL.offset + CELL.slope * plant.force + NOISE * source.normal())
            samples.append(LoadSample(len(samples), now, counts))
            if tick % 2 == 0:
                angles = round(1e6 * command), round(1e6 * plant.servo_angle)
                samples.append(ServoSample(len(samples), now, *angles, 1500, 40))
            taken = frames / optics.declaration.fps
            if t >= taken - 1e-9:
                frames += 1
                share = (t - taken) / STEP  # the picture is taken between two steps, on the camera's own rhythm
                image = draw_picture(share * before + (1.0 - share) * points, 0.0, optics)
                recorder.frames([compressed(image, 1e-6 * zero + taken)])
        recorder.samples(samples)
        stop = {"start_us": zero, "rest_n": 0.0, "camera": {"offset_s": 0.0, "offset_sigma_s": 1e-4, "gaps_host_s": []}}
        add_film(recorder, path, {"outcome": "complete", **stop})
        recorder.stop("complete", stop)
