"""The page: choose a film and logs, click where the arm is, run the verbs, read the answers."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from nicegui import app, events, ui

from tentacle.errors import InputError
from tentacle.io.video_file import frame_rate
from viz.app.arm_part import ArmPart
from viz.app.desk import ANSWER, SHOWN_FILES, Desk
from viz.app.guard import Guard
from viz.app.job import Job
from viz.app.tables import batch_table, compare_table

PAGE_STYLE = (Path(__file__).parent / "page.css").read_text(encoding="utf-8")


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
        self.desk, self.arm, self.job = desk, ArmPart(desk.propose, partial(self._say, "")), None
        self.queue: list[Job] = []

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
                self.arm.build()
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
        names = self.desk.recordings()
        earlier = ui.select(names, label="go on with an earlier recording", on_change=self._open).classes("w-full")
        earlier.set_visibility(bool(names))
        words = "drop or choose the film, the servo's log and load_cell.csv"
        ui.upload(label=words, multiple=True, auto_upload=True, on_multi_upload=self._upload).classes("w-full")
        self.kept = ui.label("Nothing chosen yet.").classes("faint")
        self.read_as = ui.label().classes("faint")

    async def _upload(self, event: events.MultiUploadEventArguments) -> None:
        """Keep what can be read of the files that were chosen together, and say why of each that cannot."""
        refused = []
        for given in event.files:
            try:
                await self._keep(given.name, await given.read())
            except InputError as error:
                refused.append(error.line())
        self._refresh_tables()
        self._say("\n".join(refused))

    async def _keep(self, given: str, content: bytes) -> None:
        file, words = self.desk.keep(self.name.value or "", given, content)
        self._tell_files(file.parent)
        if words:
            self.read_as.set_text(words)
        if file.stem == "video":
            await self.arm.show_film(file)

    async def _open(self, event: events.ValueChangeEventArguments) -> None:
        """Go on with a recording of an earlier visit."""
        with self._told():
            name = str(event.value or "")
            if not name:
                return
            self.name.set_value(name)
            film, earlier = self.desk.film(name), self.desk.earlier(name)
            self._tell_files(self.desk.place(name))
            if earlier is not None:
                await self.arm.show_earlier(film, earlier)
            elif film is not None:
                await self.arm.show_film(film)
            self._show_earlier_answer(name)

    def _show_earlier_answer(self, name: str) -> None:
        self.answer.clear()
        if name + ANSWER in self.desk.answers():
            self._show_answer(self.desk.folder / (name + ANSWER), [f"Of an earlier visit: {self.desk.state(name)}"])
            return
        with self.answer:
            ui.label("No answer yet.").classes("faint")

    def _tell_files(self, place: Path) -> None:
        names = sorted(one.name for one in place.iterdir() if not one.name.startswith("."))
        self.kept.set_text(f"In {place}: {', '.join(names)}")

    def _declare(self) -> str:
        """Write recording.toml from what is clicked and typed; the recording's name."""
        name = self.name.value or ""
        earlier = self.desk.earlier(name)
        if earlier is None or not earlier.by_hand:
            film = self.desk.film(name)
            if film is None:
                raise InputError("no film yet", field=name, expected="a film, chosen above")
            self.desk.declare(name, self.arm.answers(frame_rate(film)))
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
            self._refresh_tables()
            await self._work([self._job(verb, name)])

    def _job(self, verb: str, name: str) -> Job:
        out = {"track": f"{name}.csv", "identify": f"{name}_identified", "diagnose": name + ANSWER}[verb]
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
                self._show_answer(self.desk.folder / job.arguments[-1], job.said)
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

    def _show_answer(self, place: Path, said: Sequence[str]) -> None:
        """What the verb said, its files, and its report."""
        self.answer.clear()
        with self.answer:
            ui.label("\n".join(said)).classes("said")
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
