"""recording.toml of an earlier visit: what the page can show and change of it, and what only its author may change."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from tentacle.errors import InputError
from tentacle.io.declaration_file import read_recording_file
from tentacle.io.recording_template import Answers, recording_text
from tentacle.recording import Declaration
from tentacle.specimen import Cone
from viz.app.marks import Marks


@dataclass(frozen=True)
class Earlier:
    """answers: the numbers that the page asks for, None where the file declares another kind of arm or no camera.
    by_hand: the file says more than the page would write, so that the page must not write it anew.
    """

    answers: Answers | None
    by_hand: bool

    def number(self, name: str) -> float | None:
        """The number that the page asks for by this name; None where the file says nothing of it."""
        if self.answers is None:
            return None
        return {**vars(self.answers), **vars(self.answers.section)}.get(name)

    def marks(self) -> Marks:
        """Base and tip as the camera declares them; no mark without a camera."""
        if self.answers is None or self.answers.camera is None:
            return Marks({})
        camera, length = self.answers.camera, self.answers.length
        far = length / camera.metres_per_px
        tip = tuple(base + far * along for base, along in zip(camera.base_px, camera.arm_px, strict=True))
        return Marks({"base": camera.base_px, "tip": (tip[0], tip[1])}, length)


def read_earlier(file: Path) -> Earlier:
    """What is in the file. A file that a verb refuses is its author's, too; the verb says why."""
    try:
        answers = _answers(read_recording_file(file).declaration)
    except InputError:
        answers = None
    if answers is None:
        return Earlier(None, by_hand=True)
    there, own = (_lines(text) for text in (file.read_text(encoding="utf-8"), recording_text(answers)))
    return Earlier(answers, by_hand=there != own)


def _answers(declared: Declaration) -> Answers | None:
    arm, camera = declared.specimen, declared.camera
    if not isinstance(arm.section, Cone) or camera is None or not math.isfinite(camera.fps):
        return None
    return Answers(arm.length, arm.section, arm.density, declared.fluid.density, camera)


def _lines(text: str) -> list[str]:
    """The file's lines but for arm_px, a unit vector whose last digit changes when it is read."""
    return [line for line in text.splitlines() if not line.startswith("arm_px")]
