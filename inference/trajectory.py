"""The trajectory fit: parameters and initial states that bring the simulated motion onto the measured one.

Least squares on whitened residuals over any number of recordings at once, within bounds. All derivatives come from
one batch of simulations a round, two individuals per unknown; scipy's least_squares finds the same minimum (a test
compares).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from affine_model.arm import Arm, parameter_rows
from affine_model.curvature import Array
from affine_model.kernel import BLOCK
from inference.declared_arm import DECLARED, SeenAs, names_of, runs_of, that_matter_in, with_declared_numbers
from inference.experiment import Experiment, predict, whitened_residuals
from inference.latent_force import Filter
from inference.linear_fit import ParameterName
from tentacle.declared import Uncertain

PARAMETER_DIFFERENCE = 1e-3  # of a parameter's scale: central differences, exact to 1e-6 relative
ONE_SIDED = 1e-5  # of it on the way to the minimum: half the simulations, exact to 1e-5
MOST_STATES = 2**19  # steps times individuals that are simulated at once: some 100 MB, the largest arrays of a fit
RAN_AWAY = 1e6  # noise sigmas: every residual of a simulation that diverged


@dataclass(frozen=True)
class Problem:
    """A fit to be made: an arm, recordings, the names of the free parameters, the vector with the fixed ones.

        r = [filter (measured - predicted) / noise, (declared - mean) sqrt(T) / sd, priors of the nuisances],
        min |r|^2 / 2

    declared: the uncertain numbers of the declaration. With them, parameters is (R + D,) with their values at its end,
    and free may name them ("declared", field). Each has the prior that the declaration states, which a decision does
    not coarsen; T: see Experiment.coarsening. filters: they whiten
    each recording's residuals if unknown forces are allowed for (inference.latent_force; empty: white noise alone).
    defect (T, K) of each recording is added to its residuals (inference.deferred_correction; empty: none).
    """

    arm: Arm
    experiments: tuple[Experiment, ...]
    free: tuple[ParameterName, ...]
    parameters: Array
    step: float
    declared: tuple[Uncertain, ...] = ()
    filters: tuple[Filter, ...] = ()
    defect: tuple[Array, ...] = ()

    def rows(self) -> np.ndarray:
        """Places of the free parameters in the vector."""
        places = {(row.effect, row.parameter.name): row.index for row in parameter_rows()}
        places |= {name: len(places) + k for k, name in enumerate(names_of(self.declared))}
        return np.array([places[name] for name in self.free], dtype=int)

    @property
    def coarsening(self) -> float:
        """T by which a decision will coarsen the likelihood, as far as it is known: the same in all recordings."""
        return max(experiment.coarsening for experiment in self.experiments)

    def sizes(self) -> list[int]:
        """Number of nuisances of each recording."""
        return [len(experiment.nuisance_names(self.arm.order)) for experiment in self.experiments]

    def scales(self) -> Array:
        """Size of one unit of each unknown: of a parameter its value or nominal, whichever is larger."""
        nominal = {(row.effect, row.parameter.name): row.parameter.nominal for row in parameter_rows()}
        nominal |= {(DECLARED, number.name): number.spread for number in self.declared}
        own: list[float] = [
            max(abs(nominal[name]) * 0.1, float(abs(self.parameters[row])))
            for name, row in zip(self.free, self.rows(), strict=True)
        ]
        length = self.arm.specimen.length
        return np.concatenate([np.array(own), *(e.nuisance_scales(self.arm.order, length) for e in self.experiments)])

    def bounds(self) -> tuple[Array, Array]:
        """Bounds of all unknowns."""
        limits = {(row.effect, row.parameter.name): row.parameter.bounds for row in parameter_rows()}
        limits |= {(DECLARED, number.name): number.bounds for number in self.declared}
        low, high = np.array([limits[name] for name in self.free]).reshape(-1, 2).T.copy()
        length = self.arm.specimen.length
        rest = np.concatenate([e.nuisance_limits(self.arm.order, length) for e in self.experiments])
        return np.concatenate([low, -rest]), np.concatenate([high, rest])

    def residuals(self, unknowns: Array) -> tuple[Array, list[Array]]:
        """Residuals (N, B) on the used frames with the priors, and all frames' (T, K, B) a recording; unknowns (P,
        B).
        """
        parameters = np.repeat(self.parameters[:, None], unknowns.shape[1], axis=1)
        parameters[self.rows()] = unknowns[: len(self.free)]
        return self._compare(parameters, unknowns)

    def residuals_everywhere(self, parameters: Array, unknowns: Array) -> list[Array]:
        """All frames' residuals (T, K, B) of each recording, not whitened, for whole parameter vectors (R, B)."""
        return self._compare(parameters, unknowns)[1]

    def residuals_of(self, parameters: Array, unknowns: Array) -> Array:
        """Residuals (N, B) on the used frames for whole parameter vectors (R, B), nuisances out of unknowns (P, B)."""
        return self._compare(parameters, unknowns)[0]

    def _compare(self, parameters: Array, unknowns: Array) -> tuple[Array, list[Array]]:
        """residuals() of whole parameter vectors (R, B) or (R + D, B)."""
        used, everything = self._simulated(parameters, unknowns)
        stated = [
            (unknowns[self.free.index(name)] - number.value) * np.sqrt(self.coarsening) / number.sd
            for name, number in zip(names_of(self.declared), self.declared, strict=True)
            if number.sd is not None and name in self.free
        ]
        return np.concatenate([used, *(row[None] for row in stated)]), everything

    def known(self, parameters: Array) -> tuple[Problem, Array]:
        """The problem with its declared numbers known, out of a whole parameter vector, and the laws' vector (R,)."""
        if not self.declared:
            return self, parameters
        laws, values = np.split(parameters, [-len(self.declared)])
        return self.at(values), laws

    def at(self, values: Array) -> Problem:
        """The problem with its declared numbers known: arm and observations of these values (D,)."""
        arm, experiments = with_declared_numbers(self.arm, self.experiments, self.declared, values)
        return replace(self, arm=arm, experiments=experiments, declared=())

    def _simulated(self, parameters: Array, unknowns: Array) -> tuple[Array, list[Array]]:
        steps = max(experiment.duration for experiment in self.experiments) / self.step
        together = BLOCK * max(1, int(MOST_STATES / (steps * BLOCK)))
        starts = range(0, unknowns.shape[1], together)
        some = [self._of_some(parameters[:, k : k + together], unknowns[:, k : k + together]) for k in starts]
        if len(some) == 1:
            return some[0]
        used, everything = zip(*some, strict=True)
        return np.concatenate(used, axis=1), [np.concatenate(one, axis=2) for one in zip(*everything, strict=True)]

    def _of_some(self, parameters: Array, unknowns: Array) -> tuple[Array, list[Array]]:
        used, everything, place = [], [], len(self.free)
        laws, values = np.split(parameters, [parameters.shape[0] - len(self.declared)])
        for number, (experiment, size) in enumerate(zip(self.experiments, self.sizes(), strict=True)):
            nuisances = unknowns[place : place + size]
            place += size
            acting = experiment.acting(laws)
            stated = values[that_matter_in(experiment, self.experiments[0].name, self.declared)]
            kinds, lanes = _distinct(np.concatenate([acting, stated, nuisances]))
            error = self._errors(number, acting[:, kinds], values[:, kinds], nuisances[:, kinds])
            of_used = (
                self.filters[number].whiten(error) if self.filters else error[experiment.used].reshape(-1, kinds.size)
            )
            shared = kinds.size < lanes.size
            everything.append(error[:, :, lanes] if shared else error)
            used.append(of_used[:, lanes] if shared else of_used)
            used.append(experiment.prior_residuals(self.arm.order, self.arm.specimen.length, nuisances))
        return np.concatenate(used), everything

    def _errors(self, number: int, parameters: Array, values: Array, nuisances: Array) -> Array:
        """Residuals (T, K, B) of one recording, not whitened; declared numbers (D, B) that make another arm go through
        a run each.
        """
        if not self.declared:
            everyone = np.arange(nuisances.shape[1])
            runs = [[SeenAs(self.arm, self.experiments[number], everyone)]]
        else:
            runs = runs_of(self.arm, self.experiments, number, self.declared, values)
        found: list[Array] = []
        for ways in runs:
            lanes = np.concatenate([one.lanes for one in ways])
            seen = predict(ways[0].arm, ways[0].experiment, parameters[:, lanes], nuisances[:, lanes], self.step)
            ends = np.cumsum([0, *(one.lanes.size for one in ways)])
            rows = [
                whitened_residuals(one.experiment, seen.of(slice(*ends[k : k + 2])) if len(ways) > 1 else seen)
                for k, one in enumerate(ways)
            ]
            error = rows[0] if len(rows) == 1 else np.concatenate(rows, axis=2)
            if self.defect:
                error += self.defect[number][:, :, None]
            ran_away = np.isfinite(seen.batch.diverged)
            if ran_away.any():
                error[:, :, ran_away] = RAN_AWAY
            found.append(error)
        if len(found) == 1 and len(runs[0]) == 1:
            return found[0]
        order = np.argsort(np.concatenate([one.lanes for ways in runs for one in ways]))
        return np.concatenate(found, axis=2)[:, :, order]

    def jacobian(self, unknowns: Array) -> Array:
        """d residuals / d unknowns (N, P) by central differences, one batch; one-sided where a bound is in the way."""
        return self.linearised(unknowns)[1]

    def linearised(self, unknowns: Array) -> tuple[Array, Array, list[Array], list[Array]]:
        """Residuals (N,) and the same derivatives (N, P), then both on all frames of each recording: (T, K), (T, K, P).

        One batch: the residuals fill a place in its last block of individuals that would be empty.
        """
        scales, (low, high) = self.scales(), self.bounds()
        ahead = np.minimum(unknowns + PARAMETER_DIFFERENCE * scales, high)
        behind = np.maximum(unknowns - PARAMETER_DIFFERENCE * scales, low)
        batch = np.repeat(unknowns[:, None], 2 * unknowns.size + 1, axis=1)
        places = np.arange(unknowns.size)
        batch[places, 2 * places], batch[places, 2 * places + 1] = ahead, behind
        values, everything = self.residuals(batch)
        width = ahead - behind
        slopes = [(rows[:, :, 0:-1:2] - rows[:, :, 1:-1:2]) / width for rows in everything]
        here = [rows[:, :, -1] for rows in everything]
        return values[:, -1], (values[:, 0:-1:2] - values[:, 1:-1:2]) / width, here, slopes

    def slope(self, unknowns: Array, value: Array | None = None) -> tuple[Array, Array]:
        """Residuals (N,) and their one-sided derivatives (N, P), for the steps of the solver; value: the residuals
        there, if they are known.
        """
        step = ONE_SIDED * self.scales()
        step = np.where(unknowns + step > self.bounds()[1], -step, step)
        moved = unknowns[:, None] + np.diag(step)
        if value is None:
            values, _ = self.residuals(np.concatenate([moved, unknowns[:, None]], axis=1))
            values, value = values[:, :-1], values[:, -1]
        else:
            values, _ = self.residuals(moved)
        return value, (values - value[:, None]) / step


def _distinct(columns: Array) -> tuple[np.ndarray, np.ndarray]:
    """Places (K,) of the columns (N, B) that differ, and for each column (B,) which of them it equals.

    An unknown of one recording changes no other, and an absent effect none of the baseline's: these are run once.
    """
    kinds: dict[bytes, int] = {}
    first: list[int] = []
    lanes = np.empty(columns.shape[1], dtype=int)
    for place, column in enumerate(np.ascontiguousarray(columns.T)):
        kind = kinds.setdefault(column.tobytes(), len(kinds))
        lanes[place] = kind
        if kind == len(first):
            first.append(place)
    return np.array(first), lanes
