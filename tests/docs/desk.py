"""What a reader of the documentation has on the desk: a shell, an arm, recordings of it, and an emulated rig."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from docs.arm import shown_arm
from tentacle.cli import main
from tests.docs.shown import ROOT

SPEEDS = "arm,motion,speed_m_s\n14 cm,sine,0.0012\n14 cm,sine,0.0010\n14 cm,optimised,0.0066\n"
CALIBRATION = 'made = "3 trials"\n[effect]\ntrials = 3\nstated = [0.0, 1.0]\nright = [0.1, 0.9]\n'


def environment(folder: Path) -> dict[str, str]:
    """A shell in which `tentacle`, `python`, `pip`, `pytest`, `dask` and `rerun` are this checkout's; no screen."""
    programs = folder / "programs"
    programs.mkdir()
    for name, arguments in (
        ("tentacle", "-c 'import sys, tentacle.cli; sys.exit(tentacle.cli.main())'"),
        ("python", ""), ("pip", "-m pip"), ("pytest", "-m pytest"), ("dask", "-m dask"),
        ("rerun", "-m rerun_cli"),
    ):  # fmt: skip
        script = programs / name
        script.write_text(f'#!/bin/sh\nexec "{sys.executable}" {arguments} "$@"\n')
        script.chmod(0o755)
    # nor anything that a reader's shell does not have: with the last, words that wait in a buffer would come at once
    absent = ("DISPLAY", "WAYLAND_DISPLAY", "PYTHONUNBUFFERED")
    bare = {name: value for name, value in os.environ.items() if name not in absent}
    return {**bare, "PYTHONPATH": str(ROOT), "PATH": f"{programs}:{os.environ['PATH']}", "OMP_NUM_THREADS": "1"}


def film_an_arm(folder: Path) -> None:
    """The reader's own video and motor log: a dark cone that swings as a stiff rod, 30 frames."""
    import cv2

    folder.mkdir()
    writer = cv2.VideoWriter(str(folder / "video.mp4"), cv2.VideoWriter.fourcc(*"mp4v"), 30.0, (640, 360))
    t = np.arange(30) / 30
    theta = 0.3 * np.sin(2 * np.pi * t)
    for angle in theta:
        picture = np.full((360, 640, 3), 210, np.uint8)
        tip = 175 * np.array([-np.sin(angle), np.cos(angle)])
        side = 15.6 * np.array([np.cos(angle), np.sin(angle)])
        corners = np.array([side, -side, tip]) + np.array([320, 40])
        cv2.fillPoly(picture, [corners.round().astype(np.int32)], (50, 50, 50))
        writer.write(picture)
    writer.release()
    rows = [f"{a:.4f},{b:.6f},{b:.6f}" for a, b in zip(t, theta, strict=True)]
    (folder / "motor.csv").write_text("t_s,command_rad,angle_rad\n" + "\n".join(rows) + "\n")


def asked(command: str) -> None:
    """A verb in this process; it must succeed."""
    assert main(command.split()) == 0, command


def set_desk(desk: Path) -> Path:
    """Everything that a shown command reads, small: 3 s of one arm, filmed and as midlines; what verbs made of it."""
    desk.mkdir()
    (desk / "arm.toml").write_text(shown_arm())
    (desk / "long.toml").write_text(shown_arm().replace("length_m = 0.14", "length_m = 0.2"))
    shutil.copy(desk / "arm.toml", desk / "short.toml")
    chirp, sine = "--chirp 0.5 0.3 2 --duration 3 --fps 20", "--sine 0.4 2 --duration 3 --fps 20"
    asked(f"simulate {desk}/arm.toml --out {desk}/my_arm {chirp} --video clean --size 320 240")
    asked(f"track {desk}/my_arm --out {desk}/my_arm.rrd")  # so neither the figures nor the diagnosis need do it again
    asked(f"simulate {desk}/arm.toml --out {desk}/sine.rrd {sine}")
    asked(f"simulate {desk}/arm.toml --out {desk}/chirp.rrd {chirp}")
    asked(f"identify {desk}/sine.rrd --out {desk}/answer")
    asked(f"export {desk}/answer/model.toml --out {desk}/arm")
    for name in ("a", "b", "c", "again/trial_0017"):
        (desk / name).parent.mkdir(exist_ok=True)
        shutil.copy(desk / "sine.rrd", desk / f"{name}.rrd")
    for name in ("session.rrd", "gait/session.rrd"):
        (desk / name).parent.mkdir(exist_ok=True)
        shutil.copy(desk / "answer" / "session.rrd", desk / name)
    shutil.copy(desk / "my_arm.rrd", desk / "my_arm_tracked.rrd")
    (desk / "like_mine").mkdir()
    (desk / "like_mine" / "calibration.toml").write_text(CALIBRATION)
    shutil.copy(desk / "answer" / "model.toml", desk / "model.toml")
    shutil.copy(desk / "my_arm" / "recording.toml", desk / "recording.toml")
    for name in ("video.mp4", "film.mp4"):
        shutil.copy(desk / "my_arm" / "video.mp4", desk / name)
    (desk / "films").mkdir()
    for name in ("one.mp4", "two.mp4"):
        shutil.copy(desk / "video.mp4", desk / "films" / name)
    for name in ("run_1", "run_2", "film_recording"):
        shutil.copytree(desk / "my_arm", desk / name)
    film_in_matroska(desk / "video.mp4", desk / "camera.mkv")
    (desk / "speeds.csv").write_text(SPEEDS)
    (desk / "hidden.json").write_text('{"tip_mass": {"mass": 0.006}}')
    rows = [f"{k / 80:.4f},{52000 + 1800 * k % 7},{(1800 * k % 7) / 1765:.5f}" for k in range(80)]
    (desk / "log.csv").write_text("TIME,COUNTS,GRAMS\n" + "\n".join(rows) + "\n")
    wave = re.search(r"```toml\n(\[waveform\].*?)```", (ROOT / "docs" / "howto" / "rig.md").read_text(), re.DOTALL)
    assert wave is not None
    (desk / "wave.toml").write_text(wave[1])
    (desk / "blind.json").write_text('{"figures": {"top1": 0.9}}')
    (desk / "docs").mkdir()
    for name in ("README.md", "docs/measured.md"):  # with the tables that benchmarks/readme_table.py makes anew
        shutil.copy(ROOT / name, desk / name)
    # benchmarks/rig.py and vision.py must not stand for the rooms of those names, which lie beside them in a checkout.
    for name in ("examples", "benchmarks", "rig", "vision"):
        shutil.copytree(ROOT / name, desk / name, ignore=shutil.ignore_patterns("__pycache__"))
    return desk


def film_in_matroska(video: Path, file: Path) -> None:
    """The same frames in a container that needs no index."""
    import av

    with av.open(str(video)) as source, av.open(str(file), "w") as target:
        stream = source.streams.video[0]
        copy = target.add_stream_from_template(stream)
        for packet in source.demux(stream):
            if packet.dts is not None:
                packet.stream = copy
                target.mux(packet)


@contextmanager
def begun(command: str, folder: Path, shell: dict[str, str], until: str, seconds: float = 240.0) -> Iterator[Path]:
    """A command while it runs, from the moment that it has said `until` or written a file of that pattern.

    Gives the file with what it says. It is ended by Ctrl-C, as by hand, and whatever it started with it. The
    first command of a new checkout compiles its kernels: 20 s on a free computer, hence the patience.
    """
    said = folder / f"said_{len(list(folder.glob('said_*')))}.txt"
    with said.open("w") as stream:
        process = subprocess.Popen(
            ["bash", "-c", f"exec {command}"], cwd=folder, env=shell, stdout=stream,
            stderr=subprocess.STDOUT, start_new_session=True,
        )  # fmt: skip
    try:
        deadline = time.monotonic() + seconds
        while until not in said.read_text() and not next(folder.glob(until), None):
            assert process.poll() is None, f"{command}\n{said.read_text()}"
            assert time.monotonic() < deadline, f"{command}\n{said.read_text()}"
            time.sleep(0.05)
        yield said
        os.killpg(process.pid, signal.SIGINT)
        status = process.wait(30)
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
    text = said.read_text()
    if not command.startswith("dask"):  # stopped while it starts its workers, it says so at length
        assert status in (0, 2, 130, -signal.SIGINT), f"{command}\n{text}"  # 2: make, whose recipe was stopped
        assert "Traceback" not in text, f"{command}\n{text}"
