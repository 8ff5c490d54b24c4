"""The loop over a film's frames: the first ones are collected for a start, then each gives its result at once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from tentacle.errors import InputError
from vision.follow import Follower
from vision.frames import Frame
from vision.tracked_frame import TrackedFrame

FIRST_LOOK_FRAMES = 16  # frames from which the recording's parameters are first estimated


def follow_frames(frames: Iterable[Frame], follower: Follower) -> Iterator[TrackedFrame]:
    """Start on the first frames, then yield the result of every frame."""
    waiting: list[Frame] = []
    started = False
    for frame in frames:
        if started:
            yield follower.see(frame)
            continue
        waiting.append(frame)
        if len(waiting) == FIRST_LOOK_FRAMES:
            follower.start(waiting)
            started = True
            for early in waiting:
                yield follower.see(early)
            waiting = []
    if not started:
        if not waiting:
            raise InputError("there are no frames", expected="a video with at least one frame")
        follower.start(waiting)
        for early in waiting:
            yield follower.see(early)
