"""How many recordings split the explanations that one chirp leaves, with designed motions and with random ones.

The plant is the MuJoCo chain, which shares no equation with the model that is corrected. A chirp of an arm that hides
one effect is diagnosed. Where the verdict is a group, or one explanation holds less than 95 %, further runs of the same
arm, with the same numbers, are made until it is split: motions as `tentacle rig campaign --until-split` designs them,
and multisines drawn at random within the same limits. --faults N instead: faults injected into campaigns of short runs;
a sound run made twice, overwritten or lost is a failure.
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

# benchmarks/vision.py and benchmarks/rig.py must not stand for the rooms of those names.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks._figures import tell
from benchmarks._split_faults import FAULTS, NEEDED, FaultyBench, KilledError, decided
from benchmarks.export import arm
from discovery.diagnose import diagnose
from discovery.given import Deciding
from discovery.next_experiment import DURATION, candidate_motions
from mujoco_ref.undeclared import Noise, Scenario, make_recording
from rig.campaign import Campaign, CampaignRun
from rig.fault import Fault
from rig.motion import described, rig_motion
from rig.safety import SafetyLimits
from rig.soundness import is_complete_run
from rig.split_decision import Decision, decision_of, servo_limits
from rig.until_split import Bench, SplitPlan, run_until_split
from tentacle.io.waveform_file import waveform_from_table
from tentacle.recording import Recording
from tentacle.waveform import Chirp, Multisine, Waveform

Hidden = Mapping[str, Any]  # an effect, and its strength in words or its numbers
LIMITS = SafetyLimits(min_angle=-0.8, max_angle=0.8, max_speed=6.0, max_current=0.9)
HIDDEN = ("linear_drag", "added_mass", "skin_drag", "viscoelasticity", "cubic_stiffness", "soft_spot",
          "intrinsic_curvature", "gravity_tilt", "tip_mass", "current", "dry_friction", "servo_lag")  # fmt: skip
CHIRP = Chirp(0.25, 0.3, 1.5, DURATION)
FPS, NOISE, MOST = 30.0, Noise(midline=4e-4), 3  # further recordings at most


def recorded(hidden: Hidden, waveform: Waveform, seed: int) -> tuple[Recording, Hidden]:
    """A recording, and the effect with the numbers that it has there."""
    scenario, (name,) = Scenario(arm(), waveform, DURATION, FPS), hidden
    recording, truth = make_recording(hidden, scenario, seed, NOISE, name=f"{name}-{seed}")
    return recording, truth["effects"]


def judged(recordings: list[Recording]) -> Decision:
    deciding = Deciding(laws=False, servo=servo_limits(LIMITS))
    return decision_of(diagnose(recordings, seed=len(recordings), deciding=deciding))


def random_motion(count: int, seed: int) -> Waveform:
    """A multisine as the design draws them, the first of its own seed."""
    drawn = candidate_motions(servo_limits(LIMITS), 1000 * seed + count)
    return next(motion for motion in drawn if isinstance(motion, Multisine))


def runs_to_split(
    hidden: Hidden, first: Recording, seed: int, motion: Callable[[Decision, int], Waveform | None]
) -> tuple[int | None, Decision]:
    """Further recordings of the same arm until an explanation with the hidden effect holds 95 % (None: not within MOST,
    or another one does), and the last decision.
    """
    recordings = [first]
    decision = judged(recordings)
    while decision.ending != "split" and len(recordings) <= MOST:
        wave = motion(decision, len(recordings))
        if wave is None:
            return None, decision
        recordings.append(recorded(hidden, wave, 100 * seed + len(recordings))[0])
        decision = judged(recordings)
    right = decision.ending == "split" and set(hidden) <= set(decision.explanation)
    return (len(recordings) - 1 if right else None), decision


def designed(decision: Decision, _count: int) -> Waveform | None:
    return None if decision.ending or decision.motion is None else waveform_from_table(decision.motion)


def groups(count: int, strength: str, seed: int, names: Sequence[str] = HIDDEN) -> dict[str, float]:
    """Figures over the first `count` groups that a chirp leaves, of these hidden effects."""
    rows: list[tuple[int | None, int | None]] = []
    for k, hidden in enumerate(HIDDEN):
        if hidden not in names:
            continue
        if len(rows) == count:
            break
        first, sized = recorded({hidden: strength}, CHIRP, 100 * (seed + k))
        decision = judged([first])
        print(f"{hidden}: {decision.words}", flush=True)
        if decision.ending == "split" or decision.verdict == "unknown":
            continue
        ours, last = runs_to_split(sized, first, seed + k, designed)
        print(f"  designed: {ours}; {last.words}", flush=True)
        own = seed + k
        drawn, last = runs_to_split(sized, first, own, lambda _, n, own=own: random_motion(n, own))
        print(f"  random: {drawn}; {last.words}", flush=True)
        rows.append((ours, drawn))
    taken = [[MOST + 1 if n is None else n for n in column] for column in zip(*rows, strict=True)]
    found = {"twin_groups": float(len(rows))}
    if rows:
        found["split_designed"] = float(np.mean([ours is not None for ours, _ in rows]))
        found["split_random"] = float(np.mean([drawn is not None for _, drawn in rows]))
        found["random_over_designed"] = sum(taken[1]) / sum(taken[0])  # not split counts as one more than MOST
    return found


def faults(count: int, seed: int) -> dict[str, float]:
    """Campaigns with faults injected at random; a fault is good where no sound run is made twice, changed or lost."""
    source = random.Random(seed)
    wave = Chirp(0.3, 0.3, 2.0, 2.0)
    plan = SplitPlan(
        Campaign("faults", (CampaignRun("chirp", rig_motion(wave, 2.0, LIMITS, described(wave))),)),
        LIMITS,
        patience=(0.0, 0.0),
    )
    injected = bad = 0
    while injected < count:
        drawn = [source.choice((*FAULTS, "", "")) for _ in range(9)]
        bench = FaultyBench(drawn)
        with tempfile.TemporaryDirectory() as name:
            folder, found = Path(name), None
            while found is None:
                sound = {path: path.read_bytes() for path in folder.glob("*.rrd") if is_complete_run(path)}
                try:
                    found = run_until_split(folder, plan, Bench(bench.make, decided, lambda _runs: []))
                except (KilledError, Fault) as error:
                    print(f"  {type(error).__name__}", flush=True)
                bad += sum(path.read_bytes() != content for path, content in sound.items())
            met = sum(bool(fault) for fault in drawn) - sum(bool(fault) for fault in bench.faults)
            injected += met
            complete = [path for path in folder.glob("*.rrd") if is_complete_run(path)]
            bad += abs(bench.made - met - len(complete)) + (len(found.experiments) != NEEDED)
        print(f"{injected} faults, {bad} failures", flush=True)
    return {"split_faults": float(injected), "split_fault_failures": float(bad)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--groups", type=int, default=4)
    parser.add_argument("--strength", default="visible", help="of the hidden effect, default: visible")
    parser.add_argument("--hidden", nargs="+", choices=HIDDEN, default=HIDDEN, help="effects to hide (default: each)")
    parser.add_argument("--faults", type=int, default=0, metavar="N")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path, metavar="FILE")
    arguments = parser.parse_args()
    if arguments.faults:
        found = faults(arguments.faults, arguments.seed)
    else:
        found = groups(arguments.groups, arguments.strength, arguments.seed, arguments.hidden)
    tell(found, arguments.json)


if __name__ == "__main__":
    main()
