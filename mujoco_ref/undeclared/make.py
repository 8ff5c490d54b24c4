"""Make a recording of the reference arm with effects that its declaration does not mention."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from mujoco_ref.influence import refuse_unknown, value
from mujoco_ref.simulate import DEFAULT_LINKS, LONGEST_STEP, Initial, Setup, Simulation, simulate
from mujoco_ref.undeclared.strength import SCALED_TOGETHER, STRENGTH_SIZES, is_catalogued, scaled, typical
from tentacle.errors import InputError
from tentacle.model import Model
from tentacle.recording import Declaration, Recording
from tentacle.signals import Array, BaseTravel, LoadCellSignal, Midline, MotorSignal
from tentacle.waveform import Waveform

Strength = str | float | Mapping[str, float]
LEAD_IN = 1.5  # [s] of motion before the first frame: recordings begin while the arm moves
# A free decay shows the arm's own frequency beside the sag that it ends in: the midpoint rule errs by
# (omega step)^2 / 12 of the one, the links by 1 / (5 links^2); 2e-4 in all at 8 Hz. A driven arm keeps the base's.
DECAY_STEP, DECAY_LINKS = 5e-4, 40


@dataclass(frozen=True)
class Noise:
    """Standard deviations: midline [m] per coordinate and point, motor angle [rad], load cell [N]."""

    midline: float = 1.5e-4
    angle: float = 0.0
    load_cell: float = 5e-4


USUAL_NOISE = Noise()


@dataclass(frozen=True)
class Shifted:
    """A waveform seen `offset` [s] later than its time."""

    waveform: Waveform
    offset: float

    def __call__(self, t: ArrayLike) -> Array:
        """The waveform at t + offset."""
        return self.waveform(np.asarray(t, dtype=float) + self.offset)


@dataclass(frozen=True)
class Scenario:
    """What all runs of one recording share: the model and its base motion, duration [s], frames a second, where the
    midline is sampled, s (P,) (None: 41 points), hinges of the chain; and of a free decay the shape of eq. 1, q (K,),
    that the arm is held in until release_t [s]. travel: x, y [m] of the base, rates, accelerations
    (6, ...) over time [s].
    """

    model: Model
    waveform: Waveform
    duration: float
    fps: float
    s: Array | None = None
    links: int = DEFAULT_LINKS
    initial_q: Array | None = None
    release_t: float | None = None
    travel: Callable[[Array], Array] | None = None


def _run(
    scene: Scenario,
    hidden: Mapping[str, Mapping[str, float]],
    offset: float = 0.0,
    duration: float = 0.0,
    drift: float = 0.0,
) -> Simulation:
    """The simulation at the times of a camera's clock that is late by `offset` [s] and by the share `drift`."""
    decay = scene.initial_q is not None
    return simulate(
        scene.model,
        Shifted(scene.waveform, offset) if offset else scene.waveform,
        (duration or scene.duration) * (1.0 + drift),
        scene.fps / (1.0 + drift),
        hidden=hidden,
        setup=Setup(
            links=max(scene.links, DECAY_LINKS) if decay else scene.links,
            s=scene.s,
            lead_in=0.0 if decay else LEAD_IN,
            longest_step=DECAY_STEP if decay else LONGEST_STEP,
            initial=Initial(
                scene.initial_q, release_t=None if scene.release_t is None else max(0.0, scene.release_t - offset)
            ),
            travel=scene.travel,
        ),
    )


def seen_midline(scene: Scenario, hidden: Mapping[str, Mapping[str, float]], duration: float = 0.0) -> Array:
    """Midline points (F, P, 2) [m] as the camera shows them: late, rolled and scaled by the hidden effects."""
    offset, drift = (value(hidden, "time_offset", name) for name in ("offset", "drift"))
    return as_the_camera_has(_run(scene, hidden, offset, duration, drift).midline.xy, hidden)


def as_the_camera_has(points: Array, hidden: Mapping[str, Mapping[str, float]]) -> Array:
    """Points (..., 2) [m] rolled and scaled by the hidden effects of the camera."""
    roll = value(hidden, "camera_roll", "roll")
    turn = np.array([[np.cos(roll), -np.sin(roll)], [np.sin(roll), np.cos(roll)]])
    return (1.0 + value(hidden, "camera_scale", "excess")) * points @ turn.T


def shown_mm(scene: Scenario, hidden: Mapping[str, Mapping[str, float]], bare: Array, duration: float) -> float:
    """How far the effects move the midline, rms over points and frames [mm]."""
    change = seen_midline(scene, hidden, duration) - bare
    return 1e3 * float(np.sqrt(np.mean(np.sum(change**2, axis=2))))


def _sized(scene: Scenario, effect: str, wanted_mm: float, random: np.random.Generator) -> dict[str, float]:
    """Typical parameters scaled until the midline moves by wanted_mm; as near as the effect's own limits let it."""
    drawn = typical(effect, scene.model, random)
    duration = min(scene.duration, 8.0)
    bare = seen_midline(scene, {}, duration)
    factor, low, high = 1.0, 0.0, np.inf
    best, best_miss = drawn, np.inf
    for _ in range(10):
        parameters = scaled(effect, drawn, factor)
        shown = shown_mm(scene, {effect: parameters}, bare, duration)
        miss = abs(np.log(max(shown, 1e-9) / wanted_mm))
        if miss < best_miss:
            best, best_miss = parameters, miss
        if miss < 0.1 or not SCALED_TOGETHER[effect]:
            break
        if shown > wanted_mm:
            high = factor
        elif parameters == scaled(effect, drawn, 2.0 * factor):
            break  # at the effect's limit
        else:
            low = factor
        guess = factor * float(np.clip(wanted_mm / max(shown, 1e-9), 0.1, 10.0))
        factor = guess if low < guess < high else float(np.sqrt(max(low, 0.01 * high) * high))
    return best


def resolve(
    scene: Scenario, effects: Mapping[str, Strength], noise: Noise, random: np.random.Generator
) -> dict[str, dict[str, float]]:
    """Each effect's parameters: as given, typical times a factor, or sized to be "visible" or "faint"."""
    hidden: dict[str, dict[str, float]] = {}
    for effect, strength in effects.items():
        if isinstance(strength, Mapping):
            hidden[effect] = {name: float(number) for name, number in strength.items()}
        elif isinstance(strength, str):
            if strength not in STRENGTH_SIZES:
                raise InputError(
                    f"{strength!r} is not a size", field=effect, expected=f"one of {', '.join(STRENGTH_SIZES)}"
                )
            wanted = 1e3 * noise.midline * random.uniform(*STRENGTH_SIZES[strength])
            hidden[effect] = _sized(scene, effect, wanted, random)
        else:
            hidden[effect] = scaled(effect, typical(effect, scene.model, random), float(strength))
    refuse_unknown(hidden)
    return hidden


def reduction_mm(simulation: Simulation, length: float, orders: tuple[int, ...] = (2, 3, 4)) -> dict[str, float]:
    """Distance of the true shape from the best polynomial curvature of each order, rms [mm], by a fit of the angle."""
    angles = simulation.angles - simulation.theta[:, None]
    s = np.arange(angles.shape[1]) / (angles.shape[1] - 1)
    lost = {}
    for order in orders:
        basis = np.stack([s**j for j in range(1, order + 1)], axis=1)
        rest = angles - (basis @ np.linalg.lstsq(basis, angles.T, rcond=None)[0]).T
        # A small rotation error e(s) moves the midline across itself by L int e ds.
        moved = length * np.cumsum(0.5 * (rest[:, 1:] + rest[:, :-1]), axis=1) / (s.size - 1)
        lost[str(order)] = 1e3 * float(np.sqrt(np.mean(moved**2)))
    return lost


def make_recording(
    effects: Mapping[str, Strength],
    scene: Scenario,
    seed: int,
    noise: Noise = USUAL_NOISE,
    *,
    name: str = "trial",
    clean_midline: bool = False,
) -> tuple[Recording, dict[str, Any]]:
    """A recording whose declaration is the model's own, made with further effects, and the truth about them.

    effects: name -> parameters, or a factor on a typical strength, or "visible" or "faint" (sized so that the midline
    moves by 6-15 or 0.7-2 standard deviations of its noise). Several act together. The model's parameters, the
    catalogue's included, act too. Same seed, same recording. clean_midline leaves the midline without noise, for a
    renderer that brings its own. truth: plain data for a JSON file. Raises InputError as
    simulate does, and for an effect that is not known.
    """
    random = np.random.default_rng(seed)
    hidden = resolve(scene, effects, noise, random)
    run = _run(scene, hidden)
    points = seen_midline(scene, hidden)
    bare = seen_midline(scene, {})
    moved = 1e3 * float(np.sqrt(np.mean(np.sum((points - bare) ** 2, axis=2))))
    spread = 0.0 if clean_midline else noise.midline
    observed = points + spread * random.standard_normal(points.shape)
    motor = None
    if scene.initial_q is None or np.any(run.command):  # a decay at rest needs no log
        angle = run.command + noise.angle * random.standard_normal(run.t.size)
        motor = MotorSignal(run.t, run.command, angle)
    load = run.load_cell + noise.load_cell * random.standard_normal(run.t.size)
    recording = Recording(
        name=name,
        declaration=Declaration(
            scene.model.specimen, scene.model.fluid, scene.model.gravity, release_t=scene.release_t
        ),
        motor=motor,
        travel=None if scene.travel is None else BaseTravel(run.t, as_the_camera_has(run.mount, hidden)),
        load_cell=LoadCellSignal(run.t, load),
        midline=Midline(run.t, run.midline.s, observed, np.full(points.shape[:2], spread if spread > 0.0 else np.nan)),
    )
    known = all(is_catalogued(effect) for effect in hidden)
    truth = {
        "seed": seed,
        "effects": hidden,
        "verdict": ("effect" if known else "unknown") if hidden else "nothing_missing",
        "catalogued": known,
        "moved_mm": moved,
        "noise_mm": 1e3 * noise.midline,
        "reduction_mm": reduction_mm(run, scene.model.specimen.length),
        "mean_thrust_n": float(np.mean(run.thrust)),
    }
    return recording, truth
