"""Searches that run elsewhere: the work that tentacle.runner hands to processes or a Dask cluster, as plain data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from affine_model.swim import GaitLimits, Swimming
    from tentacle.model import Model

VERSION = "2"  # of what a search computes


def search_tasks(
    model: Model, limits: GaitLimits, settings: Mapping[str, Any], seeds: Sequence[int]
) -> list[dict[str, Any]]:
    """One task a seed; settings hold objective, method, evaluations, robust (samples, 0: at the estimates), device (of
    torch, None: none), polish and hull.
    """
    from tentacle.io.model_file import model_tables

    common = {"model": model_tables(model), "limits": asdict(limits), **settings}
    return [{**common, "seed": seed} for seed in seeds]


def search_work(task: Mapping[str, Any]) -> dict[str, Any]:
    """One whole search; plain data of its Swimming. The samples of a robust search are the same for every seed."""
    from affine_model.free_body import Hull
    from affine_model.swim import OBJECTIVES, GaitLimits, SearchPlan, optimise_gait, robust_trial, trial_of
    from tentacle.io.model_file import parse_model
    from tentacle.io.toml_table import Table
    from tentacle.servo_limits import ServoLimits

    model = parse_model(Table(dict(task["model"]), file=None, name="model"))
    limits = dict(task["limits"])
    trial = trial_of(model, GaitLimits(ServoLimits(**limits.pop("servo")), **limits))
    hull = Hull(**task["hull"]) if "hull" in task else trial.hull
    trial = replace(trial, device=task.get("device"), hull=hull)
    if task["robust"]:
        trial = robust_trial(trial, model, task["robust"], seed=0)
    objective = OBJECTIVES[task["objective"]]
    plan = SearchPlan(task["method"], task["evaluations"], task["seed"], polish=bool(task.get("polish")))
    found = optimise_gait(trial, objective, plan)
    return {
        "origin": found.origin,
        "gait": list(found.gait.alpha),
        "sine": list(found.sine.alpha),
        "promise": asdict(found.promise),
        "sine_promise": asdict(found.sine_promise),
        "value": found.value,
        "sine_value": found.sine_value,
        "evaluations": found.evaluations,
        "best": found.best,
        "peaks": found.peaks,
    }


def best_of_restarts(
    model: Model,
    limits: GaitLimits,
    settings: Mapping[str, Any],
    seeds: Sequence[int],
    folder: Path,
    cluster: str | None,
) -> Swimming:
    """The best of one search per seed, on this machine's processes or a cluster. Finished searches in folder
    are kept.
    """
    from affine_model.swim import Promise, Swimming
    from tentacle.gait import Gait
    from tentacle.runner import Runner

    tasks = search_tasks(model, limits, settings, seeds)
    results = Runner(folder, scheduler=cluster).run(search_work, tasks, version=VERSION, words="searches")
    seed, best = max(zip(seeds, results, strict=True), key=lambda pair: pair[1]["value"])
    return Swimming(
        objective=settings["objective"],
        method=settings["method"],
        seed=seed,
        origin=best["origin"],
        gait=Gait(tuple(best["gait"]), limits.bandwidth),
        sine=Gait(tuple(best["sine"]), limits.bandwidth),
        promise=Promise(**best["promise"]),
        sine_promise=Promise(**best["sine_promise"]),
        value=best["value"],
        sine_value=best["sine_value"],
        evaluations=best["evaluations"],
        best=best["best"],
        peaks=best["peaks"],
    )
