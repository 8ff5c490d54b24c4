"""The search of `optimise`: one with a bar, or one a seed side by side."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from affine_model.swim import GaitTrial, Generation, Swimming
    from tentacle.model import Model


def searched(arguments: argparse.Namespace, trial: GaitTrial, model: Model) -> Swimming:
    """The best of the searches that were asked for."""
    from dataclasses import asdict

    from tentacle.cli._swim_work import best_of_restarts

    if arguments.restarts == 1 and not arguments.cluster:
        return search_with_progress(arguments, trial, model)
    settings = {name: getattr(arguments, name) for name in ("objective", "method", "evaluations", "robust", "polish")}
    settings |= {"device": trial.device, "hull": asdict(trial.hull)}
    seeds = range(arguments.seed, arguments.seed + arguments.restarts)
    return best_of_restarts(model, trial.limits, settings, seeds, arguments.out / "searches", arguments.cluster)


def search_with_progress(arguments: argparse.Namespace, trial: GaitTrial, model: Model) -> Swimming:
    """The search with a bar on standard error, noted generation by generation in OUT/search.jsonl."""
    from dataclasses import asdict

    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    from affine_model.swim import OBJECTIVES as OBJECTIVE_TABLE
    from affine_model.swim import SearchPlan, optimise_gait
    from tentacle.cli._swim_work import VERSION
    from tentacle.io.model_file import model_tables
    from tentacle.io.search_notes import SearchNotes

    settings = {name: getattr(arguments, name) for name in ("objective", "method", "evaluations", "seed", "robust")}
    inputs = {"version": VERSION, "model": model_tables(model), "limits": asdict(trial.limits), **settings}
    if OBJECTIVE_TABLE[arguments.objective].free:
        inputs["hull"] = asdict(trial.hull)
    notes = SearchNotes(arguments.out / "search.jsonl", inputs)
    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.completed:.0f} gaits"))
    console = Console(stderr=True)
    with Progress(
        *columns, TimeRemainingColumn(), transient=True, console=console, disable=not console.is_terminal
    ) as progress:
        task = progress.add_task(f"{arguments.method}, {arguments.objective}", total=arguments.evaluations)

        def watch(generation: Generation) -> None:
            notes.note(generation)
            progress.update(task, completed=generation.evaluations)

        return optimise_gait(
            trial,
            OBJECTIVE_TABLE[arguments.objective],
            SearchPlan(arguments.method, arguments.evaluations, arguments.seed, notes.scores(), arguments.polish),
            watch=watch,
        )
