"""What `tentacle identify` writes and prints: the parameters as data and as lines, the model, report and session."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from typing import Any

from affine_model.run_forces import with_forces
from inference.identify import Identification
from tentacle.io.model_file import write_model
from tentacle.recording import Recording
from tentacle.rounding import number
from viz.compare import model_markdown, write_comparison
from viz.identify_report import Told, model_report
from viz.report import Origin, write_report
from viz.scene import model_scene


def write_identification(found: Identification, judges: Sequence[Recording], origin: Origin, folder: Path) -> None:
    """identification.json, model.toml, report.html and session.rrd; judges: the recordings that the errors are of."""
    scenes = [model_scene(run) for run in with_forces(found.runs, found.model, found.model)]
    (folder / "identification.json").write_text(json.dumps(identification_table(found), indent=1) + "\n")
    write_model(found.model, folder / "model.toml")
    told = Told(found.headline, found.words, found.regression, found.bootstrap)
    write_report(model_report(found.model, told, scenes, judges, origin), folder / "report.html")
    text = model_markdown(found.model, (found.headline, *found.words))
    write_comparison(scenes[0], judges[0], text, folder / "session.rrd")


def identification_table(found: Identification) -> dict[str, Any]:
    """identification.json as plain data."""
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
    return value if isfinite(value) else None


def identification_lines(found: Identification) -> list[str]:
    """The result for the terminal: headline, one parameter a line, remarks."""
    lines = [found.headline]
    for effect, values in found.model.parameters.items():
        for name, e in values.items():
            paper = found.regression.get(f"{effect}.{name}")
            drawn = found.bootstrap.get(f"{effect}.{name}")
            beside = "" if drawn is None else f"; bootstrap {number(drawn[0])} to {number(drawn[1])}"
            beside += "" if paper is None else f"; the paper's regression {number(paper)}"
            known = "given" if e.low == e.high else f"95 %: {e.interval_words}"
            lines.append(f"{effect}.{name} = {e.with_unit} ({known}{beside})")
    return [*lines, *found.words]
