"""A film of a camera's pictures: the same bytes, each at its own time; what is no whole picture is left out."""

from __future__ import annotations

from pathlib import Path

import av
import cv2
import numpy as np
import pytest

from rig.stills import picture_size, write_film
from vision.frames import read_frames

TICK = 1.0 / 90_000  # s, of the film's time stamps


def _jpeg(level: int, size: tuple[int, int] = (65, 48), *more: int) -> bytes:
    """A picture with noise of that width and height, as a camera's."""
    noise = np.random.default_rng(level).normal(level, 5.0, (size[1], size[0], 3))
    return cv2.imencode(".jpg", np.clip(noise, 0, 255).astype(np.uint8), [cv2.IMWRITE_JPEG_QUALITY, 92, *more])[
        1
    ].tobytes()


def test_every_picture_is_in_the_film_as_the_camera_gave_it(tmp_path: Path) -> None:
    pictures = [_jpeg(level) for level in (40, 90, 140, 190)]
    times = [0.0, 0.0334, 0.12, 3.700004]  # a camera's, with a gap
    assert write_film(zip(times, pictures, strict=True), tmp_path / "film.mp4") == 4
    with av.open(str(tmp_path / "film.mp4")) as film:
        packets = [bytes(packet) for packet in film.demux(video=0) if packet.size]
    assert packets == pictures  # byte for byte: nothing was coded anew
    frames = list(read_frames(tmp_path / "film.mp4"))
    np.testing.assert_allclose([frame.t for frame in frames], times, atol=0.51 * TICK)
    for frame, picture in zip(frames, pictures, strict=True):
        luma = cv2.imdecode(np.frombuffer(picture, np.uint8), cv2.IMREAD_GRAYSCALE)
        assert np.abs(frame.image.astype(int) - luma).max() <= 1  # two decoders round unlike


def test_a_film_that_begins_late_keeps_its_times(tmp_path: Path) -> None:
    times = [0.033333, 0.0667, 0.1]  # an edit list in milliseconds would shift them all by 0.33 ms
    write_film(((t, _jpeg(40)) for t in times), tmp_path / "film.mp4")
    np.testing.assert_allclose([frame.t for frame in read_frames(tmp_path / "film.mp4")], times, atol=0.51 * TICK)


def test_what_is_no_whole_picture_of_the_films_size_is_left_out(tmp_path: Path) -> None:
    good = _jpeg(100)
    stills = [
        (0.0, b""),
        (0.1, b"no picture"),
        (0.2, good[: len(good) // 2]),  # cut off
        (0.3, good),
        (0.3, _jpeg(101)),  # no later than the one before
        (0.25, _jpeg(102)),
        (0.4, _jpeg(103, (48, 65))),  # of another size
        (0.5, _jpeg(104)),
    ]
    assert write_film(iter(stills), tmp_path / "film.mp4") == 2
    assert [round(frame.t, 3) for frame in read_frames(tmp_path / "film.mp4")] == [0.3, 0.5]
    assert write_film(iter(stills[:3]), tmp_path / "none.mp4") == 0
    assert not (tmp_path / "none.mp4").exists()


@pytest.mark.parametrize("more", [(), (cv2.IMWRITE_JPEG_PROGRESSIVE, 1), (cv2.IMWRITE_JPEG_RST_INTERVAL, 2)])
def test_a_picture_states_its_size(more: tuple[int, ...]) -> None:
    assert picture_size(_jpeg(80, (301, 77), *more)) == (301, 77)
    grey = cv2.imencode(".jpg", np.full((7, 9), 80, np.uint8))[1].tobytes()
    assert picture_size(grey) == (9, 7)
    assert picture_size(grey[:4] + grey[-2:]) is None  # its header is gone
