"""The page: choose a film and logs, click where the arm is, run the verbs, read the answers."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from functools import partial
from pathlib import Path

import av
from nicegui import app, events, ui

from tentacle.errors import InputError
from tentacle.io.recording_template import Answers, recording_text
from tentacle.io.video_file import frame_rate
from viz.app.desk import SHOWN_FILES, Desk
from viz.app.guard import Guard
from viz.app.job import Job
from viz.app.marks import MARK_PLACES, Marks, arm_outline, drawing
from viz.app.tables import batch_table, compare_table

PAGE_STYLE = (Path(__file__).parent / "page.css").read_text(encoding="utf-8")
NUMBERS = (
    ("length", "length of the arm [m]", 0.14),
    ("base_radius", "radius at the base [m]", 0.0125),
    ("tip_radius", "radius at the tip [m]", 0.004),
    ("density", "density of the material [kg/m3]", 1070.0),
    ("fluid_density", "density of the fluid [kg/m3]", 998.0),
    ("ruler", "length of the ruler [m]", 0.05),
)


def serve(desk: Desk, port: int, token: str) -> None:
    """Serve the page on 127.0.0.1 until Ctrl-C; only a browser that was given the token gets it."""
    app.add_middleware(Guard, token=token)

    @app.get("/answers/{answer}/{file}")
    def answer_file(answer: str, file: str):
        from fastapi.responses import FileResponse, PlainTextResponse

        if file not in SHOWN_FILES or answer not in [path.name for path in desk.folder.iterdir()]:
            return PlainTextResponse("not here", status_code=404)
        return FileResponse(desk.folder / answer / file)

    ui.run(lambda: Page(desk).build(), host="127.0.0.1", port=port, title="tentacle", dark=None, show=False,
           reload=False, show_welcome_message=False, reconnect_timeout=30.0)  # fmt: skip


class Page:
    """One visitor's page: what is chosen, what is clicked, what runs."""

    def __init__(self, desk: Desk) -> None:
        """Nothing is chosen yet."""
        self.desk, self.marks, self.job, self.picture_size = desk, Marks({}), None, (640, 480)
        self.queue: list[Job] = []
        self.numbers: dict[str, ui.number] = {}

    def build(self) -> None:
        """All parts, top to bottom, in the order of work."""
        ui.add_css(PAGE_STYLE)
        with ui.column().classes("page"):
            ui.label("From a film to what the model lacks").classes("title").props('role="heading" aria-level="1"')
            ui.label(f"Everything is kept in {self.desk.folder}").classes("faint")
            self.alarm = ui.label().classes("alarm").props('role="alert"')
            self.alarm.set_visibility(False)
            with part("1  Film and logs"):
                self._build_files()
            with part("2  Where the arm is"):
                self._build_marks()
            with part("3  Run"):
                self._build_run()
            with part("4  Answer"):
                self.answer = ui.column().classes("w-full")
                with self.answer:
                    ui.label("No answer yet.").classes("faint")
            with part("All recordings"):
                self.batch = ui.column().classes("w-full")
            with part("Compare two answers"):
                self.compare = ui.column().classes("w-full")
        self._refresh_tables()
        ui.timer(0.3, self._show_progress)

    def _build_files(self) -> None:
        self.name = ui.input("name of the recording", value="my_arm").classes("w-full")
        words = "drop or choose the film, the servo's log and load_cell.csv"
        ui.upload(label=words, multiple=True, auto_upload=True, on_upload=self._upload).classes("w-full")
        self.kept = ui.label("Nothing chosen yet.").classes("faint")
        self.read_as = ui.label().classes("faint")

    async def _upload(self, event: events.UploadEventArguments) -> None:
        with self._told():
            file, words = self.desk.keep(self.name.value or "", event.file.name, await event.file.read())
            self.kept.set_text(f"In {file.parent}: " + ", ".join(sorted(one.name for one in file.parent.iterdir())))
            if words:
                self.read_as.set_text(words)
            if file.stem == "video":
                await self._show_film(file)
            self._refresh_tables()

    async def _show_film(self, film: Path) -> None:
        """The first picture, and where the film itself says the arm is."""
        picture = await asyncio.to_thread(first_picture, film)
        self.picture_size = picture.size
        self.picture.set_source(picture)
        self.marks = Marks({})
        try:
            found = await asyncio.to_thread(self.desk.propose, film)
        except InputError as error:
            self.advice.set_text(f"The film proposes nothing ({error.problem}): click base and tip.")
        else:
            self.marks = Marks.proposed(found.base, found.tip, found.width)
            advice = (words[:1].upper() + words[1:] for words in found.words)
            self.advice.set_text(" ".join(["Proposed from the film: correct it by clicking.", *advice]))
        self._draw()

    def _build_marks(self) -> None:
        self.advice = ui.label("Choose a film first.").classes("faint")
        self.place = ui.toggle(list(MARK_PLACES), value="base").props("no-caps wrap").classes("places")
        self.picture = ui.interactive_image(on_mouse=self._clicked, events=["mousedown"], cross=True).classes("film")
        ui.label("A ruler in the arm's plane gives the scale; without one, the arm's own length does.").classes("faint")
        with ui.row().classes("w-full numbers"):
            for name, words, value in NUMBERS:
                self.numbers[name] = ui.number(words, value=value, format="%.6g", on_change=self._draw)
        self.use_width = ui.checkbox(
            "take the radius at the base from the clicked edge", value=False, on_change=self._draw
        )
        self.mirrored = ui.checkbox(
            "mirrored: a positive angle in the servo's log turns the arm the other way",
            value=False,
            on_change=self._draw,
        )
        ui.label(
            "A positive angle in the servo's log turns the arm this way (drag to try; if not, tick the box above):"
        )
        self.angle = ui.slider(min=-0.6, max=0.6, step=0.02, value=0.0, on_change=self._draw).props("label")
        self.declared = ui.label().classes("faint")

    def _clicked(self, event: events.MouseEventArguments) -> None:
        self.marks = self.marks.with_point(self.place.value, (event.image_x, event.image_y))
        self._draw()

    def _radius(self, marks: Marks) -> float:
        clicked = marks.base_radius() if self.use_width.value else None
        return clicked if clicked is not None else float(self.numbers["base_radius"].value or 0.0)

    def _draw(self) -> None:
        """Marks and declared arm over the picture; what is missing is said below it."""
        values = {name: float(field.value or 0.0) for name, field in self.numbers.items()}
        marks = Marks(self.marks.points, values["length"], values["ruler"])
        arm = []
        try:
            camera = marks.camera(30.0, bool(self.mirrored.value))
            arm = arm_outline(
                camera, values["length"], (self._radius(marks), values["tip_radius"]), self.angle.value or 0.0
            )
            scale, radius = 1e3 * camera.metres_per_px, 1e3 * self._radius(marks)
            self.declared.set_text(f"{scale:.4g} mm a pixel; radius at the base {radius:.3g} mm")
        except InputError as error:
            self.declared.set_text(error.line())
        self.picture.set_content(drawing(marks, arm, max(self.picture_size) / 130.0))

    def _declare(self) -> str:
        """Write recording.toml from what is clicked and typed; the recording's name."""
        name = self.name.value or ""
        film = self.desk.film(name)
        if film is None:
            raise InputError("no film yet", field=name, expected="a film, chosen above")
        values = {key: float(field.value or 0.0) for key, field in self.numbers.items()}
        for key, _, _ in NUMBERS[:4]:
            if values[key] <= 0.0:
                raise InputError(f"{values[key]:g} is out of range", field=key, expected="a number above 0")
        marks = Marks(self.marks.points, values["length"], values.pop("ruler"))
        values["base_radius"] = self._radius(marks)
        camera = marks.camera(frame_rate(film), bool(self.mirrored.value))
        (self.desk.folder / name / "recording.toml").write_text(recording_text(Answers(camera=camera, **values)))
        return name

    def _build_run(self) -> None:
        with ui.row():
            for verb in ("track", "identify", "diagnose"):
                ui.button(verb, on_click=partial(self._start, verb)).props("no-caps")
            self.stop = ui.button("stop", on_click=self._stop).props("no-caps outline")
        self.bar = ui.linear_progress(value=0.0, show_value=False).props('aria-label="share done"')
        self.doing = ui.label("Nothing runs.").classes("doing")
        ui.label("The same from a command line:").classes("faint")
        self.line = ui.code("tentacle --help", language="bash").classes("w-full")

    async def _start(self, verb: str) -> None:
        with self._told():
            name = self._declare()
            await self._work([self._job(verb, name)])

    def _job(self, verb: str, name: str) -> Job:
        out = {"track": f"{name}.csv", "identify": f"{name}_identified", "diagnose": f"{name}_answer"}[verb]
        return Job([verb, name, "--out", out], self.desk.folder)

    async def _work(self, jobs: list[Job]) -> None:
        """Run jobs one after the other, unless some run already."""
        if self.job is not None and self.job.state == "running":
            raise InputError("something runs already", field="run", expected="its end, or stop")
        self.queue = jobs
        for job in jobs:
            self.job = job
            self.line.set_content(f"cd {self.desk.folder}\n{job.line}")
            await job.run()
            self._show_progress()
            if job.state == "done":
                self._show_answer(job)
            elif job.state == "failed":
                self._say(job.words)
            self._refresh_tables()

    def _stop(self) -> None:
        for job in self.queue:
            job.stop()

    def _show_progress(self) -> None:
        if self.job is not None:
            self.bar.set_value(self.job.share)
            done = "failed" if self.job.state == "failed" else f"{100 * self.job.share:.0f} %"
            self.doing.set_text(f"{done}  {self.job.words}")

    def _show_answer(self, job: Job) -> None:
        """What the verb said, its files, and its report."""
        place = self.desk.folder / job.arguments[-1]
        self.answer.clear()
        with self.answer:
            ui.label("\n".join(job.said)).classes("said")
            if not place.is_dir():
                return
            with ui.row():
                for file in SHOWN_FILES:
                    if (place / file).exists():
                        ui.link(file, f"/answers/{place.name}/{file}", new_tab=True)
                show = ui.button("show the session here", on_click=lambda: self._show_session(place))
                show.props("no-caps outline dense").set_visibility((place / "session.rrd").exists())
            self.session = ui.column().classes("w-full")
            _frame(f"/answers/{place.name}/report.html", "report")

    async def _show_session(self, place: Path) -> None:
        """The Rerun session in the page: `tentacle view --web` serves it on this machine until the page's end."""
        viewer = Job(["view", str(place / "session.rrd"), "--web"], self.desk.folder)
        task = asyncio.create_task(viewer.run())
        app.on_shutdown(viewer.stop)
        while not viewer.said and not task.done():
            await asyncio.sleep(0.2)
        if not viewer.said:
            self._say(viewer.words)
            return
        address = viewer.said[0].split()[0]
        with self.session:
            _frame(address, "session")

    def _refresh_tables(self) -> None:
        batch_table(self.batch, self.desk, self._run_all)
        compare_table(self.compare, self.desk)

    async def _run_all(self) -> None:
        with self._told():
            names = [name for name in self.desk.recordings() if self.desk.state(name) == "declared"]
            if not names:
                raise InputError("nothing to do", field="all", expected="a declared recording without an answer")
            await self._work([self._job("diagnose", name) for name in names])

    def _say(self, words: str) -> None:
        self.alarm.set_text(words)
        self.alarm.set_visibility(bool(words))

    def _told(self) -> _Told:
        return _Told(self._say)


class _Told:
    """Bad input inside the block becomes a line on the page."""

    def __init__(self, say: Callable[[str], None]) -> None:
        self.say = say

    def __enter__(self) -> None:
        self.say("")

    def __exit__(self, kind: type | None, error: BaseException | None, trace: object) -> bool:
        if isinstance(error, InputError):
            self.say(error.line())
            return True
        return False


def _frame(address: str, title: str) -> None:
    """Another page inside this one."""
    ui.html(f'<iframe class="{title}" src="{address}" title="{title}"></iframe>', sanitize=False).classes("w-full")


def part(title: str) -> ui.card:
    """A part of the page under its heading."""
    card = ui.card().classes("w-full part")
    with card:
        ui.label(title).classes("heading").props('role="heading" aria-level="2"')
    return card


def first_picture(film: Path):
    """The film's first frame as a PIL image."""
    with av.open(str(film)) as container:
        return next(container.decode(video=0)).to_image()
