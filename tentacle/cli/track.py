"""tentacle track: from videos to shapes with their covariance."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from vision.track import Following

if TYPE_CHECKING:
    from tentacle.recording import Recording
    from tentacle.signals import ShapeTrack
    from vision.follow import Seen
    from vision.track import Tracking

HELP = "follow the arm through a video: curvature coordinates with their covariance, frame by frame"


def configure(parser: argparse.ArgumentParser) -> None:
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
        help="the file is still being written: print each frame as it comes, stop where nothing comes for S seconds",
    )
    parser.add_argument("--json", action="store_true", help="print the summary as JSON")
    parser.add_argument(
        "--workers", type=int, metavar="N", help="of several videos: how many at a time (default: cores)"
    )
    hand = parser.add_argument_group("by hand (kept in VIDEO.proofread.toml, so that the next run knows)")
    hand.add_argument(
        "--reject", action="append", default=[], metavar="FRAMES", help="frames that are wrong: 120-131,140"
    )
    hand.add_argument("--accept", action="append", default=[], metavar="FRAMES", help="frames that are right after all")
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
    plain.add_argument("--base-radius", type=float, metavar="M", help="radius at the base [m]")
    plain.add_argument("--tip-radius", type=float, metavar="M", help="radius at the tip [m]")
    plain.add_argument(
        "--base-px", type=float, nargs=2, metavar=("U", "V"), help="the base in the picture (default: found)"
    )
    plain.add_argument("--m-per-px", type=float, metavar="M", help="scale (default: from the length, or the lens file)")
    plain.add_argument("--fps", type=float, help="frame rate of a folder of pictures [1/s]")
    plain.add_argument(
        "--exposure", type=float, default=0.0, metavar="S", help="how long the shutter is open [s] (default: 0)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Read, track, write, say what was found."""
    from tentacle.cli._track_sources import picked_recording, several
    from tentacle.errors import InputError
    from vision.batch import sources_of

    sources = arguments.source if len(arguments.source) == 1 and arguments.live else sources_of(arguments.source)
    if len(sources) > 1 or sources != arguments.source:
        return several(sources, arguments)
    if arguments.pick:
        source = picked_recording(sources[0], arguments)
        if arguments.out is None:
            return 0
        return _one(source, arguments)
    if arguments.out is None:
        raise InputError("says where the shapes go, and is missing", field="--out", expected="FILE.csv or FILE.rrd")
    return _one(sources[0], arguments)


def _one(source: Path, arguments: argparse.Namespace) -> int:
    from tentacle.cli._track_sources import numbers_of
    from tentacle.errors import InputError
    from vision.declared import recording_of
    from vision.lens_file import read_lens
    from vision.midline_file import write_midline
    from vision.paper_pipeline import paper_track
    from vision.proofread import decided
    from vision.shape_file import write_shape
    from vision.track import motor_angle

    _check_outputs(arguments)
    lens = None if arguments.lens is None else read_lens(arguments.lens)
    recording = recording_of(source, numbers_of(arguments), lens)
    if recording.video is None:
        raise InputError("the recording has no video", file=source, expected="video.mp4 or frames/")
    video, tracked = recording.video.path, None
    if arguments.paper:
        shape = paper_track(video, recording.declaration, recording.motor)
    else:
        tracked = _tracked(recording, arguments, lens, decided(video, arguments.reject, arguments.accept))
        shape = tracked.shape
    if arguments.out.suffix == ".rrd":
        _write_rrd(recording, shape, arguments.out)
    else:
        write_shape(shape, arguments.out)
    if arguments.midline is not None:
        angle = motor_angle(recording.motor, shape.t)
        write_midline(shape, angle, recording.declaration.specimen, arguments.midline)
    if arguments.overlay is not None:
        _draw(arguments.overlay, video, recording, () if tracked is None else tracked.seen)
    _report(source, recording, shape, tracked, arguments)
    return 0


def _tracked(recording: Recording, arguments: argparse.Namespace, lens: object, verdicts: dict[int, bool]) -> Tracking:
    """Track with a bar, or each frame's line where it is live; warnings go to standard error at once."""
    import sys

    from rich.console import Console
    from rich.progress import Progress

    from vision.track import track_fully

    assert recording.video is not None
    with Progress(console=Console(stderr=True), disable=arguments.json, transient=True) as progress:
        task = progress.add_task("tracking", total=None)
        return track_fully(
            recording.video.path,
            recording.declaration,
            recording.motor,
            Following(arguments.order, lens, arguments.live, verdicts=verdicts, outlines=arguments.overlay is not None),
            _say
            if arguments.live
            else lambda result: progress.update(task, advance=1, description=f"tracking {result.t:.2f} s"),
            warn=lambda words: print(f"tentacle: {words}", file=sys.stderr, flush=True),
        )


def _report(
    source: Path, recording: Recording, shape: ShapeTrack, tracked: Tracking | None, arguments: argparse.Namespace
) -> None:
    """The summary, as words or JSON."""
    import json

    from vision.declared import is_recording
    from vision.proofread import most_doubtful

    doubtful = [] if tracked is None else most_doubtful(tracked.seen)
    remarks = () if tracked is None else tracked.remarks
    summary = {
        "frames": len(shape.t),
        "accepted": int(shape.accepted.sum()),
        "order": shape.coefficients.shape[1] - 1,
        "scale": shape.scale,
        "scale_sigma": shape.scale_sigma,
        "base_shift_m": shape.base_shift.tolist(),
        "remarks": list(remarks),
        "most_doubtful": doubtful,
        "wrote": str(arguments.out),
    }
    if arguments.json:
        print(json.dumps({key: None if value != value else value for key, value in summary.items()}, indent=1))
        return
    print(f"{summary['accepted']} of {summary['frames']} frames accepted, {summary['order']} curvature coordinates")
    aside, along = 1e3 * shape.base_shift
    print(
        f"scale {shape.scale:.5f} +- {shape.scale_sigma:.5f} of the declared; base {aside:+.2f} mm aside of the"
        f" declared, {along:+.2f} mm along the arm"
    )
    for remark in remarks:
        print(remark)
    if doubtful:
        print(f"most doubtful of the accepted: frames {', '.join(map(str, doubtful))} (--reject takes them out)")
    if not is_recording(source):
        print(_camera_line(recording, shape))
    print(f"wrote {arguments.out}")


def _say(result: Seen) -> None:
    """One frame's shape, as soon as it is there."""
    words = "  ".join(f"{value:8.4f}" for value in result.x) if result.accepted else result.reason
    print(f"{result.t:9.4f}  {words}", flush=True)


def _check_outputs(arguments: argparse.Namespace) -> None:
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


def _camera_line(recording: Recording, shape: ShapeTrack) -> str:
    """The camera as the video shows it, to be copied into recording.toml (two spaces stand for line ends)."""
    camera = recording.declaration.camera
    assert camera is not None
    u, v = camera.to_pixels(shape.base_shift)
    arm = ", ".join(f"{part:g}" for part in camera.arm_px)
    parts = (
        f"fps = {camera.fps:g}",
        f"m_per_px = {camera.metres_per_px / shape.scale:.4g}",
        f"base_px = [{u:.0f}, {v:.0f}]",
        f"arm_px = [{arm}]",
    )
    return "  ".join(["[camera]", *parts])


def _write_rrd(recording: Recording, shape: object, path: Path) -> None:
    from dataclasses import replace

    from tentacle.io.recording_rrd import write_rrd

    write_rrd(replace(recording, shape=shape), path)  # type: ignore[arg-type]


def _draw(path: Path, video: Path, recording: Recording, seen: object) -> None:
    from vision.encode import write_picture, write_video
    from vision.frames import read_frames
    from vision.overlay import contact_sheet, overlay

    camera = recording.declaration.camera
    frames = read_frames(video, None if camera is None else camera.fps)
    if path.suffix == ".png":
        write_picture(path, contact_sheet(frames, seen))  # type: ignore[arg-type]
    else:
        write_video(path, overlay(frames, seen), [result.t for result in seen], crf=20)  # type: ignore[arg-type,attr-defined]
