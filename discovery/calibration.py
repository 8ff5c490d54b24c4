"""From a verdict's own confidence to the share of such verdicts that is right, as blind trials showed it."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np

STORED = "calibration.toml"
BOUNDS = (0.02, 0.98)  # no finite number of trials shows more


@dataclass(frozen=True)
class Calibration:
    """tables: verdict -> (stated, right, trials): rising knots of the stated confidence, the hit rate there, and how
    many trials they rest on. Between knots it is interpolated; a verdict without a table stays as stated."""

    tables: dict[str, tuple[tuple[float, ...], tuple[float, ...], int]]

    def __call__(self, verdict: str, stated: float) -> float:
        """The hit rate to be expected of a verdict with that stated confidence."""
        if verdict not in self.tables:
            return stated
        knots, right, _ = self.tables[verdict]
        return float(np.clip(np.interp(stated, knots, right), *BOUNDS))

    def toml(self, made: str) -> str:
        """The file's text; made: one line on how it was made."""
        lines = [f"# {made}"]
        for verdict, (stated, right, trials) in sorted(self.tables.items()):
            lines += [f"[{verdict}]", f"trials = {trials}", f"stated = {list(stated)}", f"right = {list(right)}"]
        return "\n".join(lines) + "\n"

    @staticmethod
    def of(text: str) -> Calibration:
        """The calibration of such a text."""
        found = tomllib.loads(text)
        return Calibration({v: (tuple(t["stated"]), tuple(t["right"]), t["trials"]) for v, t in found.items()})


@cache
def stored() -> Calibration:
    """The calibration that comes with the package (`tentacle blind-trial` writes such a file beside its report)."""
    return Calibration.of(files("discovery").joinpath(STORED).read_text(encoding="utf-8"))


def calibrated(verdict: str, stated: float) -> float:
    """The confidence to report for a verdict."""
    return stored()(verdict, stated)
