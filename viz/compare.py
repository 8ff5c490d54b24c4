"""Sessions that hold models against a subject: `tentacle identify` (against data), `tentacle compare` (two models)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from tentacle.model import Model
from tentacle.recording import Recording
from tentacle.rounding import number
from tentacle.signals import Array
from viz.blueprints.run import run_page
from viz.blueprints.views import blueprint_page
from viz.palette import AUGMENTED, BASE, MEASURED, REFERENCE, Role
from viz.scene import Party, ViewedRun
from viz.session import log_scene, session_file, session_id, set_layout
from viz.topics.verdict import text_table
from viz.words import effect_name

MODEL_ROLES = (BASE, AUGMENTED, REFERENCE)
CHARACTER, WINDOW = 7.5, 1920.0  # px: of a table's text on the viewer's page, and of the usual window's width


@dataclass(frozen=True)
class ComparedMotion:
    """How an arm moved: xy (T, P, 2) [m]; q (T, 2) [rad], thrust (T,) [N], drag (T, P, 2) [N/m] where
    known."""

    xy: Array
    q: Array | None = None
    thrust: Array | None = None
    drag: Array | None = None


def motions_scene(name: str, t: Array, s: Array, theta: Array, motions: Mapping[str, ComparedMotion]) -> ViewedRun:
    """Named motions on one time axis as a scene; the first is the subject, at most three models follow."""
    roles = (MEASURED, *MODEL_ROLES)[: len(motions)]
    parties = tuple(
        Party(
            rr.escape_entity_path_part(key),
            Role(key, role.colour, role.dash),
            motion.xy,
            motion.q,
            motion.thrust,
            motion.drag,
        )
        for (key, motion), role in zip(motions.items(), roles, strict=True)
    )
    return ViewedRun(name, t, s, theta, parties, np.ones(len(t), dtype=bool))


def model_markdown(model: Model, words: tuple[str, ...] = ()) -> str:
    """A model's parameters with intervals, and what there is to say about them, as a page."""
    rows = [
        (effect_name(effect), name, number(e.value), e.interval_words, e.unit)
        for effect, values in model.parameters.items()
        for name, e in values.items()
    ]
    parts = [
        "# Identified model",
        f"{model.order} curvature coordinates.",
        text_table(("effect", "parameter", "value", "95 % interval", "unit"), rows),
        "\n".join(f"- {line}" for line in words),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def page_share(page_text: str) -> float:
    """The share of the window that a page needs, so that its widest table is not cut: a quarter to a half."""
    widest = max((len(line) for line in page_text.splitlines() if line.startswith("|")), default=0)
    return float(np.clip(widest * CHARACTER / WINDOW, 0.25, 0.5))


def write_comparison(scene: ViewedRun, recording: Recording, page_text: str, path: Path | str) -> Path:
    """The session of a scene beside a page of Markdown.

    recording gives the declaration, and the video where there is one; InputError where that cannot be read.
    """
    path = Path(path)
    with session_file(path, session_id("compare", scene.name, *(party.key for party in scene.parties))) as session:
        session.log("page", rr.TextDocument(page_text, media_type=rr.MediaType.MARKDOWN), static=True)
        shown = log_scene(session, scene, recording)
        text = rrb.TextDocumentView(origin="page", name="result")
        share = page_share(page_text)
        shares = [share, 1.0 - share]
        set_layout(session, blueprint_page(rrb.Horizontal(text, rrb.Tabs(run_page(shown)), column_shares=shares)))
    return path
