"""What each blind trial is: which effects are hidden, how strongly, in which arm, under which base motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal

import numpy as np

from tentacle.errors import InputError
from tentacle.io.model_file import model_tables, parse_model
from tentacle.io.toml_table import Table
from tentacle.io.waveform_file import waveform_from_table, waveform_table
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Chirp, Multisine, Waveform
from validation.trials.likeness import Likeness
from validation.trials.sight import Sight

Kind = Literal["single", "pair", "null", "unknown"]
# Of every sixteen trials: singles carry the confusion matrix, nulls and unknowns the two ways of being wrong about it.
ROUND: tuple[Kind, ...] = (
    "single", "null", "single", "unknown", "single", "pair", "single", "single",
    "null", "single", "unknown", "single", "pair", "single", "single", "pair",
)  # fmt: skip
KINDS: tuple[Kind, ...] = ("single", "pair", "null", "unknown")
R_RANGE = (0.3, 10.0)  # noise sigmas: rms of the residual that refitting the base cannot absorb
DURATIONS = (12.0, 39.0)  # s
NOISE = (5e-5, 2e-4)  # m, of each coordinate of a midline point
VIDEO_NOISE = 2e-5  # m: a midline's noise that tells as little as the tracker's own covariance (some micrometres to 30)
NEAR = (0.8, 1.25)  # times a fitted base parameter: those of the trials like a recording
FASTEST = 6.0  # rad/s that the servo turns


@dataclass(frozen=True)
class Design:
    """One trial as plain data: all that its recording depends on.

    index; seed of its random numbers; kind; effects hidden; r: wanted size of each [noise sigmas]; sight: how the arm
    is seen; duration [s]; fps [1/s]; arm: the model with its true base parameters, as model.toml's tables; motion of
    the base, as a waveform's table. initial_q [rad], release_t [s]: instead, the arm is held in that shape until it is
    let go.
    """

    index: int
    seed: int
    kind: Kind
    effects: tuple[str, ...]
    r: tuple[float, ...]
    sight: Sight
    duration: float
    fps: float
    arm: dict[str, Any]
    motion: dict[str, Any]
    initial_q: tuple[float, ...] | None = None
    release_t: float | None = None

    def table(self) -> dict[str, Any]:
        """The design as JSON holds it."""
        start = None if self.initial_q is None else list(self.initial_q)
        lists = {"effects": list(self.effects), "r": list(self.r), "initial_q": start}
        return {**asdict(self), **lists, "sight": self.sight.table()}

    @staticmethod
    def of(table: Mapping[str, Any]) -> Design:
        """The design of a table."""
        start = None if table["initial_q"] is None else tuple(table["initial_q"])
        tuples = {"effects": tuple(table["effects"]), "r": tuple(table["r"]), "initial_q": start}
        return Design(**{**table, **tuples, "sight": Sight.of(table["sight"])})

    def model(self) -> Model:
        """The arm with its true base parameters."""
        return parse_model(Table(self.arm, file=None))

    def waveform(self) -> Waveform:
        """The base motion."""
        return waveform_from_table(self.motion)


def _log_uniform(random: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def _arm(random: np.random.Generator) -> Model:
    """A silicone arm in water."""
    length = float(random.uniform(0.11, 0.18))
    base_radius = float(random.uniform(0.009, 0.014))
    section = Cone(base_radius, float(random.uniform(0.1, 0.5)) * base_radius)
    specimen = Specimen(section, length, float(random.uniform(1030.0, 1120.0)))
    modulus = _log_uniform(random, 1e5, 5e5)
    parameters = {
        "elasticity": {"E": Estimate.exact(modulus, "Pa")},
        "damping": {"eta": Estimate.exact(modulus * _log_uniform(random, 3e-3, 2e-2), "Pa s")},
        "drag": {"C_perp": Estimate.exact(float(random.uniform(0.8, 1.5)))},
    }
    return Model(specimen, WATER, parameters=parameters)


def _varied(model: Model, random: np.random.Generator) -> Model:
    """The model with base parameters near its own: a fit that lacks an effect knows them no better."""
    changed = {
        effect: {name: Estimate.exact(e.value * float(random.uniform(*NEAR)), e.unit) for name, e in values.items()}
        for effect, values in model.parameters.items()
    }
    return replace(model, parameters=changed)


def _motion(random: np.random.Generator, duration: float) -> Waveform:
    """A chirp or a multisine between 0.2 and 3 Hz, within the servo's speed."""
    if random.uniform() < 0.5:
        stop = float(random.uniform(1.2, 3.0))
        amplitude = min(float(random.uniform(0.15, 0.4)), FASTEST / (2.0 * np.pi * stop))
        return Chirp(amplitude, 0.2, stop, duration)
    frequencies = np.sort(random.uniform(0.2, 2.5, 5))
    shares = random.uniform(0.5, 1.5, 5)
    total = min(float(random.uniform(0.3, 0.7)), FASTEST / float(shares @ (2.0 * np.pi * frequencies)) * shares.sum())
    amplitudes = (total * shares / shares.sum()).tolist()
    return Multisine(
        tuple(amplitudes), tuple(frequencies.tolist()), tuple(random.uniform(0.0, 2.0 * np.pi, 5).tolist())
    )


def _turn(names: Sequence[str], place: int, seed: int) -> str:
    """The place-th of an endless row of shuffled decks of names: all come equally often."""
    deck, card = divmod(place, len(names))
    return str(np.random.default_rng([seed, 7, deck]).permutation(sorted(names))[card])


def _hidden(
    kind: Kind, place: int, seed: int, catalogued: Sequence[str], outside: Sequence[str], random: np.random.Generator
) -> tuple[str, ...]:
    if kind == "null":
        return ()
    if kind == "unknown":
        return (_turn(outside, place, seed + 1),)
    first = _turn(catalogued, place, seed + 2 if kind == "single" else seed + 3)
    if kind == "single":
        return (first,)
    return first, str(random.choice(sorted(set(catalogued) - {first})))


def _is_video(index: int, turns: int, share: float) -> bool:
    """Every 1/share-th trial is a video, so that a short series holds its share too; one further on in each round, so
    that every kind is seen both ways.
    """
    place = index + index // turns
    return bool(np.floor((place + 0.5) * share + 0.5) > np.floor((place - 0.5) * share + 0.5))


@dataclass(frozen=True)
class Hideable:
    """Names of the effects that can be hidden, in the catalogue and out of it."""

    catalogued: Sequence[str]
    outside: Sequence[str]


def designs(
    count: int,
    seed: int,
    hideable: Hideable,
    *,
    kinds: Sequence[str] = KINDS,
    video_share: float = 0.25,
    like: Likeness | None = None,
) -> list[Design]:
    """The first `count` trials of a seed; each depends on the seed, its index and the kinds alone, so more may follow.

    like: all are runs of
    that arm under that motion, seen in that way. InputError where a kind is not known, a share is none, or nothing can
    be hidden.
    """
    unknown = sorted(set(kinds) - set(KINDS))
    if unknown or not kinds:
        raise InputError(f"{', '.join(unknown) or 'none'}", field="kinds", expected=f"some of {', '.join(KINDS)}")
    if not 0.0 <= video_share <= 1.0:
        raise InputError(f"{video_share!r} is not usable", field="video share", expected="0 to 1")
    turns: list[Kind] = [kind for kind in ROUND if kind in kinds]
    found: list[Design] = []
    places = dict.fromkeys(KINDS, 0)
    for index in range(count):
        kind = turns[index % len(turns)]
        random = np.random.default_rng([seed, index])
        effects = _hidden(kind, places[kind], seed, hideable.catalogued, hideable.outside, random)
        places[kind] += 1
        duration = float(np.round(random.uniform(*DURATIONS), 1))
        noise, sizes = _log_uniform(random, *NOISE), tuple(_log_uniform(random, *R_RANGE) for _ in effects)
        own_seed = int(random.integers(2**31))
        head = (index, own_seed, kind, effects, sizes)
        if like is None:
            video = _is_video(index, len(turns), video_share)
            sight = Sight("video", VIDEO_NOISE) if video else Sight("midline", noise, noise)
            arm, motion = model_tables(_arm(random)), waveform_table(_motion(random, duration))
            found.append(Design(*head, sight, duration, 60.0, arm, motion))
        else:
            arm = model_tables(_varied(like.model, random))
            start = (like.initial_q, like.release_t)
            found.append(Design(*head, like.sight, like.duration, like.fps, arm, like.motion, *start))
    return found
