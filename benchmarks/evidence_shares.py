"""The evidence between the shares of unknown forces, which is interpolated, against what the filter gives there.

python benchmarks/evidence_shares.py --json FILE [--trials N] [--seed S] [--plant NAME ...]

Of each blind trial, the sets that may count are taken: those whose mass is at least exp(-12) of the largest, and the
set without effects. Their evidence is computed halfway between the shares. An error is stated in coarsened nats, as the
decision weighs it, and only where the evidence is within 30 of these of its highest: the rest has no weight.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any
from unittest.mock import patch

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np

import discovery.loop
from affine_model.curvature import Array
from benchmarks._commit import commit_of
from discovery.decide import decide_by_mass, log_masses, missing_of
from discovery.diagnose import diagnose
from discovery.exchange import NEGLIGIBLE_NATS
from discovery.given import Deciding
from inference.evidence import evidence_beside
from inference.posterior import FORCE_SHARES, Hypothesis, with_derivatives
from tentacle.errors import InputError
from validation.trials.plant_design import DRAWN_PLANTS, PlantDesign, plant_designs
from validation.trials.series import made

WEIGHTLESS = 30.0  # coarsened nats below the highest
HALFWAY = np.sqrt(FORCE_SHARES[:-1] * FORCE_SHARES[1:])


def interpolation_errors(h: Hypothesis) -> tuple[Array, Array]:
    """Evidence of a set halfway between the shares (A - 1,) [nats], and the interpolated one less that."""
    known = with_derivatives(h)
    filters = (tuple(force.filter(share) for force in known.forces) for share in HALFWAY)
    exact = np.array([evidence_beside(known.problem, known.fitted, one).log for one in filters])
    fine, values = h.profile()
    return exact, np.interp(np.log(HALFWAY), np.log(fine), values) - exact


def that_count(hypotheses: Sequence[Hypothesis]) -> list[Hypothesis]:
    """The sets whose mass counts, and the one without effects."""
    missing = missing_of(hypotheses)
    masses = [max(log_masses(h, missing)) for h in hypotheses]
    least = max(masses) - NEGLIGIBLE_NATS
    return [h for h, mass in zip(hypotheses, masses, strict=True) if mass > least or not h.effects]


def rows_of(design: PlantDesign) -> Iterator[dict[str, Any]]:
    """One row for each set that counts in a trial; none where the trial is refused."""
    first: list[Hypothesis] = []

    def kept(hypotheses: Sequence[Hypothesis]) -> Any:
        first[:] = first or hypotheses  # later decisions are about whole recordings
        return decide_by_mass(list(hypotheses))

    try:
        recording, _ = made(design)
        with patch.object(discovery.loop, "decide_by_mass", kept):
            diagnose([recording], seed=design.seed, deciding=Deciding(laws=False))
    except (InputError, FloatingPointError):
        return
    temperature = missing_of(first).temperature
    for h in that_count(first):
        exact, error = interpolation_errors(h)
        counts = exact > exact.max() - WEIGHTLESS * temperature
        worst = float(np.abs(error[counts]).max()) / temperature
        yield {"trial": design.index, "effects": list(h.effects), "T": temperature, "share": h.share, "worst": worst}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, required=True, metavar="FILE")
    parser.add_argument("--trials", type=int, default=16, metavar="N")
    parser.add_argument("--seed", type=int, default=77)
    parser.add_argument("--plant", nargs="+", default=list(DRAWN_PLANTS), metavar="NAME")
    arguments = parser.parse_args()
    rows = []
    for design in plant_designs(arguments.trials, arguments.seed, plants=arguments.plant, video_share=0.0):
        for row in rows_of(design):
            rows.append(row)
            words = " + ".join(row["effects"]) or "none"
            print(f"{row['trial']:3d}  {words:50s} {row['worst']:.3f} coarsened nats", flush=True)
    worst = np.array([row["worst"] for row in rows])
    low, high = np.quantile(worst, (0.5, 0.95)).tolist()
    figures = {"median": low, "quantile_95": high, "worst": float(worst.max())}
    origin = {"seed": arguments.seed, "trials": arguments.trials, "commit": commit_of(Path(__file__).parent)}
    arguments.json.write_text(json.dumps({"figures": figures, "made": origin, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
