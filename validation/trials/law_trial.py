"""A trial of the search for laws: a law drawn by a seed and hidden in the stranger, and the error of the proposals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tentacle.proposed_law import ProposedLaw
from tentacle.recording import Recording
from validation.plants import PLANTS, Filming, Plant, Shown, Trial, drawn, recorded, shown, truth_of
from validation.plants.draw import Hidden, Numbers
from validation.plants.hidden_law import KINDS

FILMING = Filming(seconds=39.0, fps=50.0, sigma=1.5e-4)
SIZE = (2.0, 20.0)  # noise deviations that the law moves the midline, rms
POWER_OFF, PLACE_OFF = 0.1, 0.05  # tolerance of a power, and of a place in arm lengths, for an exact law
CLASSES = KINDS[1:]
SMALLER = 0.7  # of the size that was drawn: where the plant cannot move so far
STIFFEST = 3.0  # largest stiffness of a delayed spring over the arm's: a stiffer one blocks the arm
LINE, TIP, MOMENT = 0.02, 0.002, 0.2  # N/m, N, 1: strengths that the sizing starts from

# kind -> the forms of the grammar that are its law. "{side}" is right or left.
FORMS = {
    "drag_power": ("drag_width",), "one_way_drag": ("one_way_{side}",), "drag_near_point": ("patch_{power}",),
    "jet": ("jet",), "vortex": ("vortex",), "stop": ("stop_{side}",), "tether": ("tether",), "magnet": ("attraction",),
    "tip_drag_power": ("tip_drag",), "delayed_spring": ("late{weight}",),
}  # fmt: skip
IN_DISGUISE = {"delayed_spring": "viscoelasticity"}  # an effect of the catalogue that is the law


@dataclass(frozen=True)
class Met:
    """A proposed law against the truth: the name of its form, whether this is the true form, and its errors: of the
    power, of the place in arm lengths, of the frequency in Hz; None for a number that the law does not have.
    """

    name: str
    form: bool
    power_off: float | None
    place_off: float | None
    frequency_off: float | None

    @property
    def exact(self) -> bool:
        """Whether the form is right, and power and place are within the tolerance."""
        return (
            self.form
            and (self.power_off is None or self.power_off <= POWER_OFF)
            and (self.place_off is None or self.place_off <= PLACE_OFF)
            and (self.frequency_off is None or self.frequency_off <= 1.0 / FILMING.seconds)
        )


def law_recording(seed: int, kind: str | None = None) -> tuple[Recording, dict[str, Any]]:
    """A recording of the stranger with a law of that kind hidden ("nothing": none; None: drawn), and its truth."""
    random = np.random.default_rng([seed, 22])
    chosen = str(random.choice(CLASSES)) if kind is None else kind
    trial = drawn(seed, (), {}, FILMING, SIZE)
    size = float(np.exp(random.uniform(*np.log(SIZE))))
    if chosen != "nothing":
        numbers, strengths = _numbers(chosen, trial.arm, random)
        most = STIFFEST if chosen == "delayed_spring" else np.inf
        law = Hidden(chosen, "as_it_is", {"law_kind": float(KINDS.index(chosen)), **numbers}, strengths, most)
        trial = replace(trial, hidden=(law,), size=(size,))
    plant = PLANTS["stranger"](trial)
    trial, run = _run(trial, plant)
    if chosen != "nothing":  # the strength was found on a part of the film: correct it on the whole
        size = trial.size[0]
        moved = float(np.sqrt(np.mean(np.sum((run.xy - run.bare) ** 2, axis=2)))) / trial.sigma
        trial, run = _run(replace(trial, size=(size * float(np.clip(size / moved, 0.1, 10.0)),)), plant)
    truth = truth_of(trial, plant, run)
    return recorded(trial, run), {"kind": chosen, "numbers": truth["effects"].get(chosen, {}), **truth}


def _run(trial: Trial, plant: Plant) -> tuple[Trial, Shown]:
    """The plant's run, with the law as much smaller as the plant needs to stay within bounds, and the trial of it.

    A vortex force may drive an arm without bound. FloatingPointError where the plant runs away at the smallest size.
    """
    while True:
        try:
            return trial, shown(trial, plant)
        except FloatingPointError:
            if not trial.size or trial.size[0] * SMALLER < SIZE[0]:
                raise
            trial = replace(trial, size=(trial.size[0] * SMALLER,))


def met(truth: dict[str, Any], laws: Sequence[ProposedLaw]) -> list[Met]:
    """Each proposed law beside the truth, in the order given."""
    return [met_by(truth, law.law.name.removeprefix("law_"), law.values) for law in laws]


def met_by(truth: dict[str, Any], name: str, values: dict[str, float]) -> Met:
    """A form with these values of its parameters beside the truth."""
    kind, own, length = truth["kind"], truth["numbers"], truth["arm"]["length"]
    if kind == "nothing":
        return Met(name, False, None, None, None)
    words = {
        "side": "right" if own.get("law_b", 0.0) > 0.0 else "left",
        "power": "linear" if own.get("law_power") == 1.0 else "quadratic",
        "weight": {1.0: "_tip", -1.0: "_clamp"}.get(own.get("law_b", 0.0), ""),
    }
    form = name in [one.format(**words) for one in FORMS[kind]]
    power = place = frequency = None
    if form and "power" in values:
        power = abs(abs(values["power"]) - own["law_power"])
    if form and "at_x" in values:
        place = float(np.hypot(values["at_x"] - own["law_x"], values["at_y"] - own["law_y"])) / length
    elif form and "edge" in values:
        place = abs(values["edge"] - own["law_x"]) / length
    if form and "frequency" in values:
        frequency = abs(values["frequency"] - own["law_frequency"])
    return Met(name, form, power, place, frequency)


def _numbers(kind: str, arm: Numbers, random: np.random.Generator) -> tuple[Numbers, tuple[str, ...]]:
    """The law's numbers at a strength to start from, and which of them scale with its size."""
    L, side, turn = arm["length"], float(random.choice([-1.0, 1.0])), float(random.uniform(0.0, 2.0 * np.pi))
    in_reach = {"law_x": side * random.uniform(0.0, 0.35) * L, "law_y": random.uniform(0.5, 1.0) * L}
    beside = {"law_x": side * random.uniform(0.3, 0.5) * L, "law_y": random.uniform(0.8, 1.2) * L}
    reach = {"law_reach": random.uniform(0.12, 0.3) * L}
    away = float(np.hypot(beside["law_x"], beside["law_y"] - L))
    strouhal = 0.03 / (arm["base_radius"] + arm["tip_radius"]) * random.uniform(0.8, 1.5)  # St = .2 at .15 m/s or so
    both = {"law_a": LINE * np.cos(turn), "law_b": LINE * np.sin(turn)}
    numbers: dict[str, Numbers] = {
        "drag_power": {"law_a": LINE, "law_power": float(random.choice([0.5, 1.5, 2.5, 3.0]))},
        "one_way_drag": {"law_a": LINE, "law_b": side, "law_power": float(random.choice([1.0, 1.5, 2.0]))},
        "drag_near_point": {"law_a": LINE, "law_power": float(random.choice([1.0, 2.0])), **in_reach, **reach},
        "jet": {**both, **in_reach, **reach},
        "vortex": {**both, "law_power": 2.0, "law_frequency": strouhal},
        "stop": {"law_a": TIP, "law_b": side, "law_x": side * random.uniform(0.05, 0.2) * L,
                 "law_power": float(random.choice([1.0, 1.5, 2.0]))},
        "tether": {"law_a": TIP, **beside, "law_reach": random.uniform(0.7, 1.0) * away},
        "magnet": {"law_a": side * TIP, **beside, "law_power": float(random.choice([1.0, 2.0, 3.0, 4.0]))},
        "tip_drag_power": {"law_a": TIP, "law_power": float(random.choice([0.5, 1.0, 1.5, 2.0, 3.0]))},
        "delayed_spring": {"law_a": MOMENT, "law_b": float(random.choice([-1.0, 0.0, 1.0])),
                           "law_tau": float(np.exp(random.uniform(np.log(0.05), np.log(0.5))))},
    }  # fmt: skip
    strengths = ("law_a", "law_b") if kind in ("jet", "vortex") else ("law_a",)
    return {name: float(value) for name, value in numbers[kind].items()}, strengths
