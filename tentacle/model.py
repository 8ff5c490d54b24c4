"""An identified model as data: which arm, how many curvature coordinates, which effects, with which parameters.

`affine_model` turns it into dynamics; `model.toml` is its file (see tentacle.io.model_file).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from tentacle.notebook import html_paragraph, html_table
from tentacle.posterior import Posterior
from tentacle.rounding import rounded
from tentacle.specimen import AIR, HANGING_DOWN, Fluid, Gravity, Specimen


@dataclass(frozen=True)
class Estimate:
    """A parameter's value with its 95 % interval, in `unit`; low = high = value where it was given, not fitted."""

    value: float
    low: float
    high: float
    unit: str = "1"

    @staticmethod
    def exact(value: float, unit: str = "1") -> Estimate:
        """A given value."""
        return Estimate(value, value, value, unit)

    @property
    def value_words(self) -> str:
        """The value, with the digits that its interval needs."""
        return rounded(self.value, self.high - self.low)

    @property
    def with_unit(self) -> str:
        """The value with its unit; a number without one has none."""
        return self.value_words if self.unit == "1" else f"{self.value_words} {self.unit}"

    @property
    def interval_words(self) -> str:
        """The 95 % interval, or "given" where the value was not fitted."""
        if self.low == self.high:
            return "given"
        width = self.high - self.low
        return f"{rounded(self.low, width)} to {rounded(self.high, width)}"


@dataclass(frozen=True)
class Model:
    """The arm's model: a sum of effects.

    parameters maps effect name -> parameter name -> Estimate. The base effects are elasticity (E [Pa], or k0, k1
    [N m/rad]), damping (eta [Pa s], or d0, d1 [N m s/rad]) and drag (C_perp [1], in a fluid); inertia, weight and
    buoyancy have no parameter. Effects beyond those are named as in the catalogue. posterior: how the fitted estimates
    vary together (None: not known).
    """

    specimen: Specimen
    fluid: Fluid = AIR
    gravity: Gravity = HANGING_DOWN
    order: int = 2
    parameters: dict[str, dict[str, Estimate]] = field(default_factory=dict)
    posterior: Posterior | None = None

    def value(self, effect: str, parameter: str) -> float:
        """The value of one parameter; KeyError where the model has none."""
        return self.parameters[effect][parameter].value

    def with_effect(self, effect: str, **values: Estimate) -> Model:
        """This model with an effect added or its parameters replaced; its posterior is that of the others."""
        merged = {**self.parameters, effect: {**self.parameters.get(effect, {}), **values}}
        changed, known = {f"{effect}.{name}" for name in values}, self.posterior
        kept = None if known is None else known.of([name for name in known.names if name not in changed])
        return replace(self, parameters=merged, posterior=kept)

    def _repr_html_(self) -> str:
        """The parameters as a table, for notebooks."""
        rows = [
            (effect, name, e.value_words, e.interval_words, e.unit)
            for effect, values in self.parameters.items()
            for name, e in values.items()
        ]
        title = html_paragraph(f"Model with {self.order} curvature coordinates")
        return title + html_table(("effect", "parameter", "value", "95 % interval", "unit"), rows)
