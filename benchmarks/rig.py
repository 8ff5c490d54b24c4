"""The rig against faults, over a real pty, with the board's compiled core: its figures and a table of faults.

python benchmarks/rig.py --json FILE [--short]: about 45 minutes in full (10 of them one run), 5 in short form.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import traceback
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # before benchmarks/, which holds a rig.py too

from benchmarks import _rig_killed
from benchmarks._rig_faults import (
    Outcome,
    faulty_line,
    full_disk,
    fuzz,
    killed_host,
    long_run,
    run_faults,
    stalled_camera,
)
from benchmarks._rig_optimise import side_by_side

Part = tuple[dict[str, float], list[Outcome]]


def run(folder: Path, short: bool) -> Part:
    """One long run on a sound line."""
    return long_run(folder / "long", 15.0 if short else 600.0), []


def faults(folder: Path, short: bool) -> Part:
    """Faults of the line, the board, the host, the disk and the camera."""
    lines = [
        faulty_line(folder / f"line-{k}", share, 8.0 if short else 120.0)
        for k, share in enumerate((0.0033, 0.01))  # 1 % of the bytes in all, and 1 % of each kind
    ]
    in_run, unplugged = run_faults(folder)
    killed, back, tail = killed_host(folder / "killed", 1 if short else 10)
    outcomes = [*(line for line, _ in lines), *in_run, killed, full_disk(folder / "disk")]
    outcomes += [
        stalled_camera(folder / "camera"),
        _rig_killed.killed_host(folder / "optimise-host"),
        _rig_killed.killed_board(folder / "optimise-board"),
    ]
    wrong = float(sum(wrong for _, wrong in lines))
    return {"wrong_accepted": wrong, "neutral_s": max(back, *unplugged), "tail_lost_s": tail}, outcomes


def fuzzed(_folder: Path, short: bool) -> Part:
    """Random and mutated frames into both parsers."""
    return {}, [fuzz(20_000 if short else 1_000_000)]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, required=True)
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--only", choices=("run", "faults", "fuzz", "optimise"), help="one part")
    parser.add_argument("--rate", type=float, default=1.0, help="emulated seconds a second while it optimises")
    arguments = parser.parse_args()

    def optimise(folder: Path, short: bool) -> Part:
        trials, samples, every = (10, 16, 0) if short else (30, 96, 10)
        return side_by_side(folder / "optimise", trials, samples, every, arguments.rate), []

    parts: dict[str, Callable[[Path, bool], Part]] = {
        "run": run, "faults": faults, "fuzz": fuzzed, "optimise": optimise,
    }  # fmt: skip
    figures: dict[str, float] = {}
    outcomes: list[Outcome] = []
    broken: list[str] = []
    with tempfile.TemporaryDirectory() as temporary:
        for name, part in parts.items():
            if arguments.only not in (None, name):
                continue
            try:
                found, tried = part(Path(temporary), arguments.short)
            except Exception:  # one part's failure must not cost what the others took an hour to measure
                traceback.print_exc()
                broken.append(name)
                continue
            figures |= found
            outcomes += tried
            if outcomes:
                figures |= {"faults_tried": len(outcomes), "faults_survived": sum(o.good for o in outcomes)}
            arguments.json.write_text(json.dumps({"figures": figures}, indent=1) + "\n")
    for outcome in outcomes:
        print(f"{'ok ' if outcome.good else 'NOT'}  {outcome.fault:48s} {outcome.words}")
    for name, value in figures.items():
        print(f"{name} {value:.4g}")
    if broken:
        print(f"broke off: {', '.join(broken)}", file=sys.stderr)
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
