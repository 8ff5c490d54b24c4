"""The rig's commands as a user types them, against `tentacle rig emulate` over a real pty."""

from __future__ import annotations

import contextlib
import io
import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from benchmarks._rig_killed import killed_host
from benchmarks._rig_scene import NEUTRAL_US, setup_for
from rig.emulator import Emulator, read_truth
from rig.run_file import read_run
from rig.setup_file import read_setup, write_setup
from tentacle.cli import main
from tentacle.cli._live_viewer import start_viewer
from tentacle.cli._rig_terminal import viewer
from tentacle.specimen import STANDARD_GRAVITY
from viz.viewer import end_group, free_port

ROOT = Path(__file__).parents[2]
TENTACLE = [sys.executable, "-m", "tentacle"]
WAVE = '[waveform]\nkind = "sine"\namplitude_rad = 0.4\nfrequency_hz = 1.0\n'
CAMPAIGN = 'name = "c"\n[[run]]\nname = "a"\nduration_s = 0.5\n' + WAVE.replace("[waveform]", "[run.waveform]")


def started(*words: str) -> subprocess.Popen[str]:
    """A command in a process of its own."""
    return subprocess.Popen([*TENTACLE, *words], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def wait_for(what: Callable[[], bool], seconds: float = 30.0) -> None:
    until = time.monotonic() + seconds
    while not what():
        assert time.monotonic() < until
        time.sleep(0.01)


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory, compiler: None) -> Iterator[Path]:  # noqa: ARG001 (it skips)
    """`tentacle rig emulate` as it runs: its folder."""
    folder = tmp_path_factory.mktemp("bench")
    process = started("rig", "emulate", str(folder), "--no-camera")
    assert process.stdout is not None
    assert "rig check" in process.stdout.readline()
    yield folder
    process.send_signal(signal.SIGINT)
    assert process.wait(20) == 0
    assert "ended" in process.stdout.read()
    process.stdout.close()
    assert process.stderr is not None
    process.stderr.close()


def test_check_says_what_it_found(bench: Path, capsys: pytest.CaptureFixture[str]) -> None:
    status = main(["rig", "check", str(bench / "rig.toml"), "--json"])
    found = {item["name"]: item for item in json.loads(capsys.readouterr().out)}
    assert status == (0 if all(item["good"] for item in found.values()) else 3)
    # Round trips depend on how busy this computer is; these do not.
    for name in ("limits obeyed by the board", "neutral after silence, at worst", "damaged frames", "servo, frames"):
        assert found[name]["good"]
    assert found["load cell, rate"]["value"] == pytest.approx(93.5, rel=0.02)  # 10.7 ms a conversion
    assert found["load cell, noise"]["value"] == pytest.approx(60 / 180, rel=0.3)  # mN: 60 counts, 180 a mN


def test_ports_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["rig", "ports"]) == 0
    assert capsys.readouterr().out


def test_a_rig_that_is_not_there_is_one_line(bench: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (bench / "rig.toml").read_text()
    (tmp_path / "rig.toml").write_text(text.replace('port = "port"', 'port = "/dev/ttyNONE"'))
    assert main(["rig", "check", str(tmp_path / "rig.toml")]) == 3
    (tmp_path / "rig.toml").write_text(text.replace("max_current_a", "max_curent_a"))
    assert main(["rig", "check", str(tmp_path / "rig.toml")]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 2
    assert "link_lost: /dev/ttyNONE cannot be opened" in lines[0]
    assert "rig.toml" in lines[1]
    assert "max_current_a: missing" in lines[1]


def test_ctrl_c_twice_stops_the_motor_and_writes_the_stop_record(bench: Path, tmp_path: Path) -> None:
    (tmp_path / "wave.toml").write_text(WAVE)
    out = tmp_path / "run.rrd"
    words = [
        "rig",
        "record",
        str(bench / "rig.toml"),
        str(tmp_path / "wave.toml"),
        "--seconds",
        "40",
        "--out",
        str(out),
    ]
    with started(*words) as process:
        wait_for(lambda: 100 < abs(read_truth(bench / "truth").pulse_us - NEUTRAL_US) < NEUTRAL_US)  # 0: limp
        process.send_signal(signal.SIGINT)
        time.sleep(0.3)
        assert process.poll() is None  # the first waits for the run's end
        process.send_signal(signal.SIGINT)
        said, complaints = process.communicate(timeout=20)
        assert process.returncode == 130
    assert read_truth(bench / "truth").pulse_us == NEUTRAL_US
    assert said.startswith("interrupted: ")
    assert "Ctrl-C again stops the motor now" in complaints
    run = read_run(out)
    assert run.outcome == "interrupted"
    assert run.stop is not None
    assert run.stop["counters"]["samples_lost"] == 0


@pytest.mark.parametrize("what", ["its terminal is closed", "the host sleeps"])
def test_a_run_that_loses_its_host_says_so(bench: Path, tmp_path: Path, what: str) -> None:
    (tmp_path / "wave.toml").write_text(WAVE)
    out = tmp_path / "run.rrd"
    words = ["rig", "record", str(bench / "rig.toml"), str(tmp_path / "wave.toml"), "--seconds", "10"]
    with started(*words, "--out", str(out)) as process:
        wait_for(lambda: 100 < abs(read_truth(bench / "truth").pulse_us - NEUTRAL_US) < NEUTRAL_US)
        if what == "the host sleeps":
            process.send_signal(signal.SIGSTOP)
            wait_for(lambda: read_truth(bench / "truth").pulse_us == NEUTRAL_US)  # the board's watchdog
            process.send_signal(signal.SIGCONT)
        else:
            process.send_signal(signal.SIGHUP)
        process.communicate(timeout=20)
        assert process.returncode == (3 if what == "the host sleeps" else 128 + signal.SIGHUP)
    assert read_truth(bench / "truth").pulse_us == NEUTRAL_US
    run = read_run(out)
    assert run.outcome == ("watchdog" if what == "the host sleeps" else "interrupted")
    assert not run.missing


def test_a_campaign_is_made_once(bench: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "c.toml").write_text(CAMPAIGN)
    words = ["rig", "campaign", str(bench / "rig.toml"), str(tmp_path / "c.toml"), "--out", str(tmp_path / "runs")]
    assert main(words) == 0
    assert "a.rrd: complete" in capsys.readouterr().out
    assert main(words) == 0
    assert "a.rrd" not in capsys.readouterr().out


def test_a_run_becomes_an_import_folder_and_is_replayed(bench: Path, tmp_path: Path) -> None:
    (tmp_path / "wave.toml").write_text(WAVE)
    rig, run = str(bench / "rig.toml"), str(tmp_path / "run.rrd")
    assert main(["rig", "record", rig, str(tmp_path / "wave.toml"), "--seconds", "2", "--out", run]) == 0
    assert main(["rig", "record", rig, str(tmp_path / "wave.toml"), "--seconds", "2", "--out", run]) == 2  # taken
    assert main(["rig", "import", run, "--out", str(tmp_path / "folder")]) == 0
    assert {"recording.toml", "motor.csv", "load_cell.csv"} <= {file.name for file in (tmp_path / "folder").iterdir()}
    assert main(["replay", run, "--drive", rig, "--out", str(tmp_path / "again")]) == 0
    assert read_run(tmp_path / "again" / "run-replayed.rrd").outcome == "complete"


class Typed(io.StringIO):
    """Standard input whose lines are typed when they are asked for, after something was done."""

    def __init__(self, *deeds: Callable[[], str]) -> None:
        super().__init__()
        self._deeds = iter(deeds)

    def readline(self, *_: object) -> str:  # type: ignore[override]
        return next(self._deeds)() + "\n"


def test_load_cell_and_servo_are_calibrated(
    emulator: Emulator, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "rig.toml"
    write_setup(setup_for(emulator), file)
    masses = (0.0, 0.02, 0.05)

    def hang(mass: float) -> str:
        emulator.say("load", mass * STANDARD_GRAVITY)
        return ""

    monkeypatch.setattr(sys, "stdin", Typed(*(lambda m=m: hang(m) for m in masses)))
    words = ["rig", "calibrate", "load-cell", str(file), "--seconds", "0.5", "--masses", *map(str, masses)]
    assert main(words) == 0
    cell = read_setup(file).load_cell
    sigma = 60 / np.sqrt(47) / (0.035 * STANDARD_GRAVITY)  # 47 readings of 60 counts, over the spread of the loads
    assert cell.slope == pytest.approx(emulator.settings.counts_per_newton, abs=5 * sigma)
    assert capsys.readouterr().out.count("residual") == 3

    monkeypatch.setattr(sys, "stdin", Typed(*(lambda: "" for _ in masses)))
    before = file.read_text()
    assert main(words) == 2  # nothing was put on: no line, and nothing is written
    assert file.read_text() == before

    monkeypatch.setattr(sys, "stdin", Typed(lambda: "0.21", lambda: "-0.19"))
    assert main(["rig", "calibrate", "servo", str(file), "--seconds", "0.5", "--angles", "0.2", "-0.2"]) == 0
    servo = read_setup(file).servo  # 0.01 rad off at either end: the horn is 0.01 rad off
    assert servo.centre_us == pytest.approx(1500 - 0.01 * 2000 / np.pi)
    assert servo.us_per_rad == pytest.approx(2000 / np.pi)
    monkeypatch.setattr(sys, "stdin", Typed(lambda: "a lot", lambda: "0"))
    assert main(["rig", "calibrate", "servo", str(file), "--seconds", "0.5", "--angles", "0.2", "-0.2"]) == 2
    assert (
        main(["rig", "calibrate", "load-cell", str(file), "--masses", "0", "0.1"]) == 2
    )  # two masses show no residual


def listening(of: Callable[[str], bool]) -> set[str]:
    """Addresses (hexadecimal, as /proc/net/tcp has them) on which the processes listen whose command line is `of`."""
    inodes = set()
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if of((process / "cmdline").read_text()):
                inodes |= {str(entry.readlink()) for entry in (process / "fd").iterdir()}
        except OSError:
            continue  # it has ended meanwhile
    assert inodes
    found = set()
    for table in ("tcp", "tcp6", "udp", "udp6"):
        for line in Path("/proc/net", table).read_text().splitlines()[1:]:
            words = line.split()
            if f"socket:[{words[9]}]" in inodes and (words[3] == "0A" or table.startswith("udp")):
                found.add(words[1])
    return found


def two_free_ports() -> tuple[int, int]:
    """Two ports that differ: the first is held while the second is drawn."""
    with socket.socket() as first:
        first.bind(("127.0.0.1", 0))
        return first.getsockname()[1], free_port()


@pytest.mark.skipif(not Path("/proc/net/tcp").exists(), reason="no /proc/net here")
def test_nothing_listens_beyond_this_machine(bench: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert listening(lambda words: str(bench) in words) == set()  # the emulator opens no socket at all
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    port, page = two_free_ports()
    shown = start_viewer(port, page)
    assert shown is not None
    try:
        assert start_viewer(port, page) is None  # the next run takes the same
        wait_for(lambda: len(listening(lambda words: f"--port\0{port}\0" in words)) >= 2)
        addresses = listening(lambda words: f"--port\0{port}\0" in words)
    finally:
        os.killpg(shown.pid, signal.SIGKILL)
        shown.wait()
    assert addresses == {f"0100007F:{port:04X}", f"0100007F:{page:04X}"}


@pytest.mark.parametrize("outcome", ["complete", "interrupted"])
def test_the_live_viewer_stays_after_a_complete_run_alone(outcome: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    (port, page), started = two_free_ports(), []

    def start(port: int) -> subprocess.Popen[bytes] | None:
        started.append(start_viewer(port, page))
        return started[0]

    monkeypatch.setattr("tentacle.cli._rig_terminal.VIEWER_PORT", port)
    monkeypatch.setattr("tentacle.cli._live_viewer.start_viewer", start)
    with contextlib.suppress(KeyboardInterrupt), viewer(True, camera=False) as live:
        live.kept = outcome == "complete"
        if outcome == "interrupted":
            raise KeyboardInterrupt
    with socket.socket() as probe:
        assert (probe.connect_ex(("127.0.0.1", port)) == 0) == (outcome == "complete")
    end_group(started[0])


@pytest.mark.usefixtures("compiler")
def test_a_killed_optimisation_goes_on(tmp_path: Path) -> None:
    outcome = killed_host(tmp_path)
    assert outcome.good, outcome.words
