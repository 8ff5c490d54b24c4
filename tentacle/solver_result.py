"""How an iterative solver ended: the code that it returns, and the sentence that a user reads."""

from __future__ import annotations

from enum import Enum


class RESULTS(Enum):
    """The result code of a solver; `message` is its sentence, `converged` whether the answer is a minimum."""

    CONVERGED = "The fit converged."
    AT_BOUND = "The fit converged with at least one unknown on its bound."
    MAX_STEPS = "The fit used all its steps before it converged."
    SINGULAR = "The fit converged, but the data do not determine every unknown."

    @property
    def message(self) -> str:
        """One sentence in plain words."""
        return self.value

    @property
    def converged(self) -> bool:
        """Whether the last step lowered the sum of squares by less than the tolerance."""
        return self is not RESULTS.MAX_STEPS
