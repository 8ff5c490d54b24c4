"""An emulated rig over a real pty, and what the rig's tests and benchmarks do with it."""

from __future__ import annotations

import random
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

from rig.board import Board
from rig.emulator import Emulator
from rig.play import PlayEnd, PlayStart, play
from rig.protocol import BoardEvent, EventCode, LoadSample, Sample, ServoSample
from rig.safety import SafetyLimits, set_points
from rig.settle import SettleRule
from rig.setup_file import LoadCellCalibration, RigSetup, write_setup
from tentacle.io.declaration_file import RecordingFile
from tentacle.recording import Camera, Declaration
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Sine

LIMITS = SafetyLimits(min_angle=-0.8, max_angle=0.8, max_speed=8.0, max_current=0.9)
SPECIMEN = Specimen(Cone(0.0125, 0.0015), 0.14, 1070.0)
CAMERA = Camera(30.0, 0.0008, (160.0, 24.0), (0.0, 1.0), exposure=0.008)
DECLARED = Declaration(SPECIMEN, WATER, camera=CAMERA)
WAVE = Sine(0.5, 1.0)
TABLE = {"kind": "sine", "amplitude_rad": 0.5, "frequency_hz": 1.0}
NEUTRAL_US = 1500
ENDED = (EventCode.COMPLETE, EventCode.UNDERRUN, EventCode.WATCHDOG, EventCode.OVERCURRENT, EventCode.STOPPED)


def setup_for(emulator: Emulator, **changes: object) -> RigSetup:
    """rig.toml of an emulated rig, with changes."""
    settings = emulator.settings
    setup = RigSetup(
        port=emulator.url,
        limits=LIMITS,
        settle=SettleRule(threshold=2e-3, samples=60, timeout=60.0),
        load_cell=LoadCellCalibration(settings.cell_offset, settings.counts_per_newton),
        recording=RecordingFile(DECLARED),
        rate=settings.rate,
    )
    return replace(setup, **changes)  # type: ignore[arg-type]


def played(
    board: Board, seconds: float, act: Callable[[float], None] | None = None
) -> tuple[list[Sample], PlayStart, PlayEnd]:
    """WAVE for so long on an armed board; act is called all along with the seconds since the start."""
    samples: list[Sample] = []
    start, end = PlayStart(0), PlayEnd("no_answer", "", 0)
    begun = time.monotonic()
    for item in play(board, set_points(WAVE, seconds, LIMITS), LIMITS):
        if isinstance(item, PlayStart):
            start, begun = item, time.monotonic()
        elif isinstance(item, PlayEnd):
            end = item
        else:
            samples += item
        if act is not None and start.start_us:
            act(time.monotonic() - begun)
    return samples, start, end


def once(when: float, deed: Callable[[], None]) -> Callable[[float], None]:
    """Calls deed() the first time that so many seconds have passed."""
    done: list[bool] = []

    def act(elapsed: float) -> None:
        if elapsed > when and not done:
            done.append(True)
            deed()

    return act


def to_neutral(emulator: Emulator, give_up: float = 3.0) -> float:
    """Seconds until the pin is at neutral, or gives no pulse; about give_up where it does neither."""
    begun = time.monotonic()
    while emulator.truth().pulse_us not in (NEUTRAL_US, 0.0) and time.monotonic() - begun < give_up:
        time.sleep(0.002)
    return time.monotonic() - begun


def gaps(samples: list[Sample]) -> int:
    """Places where a number is missing, doubled, or out of order."""
    numbers = [sample.number for sample in samples]
    return sum(later != earlier + 1 for earlier, later in pairwise(numbers))


def wrong_samples(samples: list[Sample], start: PlayStart, seconds: float) -> int:
    """Samples that cannot be what the board measured: commands off the waveform, counts off the cell, times that
    fall.
    """
    if not start.start_us:
        return 0  # it never started: there is nothing to compare with
    wrong, last = 0, -1
    ends = [s.board_us for s in samples if isinstance(s, BoardEvent) and s.code in ENDED]
    seconds = min([seconds, *(1e-6 * (us - start.start_us) for us in ends)])
    for sample in samples:
        wrong += sample.board_us < last
        last = sample.board_us
        if isinstance(sample, ServoSample):
            t = 1e-6 * (sample.board_us - start.start_us)
            if 0.2 < t < seconds - 0.1:
                wrong += abs(1e-6 * sample.command_urad - float(WAVE(t)[0])) > 2e-3
        elif isinstance(sample, LoadSample):
            wrong += not 30000 < sample.counts < 74000
    return wrong


_CHILD = """
import sys
from pathlib import Path
from rig.connection import connected
from rig.motion import rig_motion
from rig.record import Attendance, record_run
from rig.setup_file import read_setup
from tentacle.waveform import Sine
setup = read_setup(Path(sys.argv[1]))
with connected(setup) as board:
    say = lambda phase, share: print(phase, flush=True)
    motion = rig_motion(Sine(0.5, 1.0), 60.0, setup.limits, {})
    record_run(setup, board, None, motion, Path(sys.argv[2]), Attendance(name="killed", progress=say))
"""


def killed_while_recording(emulator: Emulator, folder: Path, seconds: float) -> tuple[Path, float, float]:
    """Another process records, and is killed (-9) so many seconds into the run.

    The recording, seconds until the pin was at neutral, and the board time [s] of the kill.
    """
    folder.mkdir(parents=True, exist_ok=True)
    write_setup(setup_for(emulator), folder / "rig.toml")
    path = folder / "killed.rrd"
    words = [sys.executable, "-c", _CHILD, str(folder / "rig.toml"), str(path)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None
        while "running" not in child.stdout.readline():
            if child.poll() is not None:
                raise RuntimeError("the recording process ended by itself")
        threading.Thread(target=child.stdout.read, daemon=True).start()
        time.sleep(seconds)
        killed = 1e-6 * emulator.truth().board_us
        child.kill()
        return path, to_neutral(emulator), killed


def damage(data: bytearray, source: random.Random) -> None:
    """One fault of a line, in place: a byte changed, lost or doubled."""
    at = source.randrange(len(data))
    match source.randrange(3):
        case 0:
            data[at] = source.randrange(256)
        case 1:
            del data[at]
        case _:
            data.insert(at, data[at])
