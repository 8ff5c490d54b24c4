"""One run for drawing, from any verb: parties on one time axis, all compared with the first."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tentacle.diagnosis import Quantity, RunComparison
from tentacle.recording import Recording
from tentacle.signals import Array
from tentacle.specimen import Fluid
from viz.palette import AUGMENTED, BASE, MEASURED, MODEL, Role

LIGHTEST_LIQUID = 100.0  # kg/m^3: what is lighter is a gas, in which no arm swims
STILL = 0.01  # rad: a base that turns less is clamped


@dataclass(frozen=True)
class Party:
    """One moving party: key (its place in a session), role (its looks), xy (T, P, 2) [m] in the base frame, NaN where
    unknown.

    q (T, 2) [rad], the paper's coordinates, thrust (T,) [N] as a load cell reads it, and drag (T, P, 2) [N/m], the
    water's force per length, where they are known. sensors: what each of the run's sensors reads (T,), about its mean.
    """

    key: str
    role: Role
    xy: Array
    q: Array | None = None
    thrust: Array | None = None
    drag: Array | None = None
    sensors: tuple[Array, ...] = ()


@dataclass(frozen=True)
class ViewedRun:
    """A run: t (T,) [s], s (P,), theta (T,) [rad], judged (T,) where errors are stated; parties of that T and P;
    sensors: name, quantity of each.
    """

    name: str
    t: Array
    s: Array
    theta: Array
    parties: tuple[Party, ...]
    judged: NDArray[np.bool_]
    points: Literal["midline", "markers"] = "midline"
    sensors: tuple[tuple[str, Quantity], ...] = ()

    @property
    def subject(self) -> Party:
        """The party that the others are held against."""
        return self.parties[0]

    @property
    def models(self) -> tuple[Party, ...]:
        """The other parties."""
        return self.parties[1:]

    @property
    def tip(self) -> int:
        """The point nearest the tip."""
        return int(np.argmax(self.s))

    def residual_mm(self, party: Party) -> Array:
        """Distance (T, P) [mm] between the subject's and a party's points; NaN where either is unknown."""
        return 1e3 * np.linalg.norm(party.xy - self.subject.xy, axis=-1)

    def judged_rms_mm(self, party: Party) -> float:
        """Root mean square distance [mm] over the judged instants; NaN where there are none."""
        values = self.residual_mm(party)[self.judged]
        values = values[np.isfinite(values)]
        return float(np.sqrt(np.mean(values**2))) if values.size else float("nan")


def paired(
    runs: Sequence[RunComparison], recordings: Sequence[Recording]
) -> list[tuple[RunComparison, Recording | None]]:
    """Each run with its recording, found by name; the second run of a name gets the second recording of that name.

    Runs come back with names of their own: "run", "run (2)" and so on.
    """
    waiting: dict[str, list[Recording]] = {}
    for recording in recordings:
        waiting.setdefault(recording.name, []).append(recording)
    seen: Counter[str] = Counter()
    pairs: list[tuple[RunComparison, Recording | None]] = []
    for run in runs:
        seen[run.name] += 1
        name = run.name if seen[run.name] == 1 else f"{run.name} ({seen[run.name]})"
        candidates = waiting.get(run.name, [])
        pairs.append((replace(run, name=name), candidates.pop(0) if candidates else None))
    return pairs


def model_scene(run: RunComparison) -> ViewedRun:
    """A run with one model (its base and augmented models are the same): measured, model."""
    measured, _, augmented = scene_of(run).parties
    parties = (measured, replace(augmented, key="model", role=MODEL))
    return replace(scene_of(run), parties=parties)


def scene_of(run: RunComparison) -> ViewedRun:
    """A diagnosis's run as a scene: measured, base model, augmented model."""
    parties = (
        Party("measured", MEASURED, run.measured, run.q_measured, sensors=tuple(one.measured for one in run.sensors)),
        Party(
            "base", BASE, run.base, run.q_base, run.thrust_base, run.drag_base, tuple(one.base for one in run.sensors)
        ),
        Party(
            "augmented", AUGMENTED, run.augmented, run.q_augmented, run.thrust_augmented, run.drag_augmented,
            tuple(one.augmented for one in run.sensors),
        ),
    )  # fmt: skip
    sensors: tuple[tuple[str, Quantity], ...] = tuple((one.name, one.quantity) for one in run.sensors)
    return ViewedRun(run.name, run.t, run.s, run.theta, parties, run.judged, run.points, sensors)


def swims(fluid: Fluid, thetas: Sequence[Array]) -> bool:
    """Whether the arm is in a liquid and its base turns, by theta (T,) [rad] of each run: only then is there a thrust
    to look at, and a gait to seek.
    """
    return fluid.density >= LIGHTEST_LIQUID and any(float(np.ptp(theta)) > STILL for theta in thetas if theta.size)
