"""All cases, or some, and what became of them: python -m tests.hostile.run [--seed N] [--cases N] [--only TEXT]."""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
from collections import Counter
from pathlib import Path

from benchmarks._commit import commit_of
from tests.hostile.cases import cases
from tests.hostile.judge import Case, Outcome, judge

ROOT = Path(__file__).parents[2]


def warm() -> None:
    """Imports what the verbs import, and runs nothing."""
    os.environ["RUST_LOG"] = "off"  # as the command line does before Rerun is imported
    import av
    import cv2
    import rerun
    import scipy.interpolate
    import scipy.optimize
    import scipy.signal

    import affine_model
    import discovery.diagnose
    import inference
    import rig.optimise
    import rig.recorder
    import rig.run_file
    import tentacle.io.recording_rrd
    import vision.track
    from tentacle.cli import build_parser

    build_parser()  # every verb's file
    del av, cv2, rerun, scipy, affine_model, discovery, inference, rig, tentacle, vision


def made(material: Path) -> None:
    """The material, made in a child: what makes it starts threads."""
    child = os.fork()
    if child == 0:
        from tests.hostile.material import make_material

        code = 1
        try:
            make_material(material)
            code = 0
        finally:
            os._exit(code)
    if os.waitpid(child, 0)[1]:
        raise RuntimeError("the material could not be made")


HEAVY = frozenset(
    [
        "simulate",
        "optimise",
        "compare",
        "identify",
        "diagnose",
        "blind-trial",
        "validate",
        "render",
        "track",
        "replay",
        "library",
        "app",
    ]
)


def run(chosen: list[Case], show: bool) -> list[Outcome]:
    """The outcomes of cases."""
    warm()
    found = []
    with tempfile.TemporaryDirectory(prefix="hostile-") as folder:
        material = Path(folder) / "material"
        os.environ["HOSTILE_MATERIAL"] = str(material)
        os.environ["TENTACLE_CACHE"] = str(Path(folder) / "cache")
        made(material)
        for number, case in enumerate(chosen):
            outcome = judge(case, material, Path(folder) / f"case-{number}")
            found.append(outcome)
            if show or not outcome.good:
                print(f"{outcome.kind:10s} {outcome.seconds:5.1f} s  {outcome.name}", flush=True)
            if not outcome.good:
                print("    " + "\n    ".join(outcome.words.splitlines()[-12:]), flush=True)
    return found


def main() -> int:
    """The exit code: 0 where every case was right or refused in one line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cases", type=int)
    parser.add_argument("--only", default="")
    parser.add_argument("--quick", action="store_true", help="only those of verbs that compute nothing for long")
    parser.add_argument("--json", type=Path, metavar="FILE", help="where to write the figures")
    parser.add_argument("--show", action="store_true", help="the good ones too")
    arguments = parser.parse_args()
    commit = commit_of(ROOT)  # now: what is imported is of now
    chosen = [case for case in cases(arguments.seed) if arguments.only in case.name]
    if arguments.quick:
        chosen = [case for case in chosen if case.arguments[0] not in HEAVY]
    outcomes = run(chosen[: arguments.cases], arguments.show)
    kinds = Counter(outcome.kind for outcome in outcomes)
    bad = sum(not outcome.good for outcome in outcomes)
    seconds = sum(outcome.seconds for outcome in outcomes)
    print(f"{len(outcomes)} cases in {seconds:.0f} s: " + ", ".join(f"{n} {kind}" for kind, n in kinds.most_common()))
    if arguments.json is not None:
        figures = {"hostile_cases": float(len(outcomes)), "hostile_bad": float(bad), "hostile_minutes": seconds / 60}
        arguments.json.write_text(json.dumps({"figures": figures, "commit": commit}))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
