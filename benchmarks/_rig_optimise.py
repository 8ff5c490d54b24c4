"""`rig optimise` on the MuJoCo arm, from a model that lacks an effect: how near it comes to the arm's best gait."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from benchmarks._rig_scene import LIMITS, SPECIMEN, setup_for
from rig.connection import connected, opened_camera
from rig.emulator import Emulator, EmulatorSettings
from rig.gait_space import GaitSpace, TrialPlan
from rig.model_gaits import best_gaits
from rig.optimise import StudyPlan, best, optimise
from rig.record import trial_runner
from rig.reidentify import proposer
from rig.setup_file import CameraSettings
from tentacle.model import Estimate, Model
from tentacle.model_file import write_model
from tentacle.specimen import WATER

# Declared: the base effects and added mass. Not declared: a payload at the tip, a fifth of the arm's own mass.
DECLARED = Model(
    SPECIMEN,
    WATER,
    parameters={
        "elasticity": {"E": Estimate.exact(1.3e5)},
        "damping": {"eta": Estimate.exact(200.0)},
        "drag": {"C_perp": Estimate.exact(1.2)},
        "added_mass": {"C_a": Estimate.exact(1.0)},
    },
)
HIDDEN = {"tip_mass": {"mass": 0.006}}


def best_known(space: GaitSpace, plan: TrialPlan, samples: int) -> tuple[dict[str, float], float]:
    """The truth's best gait, by trying many on the MuJoCo arm itself (servo and noise left out), then nearby."""
    truth_model = DECLARED
    for effect, values in HIDDEN.items():
        truth_model = truth_model.with_effect(effect, **{name: Estimate.exact(v) for name, v in values.items()})
    tried = best_gaits(truth_model, space, plan, 6, seed=1) + space.sample(samples, seed=2)
    source = np.random.default_rng(3)
    bounds = np.array(list(space.bounds.values()))
    scores = [true_propulsion(space, plan, point) for point in tried]
    for width in (0.08, 0.03):
        top = tried[int(np.argmax(scores))]
        for _ in range(samples // 2):
            near = np.array(list(top.values())) + width * np.ptp(bounds, axis=1) * source.normal(size=len(bounds))
            point = dict(zip(space.bounds, np.clip(near, bounds[:, 0], bounds[:, 1]).tolist(), strict=True))
            tried.append(point)
            scores.append(true_propulsion(space, plan, point))
    place = int(np.argmax(scores))
    return tried[place], scores[place]


def true_propulsion(space: GaitSpace, plan: TrialPlan, point: dict[str, float]) -> float:
    """Mean propulsion [N] of a gait on the hidden truth, driven through the same servo as the emulated arm's."""
    from rig.arm_plant import ArmPlant

    gait, frequency = space.gait(point), point["frequency_hz"]
    plant = ArmPlant(DECLARED, HIDDEN)
    begin, end = plan.window(frequency)
    forces = []
    for t in np.arange(0.0, end, 0.004):
        plant.advance(t, float(gait(t)[0]), True)
        if t >= begin:
            forces.append(plant.force)
    return -float(np.mean(forces))


def optimised(folder: Path, trials: int, samples: int, reidentify: int, rate: float) -> tuple[float, list[str]]:
    """`rig optimise` from a model that lacks what the arm has: gap of the best gait found to the best known, by
    truth.
    """
    space, plan = GaitSpace(LIMITS, (0.4, 3.0), harmonics=1), TrialPlan(5, 2)
    _, top = best_known(space, plan, samples)
    folder.mkdir(parents=True, exist_ok=True)
    write_model(DECLARED, folder / "model.toml")
    (folder / "hidden.json").write_text(json.dumps(HIDDEN))
    first = best_gaits(DECLARED, space, plan, 5, seed=1)
    settings = EmulatorSettings(
        seed=17, rate=rate, plant="arm", plant_options=(str(folder / "model.toml"), str(folder / "hidden.json"))
    )
    lines: list[str] = []
    with Emulator(folder / "emulator", settings) as emulator:
        setup = setup_for(emulator, camera=CameraSettings("emulated") if reidentify else None)
        study = StudyPlan(space, trials, plan, reidentify, seed=5)
        propose = proposer(space, plan, told=lambda d: lines.append(f"  {d.headline}")) if reidentify else None
        with connected(setup) as board, opened_camera(setup, board.time) as camera:
            done = list(optimise(folder / "study", study, trial_runner(setup, board, camera), first, propose=propose))
    true = {trial.number: true_propulsion(space, plan, trial.point) for trial in done}
    top = max(top, *true.values())  # the best known is the best of all that was ever tried on this arm
    lines.append(
        f"best known gait of the arm: {1e3 * top:.2f} mN; declared model's first: {1e3 * true[done[0].number]:.2f} mN"
    )
    for count in sorted({min(n, trials) for n in (1, 5, 10, 20, trials)}):
        chosen = best(done[:count])
        gap = 1.0 - true[chosen.number] / top
        lines.append(
            f"  after {count:3d} trials: {1e3 * chosen.propulsion:.2f} mN measured ({chosen.source}), "
            f"gap {100 * gap:.1f} %"
        )
    return 1.0 - true[best(done).number] / top, lines
