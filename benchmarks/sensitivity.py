"""How the answers depend on the constants of the decision: each halved and doubled, on the same hypotheses.

python benchmarks/sensitivity.py --json FILE [--trials N] [--seed S] [--video-share V] [--plant NAME ...]

Every trial is made and searched once, with the constants as they are. Its hypotheses are then decided anew with each
constant changed. The search's own use of these constants, in which it leaves out sets that cannot win, stays.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import discovery.loop
from benchmarks._commit import commit_of
from discovery import decide
from discovery.decide import decide_by_mass
from discovery.diagnose import diagnose
from discovery.given import Deciding
from inference.posterior import Hypothesis
from tentacle.diagnosis import FINER_SHAPE
from tentacle.errors import InputError
from validation.trials.outcome import Outcome, answer_table, scored
from validation.trials.plant_design import DRAWN_PLANTS, PlantDesign, plant_designs
from validation.trials.plant_recording import plant_recording
from validation.trials.scores import VISIBLE, share

KINDS = ("single", "null", "unknown", "pair")
SCALED = ("ELSE", "DECLARED_FORM", "DECLARED_ALIKE", "FORM", "FORM_ALIKE")


@dataclass(frozen=True)
class Searched:
    """One trial: its outcome with the constants as they are, and the hypotheses of which it was decided."""

    outcome: Outcome
    hypotheses: tuple[Hypothesis, ...]

    def decided(self) -> Outcome:
        """The outcome with the constants as they are now."""
        decision = decide_by_mass(list(self.hypotheses))
        named = tuple(name for name in decision.effects if name != FINER_SHAPE)
        return replace(self.outcome, verdict=decision.verdict, named=named, confidence=decision.confidence)


def searched(design: PlantDesign) -> Searched | None:
    """One trial, made and searched; None where it is refused."""
    last: list[Hypothesis] = []

    def kept(hypotheses: Sequence[Hypothesis]) -> Any:
        last[:] = [replace(h, forces=(), alone=None) for h in hypotheses]
        return decide_by_mass(list(hypotheses))

    try:
        recording, truth = plant_recording(design)
        with patch.object(discovery.loop, "decide_by_mass", kept):
            answer = answer_table(diagnose([recording], seed=design.seed, deciding=Deciding(laws=False)))
    except (InputError, FloatingPointError):
        return None
    first = scored(design.index, truth, design.seen, answer, baselines={}, seconds=0.0)
    return Searched(first, tuple(last))


def variations() -> Iterator[tuple[str, str, Any]]:
    """Name of what is changed, the constant, and its value."""
    for factor, word in ((0.5, "half"), (2.0, "double")):
        for name in SCALED:
            yield f"{name} {word}", name, factor * getattr(decide, name)
        yield f"1 - CREDIBLE {word}", "CREDIBLE", 1.0 - factor * (1.0 - decide.CREDIBLE)
        prior = np.array(decide.COMPLETE) * factor ** np.arange(len(decide.COMPLETE))
        yield f"COMPLETE, each effect {word}", "COMPLETE", tuple(prior / prior.sum())


def right(found: Sequence[Outcome]) -> dict[str, int]:
    """Right answers of each kind, of effects with R >= 1."""
    return {kind: share(found, kind, lambda o: o.hit, VISIBLE).hits for kind in KINDS}


def compared(name: str, trials: Sequence[Searched], standard: Sequence[Outcome]) -> dict[str, Any]:
    """The answers with one constant changed, beside those without.

    standard_error: of the difference of two shares of the same trials, by those that changed (McNemar 1947).
    """
    found = [one.decided() for one in trials]
    turned = [b.hit - a.hit for a, b in zip(standard, found, strict=True)]
    changed = sum(turn != 0 for turn in turned)
    return {
        "changed": name, **right(found), "more_right": int(sum(turned)), "standard_error": float(np.sqrt(changed)),
        "mass": float(np.mean([o.confidence for o in found])),
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, required=True)
    parser.add_argument("--trials", type=int, default=48)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--video-share", type=float, default=0.0)
    parser.add_argument("--plant", nargs="+", default=DRAWN_PLANTS)
    arguments = parser.parse_args()
    designs = plant_designs(arguments.trials, arguments.seed, plants=arguments.plant, video_share=arguments.video_share)
    trials = list[Searched]()
    for design in designs:
        found = searched(design)
        trials += [found] if found else []
        print(f"{design.index + 1} of {len(designs)}", file=sys.stderr, flush=True)
    standard = [one.decided() for one in trials]
    counts = {kind: share(standard, kind, lambda o: o.hit, VISIBLE).count for kind in KINDS}
    rows = [compared("nothing", trials, standard)]
    for name, constant, value in variations():
        with patch.object(decide, constant, value):
            rows.append(compared(name, trials, standard))
    print(f"{len(trials)} trials; right, of " + ", ".join(f"{counts[kind]} {kind}" for kind in KINDS))
    for row in rows:
        of = " ".join(f"{row[kind]:6d}" for kind in KINDS)
        turned = f"{row['more_right']:+d} +- {row['standard_error']:.1f}"
        print(f"{row['changed']:30s} {of}   {turned}   mass {row['mass']:.3f}")
    made = {"trials": arguments.trials, "seed": arguments.seed, "video_share": arguments.video_share}
    table = {"made": made, "commit": commit_of(Path(__file__).parent), "counts": counts, "rows": rows}
    arguments.json.write_text(json.dumps(table, indent=1) + "\n")


if __name__ == "__main__":
    main()
