"""tentacle import: a lab's folder becomes one .rrd file that holds everything."""

from __future__ import annotations

import argparse
from pathlib import Path

from tentacle.cli._output import say, say_text

HELP = "check a lab's folder (video, midline or markers, with logs) and store it as one .rrd file"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument("recording", type=Path, metavar="RECORDING", help="import folder, or an .rrd to check again")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.rrd", help="where to store it")
    parser.add_argument("--json", action="store_true", help="print what was found as JSON")


def run(arguments: argparse.Namespace) -> int:
    """Read, check, write; then print the content."""
    import json

    from tentacle.errors import InputError
    from tentacle.io.reading import read_recording
    from tentacle.io.recording_rrd import write_rrd
    from tentacle.io.recording_summary import summarise
    from tentacle.slips import find_slips

    if arguments.out.suffix != ".rrd":
        raise InputError("not an .rrd name", file=arguments.out, field="--out", expected="FILE.rrd")
    recording = read_recording(arguments.recording)
    if recording.declaration.specimen.laws:
        from affine_model.declared_laws import refuse_unknown_laws

        refuse_unknown_laws(recording.declaration.specimen, f"{arguments.recording}/recording.toml")
    write_rrd(recording, arguments.out)
    summary = summarise(recording)
    if arguments.json:
        say_text(json.dumps({"file": str(arguments.out), "name": recording.name, "signals": summary}, indent=1))
    else:
        for line in summary.values():
            say(line)
        for slip in find_slips(recording):
            say(f"check: {slip.line()}")
        say(f"wrote {arguments.out}")
    return 0
