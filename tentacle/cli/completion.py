"""`tentacle completion`: what a shell needs to complete verbs, options and files."""

from __future__ import annotations

import argparse
from pathlib import Path

from tentacle.cli._output import say_text

HELP = "print a script that makes a shell complete verbs, options and files"
SHELLS = ("bash", "zsh", "tcsh")


def configure(parser: argparse.ArgumentParser) -> None:
    """The shell."""
    parser.add_argument("shell", choices=SHELLS, help='in bash: eval "$(tentacle completion bash)"')


def run(arguments: argparse.Namespace) -> int:
    """Print the script."""
    import shtab

    from tentacle.cli import build_parser

    parser = build_parser()
    _complete_files(parser)
    say_text(shtab.complete(parser, shell=arguments.shell))
    return 0


def _complete_files(parser: argparse.ArgumentParser) -> None:
    """Every argument that is a path is completed as a file, in this parser and in its verbs'."""
    import shtab

    for action in parser._actions:
        if action.type is Path:
            action.complete = shtab.FILE  # type: ignore[attr-defined]
        if isinstance(action, argparse._SubParsersAction):
            for verb in action.choices.values():
                _complete_files(verb)
