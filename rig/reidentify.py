"""A model identified anew from trials' recordings, and the gaits that it proposes."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from discovery.diagnose import diagnose
from rig.gait_space import GaitSpace, TrialPlan
from rig.model_gaits import best_gaits, predicted_propulsion
from rig.optimise import propulsion
from rig.run import Run
from rig.run_file import read_run, to_recording
from tentacle.errors import InputError
from tentacle.model import Model
from tentacle.progress import Stage, silent
from tentacle.recording import Recording
from vision.track import track

PROPOSED = 2  # gaits of a model identified anew
MOST_RECORDINGS = 3  # what one diagnosis takes; it costs minutes


def tracked(run: Run) -> Recording:
    """A rig's recording with the shapes that its camera saw; InputError where it has no camera."""
    with tempfile.TemporaryDirectory() as folder:
        recording = to_recording(run, video=Path(folder) / "video.mp4")
        if recording.video is None:
            raise InputError("has no video", file=run.path, expected="a rig with a camera ([camera] in rig.toml)")
        shape = track(recording.video.path, recording.declaration, recording.motor)
    return replace(recording, video=None, shape=shape)


def proposer(
    space: GaitSpace,
    plan: TrialPlan,
    *,
    believed: Model | None = None,
    seed: int = 0,
    told: Callable[[str], None] = lambda _: None,
    progress: Stage = silent,
) -> Callable[[Sequence[Path]], list[dict[str, float]]]:
    """A function that diagnoses the recordings that differ most and gives a model's best gaits; told hears the verdict,
    or why there is none (no arm to be seen, say): then nothing is proposed, and the search goes on. A damaged recording
    is named and left out.

    The model is the augmented one, unless the one `believed` so far, or the paper's as refitted, is nearer to the
    thrust that all the recordings measured: the load cell has no part in the diagnosis, and checks it.
    """

    def propose(recordings: Sequence[Path]) -> list[dict[str, float]]:
        runs = _readable(recordings, told)
        if not runs:
            return []
        points = [{name: float(run.start["waveform"][name]) for name in space.bounds} for run in runs]
        chosen = unlike(points, space, MOST_RECORDINGS)
        try:
            diagnosis = diagnose([tracked(runs[k]) for k in chosen], seed=seed, progress=progress)
        except InputError as error:
            told(f"no diagnosis: {error}")
            return []
        told(diagnosis.headline)
        measured = [propulsion(r, *plan.window(p["frequency_hz"])) for r, p in zip(runs, points, strict=True)]
        models = [
            m for m in (diagnosis.augmented_model, diagnosis.base_model, believed) if m is not None and m.parameters
        ]
        if not models:
            return []
        misses = [np.square(predicted_propulsion(m, space, points, plan) - measured).mean() for m in models]
        return best_gaits(models[int(np.argmin(np.nan_to_num(misses, nan=np.inf)))], space, plan, PROPOSED, seed)

    return propose


def _readable(recordings: Sequence[Path], told: Callable[[str], None]) -> list[Run]:
    """The recordings that can be read; told hears of each that cannot."""
    found = []
    for path in recordings:
        try:
            found.append(read_run(path))
        except InputError as error:
            told(f"left out: {error}")
    return found


def unlike(points: Sequence[dict[str, float]], space: GaitSpace, count: int) -> list[int]:
    """The `count` points that lie farthest apart, with the latest; near the optimum all trials are alike."""
    bounds = np.array(list(space.bounds.values()))
    unit = (np.array([list(point.values()) for point in points]) - bounds[:, 0]) / np.ptp(bounds, axis=1)
    chosen = [len(points) - 1]
    while len(chosen) < min(count, len(points)):
        apart = np.linalg.norm(unit[:, None] - unit[chosen], axis=2).min(axis=1)
        chosen.append(int(np.argmax(apart)))
    return sorted(chosen)
