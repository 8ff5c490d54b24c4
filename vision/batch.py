"""Many videos in one call: each is tracked in its own process and stored when it is done, so that none is tracked
twice; one table.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from tentacle.errors import InputError
from tentacle.io.video_file import VIDEO_SUFFIXES
from tentacle.io.written_file import write_text
from tentacle.runner import Runner
from vision.declared import DeclaredNumbers, is_recording, recording_of
from vision.lens_file import read_lens
from vision.midline_file import write_midline
from vision.proofread import file_beside, read_verdicts
from vision.shape_file import write_shape
from vision.track import Following, motor_angle, track_fully
from vision.tracked_recording import errors_about

VERSION = "1"
FILMS = (*VIDEO_SUFFIXES, ".m4v", ".mpg", ".ts", ".wmv")
SUMMARY_COLUMNS = ("source", "frames", "accepted", "repeats", "scale", "problem")


@dataclass(frozen=True)
class TrackingBatch:
    """Settings common to all videos: the arm's numbers, curvature coordinates, the lens file, the folder of the
    results.
    """

    numbers: DeclaredNumbers
    order: int | None
    lens: Path | None
    out: Path


def sources_of(paths: Sequence[Path]) -> list[Path]:
    """The videos and recordings at the given paths.

    A folder that is not a recording stands for the videos and recordings in it. A folder of pictures is a video. Raises
    InputError where a folder holds neither.
    """
    found: list[Path] = []
    for path in paths:
        inside = sorted(path.iterdir()) if path.is_dir() and not is_recording(path) else []
        films = [file for file in inside if file.suffix.lower() in FILMS or is_recording(file)]
        if inside and not films and not any(file.suffix.lower() in (".png", ".jpg", ".tif") for file in inside):
            raise InputError("holds no video and no recording", file=path, expected="videos, or recordings' folders")
        found.extend(films or [path])
    return found


def track_all(sources: Sequence[Path], batch: TrackingBatch, workers: int | None = None) -> list[Mapping[str, Any]]:
    """Track all, in parallel.

    Returns rows of COLUMNS in the sources' order, and writes them to out/summary.csv. A result in out/done is used
    again unless the video, its proofreading or an option has changed.
    """
    batch.out.mkdir(parents=True, exist_ok=True)
    names = _names(sources)
    tasks = [
        {
            "source": str(source.resolve()),
            "name": name,
            "changed": _stamp(source),
            "numbers": asdict(batch.numbers),
            "order": batch.order,
            "lens": None if batch.lens is None else str(batch.lens.resolve()),
            "out": str(batch.out.resolve()),
        }
        for source, name in zip(sources, names, strict=True)
    ]
    rows = Runner(batch.out / "done", workers).run(track_one, tasks, version=VERSION, words="tracking")
    lines = [",".join(SUMMARY_COLUMNS)]
    lines += [",".join(str(row[name]).replace(",", ";").replace("\n", " ") for name in SUMMARY_COLUMNS) for row in rows]
    write_text(batch.out / "summary.csv", "\n".join(lines) + "\n")
    return rows


def track_one(task: Mapping[str, Any]) -> dict[str, Any]:
    """Track one video: its row; writes NAME.csv and NAME.midline.csv. For a bad video the row states the problem."""
    source, out, name = Path(task["source"]), Path(task["out"]), task["name"]
    row: dict[str, Any] = dict.fromkeys(SUMMARY_COLUMNS, "") | {"source": str(source)}
    try:
        lens = None if task["lens"] is None else read_lens(Path(task["lens"]))
        numbers = task["numbers"]
        base = numbers["base_px"]
        recording = recording_of(
            source, DeclaredNumbers(**{**numbers, "base_px": None if base is None else tuple(base)}), lens
        )
        if recording.video is None:
            raise InputError("the recording has no video", file=source, expected="video.mp4 or frames/")
        video = recording.video.path
        verdicts = read_verdicts(video)
        following = Following(task["order"], lens, verdicts=verdicts)
        with errors_about(source, recording):
            shape = track_fully(video, recording.declaration, recording.motor, following=following).shape
        write_shape(shape, out / f"{name}.csv")
        angle = motor_angle(recording.motor, shape.t)
        write_midline(shape, angle, recording.declaration.specimen, out / f"{name}.midline.csv")
    except (InputError, OSError) as error:
        return row | {"problem": str(error)}
    repeats = sum(reason == "repeats the frame before" for reason in shape.reason)
    return row | {
        "frames": len(shape.t),
        "accepted": int(shape.accepted.sum()),
        "repeats": repeats,
        "scale": round(shape.scale, 6),
        "problem": "" if shape.accepted.any() else _nothing_accepted(shape.reason),
    }


def _nothing_accepted(reasons: Sequence[str]) -> str:
    """Why a video has no accepted frame, in words, and what to try."""
    often = max(set(reasons), key=reasons.count)
    return f"no frame was accepted ({often}): tentacle track of it alone with --pick shows where base and tip are"


def _names(sources: Sequence[Path]) -> list[str]:
    """A unique name for each source's results."""
    names: list[str] = []
    for source in sources:
        name, count = source.stem, 2
        while name in names:
            name, count = f"{source.stem}_{count}", count + 1
        names.append(name)
    return names


def _stamp(source: Path) -> list[float]:
    """Size and time of what a source's result depends on."""
    files = [file for file in sorted(source.iterdir()) if file.is_file()] if source.is_dir() else [source]
    files += [file_beside(file) for file in [source, *files] if file_beside(file).exists()]
    stats = [file.stat() for file in files if file.exists()]
    return [value for stat in stats for value in (float(stat.st_size), stat.st_mtime)]
