"""`tentacle check`: compare every checksum, and report whether files are as they were written."""

from __future__ import annotations

import argparse
from pathlib import Path

from tentacle.cli._output import remark, say, say_text

HELP = "check the checksums of recordings, runs and results (exit code 0: all are sound, 2: not all)"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument("path", type=Path, metavar="FILE|FOLDER", help="an .rrd, an import folder, or a folder of any")
    parser.add_argument("--json", action="store_true", help="print the findings as JSON")


def run(arguments: argparse.Namespace) -> int:
    """Check and print; a file that is not sound is reported on standard error."""
    import json
    from dataclasses import asdict

    from rig.soundness import check_file
    from tentacle.errors import InputError

    findings = check_file(arguments.path)
    unsound = [finding for finding in findings if not finding.sound]
    if not findings:
        raise InputError("holds nothing that can be checked", file=arguments.path, expected="recordings or results")
    if arguments.json:
        say_text(json.dumps([{**asdict(finding), "file": str(finding.file)} for finding in findings], indent=1))
    else:
        for finding in findings:
            if finding.sound:
                say(f"sound  {finding.file}: {finding.words}")
    for finding in unsound[:1] if arguments.json else unsound:
        remark(f"not sound: {finding.words}")
    return 2 if unsound else 0
