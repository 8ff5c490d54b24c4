"""The rig that `tentacle rig emulate` offers: its settings, and the rig.toml that fits it."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path

from rig.emulator import Emulator, EmulatorSettings
from rig.safety import SafetyLimits
from rig.settle import SettleRule
from rig.setup_file import CameraSettings, LoadCellCalibration, RigSetup
from tentacle.errors import InputError
from tentacle.io.declaration_file import RecordingFile
from tentacle.io.model_file import read_model
from tentacle.recording import Camera, Declaration
from tentacle.specimen import WATER, Cone, Specimen


@dataclass(frozen=True)
class EmulatedArm:
    """What the emulated board drives: model.toml of a MuJoCo arm and hidden.json of its undeclared effects, or None.

    Without a model two stiff links stand in for the arm.
    """

    model: Path | None = None
    hidden: Path | None = None


def emulated_setup(
    folder: Path, arm: EmulatedArm, *, seed: int, rate: float, camera: bool
) -> tuple[RigSetup, EmulatorSettings]:
    """rig.toml's content and the emulator's settings. seed: of all noise; rate: emulated seconds per second."""
    if arm.hidden is not None and arm.model is None:
        raise InputError("needs an arm to hide in", field="--hidden", expected="--model with it")
    optics = Camera(30.0, 0.0008, (160.0, 24.0), (0.0, 1.0), exposure=0.008)
    declaration = Declaration(Specimen(Cone(0.0125, 0.001), 0.14, 1070.0), WATER, camera=optics)
    settings = EmulatorSettings(seed=seed, rate=rate)
    if arm.model is not None:
        model = read_model(arm.model)
        declaration = Declaration(model.specimen, model.fluid, model.gravity, camera=optics)
        words = [str(path.resolve()) for path in (arm.model, arm.hidden) if path is not None]
        settings = replace(settings, plant="arm", plant_options=tuple(words))
    setup = RigSetup(
        port=str(folder / "port"),
        limits=SafetyLimits(min_angle=-0.8, max_angle=0.8, max_speed=8.0, max_current=0.9),
        settle=SettleRule(threshold=2e-3, samples=100, timeout=60.0),
        load_cell=LoadCellCalibration(settings.cell_offset, settings.counts_per_newton),
        recording=RecordingFile(declaration),
        camera=CameraSettings("emulated") if camera else None,
        rate=rate,
    )
    return setup, settings


def seconds_behind(running: Emulator) -> float:
    """Delay of the emulated board behind its own clock [s of it]; 0 if unknown."""
    try:
        truth = running.truth()
    except InputError:
        return 0.0
    return truth.board_time(time.monotonic()) - 1e-6 * truth.board_us
