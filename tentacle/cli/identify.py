"""`tentacle identify`: the declared model's parameters from recordings, with intervals, the paper's regression beside
them.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from inference.identify import Identification

HELP = "fit the declared model's parameters to recordings, with intervals; the paper's regression beside"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument(
        "recordings", nargs="+", metavar="RECORDING", type=Path, help="an import folder or an .rrd file"
    )
    parser.add_argument(
        "--check", nargs="+", default=[], type=Path, metavar="RECORDING",
        help="recordings that only judge (the paper fits a chirp and checks a sine)",
    )  # fmt: skip
    parser.add_argument(
        "--order", type=int, choices=range(2, 7), help="curvature coordinates (default: what the data need)"
    )
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="folder for model.toml, report.html, ..."
    )
    parser.add_argument(
        "--bootstrap", type=int, default=0, metavar="N", help="intervals from N refits to resampled residuals, too"
    )
    parser.add_argument("--seed", type=int, default=0, help="of the bootstrap's draws (default 0)")
    parser.add_argument("--json", action="store_true", help="print the result as JSON")


def run(arguments: argparse.Namespace) -> int:
    """Identify and write."""
    import json
    import sys

    from affine_model.run_forces import with_forces
    from tentacle.cli._kernels import kernels_ahead
    from tentacle.cli._progress import IDENTIFYING, reading_plan, stages
    from tentacle.errors import InputError
    from tentacle.io.model_file import write_model
    from tentacle.io.provenance import input_hashes, versions
    from tentacle.io.result_folder import replaced, written
    from vision.tracked_recording import read_tracked
    from viz.compare import model_markdown, write_comparison
    from viz.identify_report import model_report
    from viz.report import Origin, write_report
    from viz.scene import model_scene

    if arguments.bootstrap != 0 and arguments.bootstrap < 20:
        raise InputError(f"{arguments.bootstrap} is too few", field="--bootstrap", expected="0, or at least 20")
    if words := replaced(arguments.out):
        print(words, file=sys.stderr)
    plan = [*reading_plan([*arguments.recordings, *arguments.check]), *IDENTIFYING]
    with stages(plan) as stage, kernels_ahead(stage) as wait_for_kernels:
        recordings = [read_tracked(path, stage) for path in arguments.recordings]
        check = [read_tracked(path, stage) for path in arguments.check]
        wait_for_kernels()
        stage("fitting")
        from inference.identify import identify

        found = identify(recordings, check, order=arguments.order, replicates=arguments.bootstrap, seed=arguments.seed)
        summary, lines = _as_json(found), _lines(found)
        scenes = [model_scene(run) for run in with_forces(found.runs, found.model, found.model)]
        paths = [*arguments.recordings, *arguments.check]
        command = " ".join(["tentacle", *sys.argv[1:]])
        origin = Origin(command, None, versions(), input_hashes(paths))
        stage("writing the report")
        with written(arguments.out) as folder:
            (folder / "identification.json").write_text(json.dumps(summary, indent=1) + "\n")
            write_model(found.model, folder / "model.toml")
            judges = check or recordings
            told = (found.model, lines[0], found.words, found.regression)
            page = model_report(*told, scenes, judges, origin, found.bootstrap)
            write_report(page, folder / "report.html")
            text = model_markdown(found.model, (lines[0], *found.words))
            write_comparison(scenes[0], judges[0], text, folder / "session.rrd")
    end = [f"written to {arguments.out}", *_next(found.adequate, arguments)]
    print(json.dumps(summary, indent=1) if arguments.json else "\n".join([*lines, *end]))
    return 0


def _next(adequate: bool, arguments: argparse.Namespace) -> list[str]:
    """Whether the model is adequate, and which command is next."""
    if adequate:
        words = "The model is adequate: what it leaves of these recordings passes for noise."
        return [words, f"next: tentacle optimise {arguments.out / 'model.toml'} --out gait"]
    recordings = " ".join(map(str, arguments.recordings))
    words = "The model is not adequate: what it leaves of these recordings is more than noise."
    return [words, f"next: tentacle diagnose {recordings} --out {arguments.out}_diagnosed"]


def _as_json(found: Identification) -> dict[str, Any]:
    from dataclasses import asdict

    return {
        "order": found.model.order,
        "parameters": {
            effect: {name: asdict(estimate) for name, estimate in values.items()}
            for effect, values in found.model.parameters.items()
        },
        "regression": found.regression,
        "error": asdict(found.errors),
        "held_out": found.held_out,
        "adequate": found.adequate,
        "correlation": {"names": list(found.free), "matrix": found.correlation.tolist()},
        "at_bound": list(found.at_bound),
        "identifiability": {
            "condition": found.identifiability.condition,
            "weakest": found.identifiability.weakest.tolist(),
            "dead_channels": [list(places) for places in found.identifiability.dead],
            "clock_offset_s": _finite(found.identifiability.clock[0]),
            "clock_sigma_s": _finite(found.identifiability.clock[1]),
        },
        "bootstrap": {name: list(ends) for name, ends in found.bootstrap.items()},
        "words": list(found.words),
    }


def _finite(value: float) -> float | None:
    """JSON knows neither NaN nor infinity."""
    from math import isfinite

    return value if isfinite(value) else None


def _lines(found: Identification) -> list[str]:
    error = found.errors.midline_mm
    where = "recordings that were not fitted" if found.held_out else "the recordings that were fitted"
    lines = [f"{found.model.order} curvature coordinates; error {error:.2f} mm on {where}."]
    for effect, values in found.model.parameters.items():
        for name, e in values.items():
            paper = found.regression.get(f"{effect}.{name}")
            drawn = found.bootstrap.get(f"{effect}.{name}")
            beside = "" if drawn is None else f"; bootstrap {drawn[0]:.4g} to {drawn[1]:.4g}"
            beside += "" if paper is None else f"; the paper's regression {paper:.4g}"
            lines.append(f"{effect}.{name} = {e.value:.4g} {e.unit} (95 %: {e.low:.4g} to {e.high:.4g}{beside})")
    return [*lines, *found.words]
