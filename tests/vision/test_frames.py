"""Videos as labs have them: every kind of file is read, or refused in one clear line."""

import threading
import time
from pathlib import Path

import av
import cv2
import numpy as np
import pytest
from PIL import Image

from tentacle.errors import InputError
from tentacle.io.import_folder import read_folder
from tentacle.io.recording_rrd import read_rrd, write_rrd
from vision.ahead import read_ahead
from vision.encode import write_video
from vision.frames import read_frames, read_picture


def ramp(shape=(48, 64)):
    return np.linspace(0, 255, shape[0] * shape[1]).reshape(shape).astype(np.uint8)


RECORDING = """
[specimen]
section = "cone"
length_m = 0.1
base_radius_m = 0.004
tip_radius_m = 0.002
density_kg_m3 = 1000.0
[camera]
fps = 25.0
m_per_px = 0.001
base_px = [30.0, 4.0]
arm_px = [0.0, 1.0]
"""


def test_missing_empty_and_no_video(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        list(read_frames(tmp_path / "no.mp4"))
    (tmp_path / "empty.mp4").touch()
    with pytest.raises(InputError, match="the file is empty"):
        list(read_frames(tmp_path / "empty.mp4"))
    (tmp_path / "text.mp4").write_text("this is no video " * 100)
    with pytest.raises(InputError, match="not a video"):
        list(read_frames(tmp_path / "text.mp4"))


def test_truncated_video_gives_what_is_there_or_says_so(tmp_path):
    noise = np.random.default_rng(0)
    frames = [noise.integers(0, 256, (96, 128), dtype=np.uint8) for _ in range(40)]
    write_video(tmp_path / "whole.mkv", frames, np.arange(40) / 20)
    data = (tmp_path / "whole.mkv").read_bytes()
    (tmp_path / "cut.mkv").write_bytes(data[: len(data) // 2])
    assert 1 <= len(list(read_frames(tmp_path / "cut.mkv"))) < 40
    write_video(tmp_path / "whole.mp4", frames, np.arange(40) / 20)
    data = (tmp_path / "whole.mp4").read_bytes()
    (tmp_path / "cut.mp4").write_bytes(data[: len(data) // 2])  # its index is at the end, and is lost
    with pytest.raises(InputError, match=r"cut\.mp4"):
        list(read_frames(tmp_path / "cut.mp4"))


def test_sound_without_pictures(tmp_path):
    with av.open(str(tmp_path / "sound.wav"), "w") as container:
        stream = container.add_stream("pcm_s16le", rate=8000)
        sound = av.AudioFrame.from_ndarray(np.zeros((1, 800), np.int16), layout="mono")
        sound.sample_rate = 8000
        container.mux(stream.encode(sound))
    with pytest.raises(InputError, match="no video stream"):
        list(read_frames(tmp_path / "sound.wav"))


def test_one_frame(tmp_path):
    write_video(tmp_path / "one.mp4", [ramp()], [0.0])
    (frame,) = read_frames(tmp_path / "one.mp4")
    np.testing.assert_array_equal(frame.image, ramp())


@pytest.mark.parametrize("suffix", [".mp4", ".mov"])
def test_a_film_that_begins_late_keeps_its_times(tmp_path, suffix):
    times = 0.0123456 + np.arange(3) / 29.97
    write_video(tmp_path / f"late{suffix}", [ramp() + k for k in range(3)], times)
    found = [frame.t for frame in read_frames(tmp_path / f"late{suffix}")]
    np.testing.assert_allclose(found, times, atol=0.51e-6)  # ticks of a microsecond, the beginning's too


def test_colour_becomes_luma(tmp_path):
    red = np.zeros((48, 64, 3), np.uint8)
    red[:, 32:, 0] = 255
    write_video(tmp_path / "red.mp4", [red], [0.0])
    (frame,) = read_frames(tmp_path / "red.mp4")
    assert frame.image.shape == (48, 64)
    assert frame.image[24, 50] > frame.image[24, 10] + 40  # red's luma is about 0.3 of white's


@pytest.mark.parametrize("kind", ["grey", "sixteen", "alpha", "colour"])
def test_pictures_of_every_depth(tmp_path, kind):
    grey = ramp()
    picture = {
        "grey": grey,
        "sixteen": grey.astype(np.uint16) * 257,
        "alpha": np.dstack([grey, grey, grey, np.full_like(grey, 255)]),
        "colour": np.dstack([grey, grey, grey]),
    }[kind]
    cv2.imwrite(str(tmp_path / "00000.png"), picture)
    np.testing.assert_allclose(read_picture(tmp_path / "00000.png").astype(int), grey.astype(int), atol=1)
    (frame,) = read_frames(tmp_path, fps=10.0)
    assert frame.t == 0.0


def test_folder_without_rate_or_pictures(tmp_path):
    with pytest.raises(InputError, match="no pictures"):
        list(read_frames(tmp_path, 10.0))
    cv2.imwrite(str(tmp_path / "00000.png"), ramp())
    with pytest.raises(InputError, match="fps"):
        list(read_frames(tmp_path))
    (tmp_path / "00001.png").write_bytes(b"\x89PNG broken")
    with pytest.raises(InputError, match=r"00001\.png"):
        list(read_frames(tmp_path, 10.0))


def test_read_ahead_keeps_order_and_raises_in_place():
    def items():
        yield from range(10)
        raise InputError("the tenth is bad")

    ahead = read_ahead(items(), 3)
    assert [next(ahead) for _ in range(10)] == list(range(10))
    with pytest.raises(InputError, match="tenth"):
        next(ahead)


def test_a_file_that_grows_is_read_as_it_comes(tmp_path):
    frames = [np.roll(ramp(), 3 * k, axis=1) for k in range(30)]
    write_video(tmp_path / "whole.mkv", frames, np.arange(30) / 30)
    data = (tmp_path / "whole.mkv").read_bytes()
    growing = tmp_path / "growing.mkv"
    growing.touch()

    def write():
        for part in range(10):
            time.sleep(0.02)
            with growing.open("ab") as file:
                file.write(data[part * len(data) // 10 : (part + 1) * len(data) // 10])

    writer = threading.Thread(target=write)
    writer.start()
    read = list(read_frames(growing, patience=2.0))
    writer.join()
    assert len(read) == 30
    assert all(np.array_equal(a, b.image) for a, b in zip(frames, read, strict=True))


def test_a_rotation_that_the_file_declares_is_carried_out(tmp_path):
    write_video(tmp_path / "flat.mp4", [ramp()], [0.0])
    data = bytearray((tmp_path / "flat.mp4").read_bytes())
    matrix = data.index(b"tkhd") + 4 + 4 + 20 + 8 + 8  # ISO 14496-12, tkhd
    turned = (0, 1 << 16, 0, 0xFFFF0000, 0, 0, 48 << 16, 0, 1 << 30)  # a quarter turn clockwise
    data[matrix : matrix + 36] = b"".join(value.to_bytes(4, "big") for value in turned)
    (tmp_path / "portrait.mp4").write_bytes(data)
    (frame,) = read_frames(tmp_path / "portrait.mp4")
    np.testing.assert_array_equal(frame.image, np.rot90(ramp(), -1))


def test_a_codec_that_nobody_knows(tmp_path):
    write_video(tmp_path / "known.mp4", [ramp()], [0.0])
    data = (tmp_path / "known.mp4").read_bytes()
    (tmp_path / "unknown.mp4").write_bytes(data.replace(b"avc1", b"zzzz").replace(b"avcC", b"zzzC"))
    with pytest.raises(InputError, match=r"unknown\.mp4"):
        list(read_frames(tmp_path / "unknown.mp4"))


def test_a_camera_counts_its_time_from_its_first_frame(tmp_path, monkeypatch):
    frames = [np.roll(ramp(), 3 * k, axis=1) for k in range(6)]
    write_video(tmp_path / "camera.mkv", frames, 5000.0 + np.arange(6) / 25)
    opened = av.open

    def camera(file, mode, format, options):
        assert (file, format) == ("/dev/null", "v4l2")
        return opened(str(tmp_path / "camera.mkv"), mode=mode, options=options)

    monkeypatch.setattr("vision.frames.av.open", camera)
    read = list(read_frames(Path("/dev/null"), patience=1.0))  # a character device, as /dev/video0 is
    assert [frame.t for frame in read] == pytest.approx(np.arange(6) / 25, abs=1e-3)  # mkv counts milliseconds
    assert all(np.array_equal(a, b.image) for a, b in zip(frames, read, strict=True))


def test_a_device_that_is_no_camera():
    with pytest.raises(InputError, match="/dev/null"):
        list(read_frames(Path("/dev/null")))


def test_a_variable_rate_keeps_each_frames_own_time(tmp_path):
    times = np.cumsum([0.0, 0.02, 0.05, 0.011, 0.4, 0.03])
    write_video(tmp_path / "variable.mp4", [np.roll(ramp(), 3 * k, axis=1) for k in range(6)], times)
    read = [frame.t for frame in read_frames(tmp_path / "variable.mp4")]
    np.testing.assert_allclose(read, times, atol=1e-6)  # time stamps to the microsecond


@pytest.mark.parametrize(
    ("codec", "stored"),
    [("ffv1", "gray"), ("ffv1", "gray16le"), ("ffv1", "bgra"), ("qtrle", "argb"), ("ffv1", "yuva420p")],
)
def test_videos_of_every_depth(tmp_path, codec, stored):
    grey = ramp()
    picture = np.dstack([grey, grey, grey, np.full_like(grey, 255)])
    video = tmp_path / ("v.mov" if codec == "qtrle" else "v.mkv")
    with av.open(str(video), "w") as container:
        stream = container.add_stream(codec, rate=20)
        stream.width, stream.height, stream.pix_fmt = 64, 48, stored
        if stored.startswith("gray"):
            deep = grey.astype(np.uint16) * 257 if "16" in stored else grey
            frame = av.VideoFrame.from_ndarray(deep, format=stored)
        else:
            frame = av.VideoFrame.from_ndarray(picture, format="rgba").reformat(format=stored)
        container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
    (read,) = read_frames(video)
    assert read.image.dtype == np.uint8
    # luma of limited range has 219 steps for 255, and is rounded there and back
    np.testing.assert_allclose(read.image.astype(int), grey.astype(int), atol=2)


def test_what_is_transparent_in_a_video_is_black(tmp_path):
    picture = np.full((48, 64, 4), 200, np.uint8)
    picture[:, 32:, 3] = 0
    with av.open(str(tmp_path / "v.mov"), "w") as container:
        stream = container.add_stream("qtrle", rate=20)
        stream.width, stream.height, stream.pix_fmt = 64, 48, "argb"
        container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgba").reformat(format="argb")))
        container.mux(stream.encode(None))
    (read,) = read_frames(tmp_path / "v.mov")
    assert read.image[24, 50] < 3


def test_a_gif_in_a_recording_is_read_and_survives_an_rrd(tmp_path):
    pictures = [np.full((40, 60), 200 - 40 * k, dtype=np.uint8) for k in range(4)]
    first, *rest = [Image.fromarray(picture) for picture in pictures]
    first.save(tmp_path / "video.gif", save_all=True, append_images=rest, duration=[40, 80, 40, 40])
    (tmp_path / "recording.toml").write_text(RECORDING)
    write_rrd(read_folder(tmp_path), tmp_path / "kept.rrd")
    video = read_rrd(tmp_path / "kept.rrd").video
    frames = list(read_frames(video.path))
    assert [frame.t for frame in frames] == pytest.approx([0.0, 0.04, 0.12, 0.16])
    for frame, picture in zip(frames, pictures, strict=True):
        assert np.abs(frame.image.astype(int) - picture).max() <= 2
