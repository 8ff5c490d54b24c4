"""tentacle compare: the reduced model against the MuJoCo reference, rung by rung, and the map of where it may be
trusted."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tentacle.cli._ladder import Ladder
    from tentacle.cli._validity import Validity
    from tentacle.model import Model

HELP = "hold the affine model (orders 2, 3, 4) against the MuJoCo reference: a ladder of checks and a validity map"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument("models", type=Path, nargs="+", metavar="MODEL.toml", help="one arm, or a grid of them")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="report.html, session.rrd, tables")
    parser.add_argument(
        "--amplitude", type=float, default=0.4, metavar="RAD", help="of the driven motion, default: 0.4"
    )
    parser.add_argument("--frequency", type=float, metavar="HZ", help="of it, default: 0.6 of the first mode")
    parser.add_argument("--no-map", action="store_true", help="the ladder alone, without the validity map")
    parser.add_argument(
        "--tapers", type=float, nargs="*", default=(), metavar="R", help="further r_tip/r0 to map, besides its own"
    )
    parser.add_argument("--workers", type=int, metavar="N", help="processes of the map, default: one a core")
    parser.add_argument("--cluster", metavar="ADDRESS", help="a Dask scheduler instead, tcp://HOST:PORT")


def run(arguments: argparse.Namespace) -> int:
    """Climb the ladder for every model, draw the map, write what was found."""
    from rich.console import Console

    from tentacle.cli._ladder import climb
    from tentacle.cli._validity import validity_maps, write_cells
    from tentacle.errors import InputError
    from tentacle.model_file import read_model
    from tentacle.runner import Runner

    for name in ("amplitude", "frequency"):
        number = getattr(arguments, name)
        if number is not None and not number > 0.0:
            raise InputError(f"{number!r} is not usable", field=f"--{name}", expected="above 0")
    models = {file: read_model(file) for file in arguments.models}
    if len({file.stem for file in models}) < len(models):
        raise InputError("two models share a file name", field="MODEL.toml", expected="names that differ")
    console = Console(stderr=True)
    for file, model in models.items():
        out = arguments.out if len(models) == 1 else arguments.out / file.stem
        out.mkdir(parents=True, exist_ok=True)
        with console.status(f"{file.stem}: ladder"):
            ladder = climb(model, arguments.amplitude, arguments.frequency)
        maps = []
        if not arguments.no_map:
            runner = Runner(out / "cells", arguments.workers, arguments.cluster)
            maps = validity_maps(model, tuple(arguments.tapers), runner)
            write_cells(maps, out / "validity.csv")
        _write_table(ladder, out / "ladder.csv")
        _write_page(file, model, ladder, maps, out)
        _write_session(file.stem, model, ladder, out / "session.rrd")
        _print(file.stem, ladder, maps)
        print(f"wrote {out}/report.html, session.rrd, ladder.csv" + ("" if arguments.no_map else ", validity.csv"))
    return 0


def _rows(ladder: Ladder) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """The ladder as texts: a header and rows."""
    from tentacle.cli._ladder import LINKS, ORDERS

    header = ("rung", "unit", "theory", *(f"{n} links" for n in LINKS), *(f"order {o}" for o in ORDERS))
    header += tuple(f"error {o}" for o in ORDERS)
    rows = []
    for rung in ladder.rungs:
        errors = (
            f"{rung.error(o):.3g} {rung.unit}" if rung.absolute else f"{100 * rung.error(o):.2g} %" for o in ORDERS
        )
        numbers = [rung.reference[n] for n in LINKS] + [rung.affine[o] for o in ORDERS]
        theory = "" if rung.theory is None else f"{rung.theory:.5g}"
        rows.append((rung.name, rung.unit, theory, *(f"{number:.5g}" for number in numbers), *errors))
    return header, rows


def _write_table(ladder: Ladder, file: Path) -> None:
    import csv

    from tentacle.cli._ladder import LINKS, ORDERS

    header = ["rung", "unit", "theory", *(f"reference_{n}_links" for n in LINKS), *(f"affine_{o}" for o in ORDERS)]
    with file.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(header)
        for rung in ladder.rungs:
            numbers = [rung.reference[n] for n in LINKS] + [rung.affine[o] for o in ORDERS]
            writer.writerow(
                [rung.name, rung.unit, "" if rung.theory is None else repr(rung.theory), *map(repr, numbers)]
            )


def headline(maps: list[Validity]) -> str:
    """Whether the reduced model serves, in a sentence, from the arm's own map."""
    from tentacle.cli._validity import AMPLITUDES

    if not maps:
        return "The reduced model beside the reference; the table says by how much they differ."
    own, middle = maps[0], len(AMPLITUDES) // 2
    parts = []
    for level in (0.01, 0.05):
        reach = own.reach(2, level, middle)
        upto = f"up to {reach:g} of the first mode ({reach * own.first:.2g} Hz)" if reach else "nowhere on the map"
        parts.append(f"within {100 * level:.0f} % {upto}")
    return f"At {AMPLITUDES[middle]:g} rad, two coordinates follow this arm's shape " + ", ".join(parts) + "."


def _write_page(file: Path, model: Model, ladder: Ladder, maps: list[Validity], out: Path) -> None:
    import sys

    from tentacle.cli._provenance import input_hashes, versions
    from tentacle.cli._validity import AMPLITUDES, LEVELS, RATIOS
    from tentacle.cli._validity import ORDERS as MAPPED
    from viz.figures.shapes import shapes_figure
    from viz.figures.validity_map import validity_figure
    from viz.report import Origin, Picture, Report, Section, Table, render, write_report

    header, rows = _rows(ladder)
    words = (
        "The reference is a hinge chain in MuJoCo with its own section forces; it shares no equation with the reduced"
        " model. Errors are against it at the most links; how it changes with the links says how far it is converged.",
        f"Driven motion: {ladder.amplitude:g} rad at {ladder.frequency:.3g} Hz, from rest; the last two of 8."
        " Its error is rms over the arm.",
    )
    if ladder.third_opinion is not None:
        opinion = f"PyElastica's Cosserat rod, which also shears: first frequency in air {ladder.third_opinion:.4g} Hz."
        words = (*words, opinion)
    picture = Picture(shapes_figure(_scene(file.stem, model, ladder)), "Shapes of the driven motion at some instants.")
    table = Table("reference and reduced model", header, rows, numeric=tuple(range(2, len(header))))
    sections = [Section("Ladder", words, (table,), (picture,))]
    for found in maps:
        errors: dict[str, Any] = {f"shape, order {o}": found.shape[i] for i, o in enumerate(MAPPED)}
        if model.fluid.density > 0.0:
            errors |= {f"mean thrust, order {o}": found.thrust[i] for i, o in enumerate(MAPPED)}
        mode = ", ".join(f"{100 * e:.2g} % at order {o}" for e, o in zip(found.frequency, MAPPED, strict=True))
        reach = [
            (str(o), f"{100 * level:.0f} %", *(f"{found.reach(o, level, a):g}" for a in range(len(AMPLITUDES))))
            for o in MAPPED
            for level in LEVELS
        ]
        limits = Table(
            "largest frequency / first mode up to which the shape stays within the error, by amplitude",
            ("order", "error", *(f"{a:g} rad" for a in AMPLITUDES)),
            reach,
            numeric=tuple(range(2, 2 + len(AMPLITUDES))),
        )
        low, high = found.flexibility.min(), found.flexibility.max()
        sections.append(
            Section(
                f"Validity, taper {found.taper:.3g}",
                (
                    f"First mode in the fluid: {found.first:.3g} Hz; the reduced model's is off by {mode}.",
                    "Shape: rms distance of the midlines over the tip's rms motion. Thrust: of the mean over 2 periods;"
                    " blank where the mean is under 1 % of the load's rms.",
                    f"Drag over stiffness, rho w (2 pi f theta L)^2 L^3 / (2 E I0), runs from {low:.2g} to {high:.2g}.",
                ),
                (limits,),
                (Picture(validity_figure(RATIOS, AMPLITUDES, errors, LEVELS), "Lines: 1, 5 and 10 %."),),
            )
        )
    origin = Origin(
        "tentacle " + " ".join(sys.argv[1:]),
        versions=versions(),
        inputs=input_hashes([file]),
    )
    merits = [(f"{rung.name}, order 2", row[-3]) for rung, row in zip(ladder.rungs, rows, strict=True)][:4]
    report = Report("compare", f"Reduced model and reference: {file.stem}", headline(maps), sections, origin, merits)
    write_report(render(report), out / "report.html")


def _scene(name: str, model: Model, ladder: Ladder) -> Any:
    from affine_model.arm import arm_of, parameter_vector
    from affine_model.drag_along import drag_along as affine_drag
    from mujoco_ref.drag_along import drag_along as reference_drag
    from tentacle.cli._twins import S
    from viz.compare import Motion, motions_scene

    reference, wet = ladder.reference, model.fluid.density > 0.0
    drag = reference_drag(model, reference.t, S, reference.xy) if wet else None
    motions = {"reference": Motion(reference.xy, reference.q, reference.load, drag)}
    arm, parameters = arm_of(model), parameter_vector(model)
    for order, twin in ladder.affine.items():
        drag = affine_drag(arm, parameters, twin.t, S, twin.xy) if wet else None
        motions[f"order {order}"] = Motion(twin.xy, twin.q, twin.load, drag)
    return motions_scene(name, reference.t, S, reference.theta, motions)


def _write_session(name: str, model: Model, ladder: Ladder, file: Path) -> None:
    from tentacle.recording import Declaration, Recording
    from viz.compare import write_comparison

    header, rows = _rows(ladder)
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    recording = Recording(name, Declaration(model.specimen, model.fluid, model.gravity))
    write_comparison(
        _scene(name, model, ladder), recording, "# Reference and reduced model\n\n" + "\n".join(lines) + "\n", file
    )


def _print(name: str, ladder: Ladder, maps: list[Validity]) -> None:
    from rich.console import Console
    from rich.table import Table

    header, rows = _rows(ladder)
    table = Table(title=name)
    for i, title in enumerate(header):
        table.add_column(title, justify="left" if i < 2 else "right", no_wrap=i >= 2)
    for row in rows:
        table.add_row(*row)
    Console(width=None if Console().is_terminal else 160).print(table)
    if ladder.third_opinion is not None:
        print(f"PyElastica: first frequency in air {ladder.third_opinion:.4g} Hz")
    if maps:
        print(headline(maps))
