"""Every shell command that README and docs show, as typed."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = sorted((ROOT / "docs").rglob("*.md"))
PROGRAMS = ("tentacle", "python", "pytest", "pip", "make", "dask", "apt-get", "mkdocs", "rerun", "git", "cp", "mkdir")
SHELL = ("", "bash", "console", "sh", "shell")  # a fenced block of these holds commands; program output is `text`
FENCE = re.compile(r"^(?P<run><!-- run -->\n)?```(?P<language>\w*)\n(?P<body>.*?)^```", re.DOTALL | re.MULTILINE)
PLACEHOLDER = re.compile(r"\b[A-Z]{2,}\b|\bN\b|\.\.\.|[<>|]")  # a span with one of these shows a grammar


@dataclass(frozen=True)
class Block:
    """A fenced block: its language, its text, and whether it is marked to be run whole."""

    language: str
    code: str
    marked: bool


def blocks(page: Path) -> list[Block]:
    """Every fenced block of a page."""
    return [Block(found["language"], found["body"], bool(found["run"])) for found in FENCE.finditer(page.read_text())]


def lines_of(code: str) -> list[str]:
    """A shell block's commands: continued lines joined, comments and the trailing & taken off."""
    found = []
    for line in code.replace("\\\n", " ").splitlines():
        bare = re.sub(r"\s+#.*$", "", line).strip().removesuffix("&").strip()
        if bare and not bare.startswith("#"):
            found.append(bare)
    return found


def is_mention(span: str) -> bool:
    """Whether a span only names a verb, or a verb's option: `tentacle rig check`, `tentacle view --web`."""
    verbs = (
        r"(rig (ports|emulate|check|calibrate|record|import|optimise|campaign)|reproduce \w+|figure \d+|[a-z][a-z-]*)"
    )
    return re.fullmatch(f"tentacle {verbs}( --[a-z-]+)*", span) is not None


def spans(text: str) -> list[str]:
    """The `spans` of running text that are commands: a program's name, and words that are no placeholders."""
    prose = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
    found = [" ".join(span.split()) for span in re.findall(r"`([^`]+)`", prose)]
    commands = [span for span in found if span.partition(" ")[0] in PROGRAMS and " " in span]
    return [span for span in commands if not PLACEHOLDER.search(span.replace(" > docs", "")) and not is_mention(span)]


def shown(pages: list[Path]) -> dict[str, str]:
    """Command -> the page that shows it first; those inside marked blocks are left out, since these run whole."""
    found: dict[str, str] = {}
    run_whole = {line for page in pages for b in blocks(page) if b.marked for line in lines_of(b.code)}
    for page in pages:
        fenced = [line for b in blocks(page) if b.language in SHELL and not b.marked for line in lines_of(b.code)]
        for command in [*fenced, *spans(page.read_text())]:
            if command not in run_whole:
                found.setdefault(command, page.name)
    return found


def stray(page: Path) -> list[str]:
    """Lines that look like a command inside a block that claims to hold none."""
    held = [line for b in blocks(page) if b.language not in (*SHELL, "python") for line in b.code.splitlines()]
    commands = [line for line in held if line.partition(" ")[0] in PROGRAMS and " " in line]
    return [line for line in commands if not PLACEHOLDER.search(line)]
