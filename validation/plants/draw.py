"""One trial, drawn from its seed: arm, motion, hidden effects, their laws and strengths, noise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tentacle.errors import InputError
from tentacle.signals import Array
from validation.plants.laws import LAWS, OUTSIDE
from validation.plants.typical import TYPICAL, Draw, Numbers

NOTHING, SOMETHING_ELSE, TWO = 0.2, 0.15, 0.2  # shares of trials with none, with one outside the catalogue, with a pair
CARRIES = 0.5  # share of trials that declare added mass and have it
FASTEST = 6.0  # rad/s that a servo turns
# Effects of camera and servo are not in the tank's record.
SEEN = ("time_offset", "camera_roll", "camera_scale")
MOVED = ("servo_lag", "backlash")


@dataclass(frozen=True)
class Hidden:
    """One hidden effect: the law that acts, its numbers at a typical size, and which of them scale with the size."""

    effect: str
    law: str
    numbers: Numbers
    strengths: tuple[str, ...]
    most: float = np.inf

    def times(self, factor: float) -> Hidden:
        """The effect with its strength times a factor, at most `most`."""
        factor = min(factor, self.most / max(abs(self.numbers[name]) for name in self.strengths))
        changed = {name: factor * self.numbers[name] for name in self.strengths}
        return Hidden(self.effect, self.law, {**self.numbers, **changed}, self.strengths, self.most)


@dataclass(frozen=True)
class Trial:
    """All that a recording depends on.

    arm: the tank's numbers with nothing hidden. motion: amplitudes [rad], frequencies [Hz] and phases of a multisine,
    or a chirp's amplitude, first and last frequency. size: wanted rms of the hidden effects in noise sigmas, each. own:
    laws of the arm that nobody declares, at the strengths that act in every one of its recordings.
    """

    seed: int
    arm: Numbers
    carries: bool
    motion: tuple[Array, Array, Array]
    chirps: bool
    hidden: tuple[Hidden, ...]
    size: tuple[float, ...]
    seconds: float
    fps: float
    sigma: float
    own: tuple[Hidden, ...] = ()

    def theta(self, t: Array) -> Array:
        """Commanded angle of the servo [rad], with a smooth start during the first second."""
        amplitude, frequency, phase = self.motion
        if self.chirps:
            first, last = frequency
            sweep = 2.0 * np.pi * (first * t + 0.5 * (last - first) * t**2 / (self.seconds + SETTLED))
            wave = amplitude[0] * np.sin(sweep + phase[0])
        else:
            wave = np.sin(2.0 * np.pi * np.outer(t, frequency) + phase) @ amplitude
        ramp = np.clip(t, 0.0, 1.0)
        return wave * ramp**3 * (10.0 - 15.0 * ramp + 6.0 * ramp**2)


SETTLED = 2.0  # s of motion before the first frame


@dataclass(frozen=True)
class Filming:
    """seconds, frames a second, and the noise of each midline coordinate, sigma [m]."""

    seconds: float = 20.0
    fps: float = 50.0
    sigma: float = 1.5e-4


USUAL_FILMING = Filming()


def drawn(
    seed: int, effects: Sequence[str] | None, laws: Mapping[str, str], filming: Filming, size: tuple[float, float]
) -> Trial:
    """The trial of a seed; arguments that are given are not drawn."""
    random = np.random.default_rng([seed, 20])
    arm = _arm(random)
    chirps = bool(random.uniform() < 0.5)
    motion = _chirp(random) if chirps else _multisine(random)
    carries = bool(random.uniform() < CARRIES)
    names = _effects(random) if effects is None else tuple(effects)
    for name in names:
        if name not in LAWS and name not in OUTSIDE:
            expected = f"one of {', '.join((*LAWS, *OUTSIDE))}"
            raise InputError("no such effect", field=name, expected=expected)
    hidden = tuple(_hidden(name, laws.get(name), arm, random) for name in names)
    sizes = tuple(float(np.exp(random.uniform(*np.log(size)))) for _ in hidden)
    if "added_mass" in names:
        carries = False
    return Trial(seed, arm, carries, motion, chirps, hidden, sizes, filming.seconds, filming.fps, filming.sigma)


def _arm(random: np.random.Generator) -> Numbers:
    base = float(random.uniform(0.009, 0.013))
    modulus = float(np.exp(random.uniform(np.log(1.2e5), np.log(5e5))))
    return {
        "length": float(random.uniform(0.11, 0.18)),
        "base_radius": base,
        "tip_radius": base * float(random.uniform(0.15, 0.5)),
        "density": float(random.uniform(1030.0, 1120.0)),
        "water": float(random.uniform(997.0, 1003.0)),
        "gravity": 9.81,
        "E": modulus,
        "eta": modulus * float(np.exp(random.uniform(np.log(5e-3), np.log(3e-2)))),
        "C_perp": float(random.uniform(0.8, 1.5)),
    }


def _chirp(random: np.random.Generator) -> tuple[Array, Array, Array]:
    last = float(random.uniform(1.4, 2.6))
    amplitude = min(float(random.uniform(0.2, 0.45)), FASTEST / (2.0 * np.pi * last))
    return np.array([amplitude]), np.array([random.uniform(0.2, 0.4), last]), np.array([0.0])


def _multisine(random: np.random.Generator) -> tuple[Array, Array, Array]:
    frequency = np.sort(random.uniform(0.2, 2.2, 5))
    share = random.uniform(0.5, 1.5, 5) / frequency**0.5
    amplitude = share * min(random.uniform(0.5, 0.8) / share.sum(), FASTEST / (share @ (2.0 * np.pi * frequency)))
    return amplitude, frequency, random.uniform(0.0, 2.0 * np.pi, 5)


def _effects(random: np.random.Generator) -> tuple[str, ...]:
    kind = random.uniform()
    if kind < NOTHING:
        return ()
    if kind < NOTHING + SOMETHING_ELSE:
        return (str(random.choice(OUTSIDE)),)
    count = 2 if random.uniform() < TWO / (1.0 - NOTHING - SOMETHING_ELSE) else 1
    return tuple(str(name) for name in random.choice(sorted(LAWS), size=count, replace=False))


def _hidden(name: str, law: str | None, arm: Numbers, random: np.random.Generator) -> Hidden:
    """The effect at a typical size: sign, place, direction, frequency and law drawn."""
    choices = LAWS.get(name, ("as_it_is",))
    chosen = str(random.choice(choices)) if law is None else law
    if chosen not in choices:
        raise InputError(f"{chosen!r} is no law of it", field=name, expected=f"one of {', '.join(choices)}")
    sign, turn, share = float(random.choice([-1.0, 1.0])), float(random.uniform(0.0, 2.0 * np.pi)), random.uniform()
    numbers, strengths, most = TYPICAL[name](Draw(arm, chosen, sign, turn, float(share)))
    return Hidden(name, chosen, {key: float(value) for key, value in numbers.items()}, strengths, most)
