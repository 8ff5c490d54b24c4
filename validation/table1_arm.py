"""One arm of Table I: filmed under a chirp and under a sine, identified from the first film, judged on the second."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from affine_model.simulate import Start, Timing
from inference.measured_motion import MeasuredCourse
from tentacle.waveform import Chirp, Sine

if TYPE_CHECKING:
    from tentacle.recording import Recording
    from tentacle.signals import Array, ShapeTrack
    from tentacle.waveform import Waveform

AMPLITUDE, FREQUENCY = np.pi / 6, 24.0 / 39.0  # [rad], [Hz]: 24 cycles in 39 s (II-B; not the 3 Hz printed)
TABLE1_FRAME_RATE = 25.0
SIZE = (640, 480)
# The paper does not describe the chirp of its fits: this one passes the first mode of most of the arms.
CHIRP_S, CHIRP_FROM, CHIRP_TO = 12.0, 0.3, 2.0


def arm_result(task: Mapping[str, Any]) -> dict[str, Any]:
    """One arm by two routes, as plain data. task: length [m], silicone, seconds of sine, look, seed; chirp_seconds.

    q1_rad2, q2_rad2: mean squares of q_model - q_CV over the sine (the paper's measure), midline_mm: rms distance; by
    edges and a fit of trajectories. paper_*: the same by the paper's route, contour, grid and eq. 19, with
    k(s) = k0 + k1 s (eq. 13-14); null where that model leaves all bounds. motion_q1_rad2,
    motion_q2_rad2: variance of q_CV itself.
    """
    import tempfile

    from inference.identify import identify
    from vision.paper_pipeline import paper_track

    chirp = Chirp(AMPLITUDE, CHIRP_FROM, CHIRP_TO, task.get("chirp_seconds", CHIRP_S))
    sine = Sine(AMPLITUDE, FREQUENCY)
    with tempfile.TemporaryDirectory() as folder:
        learnt, _ = _film(task, chirp, chirp.duration, Path(folder) / "chirp.mp4")
        judged, truth = _film(task, sine, task["seconds"], Path(folder) / "sine.mp4")
        tracked = [_tracked(recording) for recording in (learnt, judged)]
        contours = [paper_track(_film_of(r), r.declaration, r.motor) for r in (learnt, judged)]
    found = identify(tracked[:1], tracked[1:], order=2)
    values = {effect: {name: e.value for name, e in given.items()} for effect, given in found.model.parameters.items()}
    run = found.runs[0]
    kept = run.judged & np.isfinite(run.q_measured).all(axis=1)
    squares = np.mean((run.q_augmented - run.q_measured)[kept] ** 2, axis=0)
    variance = np.var(run.q_measured[kept], axis=0)
    shape = tracked[1].shape
    assert shape is not None
    return {
        "q1_rad2": float(squares[0]),
        "q2_rad2": float(squares[1]),
        "midline_mm": found.errors.midline_mm,
        "motion_q1_rad2": float(variance[0]),
        "motion_q2_rad2": float(variance[1]),
        "accepted": float(np.mean(shape.accepted)),
        "reduction_mm": truth["reduction_mm"]["2"],
        "E_pa": values["elasticity"]["E"],
        "eta_pa_s": values["damping"]["eta"],
        "C_perp": values["drag"]["C_perp"],
        **_paper_route(learnt, contours, chirp, sine),
    }


def _film(task: Mapping[str, Any], wave: Waveform, seconds: float, file: Path) -> tuple[Recording, dict[str, Any]]:
    """A video of the reference's arm under that base motion, as a recording."""
    from mujoco_ref.undeclared import Noise, Scenario, make_recording
    from validation.film import filmed
    from validation.paper_arms import paper_arm

    model = paper_arm(task["length"], task["silicone"])
    recording, truth = make_recording(
        {}, Scenario(model, wave, seconds, TABLE1_FRAME_RATE), task["seed"], Noise(), name="table1", clean_midline=True
    )
    return filmed(recording, file, task["look"], SIZE, task["seed"]), truth


def _film_of(recording: Recording) -> Path:
    assert recording.video is not None
    return recording.video.path


def _tracked(recording: Recording) -> Recording:
    """The recording with its video tracked by edges."""
    from dataclasses import replace

    from vision.track import track

    shape = track(_film_of(recording), recording.declaration, recording.motor, order=4)  # reduced to two when judged
    return replace(recording, video=None, shape=shape)


def _paper_route(
    learnt: Recording, contours: list[ShapeTrack], chirp: Waveform, sine: Waveform
) -> dict[str, float | None]:
    """Eq. 19 on the chirp's contours, then the acquired model integrated through the sine, from q and its rate at the
    first frames.
    """
    from dataclasses import replace

    from affine_model.arm import Arm, neutral_parameters
    from affine_model.simulate import simulate
    from inference.measured_motion import local_polynomials
    from inference.regression import regression

    declared = learnt.declaration
    arm = Arm(replace(declared.specimen, stiffness="affine"), declared.fluid, declared.gravity, 2)
    free = [("elasticity", "k0"), ("elasticity", "k1"), ("damping", "d0"), ("damping", "d1"), ("drag", "C_perp")]
    t, q = _seen(contours[0])
    fitted = regression(arm, neutral_parameters(), free, MeasuredCourse(t, q, chirp(t)))
    result: dict[str, float | None] = {"paper_q1_rad2": None, "paper_q2_rad2": None}
    result |= {f"paper_{name}": float(value) for (_, name), value in zip(free, fitted.values, strict=True)}
    t, q = _seen(contours[1])
    smooth, rate, _ = local_polynomials(t, q, 7)
    step = 1.0 / 500.0
    middles = t[0] + (np.arange(int((t[-1] - t[0]) / step) + 1) + 0.5) * step
    base = sine(middles)[:, :, None]
    batch = simulate(
        arm, fitted.parameters[:, None], base, Timing(step), start=Start(q=smooth[0][:, None], q_rate=rate[0][:, None])
    )
    if np.isfinite(batch.diverged[0]):
        return result
    at = t - t[0]
    simulated = np.stack([np.interp(at, batch.t, batch.q[:, i, 0]) for i in range(2)], axis=1)
    squares = np.mean((simulated - q) ** 2, axis=0)
    return result | {"paper_q1_rad2": float(squares[0]), "paper_q2_rad2": float(squares[1])}


def _seen(track: ShapeTrack) -> tuple[Array, Array]:
    """Times and (q1, q2) of the frames with a contour."""
    return track.t[track.accepted], track.coefficients[track.accepted, 1:]
