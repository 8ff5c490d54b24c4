"""tentacle render: a test video whose truth is known."""

from __future__ import annotations

import argparse
from pathlib import Path

from tentacle.cli._output import say

HELP = "render a test video of a swaying arm, or of a recording's midline; the truth is written to a separate file"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument(
        "recording",
        type=Path,
        nargs="?",
        metavar="RECORDING",
        help="recording whose midline is rendered (default: a swaying cone)",
    )
    parser.add_argument(
        "--out", type=Path, required=True, metavar="FOLDER", help="import folder to write; FOLDER.truth.csv beside it"
    )
    parser.add_argument(
        "--look", default="clean", help="clean (default), light_arm, uneven, bubbles, faint, tank, tank_lens, mujoco"
    )
    parser.add_argument("--seed", type=int, required=True, help="the same seed gives the same video")
    parser.add_argument("--size", type=int, nargs=2, default=(1280, 720), metavar=("W", "H"), help="picture size [px]")
    parser.add_argument(
        "--compress", type=int, default=0, metavar="CRF", help="H.264 quality, 0 lossless (default) to 51"
    )
    swaying = parser.add_argument_group("the swaying cone")
    swaying.add_argument("--seconds", type=float, default=4.0, help="duration (default: 4)")
    swaying.add_argument("--fps", type=float, default=60.0, help="frames per second (default: 60)")
    swaying.add_argument(
        "--order", type=int, choices=(1, 2, 3, 4, 5), default=2, help="curvature coordinates (default: 2)"
    )
    swaying.add_argument(
        "--amplitude", type=float, default=0.9, metavar="RAD", help="size of the curvature (default: 0.9)"
    )
    swaying.add_argument(
        "--frequency", type=float, default=0.6, metavar="HZ", help="frequency of the sway (default: 0.6)"
    )
    swaying.add_argument("--exposure", type=float, default=0.004, metavar="S", help="shutter time (default: 0.004)")


def run(arguments: argparse.Namespace) -> int:
    """Render, write the import folder, its truth and, where the look has one, its lens."""
    import os

    if arguments.look == "mujoco":
        os.environ.setdefault("MUJOCO_GL", "egl")  # MuJoCo reads it when it is imported
    from tentacle.errors import InputError
    from tentacle.io.reading import read_recording
    from validation.rendered_video import RenderOptions, Sway, recorded_subject, swaying_subject, write_test_video

    size, out = arguments.size, arguments.out
    if min(size) < 16 or not 0 <= arguments.compress <= 51:
        raise InputError("cannot be rendered", field="--size, --compress", expected="16 px or more, and 0 to 51")
    for name in ("seconds", "fps", "frequency"):
        if not getattr(arguments, name) > 0:
            raise InputError(f"{getattr(arguments, name)} is not usable", field=f"--{name}", expected="above zero")
    options = RenderOptions(arguments.look, tuple(arguments.size), arguments.seed, arguments.compress)
    if arguments.recording is None:
        sway = Sway(
            arguments.seconds, arguments.fps, arguments.order, arguments.amplitude, arguments.frequency,
            arguments.exposure,
        )  # fmt: skip
        subject = swaying_subject(out.name, sway, options)
    else:
        subject = recorded_subject(read_recording(arguments.recording))
    count = write_test_video(subject, options, out)
    say(f"wrote {count} frames to {out}, the truth to {out.name}.truth.csv")
    return 0
