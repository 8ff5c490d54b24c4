"""`tentacle figure`: the paper's figures, drawn from any recording."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from tentacle.cli._output import say

if TYPE_CHECKING:
    from matplotlib.figure import Figure

HELP = "draw one of the paper's figures (3, 4, 5, 6, 8, 9, 10) from your own recordings"

FIGURES = {
    3: "the image processing of one frame",
    4: "the average period of q1, q2",
    5: "regression and simulation (needs --model)",
    6: "stills with the measured arm, and with --model the simulated arm",
    8: "the worst and the best of several recordings (needs --model)",
    9: "mean thrust over amplitude and frequency of a sine (needs --model; recordings give the measured thrust)",
    10: "swimming speeds: a CSV with the columns arm, motion, speed_m_s, one run a row",
}
SUFFIXES = (".svg", ".pdf", ".png")


def configure(parser: argparse.ArgumentParser) -> None:
    """Arguments of the verb."""
    words = "; ".join(f"{number}: {text}" for number, text in FIGURES.items())
    parser.add_argument("number", type=int, choices=tuple(FIGURES), metavar="NUMBER", help=words)
    parser.add_argument("inputs", nargs="*", type=Path, metavar="RECORDING", help="recordings (a CSV for figure 10)")
    parser.add_argument("--model", type=Path, metavar="model.toml", help="the model that identify or diagnose wrote")
    parser.add_argument(
        "--at", type=float, metavar="SECONDS", help="time of the frame in figure 3 (default: a strongly bent one)"
    )
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help="FILE.svg, FILE.pdf or FILE.png")


def run(arguments: argparse.Namespace) -> int:
    """Draw and write."""
    from tentacle.errors import InputError
    from viz.figures.style import save

    if arguments.out.suffix not in SUFFIXES:
        raise InputError("not a figure's name", file=arguments.out, field="--out", expected=" ".join(SUFFIXES))
    if not arguments.inputs and arguments.number != 9:
        raise InputError("nothing to draw", field="RECORDING", expected="at least one")
    if arguments.model is None and arguments.number in (5, 8, 9):
        raise InputError(f"figure {arguments.number} needs a model", field="--model", expected="--model model.toml")
    if arguments.at is not None and arguments.number != 3:
        raise InputError("only figure 3 shows one frame", field="--at", expected="figure 3")
    say(save(make_figure(arguments), arguments.out))
    return 0


def make_figure(arguments: argparse.Namespace) -> Figure:
    """The figure that was asked for."""
    from tentacle.cli.pages import paper_figures

    if arguments.number == 10:
        return paper_figures.speeds(arguments.inputs[0])
    if arguments.number == 3:
        return paper_figures.pipeline(arguments.inputs[0], arguments.at)
    from tentacle.cli._progress import stages
    from tentacle.io.model_file import read_model
    from vision.tracked_recording import read_tracked

    with stages() as stage:
        recordings = [read_tracked(path, stage) for path in arguments.inputs]
        stage(f"drawing figure {arguments.number}")
        if arguments.number == 4:
            return paper_figures.period(recordings[0])
        if arguments.number == 6:
            return paper_figures.stills(recordings[0], None if arguments.model is None else read_model(arguments.model))
        model = read_model(arguments.model)
        if arguments.number == 5:
            return paper_figures.regression_page(recordings[0], model)
        return (
            paper_figures.extremes(recordings, model)
            if arguments.number == 8
            else paper_figures.thrust(recordings, model)
        )
