"""`rig optimise` on the MuJoCo arm, from a model that lacks an effect: how near it comes to the arm's best gait."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from benchmarks._rig_scene import LIMITS, SPECIMEN, setup_for
from rig.connection import connected, opened_camera
from rig.emulator import Emulator, EmulatorSettings
from rig.fault import Fault
from rig.gait_space import GaitSpace, TrialPlan
from rig.model_gaits import best_gaits
from rig.optimise import RigTrial, StudyPlan, Suggestions, best, optimise_on_rig
from rig.record import trial_runner
from rig.reidentify import proposer
from rig.setup_file import CameraSettings
from tentacle.io.model_file import write_model
from tentacle.model import Estimate, Model
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
    """The truth's best gait, by trying many on the MuJoCo arm itself (noise left out): the best of both models, told of
    the effect and not, a spread, then three climbs ever nearer to the best so far.
    """
    told = DECLARED
    for effect, values in HIDDEN.items():
        told = told.with_effect(effect, **{name: Estimate.exact(v) for name, v in values.items()})
    first = [point for model in (told, DECLARED) for point in best_gaits(model, space, plan, 6, seed=1)]
    tried = [(true_propulsion(space, plan, point), point) for point in first + space.sample(samples, seed=2)]
    source = np.random.default_rng(3)
    bounds = np.array(list(space.bounds.values()))
    top, point = max(tried, key=lambda pair: pair[0])
    for width in (0.08, 0.03, 0.01):
        for _ in range(samples):
            near = np.array(list(point.values())) + width * np.ptp(bounds, axis=1) * source.normal(size=len(bounds))
            other = dict(zip(space.bounds, np.clip(near, bounds[:, 0], bounds[:, 1]).tolist(), strict=True))
            reached = true_propulsion(space, plan, other)
            if reached > top:
                top, point = reached, other
    return point, top


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


def optimised(
    folder: Path, space: GaitSpace, plan: TrialPlan, trials: int, reidentify: int, rate: float
) -> tuple[list[RigTrial], list[str]]:
    """`rig optimise` from a model that lacks what the arm has: its trials, and what the diagnoses said."""
    folder.mkdir(parents=True, exist_ok=True)
    write_model(DECLARED, folder / "model.toml")
    (folder / "hidden.json").write_text(json.dumps(HIDDEN))
    first = best_gaits(DECLARED, space, plan, 5, seed=1)
    words = (str(folder / "model.toml"), str(folder / "hidden.json"))
    settings = EmulatorSettings(seed=17, rate=rate, plant="arm", plant_options=words)
    verdicts: list[str] = []
    with Emulator(folder / "emulator", settings) as emulator:
        setup = setup_for(emulator, camera=CameraSettings("emulated") if reidentify else None)
        study = StudyPlan(space, trials, plan, reidentify, seed=5)
        propose = None
        if reidentify:
            propose = proposer(space, plan, believed=DECLARED, told=verdicts.append)
        with connected(setup) as board, opened_camera(setup, board.time) as camera:
            runner = trial_runner(setup, board, camera)
            done: list[RigTrial] = []
            try:
                done.extend(optimise_on_rig(folder / "study", study, runner, Suggestions(first, propose)))
            except Fault as fault:
                print(f"{folder.name}: broke off after {len(done)} trials: {fault}")
            return done, verdicts


def side_by_side(folder: Path, trials: int, samples: int, every: int, rate: float) -> dict[str, float]:
    """The gap of the best gait found to the best known, by truth, without re-identification and with it every so many
    trials (0: without only), as a printed table. rate: emulated seconds a second; a busy computer wants less than 1.
    """
    space, plan = GaitSpace(LIMITS, (0.4, 3.0), harmonics=1), TrialPlan(5, 2)
    _, top = best_known(space, plan, samples)
    courses = {"without": optimised(folder / "without", space, plan, trials, 0, rate)}
    if every:
        courses[f"with, every {every}"] = optimised(folder / "with", space, plan, trials, every, rate)
    true = {name: [true_propulsion(space, plan, trial.point) for trial in done] for name, (done, _) in courses.items()}
    top = max([top, *(value for values in true.values() for value in values)])  # of all that was tried on this arm
    print(f"rig optimise, re-identification side by side; best known gait of the arm {1e3 * top:.2f} mN")
    print("trials  " + "  ".join(f"{name:>34s}" for name in courses))
    gaps: dict[str, list[float]] = {name: [] for name in courses}
    for count in sorted({min(n, trials) for n in (1, 5, 10, 15, 20, 25, trials)}):
        cells = []
        for name, (done, _) in courses.items():
            if len(done) < count:
                cells.append("-")
                continue
            chosen = best(done[:count])
            gaps[name].append(1.0 - true[name][done.index(chosen)] / top)
            cells.append(f"gap {100 * gaps[name][-1]:5.1f} % ({chosen.source})")
        print(f"{count:6d}  " + "  ".join(f"{cell:>34s}" for cell in cells))
    for name, (_, verdicts) in courses.items():
        for verdict in verdicts:
            print(f"{name}: {verdict}")
    named = dict(zip(courses, ("gap_after_30", "gap_after_30_reidentified"), strict=False))
    return {named[name]: gaps[name][-1] for name, (done, _) in courses.items() if len(done) == trials}
