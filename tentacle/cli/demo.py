"""`tentacle demo`: the main job from end to end, on a tank video made now and, where its data are, on a real arm."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from tentacle.cli._output import say

if TYPE_CHECKING:
    from tentacle.diagnosis import Diagnosis
    from tentacle.progress import Stage

HELP = "make a tank video with an undeclared current, find it; then trace a real beam's undeclared weight"

DURATION, FPS, SIZE, SEED = 12.0, 30.0, (480, 360), 4
MAKING = (("simulating", 5.0), ("filming", 10.0), ("compiling the tracker", 8.0))
BEAM_BASELINE, BEAM_LOADED = "beam_gravity_V2_a.csv", "beam_load52_V2_b.csv"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument("--out", type=Path, default=Path("out/demo"), metavar="DIR", help="default: out/demo")


def run(arguments: argparse.Namespace) -> int:
    """Both parts, each with its folder of results; the second only where the data are."""
    from tentacle.cli._kernels import kernels_ahead, tracking_ahead
    from tentacle.cli._progress import DIAGNOSING, reading_plan, stages
    from vision.tracked_recording import read_tracked

    source = arguments.out / "tank" / "recording"
    plan = [*MAKING, *reading_plan([source]), *DIAGNOSING]
    with (
        stages(plan) as stage,
        tracking_ahead(stage) as wait_for_tracker,
        kernels_ahead(stage) as wait_for_kernels,
    ):
        if not source.exists():
            _film_tank(source, stage)
        wait_for_tracker()
        recording = read_tracked(source, stage)
        wait_for_kernels()
        tank = _diagnosed([recording], [], arguments.out / "tank", [source], stage)
    _say("A tank video, made now; its declaration leaves out a steady current", tank, arguments.out / "tank")
    beam = _beam_folder()
    if beam is None:
        say("The real silicone beam is not here: `tentacle data` says where to get it (TENTACLE_DATA).")
        return 0
    with stages(DIAGNOSING) as stage:
        found = _beam(beam, arguments.out / "beam", stage)
    _say("A real silicone beam with a weight of 52 g that its declaration leaves out", found, arguments.out / "beam")
    return 0


def _say(title: str, diagnosis: Diagnosis, folder: Path) -> None:
    from tentacle.cli.pages.diagnosis import answer_lines

    say("", f"{title}:", *(f"  {line}" for line in answer_lines(diagnosis)))
    say(f"  report: {folder / 'report.html'}   replay: tentacle view {folder / 'session.rrd'}")


def _film_tank(source: Path, stage: Stage) -> None:
    """The tank's import folder: simulated in MuJoCo and filmed."""
    import tempfile

    from mujoco_ref.undeclared import Scenario, make_recording
    from tentacle.io.write_folder import write_folder
    from tentacle.model import Estimate, Model
    from tentacle.specimen import WATER, Cone, Gravity, Specimen
    from tentacle.waveform import Chirp
    from validation.film import filmed

    stage("simulating the tank in MuJoCo")
    parameters = {
        "elasticity": {"E": Estimate.exact(1.6e5, "Pa")},
        "damping": {"eta": Estimate.exact(1.5e3, "Pa s")},
        "drag": {"C_perp": Estimate.exact(1.1)},
    }
    model = Model(Specimen(Cone(0.0125, 0.004), 0.14, 1070.0), WATER, Gravity(), 2, parameters)
    hidden = {"current": {"U_x": 0.04, "U_y": 0.02}}
    recording, _ = make_recording(
        hidden, Scenario(model, Chirp(0.5, 0.3, 2.0, DURATION), DURATION, FPS), SEED, name="tank", clean_midline=True
    )
    with tempfile.TemporaryDirectory() as scratch:
        stage("filming the tank")
        source.parent.mkdir(parents=True, exist_ok=True)
        write_folder(filmed(recording, Path(scratch) / "video.mp4", "tank", SIZE, SEED), source)


def _beam_folder() -> Path | None:
    from tentacle.io.external_data import data_folder

    folder = data_folder() / "silicone_beam"
    return folder if (folder / BEAM_BASELINE).exists() and (folder / BEAM_LOADED).exists() else None


def _beam(data: Path, folder: Path, stage: Stage) -> Diagnosis:
    from tentacle.io.silicone_beam import read_beam

    folder.mkdir(parents=True, exist_ok=True)
    files = [data / BEAM_LOADED, data / BEAM_BASELINE]
    return _diagnosed([read_beam(files[0])], [read_beam(files[1])], folder, files, stage)


def _diagnosed(recordings: list, baseline: list, folder: Path, inputs: list[Path], stage: Stage) -> Diagnosis:
    from discovery.diagnose import diagnose
    from tentacle.cli.pages.diagnosis import write_answer
    from tentacle.io.result_folder import written

    diagnosis = diagnose(recordings, baseline, progress=stage)
    stage("writing the report")
    with written(folder) as partial:
        write_answer(diagnosis, recordings, partial, "tentacle demo", inputs)
    return diagnosis
