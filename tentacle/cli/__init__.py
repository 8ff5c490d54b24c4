"""The command line: one file in this folder for each verb, each a thin call into one room.

A verb's file has HELP (one line), configure(parser) and run(arguments) -> exit code; it imports heavy libraries inside
run only, so that --help is quick. _endings has the ends of a command (_stop_signals: by a signal), _bounds the limits
of its numbers.
"""

from __future__ import annotations

import argparse
import logging
import os
import shutil
import sys
from collections.abc import Sequence
from difflib import get_close_matches
from importlib import import_module, metadata
from pathlib import Path
from typing import Any, NoReturn

from tentacle.cli._bounds import require_sane
from tentacle.cli._effects import effects_in_use
from tentacle.cli._endings import told
from tentacle.cli._output import begin_output, remark, require_taken
from tentacle.cli._outputs import outputs_of
from tentacle.cli._stop_signals import signals_as_interrupts
from tentacle.errors import InputError, printable
from tentacle.io.output_lock import owned_outputs
from tentacle.limited_memory import require_memory

DESCRIPTION = """\
Two models of a soft arm in a tank, side by side with measured data, and the loop that finds what a model lacks.
A RECORDING is an import folder (recording.toml with a video, a midline or markers) or an .rrd file."""
EPILOG = "`tentacle VERB --help` says more. Exit codes: 0 done, 2 bad input (one line says what), 130 stopped (Ctrl-C)."


class _HelpFormatter(argparse.RawDescriptionHelpFormatter):
    """Verbs and what they do side by side, one verb a line where the terminal is wide enough."""

    def __init__(self, prog: str) -> None:
        super().__init__(prog, max_help_position=16, width=min(shutil.get_terminal_size().columns, 120))
        self._action_max_length = 14  # argparse of Python 3.11 forgets that verbs are indented


class _Parser(argparse.ArgumentParser):
    """A parser that reports an error in one line, also for its verbs."""

    def error(self, message: str) -> NoReturn:
        """The line, and exit code 2."""
        self.exit(2, f"{self.prog}: {printable(message)}; see {self.prog} --help\n")

    def _print_message(self, message: str, file: Any = None) -> None:
        """argparse's own keeps a full disk to itself. OSError where the message cannot be written."""
        print(message, end="", file=file or sys.stderr, flush=True)


def verb_names() -> list[str]:
    """The verbs, found by listing this folder."""
    return sorted(file.stem for file in Path(__file__).parent.glob("*.py") if not file.stem.startswith("_"))


def build_parser() -> argparse.ArgumentParser:
    """The parser of all verbs."""
    parser = _Parser(
        prog="tentacle",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=_HelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=f"tentacle-twin {_version()}")
    verbs = parser.add_subparsers(title="verbs", metavar="VERB", required=True)
    for name in verb_names():
        module = import_module(f"{__name__}.{name}")
        verb = verbs.add_parser(name, help=module.HELP, description=module.HELP, allow_abbrev=False)
        module.configure(verb)
        verb.set_defaults(run=module.run)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one verb; the exit code."""
    os.environ.setdefault("RUST_LOG", "off")  # what Rerun has to say of a full disk, we say in one line
    os.environ["MPLBACKEND"] = "agg"  # a command opens no window
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # of a cache that it cannot write, it says two lines
    sys.stdout.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]  # a terminal may know no Greek
    words = list(sys.argv[1:] if arguments is None else arguments)
    if words and not words[0].startswith("-") and words[0] not in verb_names():
        remark(_unknown_verb(words[0]))
        return 2
    begin_output()
    with signals_as_interrupts() as asked, told(asked) as outcome:
        parsed = build_parser().parse_args(words)
        require_sane(parsed)
        require_memory()
        with owned_outputs(outputs_of(parsed)), effects_in_use(parsed):
            outcome.code = parsed.run(parsed)
        require_taken()
    return outcome.code


def _unknown_verb(word: str) -> str:
    """The error about a first word that is not a verb."""
    close = get_close_matches(word, verb_names(), n=1)
    hint = f"did you mean {close[0]}?" if close else "`tentacle --help` lists them"
    return InputError(f"unknown verb; {hint}", field=word).line()


def _version() -> str:
    try:
        return metadata.version("tentacle-twin")
    except metadata.PackageNotFoundError:  # run from a checkout that is not installed
        return "(not installed)"
