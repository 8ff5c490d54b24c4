"""The sessions of track, compare, optimise and the running rig: what they hold, and what they refuse."""

from __future__ import annotations

import re
import socket
import time
from dataclasses import replace
from pathlib import Path
from urllib.error import HTTPError
from urllib.parse import parse_qs, urljoin, urlsplit
from urllib.request import Request, urlopen

import numpy as np
import pytest
import rerun.blueprint as rrb
from rerun.chunk import RrdReader

from tentacle.errors import InputError
from tentacle.io.recording_rrd import write_rrd
from tentacle.recording import Recording
from tentacle.signals import AccelerationSignal, Accelerometer, StrainGauge, StrainSignal
from viz.blueprints.rig import LivePaths, rig_blueprint
from viz.compare import ComparedMotion, model_markdown, motions_scene, write_comparison
from viz.page import serve_web
from viz.track import track_scene, write_recording_view
from viz.viewer import DECLARATION, headless_viewer, holds, open_native, require_recordings, screenshot


def entities(path: Path) -> set[str]:
    return {str(chunk.entity_path) for chunk in RrdReader(str(path)).stream()}


def test_a_track_is_drawn_where_it_was_seen(case):
    scene = track_scene(case.recordings[0])
    run = case.diagnosis.runs[0]
    seen = np.isfinite(scene.subject.xy).all(axis=(1, 2))
    assert np.array_equal(seen, case.recordings[0].shape.accepted)
    # the run's points carry 0.15 mm of noise, and its own quadrature (trapezium, 41 points) 0.03 mm
    difference = scene.subject.xy[seen] - run.measured[seen]
    assert np.sqrt(np.mean(difference**2)) == pytest.approx(1.5e-4, rel=0.1)


def test_a_track_session_has_video_shape_and_bands_but_no_residual(case, tmp_path):
    found = entities(write_recording_view(case.recordings[0], tmp_path / "track.rrd"))
    assert {"/runs/chirp\\ 1/camera/measured", "/runs/chirp\\ 1/q1/measured/high", "/runs/chirp\\ 1/events"} <= found
    assert not any("residual" in path or "error" in path for path in found)


def test_a_recording_is_shown_with_whatever_it_has(case, tmp_path):
    whole = replace(case.recordings[0], shape=None)
    film = replace(whole, midline=None)
    found = entities(write_recording_view(whole, tmp_path / "midline.rrd"))
    assert "/runs/chirp\\ 1/camera/measured" in found
    found = entities(write_recording_view(film, tmp_path / "film.rrd"))
    assert {"/runs/chirp\\ 1/camera", "/runs/chirp\\ 1/theta", "/runs/chirp\\ 1/thrust/measured"} <= found


def test_every_sensor_of_a_recording_is_shown_with_each_of_its_readings(case, tmp_path):
    t = np.arange(0.0, 6.0, 0.01)
    felt = AccelerationSignal(t, ("tip",), (Accelerometer(1.0, 0.0, "normal"),), np.sin(t)[:, None])
    stretched = StrainSignal(t, ("root",), (StrainGauge(0.2, 0.01),), 0.01 * np.cos(t)[:, None])
    whole = replace(case.recordings[0], strain=stretched, acceleration=felt)
    shown = write_recording_view(whole, tmp_path / "sensors.rrd")
    assert {"/runs/chirp\\ 1/strain/root/measured", "/runs/chirp\\ 1/acceleration/tip/measured"} <= entities(shown)
    rows = [
        chunk.to_record_batch().num_rows
        for chunk in RrdReader(str(shown)).stream()
        if str(chunk.entity_path).endswith("/tip/measured") and not chunk.is_static
    ]
    assert sum(rows) == t.size


def test_a_session_is_told_from_a_recording(case, tmp_path):
    session = write_recording_view(replace(case.recordings[0], video=None), tmp_path / "session.rrd")
    assert not holds(session, DECLARATION)
    write_rrd(replace(case.recordings[0], video=None), tmp_path / "recording.rrd")
    assert holds(tmp_path / "recording.rrd", DECLARATION)


def test_two_models_are_held_against_one_another(case, tmp_path):
    run = case.diagnosis.runs[0]
    motions = {
        "MuJoCo reference": ComparedMotion(run.augmented),
        "affine/2": ComparedMotion(run.base, run.q_base, drag=run.drag_base),
    }
    scene = motions_scene("side by side", run.t, run.s, run.theta, motions)
    page = model_markdown(case.diagnosis.base_model, ("first mode 5.16 Hz",))
    declared = Recording("side by side", case.recordings[0].declaration)
    found = entities(write_comparison(scene, declared, page, tmp_path / "compare.rrd"))
    assert {"/page", "/runs/side\\ by\\ side/arms/affine\\/2", "/runs/side\\ by\\ side/arms/thrust/affine\\/2"} <= found
    assert "| elasticity | E | 210000 | 200000 to 220000 | Pa |" in page


def test_a_running_rig_is_followed_on_the_boards_time():
    """Every path is in a view, and the time panel follows the line that was asked for."""
    paths = LivePaths("/rig/a", "/rig/b", "/rig/c", "/rig/d", "/rig/e", "board_time", "/rig/f")
    blueprint = rig_blueprint(paths)
    said = str([vars(part) for part in walk(blueprint.root_container)])
    assert [path for path in ("/rig/a", "/rig/b", "/rig/c", "/rig/d", "/rig/e", "/rig/f") if path not in said] == []
    blind = rig_blueprint(replace(paths, camera=None))
    assert not any(isinstance(part, rrb.Spatial2DView) for part in walk(blind.root_container))
    assert blueprint.time_panel.timeline == "board_time"
    assert blueprint.time_panel.play_state == "following"


def walk(part):
    """A part of a layout and all that is inside it."""
    yield part
    for inner in getattr(part, "contents", []):
        if not isinstance(inner, str):
            yield from walk(inner)


def test_only_recordings_are_opened(tmp_path):
    text = tmp_path / "notes.rrd"
    text.write_text("not a recording")
    with pytest.raises(InputError, match=r"notes\.rrd.*not a Rerun recording"):
        require_recordings([text])
    with pytest.raises(InputError, match="no such file"):
        require_recordings([tmp_path / "absent.rrd"])


def test_the_viewer_listens_on_this_machine_only(monkeypatch):
    """The headless viewer's own command line says 127.0.0.1, and so does that of the window and of the web page."""
    asked = []

    def note(command, **_):
        asked.append(command)
        raise OSError("not started in this test")

    monkeypatch.setattr("viz.viewer.subprocess.Popen", note)
    monkeypatch.setenv("DISPLAY", ":0")
    with pytest.raises(OSError, match="not started"), headless_viewer():
        pass
    with pytest.raises(OSError, match="not started"):
        open_native([])
    with pytest.raises(OSError, match="not started"):
        serve_web([], told=print)
    assert [command[command.index("--bind") + 1] for command in asked] == ["127.0.0.1"] * 3


def test_a_web_page_is_served_here_alone_until_ctrl_c_and_nothing_is_left_behind(case, tmp_path):
    """The page and the data answer on 127.0.0.1, on no other address of this machine; then nobody listens any more."""
    session = write_recording_view(replace(case.recordings[0], video=None), tmp_path / "view.rrd")
    seen = []

    def visit(words: str) -> None:
        page = words.split()[0]
        html = fetched(page).decode()
        assert "<html" in html
        parts = [fetched(urljoin(page, name)) for name in re.findall(r"re_viewer[\w.]*\.(?:js|wasm)", html)]
        assert any(part.startswith(b"\0asm") for part in parts)  # the viewer itself comes from here, too
        with urlopen(page, timeout=20.0) as answer:  # the page itself would ask elsewhere (tests/viz/app)
            assert answer.headers["Content-Security-Policy"].startswith("default-src 'self'")
        data = parse_qs(urlsplit(page).query)["url"]
        assert [fetched(address) for address in data] == [session.read_bytes()]
        with pytest.raises(HTTPError, match="404"):
            fetched(urljoin(data[0], "hostname"))
        with pytest.raises(HTTPError, match="403"):
            fetched(urljoin(page, "/"))  # without the token
        with pytest.raises(HTTPError, match="403"):
            fetched(Request(data[0], headers={"Host": "example.org"}))  # a foreign name that leads here
        ports = [int(port) for port in set(re.findall(r"127\.0\.0\.1(?::|%3A)(\d+)", page))]
        assert len(ports) == 1  # page and data come from one place
        before = time.process_time()
        time.sleep(1.0)
        assert time.process_time() - before < 0.2  # nothing is busy while nobody asks
        others = {info[4][0] for info in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)}
        for address in others - {"127.0.0.1"}:
            assert [answers(address, port) for port in ports] == [False]
        seen.extend(ports)
        raise KeyboardInterrupt  # as the reader's Ctrl-C

    with pytest.raises(KeyboardInterrupt):
        serve_web([session], told=visit)
    deadline = time.monotonic() + 10.0
    while any(answers("127.0.0.1", port) for port in seen) and time.monotonic() < deadline:
        time.sleep(0.1)
    assert [answers("127.0.0.1", port) for port in seen] == [False]


def fetched(address: str | Request) -> bytes:
    with urlopen(address, timeout=20.0) as answer:
        return answer.read()


def answers(address: str, port: int) -> bool:
    with socket.socket() as probe:
        probe.settimeout(2.0)
        return probe.connect_ex((address, port)) == 0


def test_a_picture_without_a_screen_or_a_line_that_says_what_to_install(case, tmp_path):
    import cv2

    path = write_recording_view(replace(case.recordings[0], video=None), tmp_path / "track.rrd")
    try:
        screenshot([path], tmp_path / "view.png", at=1.0, settle=3.0)
    except InputError as error:
        assert "mesa-vulkan-drivers" in error.line()  # noqa: PT017
        assert not (tmp_path / "view.png").exists()
        pytest.skip(f"this machine draws no picture: {error.line()}")
    picture = cv2.imread(str(tmp_path / "view.png"))
    assert picture is not None
    blue = np.array([233, 180, 86])  # the measured party's colour, as OpenCV orders it
    assert np.sum(np.abs(picture.astype(int) - blue).max(axis=-1) < 12) > 500
