"""A person's decisions on single frames, kept in a file beside the video, so that the next run repeats them.

The file VIDEO.proofread.toml holds reject and accept, each a list of frame numbers and ranges ("120-131"); frames count
from 0 in the order of the file. The latest decision on a frame counts.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import tomli_w

from tentacle.errors import InputError
from tentacle.io.toml_table import Table, read_toml
from tentacle.io.written_file import write_text
from vision.tracked_frame import TrackedFrame

_RANGE = re.compile(r"(\d{1,9})(?:-(\d{1,9}))?")
MOST_FRAMES = 10_000_000  # of a video: 92 hours at 30 frames/s


def parse_frames(words: str, field: str, file: Path | None = None) -> list[int]:
    """Frame numbers of a text like "7,120-131". InputError if it is no such list."""
    frames: list[int] = []
    for part in words.split(","):
        match = _RANGE.fullmatch(part.strip())
        first, last = (int(match[1]), int(match[2] or match[1])) if match else (1, 0)
        if not first <= last < MOST_FRAMES:
            problem = f"{part[:60]!r} is no frame or range"
            raise InputError(problem, file=file, field=field, expected=f"frames as 7 or 120-131, below {MOST_FRAMES}")
        frames.extend(range(first, last + 1))
    return frames


def file_beside(video: Path) -> Path:
    """The file of the decisions on a video."""
    return video.with_name(video.name + ".proofread.toml")


def read_verdicts(video: Path) -> dict[int, bool]:
    """A person's decisions by frame: True accepted, False rejected; {} if there is no file."""
    file = file_beside(video)
    if not os.path.lexists(file):
        return {}
    text, values = read_toml(file)
    table = Table(values, file=file, text=text)
    verdicts: dict[int, bool] = {}
    for name, value in (("reject", False), ("accept", True)):
        entries = table.raw(name, '["7", "120-131"]', [])
        if not isinstance(entries, list):
            raise table.error("is no list", name, '["7", "120-131"]')
        for entry in entries:
            verdicts |= dict.fromkeys(parse_frames(str(entry), name, file), value)
    table.finish()
    return verdicts


def write_verdicts(video: Path, verdicts: Mapping[int, bool]) -> Path:
    """Write the decisions beside the video; gives the file."""
    file = file_beside(video)
    table = {
        name: _ranges(sorted(frame for frame, accepted in verdicts.items() if accepted == value))
        for name, value in (("reject", False), ("accept", True))
    }
    write_text(file, tomli_w.dumps(table))
    return file


def decided(video: Path, reject: Sequence[str], accept: Sequence[str]) -> dict[int, bool]:
    """The decisions on a video with new ones added; the file is updated. InputError where two new ones differ."""
    rejected, accepted = (
        [frame for part in words for frame in parse_frames(part, field)]
        for words, field in ((reject, "--reject"), (accept, "--accept"))
    )
    both = sorted(set(rejected) & set(accepted))
    if both:
        found = f"frame {both[0]} is accepted and rejected" + (f", and {len(both) - 1} more" if both[1:] else "")
        raise InputError(found, field="--reject and --accept", expected="each frame in one of them")
    verdicts = read_verdicts(video) | dict.fromkeys(rejected, False) | dict.fromkeys(accepted, True)
    if reject or accept:
        write_verdicts(video, verdicts)
    return verdicts


def most_doubtful(seen: Sequence[TrackedFrame], count: int = 9) -> list[int]:
    """Accepted frames to look at, the most doubtful first.

    The doubt is the larger of two ratios: the scatter of a frame's edges over the usual one, and the distance of its
    shape from the line between its accepted neighbours in time, over the usual one.
    """
    index = np.array([k for k, frame in enumerate(seen) if frame.accepted])
    if len(index) < 3:
        return index.tolist()
    sigma = np.array([seen[k].sigma for k in index])
    shapes = np.array([seen[k].x for k in index])
    shapes[:, 0] += np.array([seen[k].theta for k in index])
    t = np.array([seen[k].t for k in index])
    share = ((t[1:-1] - t[:-2]) / (t[2:] - t[:-2]))[:, None]
    off = np.zeros(len(index))
    # the tip's direction depends on all coordinates
    tip = shapes @ np.array([1.0, *(1.0 / j for j in range(1, shapes.shape[1]))])
    off[1:-1] = np.abs(tip[1:-1] - (tip[:-2] + share[:, 0] * (tip[2:] - tip[:-2])))
    doubt = np.maximum(sigma / np.median(sigma), off / max(float(np.median(off)), 1e-6) / 3.0)
    return index[np.argsort(-doubt)][:count].tolist()


def _ranges(frames: Sequence[int]) -> list[str]:
    words: list[str] = []
    for frame in frames:
        first, _, last = words[-1].partition("-") if words else ("", "", "")
        if words and int(last or first) == frame - 1:
            words[-1] = f"{first}-{frame}"
        else:
            words.append(str(frame))
    return words
