"""The page's working folder: recordings with their films and logs, and the answers of the verbs."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tentacle.errors import InputError
from tentacle.io.csv_table import read_csv
from tentacle.io.recording_template import Answers, recording_text, require_usable
from tentacle.io.servo_log import read_servo_log, write_motor_log
from tentacle.io.video_file import VIDEO_SUFFIXES, check_video, find_video
from tentacle.io.written_file import write_text
from viz.app.earlier import Earlier, read_earlier

MOTOR_LOG, LOAD_CELL_LOG = "motor.csv", "load_cell.csv"
LOG_NAMES = {"motor": MOTOR_LOG, "servo": MOTOR_LOG, "load_cell": LOAD_CELL_LOG}  # what a log's own name may hold
SHOWN_FILES = (
    "report.html",
    "session.rrd",
    "model.toml",
    "verdict.json",
    "identification.json",
    "next_experiment.toml",
)
ANSWER = "_answer"  # after a recording's name: the folder of its diagnosis
ImagePixels = tuple[float, float]


@dataclass(frozen=True)
class Proposed:
    """Where the arm is in a film, as the film itself proposes it [px]: base, tip when it hangs straight, the full width
    at the base; and what a person should look at.
    """

    base: ImagePixels
    tip: ImagePixels
    width: float
    words: tuple[str, ...]


ArmProposer = Callable[[Path], Proposed]


@dataclass(frozen=True)
class Desk:
    """The working folder, and what proposes where an arm is in a film."""

    folder: Path
    propose: ArmProposer

    def recordings(self) -> list[str]:
        """Names of the recordings that were begun here."""
        return sorted(
            path.name
            for path in self.folder.iterdir()
            if path.is_dir() and not path.name.startswith(".") and not (path / "report.html").exists()
        )

    def answers(self) -> list[str]:
        """Names of the folders that hold a verdict."""
        return sorted(path.parent.name for path in self.folder.glob("*/verdict.json"))

    def verdict(self, answer: str) -> Mapping[str, Any]:
        """verdict.json of an answer."""
        return json.loads((self.folder / answer / "verdict.json").read_text(encoding="utf-8"))

    def state(self, recording: str) -> str:
        """In words: filmed, declared, or what the verdict is."""
        if recording + ANSWER in self.answers():
            found = self.verdict(recording + ANSWER)
            return " + ".join(found["effects"]) or found["verdict"].replace("_", " ")
        return "declared" if (self.folder / recording / "recording.toml").exists() else "filmed, not declared"

    def place(self, recording: str) -> Path:
        """The recording's folder, made where it is missing; InputError for a name that is none."""
        if not re.fullmatch(r"[\w-]{1,60}", recording) or recording.endswith(ANSWER):
            raise InputError(f"{recording!r} is no name", field="name", expected="letters, digits, _ and -")
        place = self.folder / recording
        place.mkdir(parents=True, exist_ok=True)
        return place

    def film(self, recording: str) -> Path | None:
        """The recording's film, tried; None where there is none yet."""
        found = find_video(self.place(recording))
        return None if found is None else found.path

    def earlier(self, recording: str) -> Earlier | None:
        """How the recording was declared; None where it was not yet."""
        file = self.place(recording) / "recording.toml"
        return read_earlier(file) if file.exists() else None

    def declare(self, recording: str, answers: Answers) -> None:
        """Write recording.toml, complete or not at all. InputError where a verb would refuse it."""
        require_usable(answers)
        write_text(self.place(recording) / "recording.toml", recording_text(answers))

    def name_for(self, given: str) -> str:
        """Under which name a chosen file is read; InputError, with the remedy, for one that nothing reads."""
        suffix = Path(given).suffix.lower()
        if suffix in VIDEO_SUFFIXES:
            return f"video{suffix}"
        if suffix == ".csv":
            for part, name in LOG_NAMES.items():
                if part in given.lower():
                    return name
        expected = f"a film ({' '.join(VIDEO_SUFFIXES)}), or a log with motor, servo or load_cell in its name, .csv"
        raise InputError("is not read", file=given, expected=expected)

    def keep(self, recording: str, given: str, content: bytes) -> tuple[Path, str]:
        """Put a chosen file where it is read, and say as what; InputError where it is not what it should be: then it is
        not kept.
        """
        file = self.place(recording) / self.name_for(given)
        partial = file.with_name(f"partial_{file.name}")
        partial.write_bytes(content)
        try:
            words = _tried(partial, file.name).replace(partial.name, given)
        except InputError as error:
            partial.unlink()
            raise InputError(
                error.problem, file=given, row=error.row, field=error.field, expected=error.expected
            ) from None
        if file.suffix in VIDEO_SUFFIXES:
            for other in VIDEO_SUFFIXES:
                file.with_suffix(other).unlink(missing_ok=True)
        return partial.replace(file), words


def _tried(file: Path, name: str) -> str:
    """Try a file that shall be kept under a name. A servo's log is turned into motor.csv; words: how it was read."""
    if name == LOAD_CELL_LOG:
        read_csv(file, ("t_s", "thrust_n"), extra_allowed=True)
        return ""
    if name != MOTOR_LOG:
        check_video(file)
        return ""
    motor, words = read_servo_log(file)
    write_motor_log(motor, file)
    return words
