"""Calibration: from posterior mass to the hit rate of such verdicts in blind trials.

    log odds of the stated confidence = log odds of the posterior mass / CONFIDENCE_TEMPERATURE

unless a calibration of one's own blind trials is given. A model that is wrong in form is too sure of itself. One
temperature keeps the order of all answers, and an even chance stays even.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import get_args

import numpy as np
from scipy.special import expit, logit

from tentacle.diagnosis import Verdict
from tentacle.io.toml_table import Table, read_toml

HIT_RATE_BOUNDS = (0.02, 0.98)  # no finite number of trials shows more
# The likeliest over the 336 midlines of the series of seeds 1200001, 1400001 and 1700001 (benchmarks/results), each of
# code that was frozen before: 2.27, and 1.9 to 2.7 lose less than 2 nats. The series of seed 1800001 tests it.
CONFIDENCE_TEMPERATURE = 2.3
Curve = tuple[tuple[float, ...], tuple[float, ...], int]


def tempered(mass: float, temperature: float = CONFIDENCE_TEMPERATURE) -> float:
    """The confidence of a verdict of that posterior mass: its log odds over the temperature."""
    within = np.clip(mass, 0.0, 1.0)  # a sum of masses may exceed 1 by rounding
    return float(np.clip(expit(logit(within) / temperature), *HIT_RATE_BOUNDS))


@dataclass(frozen=True)
class Calibration:
    """tables: verdict -> (stated, right, trials): rising knots of the stated confidence, the hit rate there, and how
    many trials they rest on. Between knots it is interpolated; a verdict without a table stays as stated. made: one
    line on how.
    """

    tables: Mapping[str, Curve]
    made: str = ""

    def __call__(self, verdict: str, stated: float) -> float:
        """The hit rate to be expected of a verdict with that stated confidence."""
        if verdict not in self.tables:
            return stated
        knots, right, _ = self.tables[verdict]
        return float(np.clip(np.interp(stated, knots, right), *HIT_RATE_BOUNDS))

    def words(self, verdict: str, stated: float) -> str:
        """A sentence on the blind trials behind the confidence."""
        if verdict not in self.tables:
            return f"The confidence is uncalibrated: no blind trial gave this verdict ({self.made})."
        trials = self.tables[verdict][2]
        if not trials:
            return f"The confidence comes from other arms: no blind trial of this arm gave this verdict ({self.made})."
        return f"The confidence is the hit rate at {stated:.2f} in {trials} blind trials of this verdict ({self.made})."

    def toml(self) -> str:
        """The file's text."""
        lines = [f"made = {json.dumps(self.made)}"]  # a JSON string is a TOML string
        for verdict, (stated, right, trials) in sorted(self.tables.items()):
            lines += ["", f"[{verdict}]", f"trials = {trials}", f"stated = {list(stated)}", f"right = {list(right)}"]
        return "\n".join(lines) + "\n"


def read_calibration(file: Path) -> Calibration:
    """The calibration of a file that `tentacle blind-trial` wrote; InputError with file, line and field otherwise."""
    text, values = read_toml(file, "a calibration.toml of tentacle blind-trial")
    document = Table(values, file=file, text=text)
    made = document.string("made")
    found = {verdict: document.table(verdict, optional=True) for verdict in get_args(Verdict)}
    document.finish()
    return Calibration({verdict: _curve(table) for verdict, table in found.items() if table is not None}, made)


def _curve(table: Table) -> Curve:
    """A verdict's table, checked."""
    trials, stated, right = table.whole_number("trials"), table.numbers("stated"), table.numbers("right")
    table.finish()
    if len(stated) < 2 or np.any(np.diff(stated) <= 0.0) or stated[0] < 0.0 or stated[-1] > 1.0:
        raise table.error("is not usable", "stated", "two or more numbers that rise, within 0 to 1")
    if len(right) != len(stated) or np.any(np.diff(right) < 0.0) or right[0] < 0.0 or right[-1] > 1.0:
        raise table.error("is not usable", "right", f"{len(stated)} numbers that do not fall, within 0 to 1")
    return stated, right, trials
