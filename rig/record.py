"""One run from start to stop, recorded as it happens: a start record, what was sampled, a stop record."""

from __future__ import annotations

import glob
import shutil
import tempfile
from collections.abc import Callable
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from rig.board import Board
from rig.camera import CameraThread
from rig.connection import connect_again
from rig.coverage import LONGEST_SILENCE
from rig.fault import Fault, RunEnd
from rig.interrupts import Interrupts
from rig.live_run import LiveRun, Progress
from rig.motion import RigMotion, rig_motion
from rig.play import PlayEnd
from rig.recorder import Recorder
from rig.run_file import read_run, write_run_film
from rig.safety import check_set_points
from rig.setup_file import RigSetup, setup_tables
from rig.soundness import film_gap
from rig.stop_file import write_stop
from tentacle.errors import InputError
from tentacle.io.rrd_chunks import just_written
from tentacle.waveform import Waveform


@dataclass(frozen=True)
class RunResult:
    """outcome: "complete", "interrupted" or a fault's kind; mean_thrust [N] between the waveform's time 0 and the end,
    less the reading at rest before the run; samples and lost: counts; words: one line on what went wrong.
    """

    path: Path
    outcome: RunEnd
    words: str
    mean_thrust: float
    samples: int
    lost: int


@dataclass(frozen=True)
class Attendance:
    """name: of the recording, the file's where empty. interrupts: what asks it to stop; progress hears of a phase and
    its share; viewer: address of a live viewer; free_bytes: measures the disk's free space (None: the system's).
    """

    name: str = ""
    interrupts: Interrupts | None = None
    viewer: str | None = None
    progress: Progress = lambda _phase, _share: None
    free_bytes: Callable[[Path], int] | None = None


UNATTENDED = Attendance()


def record_run(
    setup: RigSetup,
    board: Board,
    camera: CameraThread | None,
    motion: RigMotion,
    path: Path,
    attendance: Attendance = UNATTENDED,
) -> RunResult:
    """Settles, runs and records into `path`. A fault of the rig ends the run safely and is the result's outcome.

    InputError (before anything moves) where the path is taken or the motion is beyond the limits.
    """
    if path.exists():
        raise InputError("is there already", file=path, expected="a path that is free")
    check_set_points(motion.points, motion.period, setup.limits)
    for left in path.parent.glob(_film_folder(glob.escape(path.name)) + "*"):  # of a host that died
        shutil.rmtree(left, ignore_errors=True)
    run = LiveRun(setup, board, camera, motion, attendance.progress, attendance.interrupts)
    start = _start_record(setup, board, motion, attendance.name or path.stem)
    to_newtons, viewer = setup.load_cell.to_newtons, attendance.viewer
    with Recorder(path, start, to_newtons, viewer=viewer, free_bytes=attendance.free_bytes) as recorder:
        try:
            end = run.perform(recorder)
        except Fault as fault:
            end = PlayEnd(fault.kind, str(fault), 0)
            run.to_neutral()
        stop = run.stop_record(end)
        if end.outcome != "disk":
            write_stop(path, {"outcome": end.outcome, **stop})  # a host that dies in the film's making loses nothing
            try:
                add_film(recorder, path, stop)
            except (Fault, OSError) as error:
                end = PlayEnd("disk", f"the film could not be written: {error}", end.start_us)
                stop["words"] = end.words
        recorder.stop(end.outcome, stop)
    return RunResult(path, end.outcome, end.words, run.mean_thrust(end), run.count, board.counters.samples_lost)


def trial_runner(
    setup: RigSetup,
    board: Board,
    camera: CameraThread | None,
    interrupts: Interrupts | None = None,
    progress: Progress = lambda _phase, _share: None,
) -> Callable[[Waveform, float, Path, dict[str, Any]], None]:
    """A function that tries a gait on the rig, as rig.optimise wants it; a board that was lost is connected again."""

    def run_trial(gait: Waveform, duration: float, path: Path, description: dict[str, Any]) -> None:
        connect_again(setup, board)
        motion = rig_motion(gait, duration, setup.limits, description)
        record_run(
            setup,
            board,
            camera,
            motion,
            path,
            Attendance(interrupts=interrupts, progress=progress),
        )

    return run_trial


def motion_runner(
    setup: RigSetup,
    board: Board,
    camera: CameraThread | None,
    interrupts: Interrupts | None = None,
    progress: Progress = lambda _phase, _share: None,
) -> Callable[[RigMotion, Path], Fault | None]:
    """A function that records a motion and returns the fault that kept it from its end, None where it is complete.

    A fault may leave a recording, or none where the board could not be reached. A film with a long gap is a fault too.
    """

    def run_motion(motion: RigMotion, path: Path) -> Fault | None:
        attendance = Attendance(interrupts=interrupts, progress=progress)
        try:
            connect_again(setup, board)
            result = record_run(setup, board, camera, motion, path, attendance)
        except Fault as fault:
            return fault
        if result.outcome != "complete":
            return Fault(result.outcome, result.words)
        gap = 0.0 if camera is None else film_gap(read_run(path))
        return None if gap <= LONGEST_SILENCE else Fault("camera", f"no frame came for {gap:.1f} s of the run")

    return run_motion


def _start_record(setup: RigSetup, board: Board, motion: RigMotion, name: str) -> dict[str, Any]:
    tables = setup_tables(setup)
    return {
        "name": name,
        "started_utc": datetime.now(UTC).isoformat(timespec="milliseconds"),
        "waveform": motion.description,
        "lead_s": motion.lead,
        "duration_s": motion.duration,
        "period_s": motion.period,
        "board": asdict(board.boot) if board.boot else None,
        "rig": tables,
        "recording": tables["recording"],
        "load_cell": tables["load_cell"],
        "camera": tables.get("camera"),
    }


def add_film(recorder: Recorder, path: Path, stop: dict[str, Any]) -> None:
    """Add the frames of the run as one video with true times, for tracking; the frames themselves stay.

    They pass one at a time from the file into the encoder: an hour's film takes no more memory than a minute's.
    """
    if not stop["start_us"] or stop["camera"] is None or recorder.last_clock is None:
        return
    recorder.flush()
    just_written(path)
    zero = 1e-6 * float(stop["start_us"]) + recorder.lead
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=_film_folder(path.name)) as folder:  # /tmp may be memory
        video = Path(folder) / "video.mp4"
        try:
            write_run_film(path, video, recorder.last_clock, float(stop["camera"].get("offset_s", 0.0)), zero)
        except InputError:
            return  # a camera that gave nothing: its gap is in the stop record
        recorder.video(video)


def _film_folder(name: str) -> str:
    """How the name of the folder begins in which a run's film is made."""
    return f".{name}.film-"
