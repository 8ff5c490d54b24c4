"""The arguments of `tentacle track`, and which of them go together."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

PLAIN = ("length", "base_radius", "tip_radius", "base_px", "m_per_px", "fps", "exposure")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument(
        "source",
        type=Path,
        nargs="+",
        metavar="VIDEO|RECORDING",
        help="a video, a folder of frames, or a recording; several of them, or a folder that holds them",
    )
    parser.add_argument(
        "--out", type=Path, metavar="FILE", help="FILE.csv, or FILE.rrd with everything in it; of several: a folder"
    )
    parser.add_argument(
        "--midline", type=Path, metavar="FILE", help="midlines too: .csv (reads back as midline.csv) or .h5"
    )
    parser.add_argument(
        "--order", type=int, choices=(1, 2, 3, 4, 5), help="curvature coordinates (default: 2 to 5, by the data)"
    )
    parser.add_argument(
        "--overlay", type=Path, metavar="FILE", help="the fit drawn over the video (.mp4) or over nine frames (.png)"
    )
    parser.add_argument("--lens", type=Path, metavar="FILE.toml", help="lens, as tentacle calibrate writes it")
    parser.add_argument("--paper", action="store_true", help="use the paper's method (Fig. 3) instead: the baseline")
    parser.add_argument(
        "--live",
        type=float,
        default=0.0,
        metavar="S",
        help="the file is still being written: print each new frame; stop if there is none for S seconds",
    )
    parser.add_argument("--json", action="store_true", help="print the summary as JSON")
    parser.add_argument(
        "--workers", type=int, metavar="N", help="of several videos: how many at a time (default: cores)"
    )
    hand = parser.add_argument_group("by hand (kept in VIDEO.proofread.toml, so that the next run knows)")
    hand.add_argument("--reject", action="append", default=[], metavar="FRAMES", help="frames to reject: 120-131,140")
    hand.add_argument(
        "--accept",
        action="append",
        default=[],
        metavar="FRAMES",
        help="frames to accept although the tracker rejects them",
    )
    plain = parser.add_argument_group("a plain video (not a recording)")
    plain.add_argument(
        "--pick",
        action="store_true",
        help="find base, direction, widths and scale; write recording.toml (needs --length)",
    )
    plain.add_argument("--yes", action="store_true", help="take what --pick finds without asking")
    plain.add_argument(
        "--length", type=float, metavar="M", help="length of the arm, clamp to the tip of the silicone [m]"
    )
    plain.add_argument("--base-radius", type=float, metavar="M", help="radius at the base [m] (default: found)")
    plain.add_argument("--tip-radius", type=float, metavar="M", help="radius at the tip [m] (default: found)")
    plain.add_argument(
        "--base-px", type=float, nargs=2, metavar=("U", "V"), help="the base in the picture (default: found)"
    )
    plain.add_argument("--m-per-px", type=float, metavar="M", help="scale (default: from the length, or the lens file)")
    plain.add_argument("--fps", type=float, help="frame rate of a folder of pictures [1/s]")
    plain.add_argument(
        "--exposure", type=float, default=0.0, metavar="S", help="how long the shutter is open [s] (default: 0)"
    )


def check_outputs(arguments: argparse.Namespace) -> None:
    """InputError where options contradict each other, or a name does not say what to write."""
    from tentacle.errors import InputError

    if arguments.live < 0 or (arguments.live and (arguments.paper or arguments.json)):
        raise InputError("--live is for frames as they come", field="--live", expected="seconds, no --paper or --json")
    if arguments.midline is not None and arguments.midline.suffix not in (".csv", ".h5"):
        raise InputError("not a name that says what to write", file=arguments.midline, expected=".csv or .h5")
    if arguments.out.suffix not in (".csv", ".rrd"):
        raise InputError(
            "not a name that says what to write", file=arguments.out, field="--out", expected=".csv or .rrd"
        )
    if arguments.overlay is not None and arguments.overlay.suffix not in (".mp4", ".png"):
        raise InputError("not a picture or video", file=arguments.overlay, field="--overlay", expected=".mp4 or .png")
    if arguments.overlay is not None and arguments.paper:
        raise InputError("the paper's method has no overlay", field="--overlay", expected="--overlay without --paper")
    for path in (arguments.out, arguments.overlay, arguments.midline):
        if path is not None and not path.absolute().parent.is_dir():
            raise InputError("there is no such folder", file=path.absolute().parent, expected="a folder to write to")
    if arguments.out.suffix == ".rrd":
        from tentacle.io.recording_rrd import require_replaceable

        require_replaceable(arguments.out)


def check_plain(arguments: argparse.Namespace, sources: Sequence[Path]) -> None:
    """InputError where an option for plain videos is given and every source is a recording, which states it itself."""
    from tentacle.errors import InputError
    from vision.declared import is_recording

    given = [name for name in PLAIN if getattr(arguments, name)]
    if given and all(map(is_recording, sources)):
        field = "--" + given[0].replace("_", "-")
        raise InputError("is for a plain video", file=sources[0], field=field, expected="it in recording.toml")
