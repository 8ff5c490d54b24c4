"""The input of a diagnosis: recordings of one arm. Some of them only judge."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from discovery.calibration import Calibration
from inference.prepare import Prepared
from tentacle.recording import Recording
from tentacle.servo_limits import ServoLimits
from tentacle.specimen import Specimen

SERVO_UNDER_LOAD = ServoLimits(angle=0.8, speed=6.0, acceleration=60.0)  # of a hobby servo under an arm's load in water


@dataclass(frozen=True)
class Given:
    """recordings: what is diagnosed; baseline: their declaration is complete; held_out: they only judge. words: what
    was taken beside the declaration, and why.
    """

    recordings: Sequence[Recording]
    baseline: Sequence[Recording] = ()
    held_out: Sequence[Recording] = ()
    words: tuple[str, ...] = ()

    @property
    def all(self) -> tuple[Recording, ...]:
        """Every recording."""
        return (*self.recordings, *self.baseline, *self.held_out)

    def with_laws(self, names: Iterable[str]) -> Given:
        """The same with more laws of the arm's own declared in every recording."""

        more = tuple(names)
        return self._declaring(lambda specimen: replace(specimen, laws=(*specimen.laws, *more)))

    def with_shear(self, compliance: float, why: str) -> Given:
        """The same arm with sections that shear (specimen.shear_compliance), declared in every recording."""
        sheared = self._declaring(lambda specimen: replace(specimen, shear_compliance=compliance))
        return replace(sheared, words=(*self.words, why))

    def _declaring(self, change: Callable[[Specimen], Specimen]) -> Given:
        def declared(one: Recording) -> Recording:
            own = change(one.declaration.specimen)
            return replace(one, declaration=replace(one.declaration, specimen=own))

        of, baseline, held_out = (
            [declared(one) for one in part] for part in (self.recordings, self.baseline, self.held_out)
        )
        return Given(of, baseline, held_out, self.words)


@dataclass(frozen=True)
class Deciding:
    """How a diagnosis is decided.

    calibration: of the confidence (None: discovery.calibration.tempered). laws: search laws after an unknown.
    servo: limits of the motions among which the next experiment is chosen. device: CUDA device that simulates the
    hypotheses (None: the CPU).
    """

    calibration: Calibration | None = None
    laws: bool = True
    servo: ServoLimits = SERVO_UNDER_LOAD
    device: str | None = None


SETTLING = 2.0  # s at the start of a held-out recording, from which its initial state is fitted


def held_out_run(prepared: Prepared) -> Prepared:
    """A recording kept for judging: only its first moments may be used, to find its initial state."""
    experiment = prepared.experiment
    times = experiment.observation.t
    begin = experiment.t0 if experiment.release is None else experiment.release
    head = times <= begin + (SETTLING if experiment.release is None else 0.05)
    return replace(prepared, experiment=replace(experiment, used=experiment.used & head))
