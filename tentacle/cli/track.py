"""tentacle track: from a video to shapes with their covariance."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tentacle.recording import Recording
    from tentacle.signals import ShapeTrack
    from vision.follow import Seen
    from vision.lens import Lens

HELP = "follow the arm through a video: curvature coordinates with their covariance, frame by frame"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument(
        "source", type=Path, metavar="VIDEO|RECORDING", help="a video, a folder of frames, or a recording"
    )
    parser.add_argument(
        "--out", type=Path, required=True, metavar="FILE", help="FILE.csv, or FILE.rrd with everything in it"
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
    plain = parser.add_argument_group("a plain video (not a recording)")
    plain.add_argument("--length", type=float, metavar="M", help="length of the arm [m]")
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
    import json

    from tentacle.cli._progress import stages
    from tentacle.errors import InputError
    from vision.lens_file import read_lens
    from vision.paper_pipeline import paper_track
    from vision.shape_file import write_shape
    from vision.track import track_fully
    from vision.tracked_recording import told_frames

    _check_outputs(arguments)
    if arguments.live < 0 or (arguments.live and (arguments.paper or arguments.json)):
        raise InputError("--live is for frames as they come", field="--live", expected="seconds, no --paper or --json")
    lens = None if arguments.lens is None else read_lens(arguments.lens)
    recording = _recording(arguments, lens)
    if recording.video is None:
        raise InputError("the recording has no video", file=arguments.source, expected="video.mp4 or frames/")
    video, remarks, seen = recording.video.path, (), ()
    if arguments.paper:
        shape = paper_track(video, recording.declaration, recording.motor)
    else:
        with stages([("tracking", 1.0)]) as stage:
            tracked = track_fully(
                video,
                recording.declaration,
                recording.motor,
                arguments.order,
                lens,
                _say if arguments.live else told_frames(stage, arguments.source, recording.video),
                arguments.live,
                outlines=arguments.overlay is not None,
            )
        shape, remarks, seen = tracked.shape, tracked.remarks, tracked.seen
    if arguments.out.suffix == ".rrd":
        _write_rrd(recording, shape, arguments.out)
    else:
        write_shape(shape, arguments.out)
    if arguments.overlay is not None:
        _draw(arguments.overlay, video, recording, seen)
    summary = {
        "frames": len(shape.t),
        "accepted": int(shape.accepted.sum()),
        "order": shape.coefficients.shape[1] - 1,
        "scale": shape.scale,
        "scale_sigma": shape.scale_sigma,
        "base_shift_m": shape.base_shift.tolist(),
        "remarks": list(remarks),
        "wrote": str(arguments.out),
    }
    if arguments.json:
        print(json.dumps({key: None if value != value else value for key, value in summary.items()}, indent=1))
        return 0
    print(f"{summary['accepted']} of {summary['frames']} frames accepted, {summary['order']} curvature coordinates")
    aside, along = 1e3 * shape.base_shift
    print(
        f"scale {shape.scale:.5f} +- {shape.scale_sigma:.5f} of the declared; base {aside:+.2f} mm aside of the"
        f" declared, {along:+.2f} mm along the arm"
    )
    for remark in remarks:
        print(remark)
    if not _is_recording(arguments.source):
        print(_camera_line(recording, shape))
    print(f"wrote {arguments.out}")
    return 0


def _say(result: Seen) -> None:
    """One frame's shape, as soon as it is there."""
    words = "  ".join(f"{value:8.4f}" for value in result.x) if result.accepted else result.reason
    print(f"{result.t:9.4f}  {words}", flush=True)


def _check_outputs(arguments: argparse.Namespace) -> None:
    from tentacle.errors import InputError

    if arguments.out.suffix not in (".csv", ".rrd"):
        raise InputError(
            "not a name that says what to write", file=arguments.out, field="--out", expected=".csv or .rrd"
        )
    if arguments.overlay is not None and arguments.overlay.suffix not in (".mp4", ".png"):
        raise InputError("not a picture or video", file=arguments.overlay, field="--overlay", expected=".mp4 or .png")
    if arguments.overlay is not None and arguments.paper:
        raise InputError("the paper's method has no overlay", field="--overlay", expected="--overlay without --paper")
    for path in (arguments.out, arguments.overlay):
        if path is not None and not path.absolute().parent.is_dir():
            raise InputError("there is no such folder", file=path.absolute().parent, expected="a folder to write to")


def _recording(arguments: argparse.Namespace, lens: Lens | None) -> Recording:
    """The recording given, or one made of a plain video and the arm's numbers."""
    from tentacle.errors import InputError
    from tentacle.io.reading import read_recording
    from tentacle.recording import Camera, Declaration, Recording
    from tentacle.signals import Video
    from tentacle.specimen import Cone, Specimen
    from vision.frames import read_frames
    from vision.guess import guess_camera

    source = arguments.source
    if _is_recording(source):
        return read_recording(source)
    for name in ("length", "base_radius", "tip_radius"):
        if getattr(arguments, name) is None:
            raise InputError(
                "a plain video says nothing of the arm", field=f"--{name.replace('_', '-')}", expected="metres"
            )
    # the density plays no part in tracking; water's stands in for it
    specimen = Specimen(Cone(arguments.base_radius, arguments.tip_radius), arguments.length, density=1000.0)
    fps = arguments.fps or 30.0
    first = next(iter(read_frames(source, arguments.fps, arguments.live)))
    metres_per_px = arguments.m_per_px or (lens.metres_per_px if lens is not None else None)
    if arguments.base_px is not None and metres_per_px is not None:
        camera = Camera(fps, metres_per_px, tuple(arguments.base_px), (0.0, 1.0), arguments.exposure)
    elif arguments.base_px is None and metres_per_px is None:
        camera = guess_camera(first.image, specimen, fps, arguments.exposure)
    else:
        raise InputError("base and scale go together", field="--base-px, --m-per-px", expected="both, or neither")
    return Recording(source.stem, Declaration(specimen, camera=camera), video=Video(source))


def _is_recording(source: Path) -> bool:
    return source.suffix == ".rrd" or (source / "recording.toml").exists()


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
