"""A recording's .rrd file alone gives the recording back, bit for bit; cut off, it gives what lies before the cut."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import av
import numpy as np
import pytest
import rerun as rr

import tentacle
from tentacle.errors import InputError
from tentacle.io.recording_rrd import write_rrd
from tentacle.io.video_file import frame_stamps
from tentacle.recording import Recording
from tentacle.signals import FrameShapes, ShapeTrack, Video
from tests.tentacle.io.test_import_folder import assert_equal_recordings, random_recording


def full_recording() -> Recording:
    rng = np.random.default_rng(4)
    coefficients = rng.normal(size=(30, 3))
    coefficients[3] = np.nan
    shape = ShapeTrack(
        t=np.cumsum(rng.uniform(0.01, 0.05, 30)),
        coefficients=coefficients,
        covariance=rng.normal(size=(30, 3, 3)),
        accepted=np.arange(30) != 3,
        reason=tuple("coiled" if i == 3 else "" for i in range(30)),
        scale=1.0 + 1 / 3000,
        scale_sigma=1 / 7000,
        base_shift=rng.normal(size=2),
        by_frames=FrameShapes(rng.normal(size=(30, 6)), rng.normal(size=(30, 6, 6))),
    )
    return replace(random_recording(), shape=shape)


def small_video(file: Path) -> Path:
    with av.open(str(file), "w") as container:
        stream = container.add_stream("libx264", rate=30)
        stream.width, stream.height, stream.pix_fmt = 64, 48, "yuv420p"
        for number in range(10):
            picture = np.full((48, 64, 3), 20 * number, dtype=np.uint8)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        container.mux(stream.encode())
    return file


def test_every_signal_comes_back_bit_for_bit(tmp_path: Path) -> None:
    recording = full_recording()
    write_rrd(recording, tmp_path / "run.rrd")
    assert_equal_recordings(tentacle.read(tmp_path / "run.rrd"), recording)


def test_a_video_comes_back_with_its_own_bytes(tmp_path: Path) -> None:
    video = small_video(tmp_path / "video.mp4")
    content = video.read_bytes()
    write_rrd(replace(full_recording(), video=Video(video)), tmp_path / "run.rrd")
    video.unlink()
    again = tentacle.read(tmp_path / "run.rrd")
    assert again.video is not None
    assert again.video.path.suffix == ".mp4"
    assert again.video.path.read_bytes() == content
    assert "cut_off" not in again.notes


def test_a_cut_that_takes_the_video_says_so(tmp_path: Path) -> None:
    video = Video(small_video(tmp_path / "video.mp4"))
    bare = random_recording()
    only_filmed = Recording(bare.name, bare.declaration, video=video)
    write_rrd(only_filmed, tmp_path / "whole.rrd")
    content = (tmp_path / "whole.rrd").read_bytes()
    start = content.index(b"ftypisom")
    (tmp_path / "cut.rrd").write_bytes(content[: start + 100])
    again = tentacle.read(tmp_path / "cut.rrd")
    assert again.video is None
    assert "camera 0 of 1" in again.notes["cut_off"]


def test_frames_come_back_with_their_own_bytes(tmp_path: Path, png_frames: Path) -> None:
    write_rrd(replace(full_recording(), video=Video(png_frames)), tmp_path / "run.rrd")
    again = tentacle.read(tmp_path / "run.rrd")
    assert again.video is not None
    for file in png_frames.iterdir():
        assert (again.video.path / file.name).read_bytes() == file.read_bytes()


def test_a_cut_off_file_is_recovered_up_to_the_cut(tmp_path: Path) -> None:
    recording = random_recording()
    assert recording.motor is not None
    seconds = np.linspace(0, 40, 4001)
    motor = type(recording.motor)(seconds, np.sin(seconds), np.cos(seconds))
    write_rrd(replace(recording, motor=motor), tmp_path / "whole.rrd")
    content = (tmp_path / "whole.rrd").read_bytes()
    kept = []
    for share in (0.3, 0.6, 0.9):
        (tmp_path / "cut.rrd").write_bytes(content[: int(share * len(content))])
        again = tentacle.read(tmp_path / "cut.rrd")
        assert again.motor is not None
        rows = len(again.motor.t)
        np.testing.assert_array_equal(again.motor.t, motor.t[:rows])
        np.testing.assert_array_equal(again.motor.angle, motor.angle[:rows])
        assert "the file is cut off" in again.notes["cut_off"]
        assert f"motor {rows} of 4001" in again.notes["cut_off"]
        assert again.declaration == recording.declaration
        kept.append(rows)
    # Forty blocks of one second, of about the same size, and the manifest at the end.
    assert 400 < kept[0] < kept[1] < kept[2]


def test_a_file_cut_in_its_first_message_or_no_rrd_at_all_is_refused(tmp_path: Path) -> None:
    write_rrd(random_recording(), tmp_path / "whole.rrd")
    content = (tmp_path / "whole.rrd").read_bytes()
    for bad, said in ((content[:100], "holds no recording"), (b"garbage" * 99, "not an .rrd"), (b"", "not an .rrd")):
        (tmp_path / "bad.rrd").write_bytes(bad)
        with pytest.raises(InputError, match=said):
            tentacle.read(tmp_path / "bad.rrd")
    with pytest.raises(InputError, match="no such file"):
        tentacle.read(tmp_path / "none.rrd")


def test_bytes_that_were_changed_are_refused_in_one_line(tmp_path: Path) -> None:
    write_rrd(random_recording(), tmp_path / "whole.rrd")
    content = bytearray((tmp_path / "whole.rrd").read_bytes())
    content[40:60] = bytes(20)
    (tmp_path / "bad.rrd").write_bytes(content)
    with pytest.raises(InputError) as caught:
        tentacle.read(tmp_path / "bad.rrd")
    assert "\n" not in str(caught.value)


def test_writing_that_fails_leaves_nothing(tmp_path: Path) -> None:
    recording = replace(random_recording(), video=Video(tmp_path / "none.mp4"))
    with pytest.raises(FileNotFoundError):
        write_rrd(recording, tmp_path / "run.rrd")
    assert list(tmp_path.glob("*rrd*")) == []
    assert list(tmp_path.glob(".*")) == []


def test_many_files_leave_no_threads_behind(tmp_path: Path) -> None:
    """One stream's thread may wait for the next to end it; not one a file."""
    if not Path("/proc/self/task").is_dir():
        pytest.skip("threads are counted where Linux lists them")
    recording = full_recording()
    write_rrd(recording, tmp_path / "first.rrd")
    before = len(list(Path("/proc/self/task").iterdir()))
    for k in range(6):
        write_rrd(recording, tmp_path / f"{k}.rrd")
    assert len(list(Path("/proc/self/task").iterdir())) <= before + 2


def test_a_file_of_another_kind_is_not_replaced(tmp_path: Path) -> None:
    taken = tmp_path / "notes.rrd"
    taken.write_text("not a recording")
    with pytest.raises(InputError, match=r"is there, and is no \.rrd"):
        write_rrd(full_recording(), taken)
    assert taken.read_text() == "not a recording"


def test_a_film_at_which_reruns_reader_stands_still_is_stored_with_its_times(tmp_path: Path) -> None:
    """A box of length 0 among the film's remarks; its pictures are sound."""
    film = small_video(tmp_path / "video.mp4")
    content = bytearray(film.read_bytes())
    at = content.rfind(b"ilst")
    content[at - 4 : at] = bytes(4)
    film.write_bytes(content)
    # 1/30 s in whole ticks of the container, rounded to whole nanoseconds.
    assert np.diff(frame_stamps(film)) == pytest.approx(np.full(9, 1e9 / 30), abs=1.0)
    write_rrd(replace(full_recording(), video=Video(film)), tmp_path / "film.rrd")
    again = tentacle.read(tmp_path / "film.rrd")
    assert again.video is not None
    assert again.video.path.read_bytes() == bytes(content)


def test_the_times_of_a_films_pictures_are_those_that_rerun_reads(tmp_path: Path) -> None:
    film = small_video(tmp_path / "video.mp4")
    assert np.array_equal(frame_stamps(film), rr.AssetVideo(path=film).read_frame_timestamps_nanos())
    (tmp_path / "none.mp4").write_bytes(bytes(100))
    assert len(frame_stamps(tmp_path / "none.mp4")) == 0
