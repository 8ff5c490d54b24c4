"""The drawings of docs/layout.md, as SVG: the rooms on their floors, and the way of one recording through them."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path

PICTURES = Path(__file__).parent / "pictures"
INK, PAPER, SOFT, MARK = "#1b2a33", "#ffffff", "#e6f2f1", "#00796b"
WIDTH, ROW, GAP = 820, 62, 14
FONT = 'font-family="system-ui, sans-serif"'

# From the top; a floor's rooms do not import one another, except that pages and cli hand over to viz.
FLOORS = (
    (
        ("tentacle/cli", "parses, calls one function, prints"),
        ("tentacle/cli/pages", "a result as report, session, figure"),
    ),
    (("tentacle/api", "import tentacle: read, track, identify, diagnose, simulate, compare, optimise"),),
    (("validation", "blind trials, ladder, validity map, paper"), ("rig", "the bench, emulator, firmware")),
    (("discovery", "which absent effect explains the residual"),),
    (("inference", "observation, noise, least squares, intervals"),),
    (("vision", "the arm's shape in a video"), ("mujoco_ref", "the high-order reference")),
    (("affine_model", "the reduced model: a sum of effects; swim"),),
    (("tentacle", "the shared words: recording, model, ..."), ("tentacle/io", "files in and out")),
)
WAY = (
    ("tentacle/cli", "diagnose: parse the command line"),
    ("tentacle/io", "reading: the folder or .rrd as a Recording"),
    ("vision", "track: shapes with covariance, from the video"),
    ("discovery", "diagnose: recordings of one arm; loop: the order"),
    ("inference", "prepare: base motion and observation, once"),
    ("inference", "base_fit: the declared model and its order"),
    ("affine_model", "simulate: one batch of motions a step of the fit"),
    ("inference", "discrepancy: the reduction's error, by mujoco_ref"),
    ("discovery", "search: rank sets of effects, refit the best"),
    ("inference", "posterior: the evidence of each hypothesis"),
    ("discovery", "decide: effect, group, unknown, nothing missing"),
    ("discovery", "assemble: errors, intervals, next experiment"),
    ("tentacle/cli/pages", "diagnosis: verdict.json, model.toml"),
    ("viz", "diagnosis_report: report.html"),
    ("viz", "session: session.rrd"),
)


def text(x: float, y: float, words: str, *, size: int = 14, weight: str = "normal", colour: str = INK) -> str:
    """A line of text that begins at (x, y)."""
    return (
        f'<text x="{x}" y="{y}" {FONT} font-size="{size}" font-weight="{weight}" fill="{colour}">{escape(words)}</text>'
    )


def box(x: float, y: float, width: float, room: Sequence[str]) -> list[str]:
    """A room: its name, and what it does."""
    frame = f'<rect x="{x}" y="{y}" width="{width}" height="{ROW - GAP}" rx="6" fill="{SOFT}" stroke="{MARK}"/>'
    return [frame, text(x + 10, y + 19, room[0], weight="bold"), text(x + 10, y + 38, room[1], size=12)]


def page(height: int, title: str, parts: Sequence[str]) -> str:
    """A whole SVG on white paper, so that it reads on a dark page too."""
    frame = f'viewBox="0 0 {WIDTH} {height}" role="img" aria-label="{escape(title)}"'
    head = f'<svg xmlns="http://www.w3.org/2000/svg" {frame}>'
    paper = f'<rect width="{WIDTH}" height="{height}" fill="{PAPER}"/>'
    return "\n".join([head, f"<title>{escape(title)}</title>", paper, *parts, "</svg>\n"])


def rooms() -> str:
    """The floors; viz stands beside them."""
    inner, parts, left = 580, [], 16
    for number, floor in enumerate(FLOORS):
        width = (inner - (len(floor) - 1) * GAP) / len(floor)
        for place, room in enumerate(floor):
            parts += box(left + place * (width + GAP), 16 + number * ROW, width, room)
    top, bottom = 16 + ROW, 16 + (len(FLOORS) - 1) * ROW + ROW - GAP
    x, width = left + inner + 2 * GAP, WIDTH - inner - left - 2 * GAP - 16
    frame = f'<rect x="{x}" y="{top}" width="{width}" height="{bottom - top}" rx="6" fill="none" stroke="{MARK}"/>'
    lines = (
        "viz",
        "draws the data it gets:",
        "sessions, figures, reports.",
        "It imports the words only.",
        "cli and pages call it;",
        "no room does.",
    )
    parts += [
        frame,
        *(
            text(x + 10, top + 22 + 20 * k, line, size=14 if k == 0 else 12, weight="bold" if k == 0 else "normal")
            for k, line in enumerate(lines)
        ),
    ]
    height = 16 + len(FLOORS) * ROW + 24
    parts.append(
        text(
            left,
            height - 14,
            "A floor imports from floors below it. vision and mujoco_ref do not import affine_model.",
            size=12,
        )
    )
    return page(height, "The rooms of the code, floor by floor", parts)


def way() -> str:
    """Fifteen calls, from the command line to the report."""
    columns = [
        "tentacle/cli",
        "tentacle/io",
        "vision",
        "discovery",
        "inference",
        "affine_model",
        "tentacle/cli/pages",
        "viz",
    ]
    step, parts, row = 98, [], 34
    for k, name in enumerate(columns):
        x = 20 + k * step
        parts.append(text(x, 24, name.rpartition("/")[2], size=12, weight="bold"))
        line = f'<line x1="{x + 8}" y1="34" x2="{x + 8}" y2="{50 + len(WAY) * row}" stroke="#c5d5d4" stroke-width="1"/>'
        parts.append(line)
    points = [(28 + columns.index(room) * step, 56 + k * row) for k, (room, _) in enumerate(WAY)]
    path = " ".join(f"{'M' if k == 0 else 'L'} {x} {y}" for k, (x, y) in enumerate(points))
    parts.append(f'<path d="{path}" fill="none" stroke="{MARK}" stroke-width="1.5"/>')
    for k, ((x, y), (_, words)) in enumerate(zip(points, WAY, strict=True)):
        parts.append(f'<circle cx="{x}" cy="{y}" r="9" fill="{MARK}"/>')
        parts.append(
            f'<text x="{x}" y="{y + 4}" {FONT} font-size="10" text-anchor="middle" fill="{PAPER}">{k + 1}</text>'
        )
        width = 6.3 * len(words)
        start = x + 14 if x + 14 + width < WIDTH else x - 14 - width
        back = f'<rect x="{start - 2}" y="{y - 9}" width="{width + 4}" height="18" fill="{PAPER}" fill-opacity="0.8"/>'
        parts += [back, text(start, y + 4, words, size=12)]
    return page(60 + len(WAY) * row, "The way of one recording through the rooms", parts)


if __name__ == "__main__":
    (PICTURES / "rooms.svg").write_text(rooms(), encoding="utf-8")
    (PICTURES / "way.svg").write_text(way(), encoding="utf-8")
