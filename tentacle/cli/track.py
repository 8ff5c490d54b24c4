"""tentacle track: from videos to shapes with their covariance."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from tentacle.cli._output import remark, say, say_text

if TYPE_CHECKING:
    from tentacle.recording import Recording
    from vision.lens import Lens
    from vision.track import Tracking

HELP = "follow the arm through a video: curvature coordinates with their covariance, frame by frame"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    from tentacle.cli._track_arguments import add_arguments

    add_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Read, track, write, print the results. 1 where no frame of a video is accepted."""
    from tentacle.cli._track_arguments import check_plain
    from tentacle.cli._track_sources import picked_recording, several
    from tentacle.errors import InputError
    from vision.batch import sources_of

    sources = arguments.source if len(arguments.source) == 1 and arguments.live else sources_of(arguments.source)
    if not arguments.pick:
        check_plain(arguments, sources)
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
    from tentacle.cli._track_arguments import check_outputs
    from tentacle.cli._track_sources import stated_numbers
    from tentacle.cli.pages.tracking import in_words, overlay_picture, tracking_json, tracking_summary, write_tracked
    from tentacle.errors import InputError
    from vision.declared import FOUND, is_recording, recording_of
    from vision.lens_file import read_lens
    from vision.midline_file import write_midline
    from vision.paper_pipeline import paper_track
    from vision.proofread import decided
    from vision.shape_file import write_shape
    from vision.track import motor_angle
    from vision.tracked_recording import errors_about

    check_outputs(arguments)
    lens = None if arguments.lens is None else read_lens(arguments.lens)
    recording = recording_of(source, stated_numbers(arguments), lens)
    if recording.video is None:
        raise InputError("the recording has no video", file=source, expected="video.mp4 or frames/")
    if FOUND in recording.notes and not is_recording(source):
        remark(f"{recording.notes[FOUND]}; --pick shows it in a picture")
    video, tracked = recording.video.path, None
    with errors_about(source, recording):
        if arguments.paper:
            shape = paper_track(video, recording.declaration, recording.motor)
        else:
            tracked = _tracked(source, recording, arguments, lens, decided(video, arguments.reject, arguments.accept))
            shape = tracked.shape
    if arguments.out.suffix == ".rrd":
        write_tracked(recording, shape, arguments.out)
    else:
        write_shape(shape, arguments.out)
    if arguments.midline is not None:
        angle = motor_angle(recording.motor, shape.t)
        write_midline(shape, angle, recording.declaration.specimen, arguments.midline)
    if arguments.overlay is not None:
        overlay_picture(arguments.overlay, video, recording, () if tracked is None else tracked.seen)
    told = tracking_summary(shape, tracked, arguments.out)
    say_text(tracking_json(told)) if arguments.json else say(*in_words(told, source, recording, shape))
    return int(not told["accepted"])


def _tracked(
    source: Path, recording: Recording, arguments: argparse.Namespace, lens: Lens | None, verdicts: dict[int, bool]
) -> Tracking:
    """Track with a bar or, with --live, with one line for each frame; warnings go to standard error at once."""

    from tentacle.cli._progress import stages
    from tentacle.cli.pages.tracking import print_frame
    from vision.track import Following, track_fully
    from vision.tracked_recording import told_frames

    assert recording.video is not None
    with stages([("tracking", 1.0)]) as stage:
        return track_fully(
            recording.video.path,
            recording.declaration,
            recording.motor,
            Following(arguments.order, lens, arguments.live, verdicts=verdicts, outlines=arguments.overlay is not None),
            print_frame if arguments.live else told_frames(stage, source, recording.video),
            warn=remark,
        )
