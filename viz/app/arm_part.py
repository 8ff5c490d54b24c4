"""The part of the page that says where the arm is: marks on the first picture, the arm's numbers, the servo's sign."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from functools import partial
from pathlib import Path

import av
from nicegui import events, ui

from tentacle.errors import InputError
from tentacle.io.recording_template import Answers
from tentacle.specimen import Cone
from viz.app.desk import ArmProposer
from viz.app.earlier import Earlier
from viz.app.marks import MARK_PLACES, Marks, arm_outline, drawing
from viz.app.numbers import ASKED, required_numbers, typed_number

RULER = ("ruler start", "ruler end")
NOT_LOOKED = "Look at the picture: does the yellow outline cover the arm? Then tick this."


class ArmPart:
    """What is clicked and typed about the arm. Nothing is taken for granted: a number is missing until it is typed, and
    the outline counts once a person has ticked that it covers the arm.
    """

    def __init__(self, propose: ArmProposer, changed: Callable[[], None]) -> None:
        """Nothing is chosen yet. changed: called where something is clicked or typed."""
        self.propose, self.changed = propose, changed
        self.marks, self.picture_size = Marks({}), (640, 480)
        self.numbers: dict[str, ui.input] = {}

    def build(self) -> None:
        """Top to bottom, in the order of work."""
        self.advice = ui.label("Choose a film first.").classes("faint")
        ui.label("Type the numbers of your arm. The page cannot know them.")
        with ui.row().classes("w-full numbers"):
            for name, asked in ASKED.items():
                field = ui.input(asked.words, on_change=self._change, validation=partial(_problem, name))
                self.numbers[name] = field.props(f'inputmode=decimal stack-label hint="for example {asked.example}"')
        self.place = ui.toggle(list(MARK_PLACES), value="base").props("no-caps wrap").classes("places")
        self.picture = ui.interactive_image(on_mouse=self._clicked, events=["mousedown"], cross=True).classes("film")
        ui.label("A ruler in the arm's plane gives the scale; without one, the arm's own length does.").classes("faint")
        self.declared = ui.label().classes("faint")
        self.use_width = self._tick("take the radius at the base from the clicked edge", self._change)
        ui.label(
            "A positive angle in the servo's log turns the arm this way (drag to try; if not, tick the box below):"
        )
        self.angle = ui.slider(min=-0.6, max=0.6, step=0.02, value=0.0, on_change=self._draw).props("label")
        self.mirrored = self._tick("mirrored: a positive angle turns the arm the other way", self._draw)
        self.looked = self._tick(NOT_LOOKED, self._mark_missing).classes("looked")
        self._draw()

    def _tick(self, words: str, changed: Callable[[], None]) -> ui.checkbox:
        return ui.checkbox(words, value=False, on_change=changed)

    async def show_film(self, film: Path) -> None:
        """The first picture, and where the film itself says the arm is."""
        await self._show_picture(film)
        self.marks = Marks({})
        try:
            found = await asyncio.to_thread(self.propose, film)
        except InputError as error:
            self.advice.set_text(f"The film proposes nothing ({error.problem}): click base and tip.")
        else:
            self.marks = Marks.proposed(found.base, found.tip, found.width)
            advice = (words[:1].upper() + words[1:] for words in found.words)
            self.advice.set_text(" ".join(["Proposed from the film: correct it by clicking.", *advice]))
        self._change()

    async def show_earlier(self, film: Path | None, earlier: Earlier) -> None:
        """A recording of an earlier visit as it was declared."""
        if film is not None:
            await self._show_picture(film)
        words = "As it was declared: change it by clicking and typing."
        by_hand = "recording.toml has more than this page asks for: it is used as it is. Change it in an editor."
        self.advice.set_text(by_hand if earlier.by_hand else words)
        answers = earlier.answers
        for name, field in self.numbers.items():
            value = earlier.number(name)
            field.set_value("" if value is None else f"{value:.10g}")
        self.marks = earlier.marks()
        camera = None if answers is None else answers.camera
        self.mirrored.set_value(camera is not None and camera.mirrored)
        self._draw()
        self.looked.set_value(camera is not None)

    async def _show_picture(self, film: Path) -> None:
        picture = await asyncio.to_thread(first_picture, film)
        self.picture_size = picture.size
        self.picture.set_source(picture)

    def answers(self, fps: float) -> Answers:
        """What recording.toml shall say. InputError that names what is missing or not confirmed."""
        values = required_numbers(self._typed(), [name for name in ASKED if self._is_needed(name)])
        marks = Marks(self.marks.points, values["length"], values.pop("ruler", None))
        camera = marks.camera(fps, bool(self.mirrored.value))
        if not self.looked.value:
            raise InputError("not confirmed yet", field="where the arm is", expected="the last tick of part 2")
        values.setdefault("base_radius", marks.base_radius() or 0.0)
        section = Cone(values.pop("base_radius"), values.pop("tip_radius"))
        return Answers(camera=camera, section=section, **values)

    def _typed(self) -> dict[str, str]:
        return {name: str(field.value or "") for name, field in self.numbers.items()}

    def _is_needed(self, name: str) -> bool:
        """Whether a number has to be typed: not what is clicked instead, and no ruler's length without a ruler."""
        if name == "base_radius":
            return not (self.use_width.value and "width" in self.marks.points)
        return name != "ruler" or all(end in self.marks.points for end in RULER)

    def _clicked(self, event: events.MouseEventArguments) -> None:
        self.marks = self.marks.with_point(self.place.value, (event.image_x, event.image_y))
        self._change()

    def _change(self) -> None:
        """The declared arm is another one: a person has to look at it again."""
        self.looked.set_value(False)
        self._draw()
        self.changed()

    def _draw(self) -> None:
        """Marks and declared arm over the picture; what is missing is said below it."""
        arm = []
        try:
            names = [name for name in ("length", "base_radius", "tip_radius", "ruler") if self._is_needed(name)]
            values = required_numbers(self._typed(), names)
            marks = Marks(self.marks.points, values["length"], values.get("ruler"))
            camera = marks.camera(30.0, bool(self.mirrored.value))
            radius = values.get("base_radius") or marks.base_radius() or 0.0
            radii = (radius, values["tip_radius"])
            arm = arm_outline(camera, values["length"], radii, self.angle.value or 0.0)
            scale = 1e3 * camera.metres_per_px
            self.declared.set_text(f"{scale:.4g} mm a pixel; radius at the base {1e3 * radius:.3g} mm")
        except InputError as error:
            self.declared.set_text(f"No outline yet: {error.line()}")
        self.looked.set_enabled(bool(arm))
        self.picture.set_content(drawing(self.marks, arm, max(self.picture_size) / 130.0))
        self._mark_missing()

    def _mark_missing(self) -> None:
        """What is not given or not confirmed stands out."""
        for name, field in self.numbers.items():
            missing = self._is_needed(name) and not field.value
            _stand_out(field, missing)
        _stand_out(self.looked, not self.looked.value)


def _stand_out(element: ui.element, missing: bool) -> None:
    element.classes(add="missing") if missing else element.classes(remove="missing")


def _problem(name: str, text: str) -> str | None:
    """What is wrong with a field's text; None where nothing is, or nothing is typed yet."""
    try:
        typed_number(name, text)
    except InputError as error:
        return error.problem
    return None


def first_picture(film: Path):
    """The film's first frame as a PIL image."""
    with av.open(str(film)) as container:
        return next(container.decode(video=0)).to_image()
