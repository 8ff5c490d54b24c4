"""The search over the grammar of laws: every law is ranked by linear algebra, then the best few are refined.

With t the missing force's own answer in the frames, S the answers of a law's strengths at given shapes (both freed of
what the model's own parameters take up; inference.missing_force), a law explains

    gain = (|t|^2 - min over a of |t - S a|^2) / 2 v        [nats],

v is the variance of the best law's residual, at least 1. Each parameter costs log(F) / 2 nats, F the number of frames.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import product

import numpy as np

from affine_model.curvature import Array
from discovery.laws.grammar import Form, Scale, forms
from discovery.laws.inputs import LawInputs
from discovery.laws.refine import RefinementProblem, RefinementStart, refined_shapes
from discovery.side_by_side import side_by_side
from inference.missing_force import MOTION_STEP
from inference.trajectory import RAN_AWAY
from tentacle.law.written_law import WrittenParameter

COLUMNS_AT_ONCE = 60  # their forces stay in the processor's cache
REFINED = 12  # forms whose shapes are refined
STARTS, APART = 3, 1.5  # of each form, that many grid spacings from each other


@dataclass(frozen=True)
class FittedLaw:
    """A law of a form with its shapes and strengths.

    gain [nats]: over no law. price [nats]: of its parameters. unexplained: the share of the missing force's answer that
    the law leaves, 0 .. 1 in rms. deviations: standard deviations of the shapes, if the law is true.
    """

    form: Form
    shapes: Mapping[str, float]
    strengths: Mapping[str, float]
    gain: float
    price: float
    unexplained: float
    deviations: Mapping[str, float]

    @property
    def evidence(self) -> float:
        """Gain less price [nats]."""
        return self.gain - self.price

    @property
    def values(self) -> dict[str, float]:
        """All parameters."""
        return {**self.strengths, **self.shapes}


@dataclass(frozen=True)
class Sought:
    """The recordings in which a law is sought."""

    seen: tuple[LawInputs, ...]

    @cached_property
    def target(self) -> Array:
        """The missing force's answer in all frames, whitened."""
        return np.concatenate([one.small.freed(one.small.target[:, None])[:, 0] for one in self.seen])

    def prepare(self) -> None:
        """What every form needs is computed once, before processes share the forms."""
        for one in self.seen:
            one.prepare()
        _ = self.target

    @property
    def ran_away(self) -> bool:
        """Whether the small motions leave all bounds: about a model that falls over, they grow without end."""
        return not all(bool((np.abs(one.small.target) < RAN_AWAY).all()) for one in self.seen)

    @property
    def frames(self) -> int:
        """Number of frames that show it."""
        return sum(one.small.place.size for one in self.seen)

    @property
    def scale(self) -> Scale:
        """What the grammar's grids depend on."""
        arm = self.seen[0].arm
        duration = max(one.motion.t.size for one in self.seen) * MOTION_STEP
        return Scale(arm.specimen.length, arm.fluid.density > 0.0, duration)

    @property
    def degrees(self) -> int:
        """Values in the frames, less what the model's own unknowns take up."""
        return max(self.target.size - sum(one.small.absorbed.shape[1] for one in self.seen), 1)

    @property
    def size(self) -> float:
        """The missing force's answer beyond noise, rms, in noise deviations."""
        return float(np.sqrt(max(float(self.target @ self.target) / self.degrees - 1.0, 0.0)))

    def left(self, explained: float) -> float:
        """The share (0 .. 1, rms) of that answer that a law leaves which explains so much of |t|^2."""
        whole = float(self.target @ self.target)
        return float(np.sqrt(max(whole - explained - self.degrees, 0.0) / max(whole - self.degrees, 1e-12 * whole)))

    def change(self, found: FittedLaw) -> Array:
        """What the model's free parameters change by beside that law, in their scales (P,): least squares over both."""
        rows, target = [], []
        for one in self.seen:
            small, basis = one.small, one.small.state_basis
            answer = small.answer(one.force(found.form.law, found.values)[:, :, None])
            columns = np.concatenate([small.by_parameters, answer, small.target[:, None]], axis=1)
            columns = columns - basis @ (basis.T @ columns)
            rows.append(columns[:, :-1])
            target.append(columns[:, -1])
        columns = np.concatenate(rows)
        size = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
        solution = np.linalg.lstsq(columns / size, np.concatenate(target), rcond=1e-8)[0] / size
        return np.asarray(solution[:-1])

    def columns(self, form: Form, trials: list[tuple[float, ...]]) -> Array:
        """The answers (rows, trials * strengths) of the form's unit strengths at each trial's shapes."""
        answers = []
        for one in self.seen:
            forces = []
            for trial in trials:
                shapes = dict(zip((p.name for p in form.shapes), trial, strict=True))
                for strength in form.strengths:
                    units = {p.name: float(p is strength) for p in form.strengths}
                    forces.append(one.force(form.law, {**units, **shapes}))
            answers.append(one.small.freed(one.small.answer(np.stack(forces, axis=2))))
        return np.concatenate(answers)

    def explained(self, form: Form, columns: Array) -> tuple[Array, Array]:
        """Of each group of columns, one a strength: |t|^2 less the least |t - S a|^2, and a (groups, strengths);
        nothing is explained where a strength leaves its bounds.
        """
        count = len(form.strengths)
        size = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
        scaled = (columns / size).reshape(columns.shape[0], -1, count)
        slope = np.einsum("rgc,r->gc", scaled, self.target)
        information = np.einsum("rgc,rgd->gcd", scaled, scaled) + 1e-9 * np.eye(count)
        strengths = np.linalg.solve(information, slope[..., None])[..., 0]
        found = strengths / size.reshape(-1, count)
        bounds = np.array([p.bounds for p in form.strengths])
        within = np.all((found >= bounds[:, 0]) & (found <= bounds[:, 1]), axis=1)
        return np.where(within, np.einsum("gc,gc->g", slope, strengths), 0.0), found


@dataclass(frozen=True)
class RoughLaw:
    """A form where its refinement begins, best start first; promise [nats]: the evidence at the best, with v = 1."""

    form: Form
    starts: list[RefinementStart]
    promise: float


def search_laws(sought: Sought, among: tuple[Form, ...] = ()) -> tuple[FittedLaw, ...]:
    """Laws that explain the missing force, best first; one a form. among: these forms alone (none: the grammar's)."""
    sought.prepare()
    rough = side_by_side([partial(_rough, sought, form) for form in among or forms(sought.scale)])
    rough.sort(key=lambda row: -row.promise)
    refined = side_by_side([partial(_refined, sought, one.form, one.starts) for one in rough[:REFINED]])
    whole = float(sought.target @ sought.target)
    variance = max(1.0, min((whole - 2.0 * one.gain) / sought.degrees for one in refined))
    scaled = [replace(one, gain=one.gain / variance) for one in refined]
    return tuple(sorted(scaled, key=lambda one: -one.evidence))


def _rough(sought: Sought, form: Form) -> RoughLaw:
    starts = _starts(sought, form)
    return RoughLaw(form, starts, starts[0].explained / 2.0 - _price(form, sought.frames))


def _price(form: Form, frames: int) -> float:
    return 0.5 * len(form.law.parameters) * float(np.log(frames))


def _starts(sought: Sought, form: Form) -> list[RefinementStart]:
    """The best of the form's first values of its shapes, apart from each other; best first."""
    trials = list(product(*(p.scan for p in form.shapes)))
    explained = np.concatenate([
        sought.explained(form, sought.columns(form, part))[0]
        for part in _batched(trials, COLUMNS_AT_ONCE // len(form.strengths))
    ])  # fmt: skip
    places, chosen = np.array(trials, float).reshape(len(trials), -1), list[int]()
    spacing = np.array([grid_spacing(p) for p in form.shapes])
    for k in np.argsort(-explained):
        apart = [np.abs((places[k] - places[one]) / spacing).max(initial=0.0) > APART for one in chosen]
        if all(apart) and len(chosen) < STARTS:
            chosen.append(int(k))
    return [RefinementStart(places[k], float(explained[k])) for k in chosen]


def _batched(trials: list[tuple[float, ...]], size: int) -> Iterator[list[tuple[float, ...]]]:
    for begin in range(0, len(trials), size):
        yield trials[begin : begin + size]


def _refined(sought: Sought, form: Form, starts: list[RefinementStart]) -> FittedLaw:
    """The form with its shapes refined, each within its bounds."""
    names = [p.name for p in form.shapes]

    def answers(trials: Array) -> Array:
        return sought.columns(form, [tuple(float(v) for v in trial) for trial in trials])

    shapes, deviations = starts[0].shapes, np.zeros(0)
    if names:
        bounds = np.array([p.bounds for p in form.shapes])
        spacing = np.array([grid_spacing(p) for p in form.shapes])
        asked = RefinementProblem(answers, sought.target, bounds, spacing, np.array([p.bounds for p in form.strengths]))
        shapes, deviations = refined_shapes(starts, asked)
    explained, strengths = sought.explained(form, answers(shapes[None]))
    return FittedLaw(
        form, dict(zip(names, (float(v) for v in shapes), strict=True)),
        dict(zip((p.name for p in form.strengths), (float(v) for v in strengths[0]), strict=True)),
        0.5 * float(explained[0]), _price(form, sought.frames),
        sought.left(float(explained[0])),
        dict(zip(names, (float(v) for v in deviations), strict=True)),
    )  # fmt: skip


def grid_spacing(shape: WrittenParameter) -> float:
    """Typical distance of the values of a shape's grid; of a single value a tenth of the way between its bounds."""
    if len(shape.scan) == 1:
        return (shape.bounds[1] - shape.bounds[0]) / 10.0
    return float(np.median(np.diff(np.sort(shape.scan))))
