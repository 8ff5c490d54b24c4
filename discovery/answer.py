"""Parts of every answer: the error budget, the next experiment in words, and "cannot tell"."""

from __future__ import annotations

import numpy as np

from discovery.next_experiment import DURATION, Proposal
from tentacle.diagnosis import Diagnosis, ErrorBudget, ErrorMeasure
from tentacle.model import Model
from tentacle.recording import Recording

MANY = 1000.0  # nats, beyond which an expected gap is only told as a bound
MOST_EFFECTS = 3  # that one answer names together
FAR_FROM_FLOOR = 1.2  # times the noise: of 106 drawn trials with nothing hidden none left more than 1.11 times
ACCOUNTS = 3  # hypotheses of one effect that the next experiment separates after an unknown


def cannot_tell(recording: Recording, reason: str, seed: int) -> Diagnosis:
    """The verdict "unknown" of data that show too little. It states no error, no ranking and no parameters."""
    d = recording.declaration
    model = Model(d.specimen, d.fluid, d.gravity)
    nothing = ErrorMeasure()
    return Diagnosis(
        verdict="unknown",
        effects=(),
        confidence=0.0,
        parameters={},
        before=nothing,
        after=nothing,
        floor=nothing,
        held_out=False,
        ranking=(),
        next_experiment=None,
        budget=ErrorBudget(0.0, 0.0, 0.0, 0.0),
        base_model=model,
        augmented_model=model,
        twin_names=(),
        twin_cosines=np.zeros((0, 0)),
        runs=(),
        words=("These data cannot tell.", reason),
        seed=seed,
    )


def far_from_floor(after: float | None, floor: float | None, times: float = FAR_FROM_FLOOR) -> bool:
    """Whether a model leaves more than so many `times` what noise would leave [mm] on held-out frames; False where that
    is not known.
    """
    return after is not None and floor is not None and after > times * floor


NO_SERVO = "No servo turned the base of these recordings, so that no next base motion is proposed."
_NONE_SEPARATES, _NEXT = "No base motion within the servo's limits separates", "The next experiment,"


def without_proposal(words: tuple[str, ...]) -> tuple[str, ...]:
    """The sentences without that on the proposed base motion, for another motion takes its place."""
    return tuple(word for word in words if not word.startswith((_NONE_SEPARATES, _NEXT)))


def nats_words(nats: float) -> str:
    """An expected gap: of a rival that hardly moves like the arm it may be any number, so that a large one is told as
    a bound.
    """
    if nats >= MANY:
        return f"more than {MANY:.0f} nats"
    return f"{nats:.0f} nats" if nats >= 10.0 else f"{nats:.1f} nats"


def proposal_words(proposal: Proposal) -> str:
    """A sentence on the sets of effects that the proposed base motion is expected to separate, and by how much."""
    one, *others = (" + ".join(effects) or "nothing missing" for effects in proposal.sets)
    splits, gap = f"{one} from {' and from '.join(others)}", nats_words(proposal.nats)
    if proposal.asked is None:
        return f"{_NONE_SEPARATES} {splits}: the best one tried would give {gap}."
    least = "at least " if len(others) > 1 and proposal.nats < MANY else ""
    return (
        f"{_NEXT} {DURATION:.0f} s of the base motion in next_experiment.toml, would separate {splits} by {least}{gap}."
    )


def error_budget(before: ErrorMeasure, after: ErrorMeasure, floor: ErrorMeasure, lost: float) -> ErrorBudget:
    """The error before in parts [mm]: noise, reduction (lost), explained by the added effects, and unexplained."""

    def apart(large: float | None, small: float | None) -> float:
        if large is None or small is None:
            return 0.0
        return float(np.sqrt(max(large**2 - small**2, 0.0)))

    noise = apart(floor.midline_mm, lost)
    return ErrorBudget(
        noise_mm=noise,
        reduction_mm=lost,
        missing_mm=apart(before.midline_mm, after.midline_mm),
        rest_mm=apart(after.midline_mm, floor.midline_mm),
    )
