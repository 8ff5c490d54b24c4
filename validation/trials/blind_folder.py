"""A folder of blind recordings with the answers in another file, to be diagnosed by a person or by another program."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from mujoco_ref.undeclared import Scenario, SealedPlan, make_recording, trial_name
from tentacle.io.recording_rrd import write_rrd
from tentacle.io.write_folder import write_folder
from tentacle.recording import Recording
from validation.film import filmed


@dataclass(frozen=True)
class FilmStyle:
    """How recordings are filmed: look (None: no video, the midline instead), size [px]."""

    look: str | None = None
    size: tuple[int, int] = (960, 720)


def write_simulated(recording: Recording, film: FilmStyle, out: Path, seed: int) -> None:
    """Write an import folder, or an .rrd file if the name ends in .rrd; with a look the midline becomes a rendered
    video.
    """
    with tempfile.TemporaryDirectory() as folder:
        if film.look is not None:
            recording = filmed(recording, Path(folder) / "video.mp4", film.look, film.size, seed)
        if out.suffix == ".rrd":
            write_rrd(recording, out)
        else:
            write_folder(recording, out)


def write_trials(plan: SealedPlan, count: int, film: FilmStyle, out: Path, sealed: Path) -> Iterator[int]:
    """Write count recordings to out, with a baseline that hides nothing, and their answers to sealed (JSON lines).

    Yields each trial's number when it is done. A trial whose recording and answer exist is not made again.
    """
    clean = film.look is not None
    lines = sealed.read_text(encoding="utf-8").splitlines() if sealed.exists() else []
    answered = {json.loads(line)["trial"] for line in lines}
    out.mkdir(parents=True, exist_ok=True)
    sealed.parent.mkdir(parents=True, exist_ok=True)
    if not (out / "baseline").exists():
        base, _ = make_recording(
            {},
            Scenario(plan.model, plan.waveform, plan.duration, plan.fps),
            plan.seed,
            plan.noise,
            name="baseline",
            clean_midline=clean,
        )
        write_simulated(base, film, out / "baseline", plan.seed)
    for k in range(count):
        folder = out / trial_name(k)
        if not folder.exists() or k not in answered:
            trial = plan.trial(k, clean_midline=clean)
            if not folder.exists():
                write_simulated(trial.recording, film, folder, trial.truth["seed"])
            if k not in answered:
                with sealed.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(trial.truth) + "\n")
        yield k
