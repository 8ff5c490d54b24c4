"""What each blind trial is: which effects are hidden, how strongly, in which arm, under which base motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np

from tentacle.errors import InputError
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Chirp, Multisine, Waveform

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
FASTEST = 6.0  # rad/s that the servo turns


@dataclass(frozen=True)
class Design:
    """One trial as plain data: all that its recording depends on.

    index; seed of its random numbers; kind; effects hidden; r: wanted size of each [noise sigmas]; seen: as a "midline"
    with that noise [m], or as a "video" that is rendered and tracked; duration [s]; fps [1/s]; arm: length, base_radius
    [m], tip_ratio [1], density [kg/m^3], E [Pa], relaxation (eta / E) [s], C_perp [1]; motion: kind and its values.
    """

    index: int
    seed: int
    kind: Kind
    effects: tuple[str, ...]
    r: tuple[float, ...]
    seen: Literal["midline", "video"]
    noise: float
    duration: float
    fps: float
    arm: dict[str, float]
    motion: dict[str, Any]

    def table(self) -> dict[str, Any]:
        """The design as JSON holds it."""
        return {**asdict(self), "effects": list(self.effects), "r": list(self.r)}

    @staticmethod
    def of(table: Mapping[str, Any]) -> Design:
        """The design of a table."""
        return Design(**{**table, "effects": tuple(table["effects"]), "r": tuple(table["r"])})

    def model(self) -> Model:
        """The arm with its true base parameters, in water."""
        a = self.arm
        section = Cone(a["base_radius"], a["tip_ratio"] * a["base_radius"])
        specimen = Specimen(section, a["length"], a["density"])
        parameters = {
            "elasticity": {"E": Estimate.exact(a["E"], "Pa")},
            "damping": {"eta": Estimate.exact(a["E"] * a["relaxation"], "Pa s")},
            "drag": {"C_perp": Estimate.exact(a["C_perp"])},
        }
        return Model(specimen, WATER, parameters=parameters)

    def waveform(self) -> Waveform:
        """The base motion."""
        values = {name: value for name, value in self.motion.items() if name != "kind"}
        if self.motion["kind"] == "chirp":
            return Chirp(**values)
        return Multisine(**{name: tuple(value) for name, value in values.items()})


def _log_uniform(random: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def _arm(random: np.random.Generator) -> dict[str, float]:
    return {
        "length": float(random.uniform(0.11, 0.18)),
        "base_radius": float(random.uniform(0.009, 0.014)),
        "tip_ratio": float(random.uniform(0.1, 0.5)),
        "density": float(random.uniform(1030.0, 1120.0)),
        "E": _log_uniform(random, 1e5, 5e5),
        "relaxation": _log_uniform(random, 3e-3, 2e-2),
        "C_perp": float(random.uniform(0.8, 1.5)),
    }


def _motion(random: np.random.Generator, duration: float) -> dict[str, Any]:
    """A chirp or a multisine between 0.2 and 3 Hz, within the servo's speed."""
    if random.uniform() < 0.5:
        stop = float(random.uniform(1.2, 3.0))
        amplitude = min(float(random.uniform(0.15, 0.4)), FASTEST / (2.0 * np.pi * stop))
        return {"kind": "chirp", "amplitude": amplitude, "start": 0.2, "stop": stop, "duration": duration}
    frequencies = np.sort(random.uniform(0.2, 2.5, 5))
    shares = random.uniform(0.5, 1.5, 5)
    total = min(float(random.uniform(0.3, 0.7)), FASTEST / float(shares @ (2.0 * np.pi * frequencies)) * shares.sum())
    return {
        "kind": "multisine",
        "amplitudes": (total * shares / shares.sum()).tolist(),
        "frequencies": frequencies.tolist(),
        "phases": random.uniform(0.0, 2.0 * np.pi, 5).tolist(),
    }


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


def designs(
    count: int,
    seed: int,
    catalogued: Sequence[str],
    outside: Sequence[str],
    *,
    kinds: Sequence[str] = KINDS,
    video_share: float = 0.25,
) -> list[Design]:
    """The first `count` trials of a seed; each depends on the seed, its index and the kinds alone, so more may follow.

    catalogued, outside: names of the effects that can be hidden, in the catalogue and out of it. InputError where a
    kind is not known or a share is none.
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
        effects = _hidden(kind, places[kind], seed, catalogued, outside, random)
        places[kind] += 1
        duration = float(np.round(random.uniform(*DURATIONS), 1))
        noise, sizes = _log_uniform(random, *NOISE), tuple(_log_uniform(random, *R_RANGE) for _ in effects)
        # Every 1/share-th trial is a video, so that a short series holds its share too; one further on in each round,
        # so that every kind is seen both ways.
        place = index + index // len(turns)
        video = np.floor((place + 0.5) * video_share + 0.5) > np.floor((place - 0.5) * video_share + 0.5)
        found.append(
            Design(
                index=index,
                seed=int(random.integers(2**31)),
                kind=kind,
                effects=effects,
                r=sizes,
                seen="video" if video else "midline",
                noise=noise,
                duration=duration,
                fps=60.0,
                arm=_arm(random),
                motion=_motion(random, duration),
            )
        )
    return found
