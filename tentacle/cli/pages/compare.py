"""What `tentacle compare` writes for one arm: the ladder and the validity map as a page and as a session."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from tentacle.cli.pages.validity import validity_sections
from validation.ladder_table import ladder_rows

if TYPE_CHECKING:
    from tentacle.model import Model
    from validation.ladder import Ladder
    from validation.validity_map import Validity

WITHOUT_MAP = "The table gives the difference between the reduced model and the reference."


def write_compare_page(file: Path, model: Model, ladder: Ladder, maps: list[Validity], page: Path) -> None:
    """The report of one arm."""
    import sys

    from tentacle.io.provenance import input_hashes, versions
    from validation.validity_advice import sentence
    from viz.figures.shapes import shapes_figure
    from viz.report import Origin, Picture, Report, ReportSection, ReportTable, render_report, write_report

    both = ladder_rows(ladder)
    words = (
        "The reference is a hinge chain in MuJoCo with its own section forces; it shares no equation with the reduced"
        " model. Errors are differences from the reference with the most links. Still open: the reference's own error"
        " with those links, estimated as a third of the last change. A smaller error has no meaning.",
        f"Driven motion: {ladder.amplitude:g} rad at {ladder.frequency:.3g} Hz, from rest; the last two of 8."
        " Its error is rms over the arm.",
    )
    if ladder.third_opinion is not None:
        opinion = f"PyElastica's Cosserat rod, which also shears: first frequency in air {ladder.third_opinion:.4g} Hz."
        words = (*words, opinion)
    picture = Picture(shapes_figure(_scene(file.stem, model, ladder)), "Shapes of the driven motion at some instants.")
    tables = tuple(ReportTable(t.title, t.header, t.rows, numeric=tuple(range(2, len(t.header)))) for t in both)
    sections = [ReportSection("Ladder", words, tables, (picture,)), *validity_sections(model, maps)]
    origin = Origin("tentacle " + " ".join(sys.argv[1:]), versions=versions(), inputs=input_hashes([file]))
    merits = [(f"{rung.name}, order 2", row[-3]) for rung, row in zip(ladder.rungs, both[1].rows, strict=True)][:4]
    headline = sentence(maps[0]) if maps else WITHOUT_MAP
    report = Report("compare", f"Reduced model and reference: {file.stem}", headline, sections, origin, merits)
    write_report(render_report(report), page)


def _scene(name: str, model: Model, ladder: Ladder) -> Any:
    from affine_model.arm import arm_of, parameter_vector
    from affine_model.drag_along import drag_along as affine_drag
    from mujoco_ref.drag_along import chain_drag_along as reference_drag
    from validation.model_pair import S
    from viz.compare import ComparedMotion, motions_scene

    reference, wet = ladder.reference, model.fluid.density > 0.0
    drag = reference_drag(model, reference.t, S, reference.xy) if wet else None
    motions = {"reference": ComparedMotion(reference.xy, reference.q, reference.load, drag)}
    arm, parameters = arm_of(model), parameter_vector(model)
    for order, twin in ladder.affine.items():
        drag = affine_drag(arm, parameters, twin.t, S, twin.xy) if wet else None
        motions[f"order {order}"] = ComparedMotion(twin.xy, twin.q, twin.load, drag)
    return motions_scene(name, reference.t, S, reference.theta, motions)


def write_compare_session(name: str, model: Model, ladder: Ladder, maps: list[Validity], file: Path) -> None:
    """Both models' arms in 3D, over one another, beside the reduced model's errors; the report has all numbers."""
    from tentacle.recording import Declaration, Recording
    from validation.validity_advice import sentence
    from viz.compare import write_comparison
    from viz.topics.verdict import text_table

    reduced = ladder_rows(ladder)[1]
    errors = [k for k, name in enumerate(reduced.header) if k == 0 or name.startswith("error")]
    header, *rows = [tuple(row[k] for k in errors) for row in (reduced.header, *reduced.rows)]
    table = text_table(header, rows)
    recording = Recording(name, Declaration(model.specimen, model.fluid, model.gravity))
    answer = sentence(maps[0]) if maps else WITHOUT_MAP
    text = f"# Reference and reduced model\n\n{answer}\n\nErrors of orders 2 to 4:\n\n{table}\n"
    write_comparison(_scene(name, model, ladder), recording, text, file)
