"""Does a gait keep its promise? It is found on a model of a recording of a plant, and the plant itself then swims it.

The plant is the MuJoCo chain of validation.plants.chain, which shares no line with the model. A recording of it gives
an identified model with its posterior. The gait is searched at the estimates, and under the posterior. The promise is
the 95 % interval of the mean thrust over the posterior's draws. Delivered is the plant's own mean force on its mount,
base clamped.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from affine_model.swim import OBJECTIVES, GaitTrial, SearchPlan, optimise_gait, robust_trial, run, trial_of
from affine_model.swim.robust import promised_interval
from inference.identify import identify
from tentacle.gait import Gait
from tentacle.model import Model
from tentacle.recording import Recording
from tentacle.signals import Array
from validation.plants import chain, drawn, recorded, shown
from validation.plants.draw import Filming, Trial
from validation.plants.filmed import film

THRUST = OBJECTIVES["thrust"]
PROMISED_S, SWUM_S = 12.0, 20.0  # the promise's window, and the plant's
DRAWS = 200  # of the posterior for an interval


@dataclass(frozen=True)
class Promised:
    """One gait's promise [N]: at the estimates, its 95 % interval, the interval of independent estimates; and the
    plant's thrust [N]. words: how the gait was found.
    """

    seed: int
    words: str
    promised: float
    interval: tuple[float, float]
    independent: tuple[float, float]
    delivered: float

    @property
    def kept(self) -> bool:
        """Whether the plant delivers within the interval."""
        return self.interval[0] <= self.delivered <= self.interval[1]

    @property
    def ratio(self) -> float:
        """Delivered over promised."""
        return self.delivered / self.promised


@dataclass(frozen=True)
class _Swum(Trial):
    """The plant's trial with a gait for its motion."""

    gait: Gait | None = None

    def theta(self, t: Array) -> Array:
        """The gait's angle [rad], with the trial's smooth start."""
        assert self.gait is not None
        ramp = np.clip(t, 0.0, 1.0)
        return np.asarray(self.gait(t))[0] * ramp**3 * (10.0 - 15.0 * ramp + 6.0 * ramp**2)


def delivered_thrust(trial: Trial, gait: Gait) -> float:
    """Mean forward thrust [N] of the plant under a gait: the load on its mount, weighted by Hann's window, which leaves
    nothing of the inertia's share however many periods it holds.
    """
    own = {name: getattr(trial, name) for name in Trial.__dataclass_fields__}
    swum = _Swum(**{**own, "seconds": SWUM_S, "chirps": False}, gait=gait)
    _, load, _, _ = film(swum, chain.plant(trial), ())
    return -float(np.average(load, weights=np.hanning(load.size + 2)[1:-1]))


def filmed_trial(seed: int, filming: Filming) -> tuple[Trial, Recording]:
    """A trial of the chain with nothing hidden, and its recording."""
    trial = drawn(seed, (), {}, filming, (6.0, 15.0))
    return trial, recorded(trial, shown(trial, chain.plant(trial)))


def whole_periods(trial: GaitTrial, gait: Gait) -> GaitTrial:
    """The fine trial with a window of whole periods of the gait's strongest wave."""
    strongest = int(np.argmax(np.abs(gait.alpha[:3])))
    period = 2.0 * np.pi / gait.alpha[3 + strongest]
    return replace(trial.refined(period * round(PROMISED_S / period)), settle=4.0)


def promises_kept(seed: int, filming: Filming, evaluations: int, samples: int) -> Iterator[Promised]:
    """The gait at the estimates and the one under the posterior, promised by the model and swum by the plant."""
    trial, recording = filmed_trial(seed, filming)
    model = identify([recording]).model
    at_estimates, plan = trial_of(model), SearchPlan(evaluations=evaluations, seed=seed)
    alone: Model = replace(model, posterior=None)
    searches = {
        "at the estimates": at_estimates,
        "under the posterior": robust_trial(at_estimates, model, samples, seed),
    }
    for words, searched in searches.items():
        gait = optimise_gait(searched, THRUST, plan).gait
        ready, alpha = whole_periods(at_estimates, gait), np.array(gait.alpha)
        promised = float(run(ready, alpha[:, None]).thrust[0, 0])
        interval = promised_interval(ready, model, THRUST, alpha, (DRAWS, 1))
        independent = promised_interval(ready, alone, THRUST, alpha, (DRAWS, 1))
        yield Promised(seed, words, promised, interval, independent, delivered_thrust(trial, gait))
