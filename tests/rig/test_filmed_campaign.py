"""A whole campaign from films: tracked, diagnosed together, designed, run again, and a drift of the arm found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.export import arm
from rig.campaign import Campaign, CampaignRun
from rig.motion import RigMotion, described, rig_motion
from rig.safety import SafetyLimits
from rig.sentinel import sentinel
from rig.soundness import is_filmed_run
from rig.split_decision import joint_judge
from rig.until_split import Bench, SplitPlan, run_until_split
from tentacle.base_motion import fit_samples
from tentacle.diagnosis import Diagnosis
from tentacle.model import Estimate, Model
from tentacle.recording import Recording
from tentacle.waveform import Chirp
from tests.rig.filmed import filmed_run

HIDDEN = {"viscoelasticity": {"g": 0.4, "tau": 0.5}}  # one that the chirp shows, but not alone
SOFTER = 0.05


class FilmedBench:
    """The MuJoCo arm in front of the emulated camera, without a wait; `model` may change between two runs."""

    def __init__(self, model: Model) -> None:
        self.model = model

    def make(self, motion: RigMotion, path: Path) -> None:
        t = np.asarray(np.arange(len(motion.points)) * motion.period, dtype=float)
        wave = fit_samples(t, motion.points)
        filmed_run(self.model, HIDDEN, wave, motion.duration, path, motion.description)


@pytest.mark.long
def test_a_chirp_leaves_twins_that_a_designed_motion_splits_and_a_softer_arm_is_a_drift(
    limits: SafetyLimits, tmp_path: Path
) -> None:
    chirp = Chirp(0.2, 0.3, 1.5, 15.0)
    first = Campaign("twins", (CampaignRun("chirp", rig_motion(chirp, 15.0, limits, described(chirp))),))
    plan = SplitPlan(first, limits, most=4, repeats=3)
    bench, told, kept = FilmedBench(arm()), [], []

    def keep(_found: Diagnosis, _recordings: Sequence[Recording], runs: Sequence[Path]) -> None:
        kept.append(len(runs))

    def campaign() -> Bench:
        same = sentinel(plan.reference, plan.repeats, plan.comparisons, told.append)
        return Bench(bench.make, joint_judge(limits, 0, keep=keep), same, is_filmed_run)

    found = run_until_split(tmp_path, plan, campaign(), told=told.append)
    assert found.ending == "split"
    assert found.decision is not None
    assert set(HIDDEN) <= set(found.decision.explanation)
    assert 2 <= len(found.experiments) <= 4  # no explanation holds 95 % after the chirp alone
    assert kept == list(range(1, len(found.experiments) + 1))
    # The reference before the conclusion again, by an arm that has become 5 % softer. Only the load cell's noise
    # differs between two runs here: the tip's swing, which changes by as much as the stiffness, repeats exactly.
    last = max(tmp_path.glob("reference-*.rrd"))
    last.unlink()
    values = bench.model.parameters["elasticity"]["E"].value
    softer = {**bench.model.parameters, "elasticity": {"E": Estimate.exact(values * (1.0 - SOFTER))}}
    bench.model = replace(bench.model, parameters=softer)
    drifted = run_until_split(tmp_path, plan, campaign())
    assert drifted.ending == "drifted"
    assert any(line.startswith("the tip's swing changed") for line in drifted.drift)
    assert len(kept) == len(found.experiments)  # no diagnosis was made again
