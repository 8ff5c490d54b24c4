"""The loop on recordings of a simulator that shares nothing with it (validation.plants.stranger), one effect at a time.

python benchmarks/stranger.py --json FILE [--plant NAME] [--short] [--only EFFECT ...] [--seed N] [--every-law]

Each effect's verdict, errors before and after, and how many are right: the truth named first, or in the named group.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from discovery.diagnose import diagnose
from tentacle.diagnosis import Diagnosis
from validation.plants import PLANTS, make
from validation.plants.draw import Filming
from validation.plants.laws import LAWS, OUTSIDE

SHORT = ("nothing", "current", "servo_lag")
CASES = ("nothing", *LAWS, *OUTSIDE)


def right(case: str, found: Diagnosis) -> bool:
    """Whether the truth is named first, or in the named group; of nothing hidden: whether nothing is named; of what no
    catalogue has: whether it is called unknown.
    """
    named = found.missing_effects
    if case == "nothing":
        return not named and found.verdict != "unknown"
    if case in OUTSIDE:
        return found.verdict == "unknown"
    return bool(named) and (named[0] == case or (found.verdict == "group" and case in named))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, required=True, metavar="FILE")
    parser.add_argument("--short", action="store_true", help=f"{', '.join(SHORT)}, of 12 s each")
    parser.add_argument("--only", nargs="+", choices=CASES, metavar="EFFECT", help="these alone")
    parser.add_argument("--plant", choices=tuple(PLANTS), default="stranger")
    parser.add_argument("--seed", type=int, default=0, help="of arm, motion, laws and noise (default 0)")
    parser.add_argument("--every-law", action="store_true", help="each effect by each of its laws, not by a drawn one")
    arguments = parser.parse_args()
    effects = arguments.only or (SHORT if arguments.short else CASES)
    cases = [(name, law) for name in effects for law in (LAWS.get(name, (None,)) if arguments.every_law else (None,))]
    answers: dict[str, Any] = {}
    for name, law in cases:
        recording, truth = make(
            arguments.plant,
            arguments.seed,
            effects=() if name == "nothing" else (name,),
            laws={} if law is None else {name: law},
            filming=Filming(seconds=12.0 if arguments.short else 20.0),
        )
        case = " ".join((name, *truth["laws"].values()))
        found = diagnose([recording])
        answers[case] = right(name, found)
        values = {f"{effect}.{parameter}": round(estimate.value, 5)
                  for effect, table in found.parameters.items() for parameter, estimate in table.items()}  # fmt: skip
        print(f"{'ok ' if answers[case] else 'NOT'} {case:34s} {found.verdict:16s} {' + '.join(found.effects):50s} "
              f"{found.before.midline_mm:.3f} to {found.after.midline_mm:.3f} mm (floor {found.floor.midline_mm:.3f}) "
              f"{values}", flush=True)  # fmt: skip
    figures = {"right": sum(answers.values()) / len(answers), "cases": len(answers)}
    print(f"right: {sum(answers.values())} of {len(answers)}")
    arguments.json.write_text(json.dumps({"figures": figures, "right": answers}, indent=1) + "\n")


if __name__ == "__main__":
    main()
