"""What the loop says of real arms whose truth is known from outside: payloads, repeats, tendons, pressure.

python benchmarks/real_arms.py --json FILE [--only KIND] [--trajectories N]

Each case is one call of diagnose. A case is right where its verdict is the one that SOURCE.txt of the data supports:
a payload of 52 g (beam) and of 100 g (trunk), other payloads that are simulated and added to a bare beam (payloads),
nothing between repeats, something outside the catalogue where tendons or pressure move the arm. Data: TENTACLE_DATA;
a set that is not there is left out and said so.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from discovery.diagnose import diagnose
from tentacle.diagnosis import Diagnosis
from tentacle.io.convert_data import convert_data
from tentacle.io.external_data import data_folder
from tentacle.io.pressure_arm import read_pressure_arms
from tentacle.io.reading import read_recording
from tentacle.io.silicone_beam import read_beam
from tentacle.io.trunk_payload import read_decays, read_driven
from tentacle.recording import Recording
from validation.trials.design import designs
from validation.trials.likeness import RealParts, likeness
from validation.trials.recording import recording_with

BEAM_TRUTH, TRUNK_TRUTH = 0.052, 0.100  # kg
BEAM_WITHIN = 0.1  # of the truth
TRUNK_RANGE = (0.070, 0.130)  # kg
PAYLOADS = (0.005, 0.010, 0.020, 0.035, 0.052, 0.075, 0.102, 0.150)  # kg


@dataclass(frozen=True)
class Case:
    """A call of diagnose: what is judged, what is believed complete, which verdict is right, the true payload [kg]."""

    name: str
    recordings: tuple[Recording, ...]
    baseline: tuple[Recording, ...]
    right: str
    truth: float | None = None


def beam_cases(folder: Path) -> Iterator[Case]:
    """Four pairings of a loaded run with a bare one, and the bare runs against each other."""
    bare = {k: read_beam(folder / f"beam_gravity_V2_{k}.csv") for k in "ab"}
    loaded = {k: read_beam(folder / f"beam_load52_V2_{k}.csv") for k in "ab"}
    for k in "ab":
        for j in "ab":
            yield Case(f"beam_load_{k}_on_bare_{j}", (loaded[k],), (bare[j],), "effect", BEAM_TRUTH)
    for k, j in ("ab", "ba"):
        yield Case(f"beam_bare_{k}_on_bare_{j}", (bare[k],), (bare[j],), "nothing_missing")


def payload_cases(folder: Path) -> Iterator[Case]:
    """Payloads on the tip's face: the MuJoCo reference's run with one, plus what the model leaves in a bare run. The
    other bare run is the baseline.
    """
    with TemporaryDirectory() as kept:
        convert_data("silicone_beam", folder.parent, Path(kept))
        paths = {k: Path(kept) / f"beam_gravity_V2_{k}" for k in "ab"}
        bare = {k: read_recording(path) for k, path in paths.items()}
        for k, j in ("ab", "ba"):
            real = RealParts(str(paths[k]), (str(paths[j]),))
            like = replace(likeness(bare[k], with_own_errors=True), real=real)
            (design,) = designs(1, 0, ("tip_mass",), (), like, ["single"])
            for mass in PAYLOADS:
                hidden = {"tip_mass": {"mass": mass, "reach": 0.0, "drop": 0.0}}
                loaded = recording_with(design, hidden)[0]
                yield Case(f"payload_{1e3 * mass:.0f}_g_in_{k}_on_{j}", (loaded,), (bare[j],), "effect", mass)


def trunk_cases(folder: Path, count: int) -> Iterator[Case]:
    """Repeats with 200 g, each 300 g decay against them, and all of these at once."""
    known = read_decays(folder / "observations_manual_decay_200g.csv")[1:4]
    repeats = read_decays(folder / "observations_manual_decay_200g_2.csv")[:count]
    heavier = read_decays(folder / "observations_manual_decay_300g.csv")[:count]
    for recording in repeats:
        yield Case(f"trunk_{recording.name}", (recording,), tuple(known), "nothing_missing")
    for recording in heavier:
        yield Case(f"trunk_{recording.name}", (recording,), tuple(known), "effect", TRUNK_TRUTH)
    yield Case("trunk_300g_together", tuple(heavier), tuple(known), "effect", TRUNK_TRUTH)


def driven_cases(folder: Path) -> Iterator[Case]:
    """Tendons that the declaration does not know."""
    for name in ("observations_controlled_1_0g", "observations_controlled_1_100g"):
        yield Case(f"driven_{name[-4:].strip('_')}", (read_driven(folder / f"{name}.csv"),), (), "unknown")


def pressure_cases(folder: Path) -> Iterator[Case]:
    """A pressure that the declaration does not know."""
    for recording in read_pressure_arms(folder):
        yield Case(f"pressure_{recording.name}", (recording,), (), "unknown")


def judged(case: Case, found: Diagnosis) -> tuple[bool, str]:
    """Whether the answer is right, and the line that is printed of it."""
    right = found.verdict == case.right
    payload = found.parameters.get("tip_mass", {}).get("mass")
    words = f"{found.verdict} {' + '.join(found.effects)} (confidence {found.confidence:.2f})"
    if payload is not None:
        words += f", payload {1e3 * payload.value:.1f} g [{1e3 * payload.low:.1f}, {1e3 * payload.high:.1f}]"
    if case.truth is not None:
        within = payload is not None and abs(payload.value / case.truth - 1.0) < BEAM_WITHIN
        if case.truth == TRUNK_TRUTH:
            within = payload is not None and TRUNK_RANGE[0] <= payload.value <= TRUNK_RANGE[1]
        right = right and within and "tip_mass" in found.effects
    before, after = found.before.midline_mm, found.after.midline_mm
    errors = ", ".join("-" if value is None else f"{value:.2f}" for value in (before, after, found.floor.midline_mm))
    return right, f"{words}; mm before, after, floor: {errors}"


def main() -> None:
    """Run the cases, print a line of each, write the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, required=True)
    parser.add_argument("--only", choices=["beam", "payloads", "trunk", "driven", "pressure"])
    parser.add_argument("--trajectories", type=int, default=4, help="of the trunk's decays of each payload (default 4)")
    arguments = parser.parse_args()
    data = data_folder()
    makers = {
        "beam": ("silicone_beam", beam_cases),
        "payloads": ("silicone_beam", payload_cases),
        "trunk": ("trunk_payload", lambda folder: trunk_cases(folder, arguments.trajectories)),
        "driven": ("trunk_payload", driven_cases),
        "pressure": ("pressure_arm", pressure_cases),
    }
    figures: dict[str, float] = {}
    for kind, (name, make) in makers.items():
        if arguments.only not in (None, kind):
            continue
        if not (data / name).is_dir():
            print(f"{kind}: {data / name} is not there (`tentacle data` says where to get it)")
            continue
        rights: list[bool] = []
        seconds: list[float] = []
        for case in make(data / name):
            begin = time.perf_counter()
            right, words = judged(case, diagnose(list(case.recordings), list(case.baseline)))
            seconds.append(time.perf_counter() - begin)
            rights.append(right)
            print(f"{'right' if right else 'WRONG'}  {case.name}: {words}; {seconds[-1]:.0f} s", flush=True)
        figures |= summary(kind, rights, seconds)
    arguments.json.write_text(json.dumps({"figures": figures}, indent=1) + "\n")


def summary(kind: str, rights: Sequence[bool], seconds: Sequence[float]) -> dict[str, float]:
    """Share of right answers and the longest time of a kind of arm."""
    return {f"{kind}_right": float(np.mean(rights)), f"{kind}_s_worst": float(max(seconds))}


if __name__ == "__main__":
    main()
