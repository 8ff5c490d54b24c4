"""Design of the blind trials like a recording: the effects that the reference hides in its arm, and their strengths."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from tentacle.io.model_file import model_tables, parse_model
from tentacle.io.toml_table import Table
from tentacle.io.waveform_file import waveform_from_table
from tentacle.model import Estimate, Model
from tentacle.waveform import Waveform
from validation.trials.likeness import Likeness
from validation.trials.rounds import TRIAL_KINDS, TrialKind, dealt, log_uniform
from validation.trials.sight import Measurement

R_RANGE = (0.3, 10.0)  # noise sigmas: rms of the residual that refitting the base cannot absorb
BASE_SPREAD = (0.8, 1.25)  # times a fitted base parameter, in the trials like a recording


@dataclass(frozen=True)
class Design:
    """One trial as plain data: all that its recording depends on.

    index; seed of its random numbers; kind; effects hidden; r: wanted size of each [noise sigmas]; sight: how the arm
    is seen; duration [s]; fps [1/s]; arm: the model with its true base parameters, as model.toml's tables; motion of
    the base, as a waveform's table. initial_q [rad], release_t [s]: instead, the arm is held in that shape until it is
    let go. errors_of: the recording whose own errors are the noise (a path; empty: white noise). baseline: recordings
    that the diagnosis is told to be complete (paths).
    """

    index: int
    seed: int
    kind: TrialKind
    effects: tuple[str, ...]
    r: tuple[float, ...]
    sight: Measurement
    duration: float
    fps: float
    arm: dict[str, Any]
    motion: dict[str, Any]
    initial_q: tuple[float, ...] | None = None
    release_t: float | None = None
    errors_of: str = ""
    baseline: tuple[str, ...] = ()

    def table(self) -> dict[str, Any]:
        """The design as JSON holds it."""
        start = None if self.initial_q is None else list(self.initial_q)
        lists = {"effects": list(self.effects), "r": list(self.r), "initial_q": start, "baseline": list(self.baseline)}
        return {**asdict(self), **lists, "sight": self.sight.table()}

    @staticmethod
    def of(table: Mapping[str, Any]) -> Design:
        """The design of a table."""
        start = None if table["initial_q"] is None else tuple(table["initial_q"])
        tuples = {name: tuple(table[name]) for name in ("effects", "r", "baseline")} | {"initial_q": start}
        return Design(**{**table, **tuples, "sight": Measurement.of(table["sight"])})

    def model(self) -> Model:
        """The arm with its true base parameters."""
        return parse_model(Table(self.arm, file=None))

    def waveform(self) -> Waveform:
        """The base motion."""
        return waveform_from_table(self.motion)


def _varied(model: Model, random: np.random.Generator) -> Model:
    """The model with base parameters near the fitted ones, which are uncertain if the fit lacks an effect."""
    changed = {
        effect: {
            name: Estimate.exact(e.value * float(random.uniform(*BASE_SPREAD)), e.unit) for name, e in values.items()
        }
        for effect, values in model.parameters.items()
    }
    return replace(model, parameters=changed)


def designs(
    count: int,
    seed: int,
    catalogued: Sequence[str],
    outside: Sequence[str],
    like: Likeness,
    kinds: Sequence[str] = TRIAL_KINDS,
) -> list[Design]:
    """The first `count` trials of a seed like a recording: its arm, its motion, its kind of measurement.

    catalogued, outside: names of the effects that can be hidden, in the catalogue and out of it. Beside a real baseline
    the arm keeps its fitted parameters. InputError where a kind is not known.
    """
    found = []
    for one in dealt(count, seed, catalogued, outside, kinds=kinds):
        sizes = tuple(log_uniform(one.random, *R_RANGE) for _ in one.effects)
        head = (one.index, int(one.random.integers(2**31)), one.kind, one.effects, sizes)
        arm = model_tables(like.model if like.real.baseline else _varied(like.model, one.random))
        rest = (like.initial_q, like.release_t, like.real.errors_of, like.real.baseline)
        found.append(Design(*head, like.sight, like.duration, like.fps, arm, like.motion, *rest))
    return found
