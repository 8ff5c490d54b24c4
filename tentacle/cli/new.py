"""`tentacle new`: a folder for a recording, with a recording.toml full of comments."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from tentacle.cli._output import say
from tentacle.cli._questions import FLAGS, answers_of
from tentacle.errors import InputError

if TYPE_CHECKING:
    from tentacle.signals import MotorSignal

HELP = "begin a recording: a folder with a commented recording.toml, from five questions or flags"


def configure(parser: argparse.ArgumentParser) -> None:
    """A folder, the answers, and the film."""
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="folder of the new recording")
    for name, question, _ in FLAGS:
        parser.add_argument(f"--{name.replace('_', '-')}", type=float, metavar="X", help=question)
    parser.add_argument(
        "--video", type=Path, metavar="FILM", help="copy this film into the folder, and propose [camera] from it"
    )
    parser.add_argument(
        "--motor", type=Path, metavar="LOG",
        help="the servo's log as your own program wrote it (degrees, ms, semicolons, decimal commas): motor.csv of it",
    )  # fmt: skip
    parser.add_argument(
        "--motor-columns", nargs="+", metavar="NAME",
        help="names of LOG's columns: time, command and, if it was measured, angle; for a header that does not tell",
    )  # fmt: skip
    parser.add_argument("--motor-unit", choices=("rad", "deg"), help="unit of LOG's angles, where no name states it")


def run(arguments: argparse.Namespace) -> int:
    """Ask for the missing numbers, write the file, and print the next step."""
    from tentacle.io.recording_template import recording_text, require_usable, write_recording_file
    from tentacle.io.servo_log import write_motor_log

    if (arguments.folder / "recording.toml").exists():  # the files are checked before the questions
        write_recording_file(arguments.folder, "")
    if arguments.video is not None:
        from vision.film_begun import require_film

        require_film(arguments.video)
    motor = None if arguments.motor is None else _motor_log(arguments)
    answers, words = answers_of(arguments), ""
    require_usable(answers)
    if arguments.video is not None:
        from vision.film_begun import begun

        answers, words = begun(answers, arguments.video, arguments.folder)
    if motor is not None:
        write_motor_log(motor, arguments.folder / "motor.csv")
    file = write_recording_file(arguments.folder, recording_text(answers))
    say(f"wrote {file}")
    if words:
        say(words)
    if answers.camera is None:
        line = f"tentacle import {arguments.folder} --out my_arm.rrd"
        say(f"put the film beside it as video.mp4, fill in [camera], then: {line}")
    else:
        if not (arguments.folder / "motor.csv").exists():
            say("a servo turns the base? begin again with --motor LOG: without a log the base counts as clamped")
        say(f"next: tentacle diagnose {arguments.folder} --out answer")
    return 0


def _motor_log(arguments: argparse.Namespace) -> MotorSignal:
    """The servo's log in s and rad; what was read as what is printed. InputError where the folder has a log already."""
    from tentacle.io.servo_log import ServoColumns, read_servo_log

    columns, target = arguments.motor_columns, arguments.folder / "motor.csv"
    if columns is not None and not 2 <= len(columns) <= 3:
        expected = "TIME COMMAND, or TIME COMMAND ANGLE"
        raise InputError(f"{len(columns)} names", field="--motor-columns", expected=expected)
    if target.exists():
        raise InputError("is there already", file=target, field="--motor", expected="a folder without one")
    motor, words = read_servo_log(arguments.motor, ServoColumns(columns, arguments.motor_unit))
    say(words)
    return motor
