"""Table I: fifteen arms identified from rendered video, and the error of each identified model against the tracked
shapes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tentacle.runner import Runner
from tentacle.specimen import WATER
from validation.paper_arms import ADDED_MASS, CHOICES, PAPER_SILICONES
from validation.rank_correlation import rank_correlation
from validation.table1_arm import CHIRP_FROM, CHIRP_S, CHIRP_TO, arm_result

TABLE1_LENGTHS = (0.12, 0.15, 0.18, 0.22, 0.25)
VERSION = "2"
# (q1, q2) as printed, "Error (rad)": by its formula a mean square, rad^2.
PAPER = {
    "Eco-Flex": ((2.2, 5.1), (4.2, 6.7), (5.1, 8.9), (6.7, 20.1), (5.7, 22.2)),
    "Dragon Skin 10": ((3.1, 4.3), (3.8, 5.8), (4.2, 15.4), (4.2, 9.8), (5.2, 6.8)),
    "Dragon Skin 20": ((1.1, 6.2), (2.8, 9.5), (5.4, 8.2), (5.0, 6.3), (6.7, 15.6)),
}
TABLE1_HEADER = (
    "silicone", "L [cm]", "q1 [rad^2]", "q2 [rad^2]", "midline [mm]", "contours, eq. 19: q1", "q2",
    "paper q1", "paper q2", "q2 / its variance [%]", "E found/true", "reduction [mm]",
)  # fmt: skip


@dataclass(frozen=True)
class Table1:
    """Columns for the CSV (name -> one value for each arm), rows of texts under HEADER, and the results in
    sentences.
    """

    columns: Mapping[str, Any]
    rows: Sequence[tuple[str, ...]]
    words: tuple[str, ...]

    @property
    def worst(self) -> tuple[str, ...]:
        """The row of the arm with the largest error of the midline."""
        return max(self.rows, key=lambda row: float(row[4]))


def table1(runner: Runner, seconds: float, look: str, seed: int) -> Table1:
    """All arms: seconds [s] of sine to judge, the rendered tank's look, seed of the pictures' noise."""
    shared = {"seconds": seconds, "look": look, "seed": seed}
    tasks = [
        {"length": length, "silicone": silicone, **shared} for silicone in PAPER_SILICONES for length in TABLE1_LENGTHS
    ]
    results = runner.run(arm_result, tasks, version=VERSION, words="Table I")
    printed = np.array([PAPER[task["silicone"]][TABLE1_LENGTHS.index(task["length"])] for task in tasks])
    columns = {
        "length_m": np.array([task["length"] for task in tasks]),
        "young_pa": np.array([PAPER_SILICONES[task["silicone"]].modulus for task in tasks]),
        "printed_q1": printed[:, 0],
        "printed_q2": printed[:, 1],
    }
    columns |= {name: np.array([result[name] for result in results], dtype=float) for name in results[0]}
    rows = [_row(task, result, paper) for task, result, paper in zip(tasks, results, printed, strict=True)]
    return Table1(columns, rows, _words(columns))


def _row(task: Mapping[str, Any], result: Mapping[str, Any], paper: Sequence[float]) -> tuple[str, ...]:
    theirs = [result[name] for name in ("paper_q1_rad2", "paper_q2_rad2")]
    return (
        task["silicone"],
        f"{100 * task['length']:.0f}",
        f"{result['q1_rad2']:.2g}",
        f"{result['q2_rad2']:.2g}",
        f"{result['midline_mm']:.2f}",
        *("diverges" if error is None else f"{error:.2g}" for error in theirs),
        f"{paper[0]:g}",
        f"{paper[1]:g}",
        f"{100 * result['q2_rad2'] / result['motion_q2_rad2']:.1f}",
        f"{result['E_pa'] / PAPER_SILICONES[task['silicone']].modulus:.2f}",
        f"{result['reduction_mm']:.2f}",
    )


def _words(columns: Mapping[str, Any]) -> tuple[str, ...]:
    """Results of the table, with the differences from the paper and their reasons."""

    def rank(ours: str, theirs: str) -> float:
        """Spearman's correlation."""
        return rank_correlation(columns[ours], columns[theirs])

    q1, q2 = (rank(f"{name}_rad2", f"printed_{name}") for name in ("q1", "q2"))
    both = columns["printed_q1"].size
    beyond = int(np.sum(columns["printed_q1"] > columns["motion_q1_rad2"]))
    higher = np.mean(columns["q2_rad2"] > columns["q1_rad2"])
    density = PAPER_SILICONES["Dragon Skin 10"].density
    share = density / (density + ADDED_MASS * WATER.density)
    lost = int(np.sum(~np.isfinite(columns["paper_q1_rad2"])))
    soft = int(np.sum(columns["paper_k0"] + columns["paper_k1"] <= 0.0))
    return (
        f"Learnt from {CHIRP_S:g} s of chirp, {CHIRP_FROM:g} to {CHIRP_TO:g} Hz, judged on the sine, as in the paper."
        " Errors are the paper's measure, the mean square of q_model - q_CV, which is rad^2 though the print says rad.",
        f"In {beyond} of {both} arms the error printed for q1 exceeds the whole variance that q1 has"
        " here, by up to five orders: the printed numbers cannot be rad^2 of such arms, and the paper gives no scale."
        f" So only the order is compared: rank correlation {q1:.2f} for q1, {q2:.2f} for q2. In both, longer and softer"
        " arms have larger errors.",
        f"As in the paper, q2 has the larger error: in {100 * higher:.0f} % of the arms.",
        f"E comes out near {share:.2f} of the truth, because the paper's model has no added mass: with too little"
        " inertia, stiffness, damping and drag must all be too small for the same motion.",
        "Contours, eq. 19: the paper's own route, largest contour, grid search, pseudo-inverse on differentiated q,"
        f" k(s) = k0 + k1 s. In {soft} of {both} arms that k(s) is negative at the tip: a cone's"
        f" falls with r^4, which no affine k follows. Integrated, {lost} of these models leave all bounds; numerical"
        " derivatives of q bias damping and drag, down to a damping that is negative.",
        "The reference also has no slack servo and no standing waves, and its silicone is linear. So the error of"
        " Eco-Flex is larger because it is soft, not because it is non-linear, as the paper suspects.",
        CHOICES,
    )
