"""The public functions of `import tentacle`: one for each verb of the command line, with the same name and defaults."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tentacle.errors import InputError
from tentacle.model import Model
from tentacle.recording import Recording

if TYPE_CHECKING:
    from affine_model.swim import Swimming
    from inference.identify import Identification
    from tentacle.diagnosis import Diagnosis
    from tentacle.signals import ShapeTrack
    from tentacle.waveform import Waveform
    from validation.ladder import Ladder


def read(path: str | Path) -> Recording:
    """A recording from an import folder or an .rrd file. InputError names what is wrong with it."""
    from tentacle.io.reading import read_recording

    return read_recording(path)


def track(recording: Recording, *, order: int | None = None) -> ShapeTrack:
    """The arm's shape in every frame of the recording's video, with its covariance.

    order: number of curvature coordinates; by default the data decide, 2 to 5.
    """
    from vision.track import track as follow

    if recording.video is None:
        raise InputError("the recording has no video", file=recording.name, expected="video.mp4 or frames/")
    return follow(recording.video.path, recording.declaration, recording.motor, order)


def identify(
    recordings: Recording | Sequence[Recording],
    *,
    check: Sequence[Recording] = (),
    order: int | None = None,
    device: str = "auto",
) -> Identification:
    """The declared model's parameters with 95 % intervals, fitted to the recordings.

    check: recordings on which the fit is tested; they are not fitted. order: number of curvature coordinates; by
    default the data decide. device: "auto" (the CPU), "cpu", "cuda" or "cuda:1".
    """
    from affine_model.device import cuda_device
    from inference.identify import identify as fit

    place = cuda_device(device)
    return fit([seen(r) for r in _several(recordings)], [seen(r) for r in check], order=order, device=place)


def diagnose(
    recordings: Recording | Sequence[Recording],
    *,
    baseline: Sequence[Recording] = (),
    held_out: Sequence[Recording] = (),
    seed: int = 0,
    device: str = "auto",
) -> Diagnosis:
    """The effect that the declared model lacks, and the error with and without it.

    baseline: recordings with a complete declaration; the base parameters are fitted to them too. held_out: recordings
    on which the errors are measured; they are not fitted. Without any, the errors are measured on a third of each
    recording. device: "auto" (the CPU), "cpu", "cuda" or "cuda:1".
    """
    from affine_model.device import cuda_device
    from discovery.diagnose import diagnose as trace
    from discovery.given import Deciding

    groups, deciding = (_several(recordings), baseline, held_out), Deciding(device=cuda_device(device))
    return trace(*([seen(r) for r in group] for group in groups), seed=seed, deciding=deciding)


def simulate(
    model: Model | Identification,
    waveform: Waveform,
    *,
    duration: float = 12.0,
    fps: float = 60.0,
    hide: Mapping[str, Any] | None = None,
    seed: int = 0,
) -> Recording:
    """A recording made by the high-order reference (MuJoCo): the base follows the waveform for `duration` seconds.

    hide: effects that act and that the recording does not declare, name -> "visible", "faint" or {parameter: value}.
    seed: of the measurement noise and of all other random choices.
    """
    from mujoco_ref.undeclared import Scenario, make_recording

    recording, _ = make_recording(hide or {}, Scenario(_model(model), waveform, duration, fps), seed, name="simulated")
    return recording


def compare(model: Model | Identification, *, amplitude: float = 0.4, frequency: float | None = None) -> Ladder:
    """The reduced model (orders 2, 3, 4) against the reference: frequencies, shape at rest, release, driven motion,
    thrust.

    amplitude [rad] and frequency [Hz] of the driven motion; by default 0.6 of the first mode's frequency.
    """
    from validation.ladder import run_ladder

    return run_ladder(_model(model), amplitude, frequency)


def optimise(
    model: Model | Identification,
    *,
    objective: str = "thrust",
    method: str = "cmaes",
    evaluations: int = 5000,
    seed: int = 0,
    device: str = "auto",
) -> Swimming:
    """The base motion (eq. 20) that swims best within a hobby servo's limits.

    objective: "thrust", "speed", "transport" (distance per energy) or "free" (speed of a free hull, on the CPU).
    method: "cmaes", "ga" (the paper's), "ga-individual" or "random". device: "auto", "cpu", "cuda" or "cuda:1".
    """
    from affine_model.device import chosen_device
    from affine_model.swim import OBJECTIVES, SearchPlan, trial_of
    from affine_model.swim import optimise_gait as search

    if objective not in OBJECTIVES:
        raise InputError(f"{objective!r} is not known", field="objective", expected=", ".join(OBJECTIVES))
    trial = replace(trial_of(_model(model)), device=chosen_device(device, objective == "free"))
    return search(trial, OBJECTIVES[objective], SearchPlan(method, evaluations, seed))


def seen(recording: Recording) -> Recording:
    """The recording; its video is tracked if it has no shapes, midline or markers yet."""
    measured = recording.midline or recording.markers or recording.shape
    return recording if measured is not None or recording.video is None else replace(recording, shape=track(recording))


def _several(recordings: Recording | Sequence[Recording]) -> Sequence[Recording]:
    return [recordings] if isinstance(recordings, Recording) else recordings


def _model(model: Model | Identification) -> Model:
    return model if isinstance(model, Model) else model.model
