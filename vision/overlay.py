"""The tracked shape drawn over the video: the fitted outline, or the reason of a rejection."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from vision.frames import Frame
from vision.tracked_frame import TrackedFrame

GOOD, BAD = (60, 220, 90), (235, 70, 60)  # RGB
FINE_BITS = 4  # sub-pixel bits of OpenCV's drawing


def draw_overlay(image: NDArray[np.uint8], seen: TrackedFrame) -> NDArray[np.uint8]:
    """An RGB copy (H, W, 3) of a grey frame with the outline and the time."""
    picture = np.repeat(image[:, :, None], 3, axis=2)
    scale = max(image.shape[0] / 720.0, 0.4)
    if seen.accepted and len(seen.outline_px):
        points = np.rint(seen.outline_px * 2**FINE_BITS).astype(np.int32)
        cv2.polylines(picture, [points], False, GOOD, max(round(scale), 1), cv2.LINE_AA, FINE_BITS)
    words = f"{seen.t:.3f} s" if seen.accepted else f"{seen.t:.3f} s  {seen.reason}"
    place = (round(12 * scale), round(28 * scale))
    cv2.putText(
        picture, words, place, cv2.FONT_HERSHEY_SIMPLEX, 0.8 * scale, GOOD if seen.accepted else BAD, 1, cv2.LINE_AA
    )
    return picture


def overlay(frames: Iterable[Frame], seen: Sequence[TrackedFrame]) -> Iterator[NDArray[np.uint8]]:
    """Each frame with its result drawn over it; frames and results are matched by their time stamps."""
    results = {result.t: result for result in seen}
    for frame in frames:
        if frame.t in results:
            yield draw_overlay(frame.image, results[frame.t])


def contact_sheet(
    frames: Iterable[Frame], seen: Sequence[TrackedFrame], columns: int = 3, rows: int = 3
) -> NDArray[np.uint8]:
    """One RGB picture of frames spread over the video, rejected ones among them where there are any."""
    count = columns * rows
    rejected = [k for k, result in enumerate(seen) if not result.accepted][: count // 3]
    spread = [int(k) for k in np.linspace(0, len(seen) - 1, min(count - len(rejected), len(seen)))]
    chosen = {seen[k].t: seen[k] for k in sorted({*rejected, *spread})}
    tiles = [draw_overlay(frame.image, chosen[frame.t]) for frame in frames if frame.t in chosen]
    height, width = tiles[0].shape[:2]
    shrink = min(1.0, 640.0 / width)
    size = (round(width * shrink), round(height * shrink))
    tiles = [cv2.resize(tile, size, interpolation=cv2.INTER_AREA) for tile in tiles]
    tiles += [np.zeros_like(tiles[0])] * (-len(tiles) % columns)
    lines = [np.concatenate(tiles[k : k + columns], axis=1) for k in range(0, len(tiles), columns)]
    return np.asarray(np.concatenate(lines, axis=0), dtype=np.uint8)
