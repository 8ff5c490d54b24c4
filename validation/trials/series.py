"""One blind trial from its design to its result, and a series of them on the runner."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from affine_model.cores import processor_seconds
from discovery.diagnose import diagnose
from discovery.given import Deciding
from mujoco_ref.influence import KNOWN, UNCATALOGUED
from mujoco_ref.undeclared.strength import SCALED_TOGETHER
from tentacle.errors import InputError
from tentacle.io.reading import read_recording
from tentacle.recording import Recording
from tentacle.runner import Runner
from validation.trials.baselines import baselines
from validation.trials.design import Design
from validation.trials.outcome import Outcome, answer_table, scored
from validation.trials.plant_design import PlantDesign
from validation.trials.plant_recording import plant_baseline, plant_recording
from validation.trials.recording import trial_recording

TRIAL_ROOMS = (
    "affine_model",
    "mujoco_ref",
    "vision",
    "inference",
    "discovery",
    "validation",
)  # rooms whose code a trial's result depends on
CATALOGUED = tuple(name for name in KNOWN if SCALED_TOGETHER.get(name) and name not in UNCATALOGUED)


AnyDesign = PlantDesign | Design


def design_of(table: Mapping[str, Any]) -> AnyDesign:
    """The design of a table: in a plant, or like a recording."""
    return PlantDesign.of(table) if "plant" in table else Design.of(table)


def made(design: AnyDesign) -> tuple[Recording, dict[str, Any]]:
    """A design's recording and truth."""
    return plant_recording(design) if isinstance(design, PlantDesign) else trial_recording(design)


def baseline_of(design: AnyDesign) -> list[Recording]:
    """The recordings that a design's diagnosis is told to be complete."""
    if isinstance(design, PlantDesign):
        return plant_baseline(design)
    return [read_recording(Path(path)) for path in design.baseline]


def seen_as(design: AnyDesign) -> str:
    """What is measured of the arm: midline, video, track or markers."""
    return design.seen if isinstance(design, PlantDesign) else design.sight.kind


@cache
def trials_code_version() -> str:
    """A hash of the rooms' source, so that stored results of other code are not used."""
    root, total = Path(__file__).resolve().parents[2], hashlib.sha256()
    files = [file for room in TRIAL_ROOMS for pattern in ("*.py", "*.toml") for file in (root / room).rglob(pattern)]
    for file in sorted(files):
        total.update(file.relative_to(root).as_posix().encode())
        total.update(file.read_bytes())
    return total.hexdigest()[:16]


def trial(task: Mapping[str, Any]) -> dict[str, Any]:
    """The runner's work: make the recording of a design's table, diagnose it without the truth, and score the answer.

    A table may name the CUDA device that simulates the hypotheses, as "device". If the arm cannot follow the drawn
    motion, or the recording cannot be judged, "refused" has the message.
    """
    design = design_of({name: value for name, value in task.items() if name != "device"})
    deciding = Deciding(laws=False, device=task.get("device"))
    try:
        recording, truth = made(design)
        baseline = baseline_of(design)
    except InputError as error:
        return {"refused": error.line()}
    except FloatingPointError as error:
        return {"refused": str(error)}
    begin = processor_seconds()
    try:
        answer = answer_table(diagnose([recording], baseline, seed=design.seed, deciding=deciding))
    except InputError as error:
        return {"refused": error.line(), "truth": truth}
    seconds = processor_seconds() - begin
    # Single markers are no shapes, and the paper's regression wants those.
    methods = {} if recording.markers is not None else baselines(recording)
    others = {**methods, "score_test": answer["score_test"][:1]}
    return {"truth": truth, "answer": answer, "baselines": {k: list(v) for k, v in others.items()}, "seconds": seconds}


def run_series(
    found: Sequence[AnyDesign], runner: Runner, inputs: str = "", device: str | None = None
) -> tuple[list[Outcome], list[tuple[int, str]]]:
    """Outcomes of the trials, and (index, line) of those that were refused; what the runner's folder holds is not
    done again. inputs: a hash of the recordings that the trials use. device: CUDA device of the diagnoses (None: CPU).
    """
    version = trials_code_version() + inputs
    place = {} if device is None else {"device": device}
    tasks = [{**design.table(), **place} for design in found]
    results = runner.run(trial, tasks, version=version, words="blind trials")
    outcomes, refused = [], []
    for design, result in zip(found, results, strict=True):
        if "refused" in result:
            refused.append((design.index, str(result["refused"])))
            continue
        more = {"baselines": result["baselines"], "seconds": result["seconds"]}
        outcomes.append(scored(design.index, result["truth"], seen_as(design), result["answer"], **more))
    return outcomes, refused
