"""Body of `tentacle rig calibrate`: a dialogue on the terminal, then the new RIG.toml."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from tentacle.cli._output import say, say_text
from tentacle.errors import InputError

if TYPE_CHECKING:
    from rig.board import Board


def calibrate(arguments: argparse.Namespace) -> int:
    """Calibrate one part and write it into RIG.toml."""
    from rig import bench_calibration as bench
    from rig.setup_file import read_setup, write_setup

    setup = read_setup(arguments.rig)
    if arguments.part == "load-cell":
        changed = bench.calibrated_load_cell(
            setup, arguments.masses, arguments.seconds, pulls_back=arguments.pulls_back, say=say, ask=_ask
        )
    elif arguments.part == "servo":
        changed = bench.calibrated_servo(setup, arguments.angles, arguments.seconds, say=say, ask=_ask)
    elif arguments.part == "camera-scale":
        changed = bench.calibrated_scale(setup, arguments.points, arguments.metres, say=say)
    else:
        changed = bench.calibrated_offset(setup, arguments.flashes, tap=arguments.tap, say=say)
    write_setup(changed, arguments.rig)
    say(f"wrote {arguments.rig}")
    return 0


def _ask(question: str, board: Board) -> str:
    """Ask on the terminal; the board is served meanwhile, so that its watchdog does not act."""
    import threading

    answers: list[str] = []
    say_text(f"{question}; then Enter: ", end="")
    thread = threading.Thread(target=lambda: answers.append(sys.stdin.readline()), daemon=True)
    thread.start()
    while thread.is_alive():
        board.service(0.02)
    if not answers or not answers[0]:
        raise InputError("the terminal gave no answer", expected="a line on standard input")
    return answers[0].strip()
