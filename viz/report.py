"""report.html: one page for every verb. A Report has its content; the template has its look."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
from markupsafe import Markup
from matplotlib.figure import Figure

from viz.figures.style import svg
from viz.glossary import terms_in


@dataclass(frozen=True)
class ReportTable:
    """Rows of texts under a header; `numeric` are the columns that are set right-aligned; `marked` rows
    stand out, `warned` rows are those that failed; `bars`, a share (0 to 1) a row, are drawn behind the first numeric
    column."""

    caption: str
    header: tuple[str, ...]
    rows: Sequence[Sequence[str]]
    numeric: tuple[int, ...] = ()
    marked: tuple[int, ...] = ()
    warned: tuple[int, ...] = ()
    bars: tuple[float, ...] = ()


@dataclass(frozen=True)
class Picture:
    """A figure and what it shows, in words."""

    figure: Figure
    caption: str


@dataclass(frozen=True)
class ReportSection:
    """A heading with paragraphs, commands to copy (what each does, the line), links to files beside the page (name,
    what it is), then its tables, then its pictures. A leading section has its pictures first and no heading of its own.
    """

    title: str
    paragraphs: Sequence[str] = ()
    tables: Sequence[ReportTable] = ()
    pictures: Sequence[Picture] = ()
    commands: Sequence[tuple[str, str]] = ()
    files: Sequence[tuple[str, str]] = ()
    leads: bool = False


@dataclass(frozen=True)
class Origin:
    """How to reproduce a report: command line, seed, versions and SHA-256 of every input."""

    command: str
    seed: int | None = None
    versions: Mapping[str, str] = field(default_factory=dict)
    inputs: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Report:
    """A page: verb, title, headline sentence, a few key figures (name, value) beside it, sections, origin."""

    verb: str
    title: str
    headline: str
    sections: Sequence[ReportSection]
    origin: Origin
    figures_of_merit: Sequence[tuple[str, str]] = ()


def render_report(report: Report) -> str:
    """The page as one self-contained HTML text: style and figures inside, nothing loaded from elsewhere."""
    return render_page("report.html", report=report, terms=terms_in(_words_of(report)))


def _words_of(report: Report) -> str:
    """All that the page says in sentences, captions and headings."""
    said = [report.headline, *(name for name, _ in report.figures_of_merit)]
    for section in report.sections:
        said += [section.title, *section.paragraphs, *(picture.caption for picture in section.pictures)]
        said += [word for table in section.tables for word in (table.caption, *table.header)]
    return "\n".join(said)


def render_page(template: str, **content: object) -> str:
    """A template's page; `drawn(figure, caption)` puts a figure into it."""
    environment = Environment(
        loader=PackageLoader("viz"), autoescape=select_autoescape(default=True), undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    count = 0

    def drawn(figure: Figure, caption: str) -> Markup:
        nonlocal count
        count += 1
        element = svg(figure, f"figure{count}")
        # the caption is the picture's text for who cannot see it
        label = Markup.escape(caption)
        return Markup(element.replace("<svg ", f'<svg role="img" aria-label="{label}" ', 1))

    return environment.get_template(template).render(**content, drawn=drawn, bar=_bar)


def _bar(share: float) -> str:
    """The style that gives a cell's bar its length."""
    return f"--share: {100.0 * min(max(share, 0.0), 1.0):.1f}%"


def write_report(page: str, path: Path | str) -> Path:
    """Write a rendered page, whole or not at all. Returns the path."""
    path = Path(path)
    unfinished = path.with_name(path.name + ".unfinished")
    unfinished.write_text(page, encoding="utf-8")
    unfinished.replace(path)
    return path
