"""session.rrd holds what the diagnosis says, on one time line, small, whole or not at all."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rerun.chunk import RrdReader

from tentacle.errors import InputError
from tentacle.signals import Video
from viz.session import write_session
from viz.topics.forces import thrust_of
from viz.topics.verdict import verdict_markdown


def read(path: Path) -> dict[str, list]:
    """Entity path -> its record batches."""
    found: dict[str, list] = {}
    for chunk in RrdReader(str(path)).stream():
        found.setdefault(str(chunk.entity_path), []).append(chunk.to_record_batch())
    return found


def times_of(batch) -> np.ndarray:
    """The time line's column [s]; it counts whole nanoseconds."""
    return batch.column("time").cast("int64").to_numpy() / 1e9


def scalars(batches: list) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and values of the Scalars columns among batches."""
    times, values = [], []
    for batch in batches:
        if "Scalars:scalars" in batch.schema.names:
            times += times_of(batch).tolist()
            values += [row[0] for row in batch.column("Scalars:scalars").to_pylist()]
    return np.array(times), np.array(values)


def contents(batches: list) -> list[list[str]]:
    """Every value of an entity as text, without row ids; in no order, since batches are written as they fill."""
    return sorted(
        [b.column(name).to_string(window=10**6) for name in b.schema.names if "RowId" not in name] for b in batches
    )


@pytest.fixture(scope="module")
def written(case, tmp_path_factory) -> Path:
    return write_session(case.diagnosis, case.recordings, tmp_path_factory.mktemp("session") / "session.rrd")


def test_values_and_times_come_back_as_they_went_in(case, written):
    found = read(written)
    run = case.diagnosis.runs[0]
    for index, name in enumerate(("q1", "q2")):
        times, values = scalars(found[f"/runs/chirp\\ 1/{name}/augmented"])
        np.testing.assert_allclose(times, run.t, atol=1e-9)  # the time line counts whole nanoseconds
        np.testing.assert_array_equal(values, run.q_augmented[:, index])


def test_every_topic_of_every_run_is_there(written):
    found = read(written)
    topics = ["arms/measured", "arms/base", "arms/augmented", "arms/drag/base", "arms/thrust/augmented",
              "arms/water", "tip/measured", "q1/base", "q2/measured/low",
              "theta", "residual/base/map", "residual/augmented/now", "error/augmented", "spectrum", "thrust/measured",
              "thrust/base", "events"]  # fmt: skip
    for run in ("chirp\\ 1", "gait\\:\\ trial\\/2"):
        assert [topic for topic in topics if f"/runs/{run}/{topic}" not in found] == []
    assert "/verdict" in found
    assert "/runs/chirp\\ 1/camera/rejected" in found
    assert "/runs/gait\\:\\ trial\\/2/camera" not in found  # no video, no view of one


def test_the_enlarged_tip_stands_as_far_from_the_measured_one_as_in_the_run(case, written):
    run = case.diagnosis.runs[0]
    batches = read(written)["/runs/chirp\\ 1/tip/base/end"]
    drawn = [row[0] for b in batches if "time" in b.schema.names for row in b["Points2D:positions"].to_pylist() if row]
    away = 1e3 * (run.base - run.measured)[:, -1]  # [mm]
    known = away[np.isfinite(away).all(axis=1)]
    np.testing.assert_allclose(np.sort(drawn, axis=0), np.sort(known, axis=0), rtol=1e-5)  # single precision


def test_a_missing_instant_has_no_arm_and_the_others_have_24_pieces(case, written):
    pieces = [
        len(row)
        for batch in read(written)["/runs/chirp\\ 1/arms/measured"]
        if "time" in batch.schema.names
        for row in batch.column("LineStrips3D:strips").to_pylist()
    ]
    present = np.isfinite(case.diagnosis.runs[0].measured).all(axis=(1, 2))
    assert pieces == [24 if there else 0 for there in present]


def test_the_video_inside_is_av1_and_has_every_frame_at_its_time(case, written):
    batches = read(written)["/runs/chirp\\ 1/camera"]
    blob = next(b.column("AssetVideo:blob")[0].as_py()[0] for b in batches if "AssetVideo:blob" in b.schema.names)
    assert b"av01" in bytes(blob)
    times = np.concatenate([times_of(b) for b in batches if "time" in b.schema.names])
    np.testing.assert_allclose(times, case.diagnosis.runs[0].t, atol=1e-4)  # mp4 ticks: 1/90000 s and the source's own


def test_force_arrows_are_on_one_scale_and_add_up_to_the_thrust(case, written):
    """The longest drag arrow is half the arm; the thrust's is in proportion to the sum of the drag along y (eq. 17)."""
    run = case.diagnosis.runs[0]
    found, lengths = read(written), []
    for key in ("base", "augmented"):
        batches = [b for b in found[f"/runs/chirp\\ 1/arms/drag/{key}"] if "time" in b.schema.names]
        vectors = np.concatenate([np.array(row) for b in batches for row in b.column("Arrows3D:vectors").to_pylist()])
        lengths.append(np.linalg.norm(vectors, axis=1).max())
    assert max(lengths) == pytest.approx(0.07, rel=0.02)  # 12 of the 41 points are drawn
    thrust = thrust_of(run.drag_augmented, run.s, 0.14)
    batches = [b for b in found["/runs/chirp\\ 1/arms/thrust/augmented"] if "time" in b.schema.names]
    drawn = np.array([row[0][1] for b in batches for row in b.column("Arrows3D:vectors").to_pylist()])
    strongest = max(np.abs(thrust_of(drag, run.s, 0.14)).max() for drag in (run.drag_base, run.drag_augmented))
    np.testing.assert_allclose(drawn, 0.07 * thrust / strongest, atol=1e-8)  # float32


def test_small_on_disk(case, written):
    # 6 s, two runs, one video: 20 MB is allowed for 39 s of one run, which is 0.5 MB a second
    seconds = sum(run.t[-1] for run in case.diagnosis.runs)
    assert written.stat().st_size < 0.5e6 * seconds


def test_the_same_diagnosis_gives_the_same_chunks(case, written, tmp_path):
    again = read(write_session(case.diagnosis, case.recordings, tmp_path / "again.rrd"))
    before = read(written)
    assert before.keys() == again.keys()
    for path in before:
        if path.startswith(("/runs", "/verdict")):  # row ids come from the clock, the layout's ids too
            assert contents(before[path]) == contents(again[path]), path


def test_an_unreadable_video_leaves_no_file(case, tmp_path):
    broken = tmp_path / "video.mp4"
    broken.write_bytes(b"not a video")
    recordings = [replace(case.recordings[0], video=Video(broken))]
    with pytest.raises(InputError, match=r"video\.mp4.*cannot be read"):
        write_session(case.diagnosis, recordings, tmp_path / "session.rrd")
    assert [p.name for p in tmp_path.iterdir()] == ["video.mp4"]


def test_markers_are_points_with_lines_to_where_the_models_put_them(case, tmp_path):
    run = replace(case.diagnosis.runs[0], points="markers")
    found = read(write_session(replace(case.diagnosis, runs=(run,)), [], tmp_path / "markers.rrd"))
    assert "/runs/chirp\\ 1/arms/base/miss" in found
    lengths = [
        np.linalg.norm(np.subtract(strip[1], strip[0]))
        for batch in found["/runs/chirp\\ 1/arms/base/miss"]
        if "time" in batch.schema.names
        for row in batch.column("LineStrips3D:strips").to_pylist()
        for strip in row
    ]
    distance = np.linalg.norm(run.base - run.measured, axis=-1)
    # float32 positions of 0.1 m: 1e-8 m
    np.testing.assert_allclose(lengths, distance[np.isfinite(distance)], atol=1e-7)


def test_the_verdict_page_says_what_the_diagnosis_says(case):
    page = verdict_markdown(case.diagnosis)
    assert case.diagnosis.headline in page
    assert "| midline | mm | 10.5 | 0.31 | 0.21 |" in page
    assert "| current | speed | 0.052 | 0.047 to 0.058 | m/s |" in page


def test_two_recordings_of_one_name_are_both_shown_each_with_its_own_signals(case, tmp_path):
    first, second = case.recordings
    runs = tuple(replace(run, name="run") for run in case.diagnosis.runs)
    twins = [replace(first, name="run", video=None), replace(second, name="run")]
    found = read(write_session(replace(case.diagnosis, runs=runs), twins, tmp_path / "twins.rrd"))
    for path, recording in (("/runs/run", first), ("/runs/run\\ \\(2\\)", second)):
        _, thrust = scalars(found[f"{path}/thrust/measured"])
        np.testing.assert_array_equal(thrust, recording.load_cell.thrust)
