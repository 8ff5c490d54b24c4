"""A filmed plant: hidden effects scaled to a change of the picture, the run, the recording and its truth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from tentacle.errors import InputError
from tentacle.recording import Declaration, Recording
from tentacle.signals import Array, LoadCellSignal, Midline, MotorSignal
from tentacle.specimen import Cone, Fluid, Gravity, Specimen
from validation.plants.camera import as_filmed, looks_at
from validation.plants.draw import MOVED, SEEN, SETTLED, Hidden, Trial
from validation.plants.laws import LAWS, law_number, law_record
from validation.plants.servo import turned

STEP, COARSE = 1e-3, 2e-3  # s, at most: the tip is right to 1 micrometre; to 5, which is enough to size an effect
PLACES = np.linspace(0.0, 1.0, 31)
# (record, base angle at half steps [rad], step [s], every how many steps) -> places (T, P, 2) [m] at P even points from
# clamp to tip, and the force along y on the mount (T,) [N].
Mover = Callable[[np.ndarray, Array, float, int], tuple[Array, Array]]
LONGER = 0.5  # s beyond the last frame, for a camera with a time offset
LOAD_NOISE = 5e-4  # N
SIZING = 8.0  # s of film from which a hidden effect's strength is found


@dataclass(frozen=True)
class Plant:
    """The function that moves a trial's arm, in steps of at most `step` [s], and its entries in the truth (plain
    data).
    """

    move: Mover
    step: float = STEP
    own: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Shown:
    """A plant's run without noise. hidden: the effects, at the strengths that act. xy, bare (T, P, 2) [m]: the midline
    in the picture with the hidden effects and without.

    load (T,) [N], command (T,) [rad] at the frames' times t (T,) [s], the first at 0.
    """

    hidden: tuple[Hidden, ...]
    t: Array
    xy: Array
    bare: Array
    load: Array
    command: Array


def shown(trial: Trial, plant: Plant) -> Shown:
    """The trial's run, with the hidden effects at the requested size."""
    hidden = sized(trial, plant)
    xy, load, command, t = film(trial, plant, hidden)
    bare = film(trial, plant, ())[0] if hidden else xy
    return Shown(hidden, t, xy, bare, load, command)


def declaration_of(trial: Trial) -> Declaration:
    """The declaration of the trial's arm, without the hidden effects."""
    arm = trial.arm
    specimen = Specimen(Cone(arm["base_radius"], arm["tip_radius"]), arm["length"], arm["density"])
    fluid = Fluid(arm["water"], "section" if trial.carries else "none")
    return Declaration(specimen, fluid, Gravity(0.0, arm["gravity"]))


def recorded(trial: Trial, run: Shown) -> Recording:
    """The recording as a lab has it: the midline with the trial's noise, the servo's log and the load cell's."""
    random = np.random.default_rng([trial.seed, 21])
    noisy = run.xy + trial.sigma * random.standard_normal(run.xy.shape)
    return Recording(
        f"trial_{trial.seed}",
        declaration_of(trial),
        MotorSignal(run.t, run.command, run.command),
        LoadCellSignal(run.t, run.load + LOAD_NOISE * random.standard_normal(run.load.size)),
        Midline(run.t, PLACES, noisy, np.full(run.xy.shape[:2], trial.sigma)),
    )


def truth_of(trial: Trial, plant: Plant, run: Shown) -> dict[str, Any]:
    """The answers to the recording, as plain data for a JSON file."""
    catalogued = all(one.effect in LAWS for one in run.hidden)
    return {
        "seed": trial.seed,
        "verdict": ("effect" if catalogued else "unknown") if run.hidden else "nothing_missing",
        "effects": {one.effect: one.numbers for one in run.hidden},
        "laws": {one.effect: one.law for one in run.hidden},
        "own": {one.effect: {"law": one.law, **one.numbers} for one in trial.own},
        "arm": trial.arm,
        "declared_added_mass": trial.carries,
        "motion": {"chirp": trial.chirps, "parts": [part.tolist() for part in trial.motion]},
        "moved_mm": 1e3 * float(np.sqrt(np.mean(np.sum((run.xy - run.bare) ** 2, axis=2)))),
        "noise_mm": 1e3 * trial.sigma,
        **plant.own,
    }


def sized(trial: Trial, plant: Plant) -> tuple[Hidden, ...]:
    """Each hidden effect at the requested size, by up to three corrections with a shorter run; added mass is not
    scaled.
    """
    if not trial.hidden:
        return ()
    short = replace(trial, seconds=min(trial.seconds, SIZING))
    if trial.chirps and short.seconds < trial.seconds:  # the same part of the chirp
        amplitude, (first, last), phase = trial.motion
        last = first + (last - first) * (short.seconds + SETTLED) / (trial.seconds + SETTLED)
        short = replace(short, motion=(amplitude, np.array([first, last]), phase))
    rough = replace(plant, step=max(COARSE, plant.step))
    bare = film(short, rough, ())[0]
    sized = []
    for one, size in zip(trial.hidden, trial.size, strict=True):
        wanted = size * trial.sigma
        if one.effect != "added_mass":
            for _ in range(3):
                moved = float(np.sqrt(np.mean(np.sum((film(short, rough, (one,))[0] - bare) ** 2, axis=2))))
                ratio = wanted / max(moved, 1e-12)
                one = one.times(float(np.clip(ratio, 0.05, 20.0)))
                if 0.9 < ratio < 1.1:
                    break
        sized.append(one)
    return tuple(sized)


def film(trial: Trial, plant: Plant, hidden: tuple[Hidden, ...]) -> tuple[Array, Array, Array, Array]:
    """Midline (T, P, 2) [m], load cell [N], logged command [rad] and frames' times [s] with these effects in it, beside
    the arm's own laws.

    InputError where the plant's motion grows without bound.
    """
    hidden = (*trial.own, *hidden)
    numbers, laws = _numbers(trial, hidden), {one.effect: one.law for one in hidden}
    outside = {name: value for one in hidden if one.effect in (*SEEN, *MOVED) for name, value in one.numbers.items()}
    every = int(np.ceil(1.0 / (trial.fps * plant.step) - 1e-9))
    step = 1.0 / (trial.fps * every)
    duration = SETTLED + trial.seconds + LONGER
    half_steps: Array = 0.5 * step * np.arange(2 * round(duration / step) + 1, dtype=np.float64)
    theta = turned(trial.theta(half_steps), 0.5 * step, outside, laws)
    try:
        places, pulls = plant.move(law_record(**numbers), theta, step, every)
    except np.linalg.LinAlgError:
        effects = ", ".join(laws) or "no effect"
        raise InputError("its motion grows without bound", field=f"plant with {effects}") from None
    run_t = step * every * np.arange(len(places))
    frames: Array = SETTLED + np.arange(round(trial.seconds * trial.fps) + 1, dtype=np.float64) / trial.fps
    points = CubicSpline(np.linspace(0.0, 1.0, places.shape[1]), places, axis=1)(PLACES)
    xy = CubicSpline(run_t, points)(np.clip(looks_at(frames, outside, laws), 0.0, run_t[-1]))
    load = CubicSpline(run_t[:-1], pulls[:-1] - pulls[0])(frames)
    return as_filmed(xy, trial.arm["length"], outside, laws), load, trial.theta(frames), frames - SETTLED


def _numbers(trial: Trial, hidden: tuple[Hidden, ...]) -> dict[str, float]:
    """The tank's numbers with these effects acting."""
    numbers = dict(trial.arm)
    if trial.carries:
        numbers |= {"C_a": 1.0}
    for one in hidden:
        if one.effect in (*SEEN, *MOVED):
            continue
        own = dict(one.numbers)
        if one.effect in LAWS:
            own[f"{one.effect}_law"] = float(law_number(one.effect, one.law))
        numbers["gravity"] *= np.cos(own.pop("weakened", 0.0))
        numbers |= own
    return numbers
