"""What the recordings of a campaign tell together, and the experiment that would split what is left."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

from discovery.answer import nats_words
from discovery.diagnose import diagnose
from discovery.given import SERVO_UNDER_LOAD, Deciding
from discovery.next_experiment import SEPARATES
from rig.reidentify import tracked
from rig.run_file import read_run
from rig.safety import SafetyLimits
from tentacle.diagnosis import Diagnosis, Verdict
from tentacle.progress import Stage, silent
from tentacle.recording import Recording
from tentacle.servo_limits import ServoLimits

HOLDS = 0.95  # posterior mass from which one explanation is the answer
Ending = Literal["split", "limits"]


@dataclass(frozen=True)
class Decision:
    """A joint diagnosis in short. explanation: the effects that are named, with the mass of all sets that hold them;
    where none or a group is named, the credible set with the largest mass. others: how many more sets are credible.
    motion: table of the base motion to run next (None: none can be commanded or judged, or none separates enough).
    nats: by which the best one tried separates the two nearest explanations.
    """

    verdict: Verdict
    headline: str
    explanation: tuple[str, ...]
    mass: float
    others: int
    motion: dict[str, Any] | None
    nats: float

    @property
    def ending(self) -> Ending | None:
        """Why no further experiment is made; None where one is. An unknown is no explanation, whatever its mass."""
        if self.verdict != "unknown" and self.mass >= HOLDS:
            return "split"
        return "limits" if self.motion is None or self.nats < SEPARATES else None

    @property
    def words(self) -> str:
        """The leading explanation and its mass, and what the next experiment would give."""
        name = " + ".join(self.explanation) or "nothing missing"
        said = f"{self.verdict}: {name} holds {100 * self.mass:.1f} %"
        if self.ending == "split":
            return f"{said}; split"
        if self.motion is None and self.nats <= 0.0:
            return f"{said}; no base motion can be proposed"
        ends = "no motion within the limits splits further: the best" if self.ending == "limits" else "the next motion"
        return f"{said}, {self.others} more within 95 %; {ends} would give {nats_words(self.nats)}"

    def table(self) -> dict[str, Any]:
        """Plain data for the journal and for the start record of the run that follows."""
        return {**asdict(self), "explanation": list(self.explanation)}


def decision_from(table: dict[str, Any]) -> Decision:
    """The decision in plain data; KeyError, TypeError or ValueError where it is none."""
    return Decision(**{**table, "explanation": tuple(table["explanation"]), "mass": float(table["mass"])})


def decision_of(found: Diagnosis) -> Decision:
    """A diagnosis in short."""
    sets = found.sets
    explanation, mass = (sets[0].effects, sets[0].probability) if sets else ((), 0.0)
    if found.verdict == "effect" and found.certain and found.uncalibrated is not None:
        explanation, mass = found.certain, found.uncalibrated
    others, motion = max(len(sets) - 1, 0), found.next_experiment
    return Decision(found.verdict, found.headline, explanation, mass, others, motion, found.next_nats or 0.0)


def servo_limits(limits: SafetyLimits) -> ServoLimits:
    """The rig's limits as the design takes them: both ways the smaller angle, and a loaded servo's acceleration."""
    angle = min(limits.max_angle, -limits.min_angle)
    return ServoLimits(angle, limits.max_speed, SERVO_UNDER_LOAD.acceleration)


def joint_judge(
    limits: SafetyLimits,
    seed: int,
    progress: Stage = silent,
    keep: Callable[[Diagnosis, Sequence[Recording], Sequence[Path]], None] = lambda _found, _recordings, _runs: None,
) -> Callable[[Sequence[Path]], Decision]:
    """A function that diagnoses runs jointly, and hands every diagnosis to keep. Each film is tracked once.

    The proposed motions differ from one count of runs to the next, because their random phases are drawn anew.
    """
    known: dict[Path, Recording] = {}

    def judge(runs: Sequence[Path]) -> Decision:
        for path in runs:
            if path not in known:
                progress(f"tracking {path.name}")
                known[path] = tracked(read_run(path))
        deciding = Deciding(laws=False, servo=servo_limits(limits))
        recordings = [known[path] for path in runs]
        found = diagnose(recordings, seed=seed + len(runs), deciding=deciding, progress=progress)
        keep(found, recordings, runs)
        return decision_of(found)

    return judge
