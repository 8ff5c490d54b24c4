"""A model identified anew from trials' recordings, and the gaits that it proposes."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from discovery.diagnose import diagnose
from rig.gait_space import GaitSpace, TrialPlan
from rig.model_gaits import best_gaits
from rig.run_file import read_run, to_recording
from tentacle.diagnosis import Diagnosis
from tentacle.errors import InputError
from tentacle.recording import Recording
from vision.track import track

MOST_RECORDINGS = 3  # what one diagnosis takes: trials are short, and alike near the optimum


def tracked(path: Path) -> Recording:
    """A rig's recording with the shapes that its camera saw; InputError where it has no camera."""
    with tempfile.TemporaryDirectory() as folder:
        recording = to_recording(read_run(path), video=Path(folder) / "video.mp4")
        if recording.video is None:
            raise InputError("has no video", file=path, expected="a rig with a camera ([camera] in rig.toml)")
        shape = track(recording.video.path, recording.declaration, recording.motor)
    return replace(recording, video=None, shape=shape)


def proposer(
    space: GaitSpace,
    plan: TrialPlan,
    *,
    count: int = 2,
    seed: int = 0,
    told: Callable[[Diagnosis], None] = lambda _: None,
) -> Callable[[Sequence[Path]], list[dict[str, float]]]:
    """A function that diagnoses the latest recordings and gives the augmented model's best gaits; told hears the
    verdict.
    """

    def propose(recordings: Sequence[Path]) -> list[dict[str, float]]:
        diagnosis = diagnose([tracked(path) for path in recordings[-MOST_RECORDINGS:]], seed=seed)
        told(diagnosis)
        return best_gaits(diagnosis.augmented_model, space, plan, count, seed)

    return propose
