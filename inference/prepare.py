"""From a recording to an experiment: the channel that is judged, its time window and its noise."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from affine_model.curvature import Array
from affine_model.declared_laws import declared_laws, refuse_unknown_laws
from inference.appearance import Appearance, Motion
from inference.experiment import Experiment
from inference.jumps import without_jumps
from inference.known_base import within_log
from inference.latent_force import LAW_KNOWN
from inference.measured_shapes import Tracker, fit_shapes, from_markers, from_track
from inference.motion_spread import motion_spread
from inference.noise_floor import noise_deviation
from inference.observation import POSE, Observation
from inference.sensed_observation import with_sensors
from tentacle.base_motion import HeldOutside, fit_base_motion, fit_travel, seen_from_base
from tentacle.errors import InputError
from tentacle.recording import Recording
from tentacle.slips import root_direction, root_turning
from tentacle.specimen import declared_effects
from tentacle.waveform import Rest, Waveform

MOST_COORDINATES = 8  # measured per frame; an arm that is nearly a hinge somewhere shows all of them
LONGEST_RECORDING = 120.0  # s: of longer recordings the first two minutes are judged
FEWEST_FRAMES = 30
RELEASE = "release.t_s"
# The stretch that is not fitted, of a driven recording and of a decay: at its end a chirp has its highest frequencies,
# which the fit must see; a decay is followed from its release on.
JUDGED, LAST = (0.5, 5.0 / 6.0), (2.0 / 3.0, 1.0)
# Of a motion that leaves the plane by a share r, the plane shows r^2 / 2 too little: as much as a law is known to, 3 %.
MOST_OUT_OF_PLANE = math.sqrt(2.0 * LAW_KNOWN)
LEAST_MOTION = 2.0  # noise sigmas
# Radians that the seen root turns for a radian of the servo. Below, its frame turns along, or one sign is wrong.
TURNING, OPPOSITE = 0.35, -0.6


class CannotTellError(InputError):
    """A recording is readable but shows too little to judge a model. The message gives the reason in a sentence."""


@dataclass(frozen=True)
class Prepared:
    """A recording with its experiment.

    points (T, P, 2) [m]: its midline in the standing frame (None without a midline). sigma [m]: of a coordinate if the
    midline states none. words: decisions that were made on the way.
    """

    recording: Recording
    experiment: Experiment
    points: Array | None
    sigma: float
    words: tuple[str, ...]


def _base(recording: Recording) -> Waveform:
    if recording.motor is None:
        return Rest()
    return HeldOutside(fit_base_motion(recording.motor), recording.motor.t[0], recording.motor.t[-1])


def _following(recording: Recording, base: Waveform) -> float | None:
    """How far the seen root turns for a radian of the servo; None if the base hardly turns or no root is seen."""
    if recording.shape is not None and recording.midline is None:
        track = recording.shape.measured()
        seen = track.accepted & np.isfinite(track.coefficients).all(axis=1)
        theta = base(track.t[seen])[0]
        # A track counts the root from the servo's angle.
        return root_turning(theta, track.coefficients[seen, 0] + theta)
    root = root_direction(recording)
    return None if root is None else root_turning(base(root[0])[0], root[1])


def _with_sign_reversed(recording: Recording, base: Waveform) -> Recording:
    """The recording with its servo's log in the opposite sense; the observation stays the same."""
    assert recording.motor is not None
    motor = replace(recording.motor, command=-recording.motor.command, angle=-recording.motor.angle)
    shape = recording.shape
    if shape is not None:
        turned, frames = 2.0 * base(shape.t)[0], shape.by_frames
        frames = frames and replace(frames, coefficients=_root_turned(frames.coefficients, turned))
        shape = replace(shape, coefficients=_root_turned(shape.coefficients, turned), by_frames=frames)
    return replace(recording, motor=motor, shape=shape)


def _root_turned(coefficients: Array, turned: Array) -> Array:
    """Shapes (T, K) with the angle (T,) of their root larger by so much."""
    found = coefficients.copy()
    found[:, 0] += turned
    return found


def _turned(xy: Array, theta: Array) -> Array:
    """Points (T, P, 2) turned by theta (T,), from the base's own frame to the standing one."""
    cos, sin = np.cos(theta)[:, None], np.sin(theta)[:, None]
    return np.stack([cos * xy[..., 0] - sin * xy[..., 1], sin * xy[..., 0] + cos * xy[..., 1]], axis=-1)


def _observation(
    recording: Recording, base: Waveform, turning: bool
) -> tuple[Observation, Array | None, float, list[str]]:
    length, words = recording.declaration.specimen.length, []
    if recording.midline is not None:
        data = recording.midline
        theta = base(data.t)[0]
        if turning:
            words.append("The midline turns with the base: it is read as measured in the base's own turning frame.")
            data = type(data)(data.t, data.s, _turned(data.xy, theta), data.sigma)
        counts = np.isfinite(data.xy).all(axis=2).sum(axis=1)
        points = int(np.median(counts[counts > 0])) if counts.any() else 0
        order = min(MOST_COORDINATES, points - POSE)
        if order < 2:
            raise CannotTellError(f"The midline of {recording.name} has {points} points a frame; 6 are needed.")
        sigma = 1e-4
        if not np.isfinite(data.sigma).any():
            free = noise_deviation(data.xy)
            sigma = float(np.nanmedian(free[np.abs(data.xy).max(axis=0, initial=0.0, where=np.isfinite(data.xy)) > 0]))
            sigma = max(sigma, 1e-7)
            words.append(f"The midline states no noise; {1e3 * sigma:.3f} mm was found between frames.")
        return fit_shapes(data, theta, length, order, Tracker(sigma)), data.xy, sigma, words
    if recording.shape is not None:
        return from_track(recording.shape, base(recording.shape.t)[0], length), None, 0.0, words
    if recording.markers is not None:
        data = recording.markers
        sigma = max(float(np.nanmedian(noise_deviation(data.xy))), 1e-6)
        words.append(f"Markers: {1e3 * sigma:.3f} mm of noise between frames.")
        return from_markers(data, base(data.t)[0], length, sigma), None, sigma, words
    raise InputError(
        "has no measurement of the arm's shape", file=recording.name, expected="a midline, markers or a tracked video"
    )


def prepare(recording: Recording, *, hold_out: bool, device: str | None = None) -> Prepared:
    """The experiment of a recording; with hold_out the stretch JUDGED (LAST of a decay) judges only. device: CUDA
    device that simulates it (None: the CPU).

    Raises InputError where no shape was measured at all, CannotTellError where too little was.
    """
    spatial = _spatial_words(recording)
    specimen, fluid = recording.declaration.specimen, recording.declaration.fluid
    refuse_unknown_laws(specimen, f"{recording.name}/recording.toml")
    laws = declared_laws(specimen, fluid)
    travel = None if recording.travel is None else fit_travel(recording.travel)
    recording = seen_from_base(recording, travel)
    base = _base(recording)
    following = _following(recording, base)
    opposite = following is not None and following < OPPOSITE
    if opposite:
        recording = _with_sign_reversed(recording, base)
        base = _base(recording)
    turning = following is not None and OPPOSITE <= following < TURNING
    observation, points, sigma, words = _observation(recording, base, turning)
    words += spatial
    if opposite:
        filmed = recording.declaration.camera is not None
        remedy = "Declare `mirrored` in [camera] or turn" if filmed else "Turn the sign of the points' x, or"
        words.append(
            f"In {recording.name} the arm's root turns against the servo's log ({following:.2f} rad a radian): "
            f"the log's sign is taken as reversed. {remedy} the log's sign."
        )
    times = observation.t
    observation, beyond = within_log(observation, base.motion if isinstance(base, HeldOutside) else None)
    if beyond:
        share = f"{beyond} of {len(times)}"
        words.append(f"Left out of {recording.name}: frames that show the base beyond the servo's log, {share}.")
    shown = np.zeros((2, 0))
    if observation.shapes is not None:
        observation, jumps = without_jumps(observation.shapes)
        if jumps:
            share = f"{jumps} of {len(times)}"
            words.append(f"Left out of {recording.name}: frames shown twice or misread, out of the motion, {share}.")
        shown = motion_spread(observation)
    observation, of_sensors = with_sensors(observation, recording)
    words += of_sensors
    seen = observation.seen
    if seen.sum() < FEWEST_FRAMES:
        count = int(seen.sum())
        raise CannotTellError(f"{recording.name} has {count} usable frames; at least {FEWEST_FRAMES} are needed.")
    if not observation.changed() > LEAST_MOTION:
        raise CannotTellError(f"{recording.name}: the arm hardly moves beyond the noise; its dynamics cannot be seen.")
    release = recording.declaration.release_t
    first = times[seen][0]
    last = min(times[seen][-1], first + LONGEST_RECORDING)
    if times[seen][-1] > last:
        words.append(f"Of {recording.name} the first {LONGEST_RECORDING:.0f} s are judged.")
    within = seen & (times <= last)
    used = within.copy()
    if hold_out:
        begin = first if release is None else release
        stretch = JUDGED if release is None else LAST
        first_judged, last_judged = (begin + share * (last - begin) for share in stretch)
        used &= (times <= first_judged) | (times > last_judged)
    interval = float(np.median(np.diff(times)))
    experiment = Experiment(
        name=recording.name,
        observation=observation,
        base=base,
        t0=float(first),
        duration=float(last - (first if release is None else release)) + 0.2,
        release=release,
        used=used,
        noise_gain=np.ones(observation.channels),
        release_sigma=_release_sd(recording, 2.0 * interval),
        shapes_seen=shown[0],
        rates_seen=shown[1],
        base_known_from=None if recording.motor is None else float(recording.motor.t[0]),
        travel=travel,
        remembers=any(law.relaxation_time is not None for law in laws),
        declared=frozenset((*(law.name for law in laws), *declared_effects(specimen, fluid))),
        device=device,
    )
    return Prepared(recording, experiment, points, sigma, tuple(words))


def _spatial_words(recording: Recording) -> list[str]:
    """What is said of a motion that leaves the plane; CannotTellError where a planar model does not serve it."""
    share = recording.declaration.out_of_plane
    if share is None:
        return []
    if share > MOST_OUT_OF_PLANE:
        raise CannotTellError(
            f"{100.0 * share:.0f} % of the motion of {recording.name} leaves its plane, more than the "
            f"{100.0 * MOST_OUT_OF_PLANE:.0f} % for which a planar model serves."
        )
    return [f"{100.0 * share:.1f} % of the motion of {recording.name} leaves its plane."]


def _release_sd(recording: Recording, usual: float) -> float:
    """Standard deviation [s] of the instant of the release: as declared, or some frames."""
    declared = recording.declaration.uncertain
    return next((number.spread for number in declared if number.field == RELEASE), usual)


def recalibrated(experiment: Experiment, residuals: Array) -> Experiment:
    """The experiment with the noise that the residuals of a fit show, if the stated noise is too small or missing.

    A channel that is more than 10 % noisier than stated gets the larger value. A quieter channel keeps the stated
    value, as smoothed data look quieter between frames than they are. What was measured holds no less noise than it
    shows by itself: beyond that, a residual is the ringing of a model with too little damping.
    """
    seen = experiment.observation
    still = np.zeros((seen.t.size, seen.order, 1))
    resting = Motion(np.zeros((2, *still.shape)), np.zeros((2, still.shape[0], 1)), np.zeros((1, 2, 1)))
    shown = replace(Appearance.as_declared(still, seen.theta[:, None]), motion=resting)
    measured = seen.predict(shown)[:, :, 0]
    own, left = (noise_deviation(np.where(rows == 0.0, np.nan, rows)) for rows in (measured, residuals))
    found = np.fmin(own, left * experiment.noise_gain)
    gain = np.where(np.isfinite(found) & (found > 1.1), found, 1.0)
    return replace(experiment, noise_gain=gain)
