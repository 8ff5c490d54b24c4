"""Faults brought about on an emulated rig, over a real pty, and what came of each."""

from __future__ import annotations

import random
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks._rig_scene import (
    DECLARED,
    LIMITS,
    TABLE,
    WAVE,
    damage,
    gaps,
    killed_while_recording,
    once,
    played,
    setup_for,
    to_neutral,
    wrong_samples,
)
from rig.board import Board
from rig.build_core import compiled
from rig.calibrate import camera_offset
from rig.camera import CameraThread
from rig.connection import connected, opened_camera
from rig.emulated_camera import EmulatedOptics, EmulatedSource
from rig.emulator import Emulator, EmulatorSettings
from rig.link import Link
from rig.motion import rig_motion
from rig.play import arm_board
from rig.protocol import BoardEvent, LoadSample, Parser, Type, WireFrame, encode
from rig.record import Attendance, record_run
from rig.run_file import read_run
from rig.safety import ServoCalibration
from rig.setup_file import CameraSettings

PAGE = Path(__file__).parents[1] / "docs" / "protocol.md"


@dataclass(frozen=True)
class Outcome:
    """A fault that was brought about, what came of it, and whether that is what should come of it."""

    fault: str
    words: str
    good: bool


def long_run(folder: Path, seconds: float) -> dict[str, float]:
    """Samples at full rate: none lost, none doubled, the clock and the camera's delay against the truth."""
    with Emulator(folder, EmulatorSettings(seed=11, skew_ppm=60.0)) as emulator:
        setup = setup_for(emulator, camera=CameraSettings("emulated"))
        errors: list[float] = []

        def compare(_: float) -> None:
            if len(board.clock) > 20:
                fit, now = board.clock.fit(), time.monotonic()
                errors.append(abs(fit.to_board(now) - emulator.truth().board_time(now)))

        with connected(setup) as board, opened_camera(setup, board.time) as camera:
            assert camera is not None
            offset = camera_offset(board, camera, flashes=24)
            due = [1.0]

            def act(elapsed: float) -> None:
                if elapsed > due[0]:
                    compare(elapsed)
                    due[0] += 1.0

            samples, start, end = played(board, seconds, act)
            counters = board.counters
    numbers = np.array([s.number for s in samples])
    missing = int(numbers[-1] - numbers[0] + 1 - len(set(numbers.tolist()))) + counters.samples_lost
    doubled = len(numbers) - len(set(numbers.tolist()))
    loads = sum(isinstance(s, LoadSample) for s in samples)
    truth = EmulatedOptics.of(DECLARED).offset
    print(f"{seconds:.0f} s: {end.outcome}, {loads} load cell and {len(samples) - loads} other samples, "
          f"{missing} lost, {doubled} doubled, {wrong_samples(samples, start, seconds)} wrong")  # fmt: skip
    print(f"clock: worst error {1e3 * max(errors):.3f} ms; camera: {1e3 * offset.offset:.2f} "
          f"+- {1e3 * offset.sigma:.2f} ms, true {1e3 * truth:.2f} ms")  # fmt: skip
    if end.outcome != "complete":
        raise RuntimeError(
            f"the long run ended as {end.outcome} ({end.words}): it has no figures; is the machine quiet?"
        )
    return {
        "samples_lost": float(missing + doubled),
        "clock_ms": 1e3 * max(errors),
        "camera_offset_ms": 1e3 * abs(offset.offset - truth),
    }


def faulty_line(folder: Path, share: float, seconds: float) -> tuple[Outcome, int]:
    """So large a share of the bytes corrupted, as large a one dropped, and as large a one doubled, both ways."""
    with Emulator(folder, EmulatorSettings(seed=12)) as emulator:
        board = Board(Link(emulator.url))
        board.connect()
        emulator.say("line", share, share, share)
        arm_board(board, LIMITS, ServoCalibration())
        samples, start, end = played(board, seconds)
        counters = board.counters
        emulator.say("line", 0.0, 0.0, 0.0)
        board.close()
        neutral = to_neutral(emulator)
    wrong = wrong_samples(samples, start, seconds)
    words = (
        f"{end.outcome}; {counters.host_bad_frames} + {counters.board_bad_frames} frames damaged, "
        f"{counters.retries} retries, {counters.samples_lost} samples lost, {wrong} wrong accepted"
    )
    whole = end.outcome == "complete" and gaps(samples) == counters.samples_lost == 0
    stopped = end.outcome != "complete" and bool(end.words)  # it says why
    good = wrong == 0 and neutral < 1.0 and (whole or stopped)
    name = f"{100 * share:.2g} % of bytes corrupted, dropped and doubled each, {seconds:.0f} s"
    return Outcome(name, words, good), wrong


def run_faults(folder: Path) -> tuple[list[Outcome], list[float]]:
    """Faults in the middle of a run, each on a fresh board."""
    outcomes: list[Outcome] = []
    neutral: list[float] = []

    def trial(name: str, deed: Callable[[Emulator], None], expected: tuple[str, ...], at: float = 1.0) -> None:
        with Emulator(folder / name.split()[0], EmulatorSettings(seed=13)) as emulator:
            board = Board(Link(emulator.url))
            board.connect()
            arm_board(board, LIMITS, ServoCalibration())
            samples, start, end = played(board, 4.0, once(at, lambda: deed(emulator)))
            after = to_neutral(emulator)
            events = ", ".join(sorted({f"{s.code}" for s in samples if isinstance(s, BoardEvent)}))
            good = end.outcome in expected and after < 1.0 and wrong_samples(samples, start, 4.0) == 0
            outcomes.append(
                Outcome(
                    name,
                    f"{end.outcome}; gaps {gaps(samples)}; events {events}; at neutral {after:.2f} s after the end",
                    good,
                )
            )
            board.close()

    def unplug(emulator: Emulator) -> None:
        emulator.say("unplug")
        neutral.append(to_neutral(emulator))
        emulator.say("replug")

    trial("unplug and replug", unplug, ("link_lost", "watchdog"))
    trial("reset of the board", lambda e: e.say("reset"), ("board_reset",))
    trial("jammed servo", lambda e: e.say("jam", 1), ("overcurrent",))
    trial("mute board for 0.15 s", lambda e: e.say("mute", 0.15), ("complete",))
    trial("cell cable off for good", lambda e: e.say("cell_off", 1), ("complete",))
    trial("read of the cell cut by an interrupt", lambda e: e.say("cell_glitch"), ("complete",))
    trial("hung host for 0.6 s", lambda _: time.sleep(0.6), ("watchdog",))
    return outcomes, neutral


def killed_host(folder: Path, times: int) -> tuple[Outcome, float, float]:
    """kill -9 of the recording process, each time at another angle of the arm."""
    back: list[float] = []
    tails: list[float] = []
    crashed = True
    for k in range(times):
        with Emulator(folder / str(k), EmulatorSettings(seed=14 + k)) as emulator:
            path, neutral, killed = killed_while_recording(emulator, folder / str(k), 1.7 + 0.13 * k)
            back.append(neutral)
            run = read_run(path)
            crashed &= run.outcome == "crashed"
            tails.append(killed - float(run.load_t[-1]))
    words = (
        f"at neutral within {max(back):.3f} s; file read up to {max(tails):.3f} s before the kill, marked as crashed"
    )
    good = crashed and max(back) <= 0.5 and max(tails) <= 0.3
    return Outcome("host killed -9", words, good), max(back), max(tails)


def full_disk(folder: Path) -> Outcome:
    with Emulator(folder, EmulatorSettings(seed=15)) as emulator:
        setup = setup_for(emulator)
        begun = time.monotonic()
        with connected(setup) as board:
            result = record_run(
                setup,
                board,
                None,
                rig_motion(WAVE, 20.0, setup.limits, TABLE),
                folder / "full.rrd",
                Attendance(name="full", free_bytes=lambda _: 0 if time.monotonic() - begun > 4.0 else 10**10),
            )
            after = to_neutral(emulator)
        run = read_run(folder / "full.rrd")
    good = result.outcome == run.outcome == "disk" and after < 0.6 and len(run.load) > 50
    return Outcome("disk full", f"{result.outcome}: {result.words}; {len(run.load)} readings in the file", good)


def stalled_camera(folder: Path) -> Outcome:
    with Emulator(folder, EmulatorSettings(seed=16)) as emulator:
        setup = setup_for(emulator, camera=CameraSettings("emulated", 0.049, 0.001))
        optics = replace(EmulatedOptics.of(DECLARED), stall=(5.0, 6.5))
        with connected(setup) as board:
            camera = CameraThread(lambda: EmulatedSource(emulator.trace, optics, board.time), board.time)
            motion = rig_motion(WAVE, 4.0, setup.limits, TABLE)
            result = record_run(setup, board, camera, motion, folder / "stall.rrd", Attendance(name="stall"))
            camera.close()
        run = read_run(folder / "stall.rrd")
    seconds = [round(b - a, 2) for a, b in run.stop["camera"]["gaps_host_s"]] if run.stop else []
    words = f"{result.outcome}, {result.lost} samples lost; gap written down: {seconds} s"
    return Outcome(
        "camera stalls for 1.5 s", words, result.outcome == "complete" and result.lost == 0 and len(seconds) == 1
    )


def fuzz(frames: int) -> Outcome:
    """Both parsers: the board's with sanitizers and a servo pin that checks, the host's against the original frames."""
    command = [str(compiled("core_check")), "--vectors", str(PAGE), "--random", str(frames), "--mutated", str(frames)]
    board = subprocess.run(command, capture_output=True, text=True, check=False)
    source, wrong = random.Random(3), 0
    parser = Parser()
    for _ in range(frames):
        parser.feed(source.randbytes(source.randrange(1, 60)) + b"\0")
    for number in range(frames):
        original = encode(
            WireFrame(Type.LOAD, number & 255, (number & 0xFFFFFFFF).to_bytes(4, "little") + source.randbytes(12))
        )
        data = bytearray(original)
        damage(data, source)
        wrong += sum(encode(frame) != original for frame in Parser().feed(bytes(data) + b"\0"))
    words = f"board: {' / '.join(board.stdout.strip().splitlines()[-3:])}; host: {wrong} damaged frames accepted"
    return Outcome(
        f"fuzz, {frames} random and {frames} mutated frames, both parsers", words, board.returncode == 0 and wrong == 0
    )
