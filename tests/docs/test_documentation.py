"""The documentation builds without a warning, its marked blocks run, and what it names exists."""

from __future__ import annotations

import importlib
import os
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from tentacle.cli import build_parser

ROOT = Path(__file__).parents[2]
PAGES = sorted((ROOT / "docs").rglob("*.md"))
BLOCK = re.compile(r"<!-- run -->\n```(?P<language>bash|python)\n(?P<code>.*?)\n```", re.DOTALL)


@dataclass(frozen=True)
class Block:
    language: str
    code: str


def blocks(page: Path) -> list[Block]:
    return [Block(found["language"], found["code"]) for found in BLOCK.finditer(page.read_text())]


def environment(folder: Path) -> dict[str, str]:
    """A shell in which `tentacle` and `python` are this checkout's."""
    programs = folder / "programs"
    programs.mkdir()
    for name, arguments in (
        ("tentacle", "-c 'import sys, tentacle.cli; sys.exit(tentacle.cli.main())'"),
        ("python", ""),
    ):
        script = programs / name
        script.write_text(f'#!/bin/sh\nexec "{sys.executable}" {arguments} "$@"\n')
        script.chmod(0o755)
    return {**os.environ, "PYTHONPATH": str(ROOT), "PATH": f"{programs}:{os.environ['PATH']}"}


def film_an_arm(folder: Path) -> None:
    """The reader's own video and motor log: a dark cone that swings as a stiff rod, 30 frames."""
    import cv2
    import numpy as np

    folder.mkdir()
    writer = cv2.VideoWriter(str(folder / "video.mp4"), cv2.VideoWriter.fourcc(*"mp4v"), 30.0, (640, 360))
    t = np.arange(30) / 30
    theta = 0.3 * np.sin(2 * np.pi * t)
    for angle in theta:
        picture = np.full((360, 640, 3), 210, np.uint8)
        tip = 175 * np.array([-np.sin(angle), np.cos(angle)])
        side = 15.6 * np.array([np.cos(angle), np.sin(angle)])
        corners = np.array([side, -side, tip]) + np.array([320, 40])
        cv2.fillPoly(picture, [corners.round().astype(np.int32)], (50, 50, 50))
        writer.write(picture)
    writer.release()
    rows = [f"{a:.4f},{b:.6f},{b:.6f}" for a, b in zip(t, theta, strict=True)]
    (folder / "motor.csv").write_text("t_s,command_rad,angle_rad\n" + "\n".join(rows) + "\n")


@pytest.mark.parametrize("page", [p for p in PAGES if blocks(p)], ids=lambda p: p.stem)
def test_marked_blocks_run(page, tmp_path):
    """Bash blocks in order; the Python blocks of a page as one program."""
    film_an_arm(tmp_path / "my_arm")
    shell = environment(tmp_path)
    commands = [["bash", "-eu", "-c", block.code] for block in blocks(page) if block.language == "bash"]
    program = "\n".join(block.code for block in blocks(page) if block.language == "python")
    if program:
        (tmp_path / "program.py").write_text(program)
        commands.append([sys.executable, "-W", "error::DeprecationWarning:__main__", "program.py"])
    for command in commands:
        done = subprocess.run(
            command, cwd=tmp_path, env=shell, capture_output=True, text=True, timeout=300, check=False
        )
        assert done.returncode == 0, f"{command[-1]}\n{done.stdout}\n{done.stderr}"


def test_every_verb_that_is_named_exists():
    verbs = {file.stem for file in (ROOT / "tentacle" / "cli").glob("[a-z]*.py")}
    named = {verb for page in PAGES for verb in re.findall(r"`?tentacle ([a-z]+(?:-[a-z]+)*)", code_of(page))}
    assert named - verbs == set()


def commands_of(page: Path) -> list[str]:
    """Every `tentacle ...` line of a page's fenced blocks, as typed; blocks of `text` show a grammar, not a command."""
    found = []
    for language, body in re.findall(r"^```(\w*)\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE):
        lines = body.replace("\\\n", " ").splitlines() if language in ("", "bash", "console") else []
        found += [line for line in lines if line.startswith("tentacle ")]
    spans = re.findall(r"`(tentacle [^`]+)`", page.read_text())
    # a span that says more than the verb is a command, unless it stands for one: capitals, dots
    return found + [span for span in spans if len(span.split()) > 3 and not re.search(r"\b[A-Z]{2,}|\.\.\.", span)]


@pytest.mark.parametrize("page", [*PAGES, ROOT / "README.md"], ids=lambda p: p.stem)
def test_every_command_is_one_that_the_program_takes(page):
    """What no test runs, being long or needing hardware, is at least parsed: verbs, options and their values."""
    parser = build_parser()
    for command in commands_of(page):
        words = shlex.split(command, comments=True)[1:]
        try:
            parser.parse_args([word for word in words if word != "&"])
        except SystemExit as ended:
            assert ended.code == 0, command  # noqa: PT017 (it says which)


def code_of(page: Path) -> str:
    """What a page shows as code: fenced blocks and `spans`."""
    text = page.read_text()
    fenced = re.findall(r"```(?:bash|console)\n(.*?)```", text, re.DOTALL)
    return "\n".join(fenced + re.findall(r"`[^`\n]+`", text))


def test_every_function_of_the_equations_table_exists():
    page = (ROOT / "docs" / "reference" / "equations.md").read_text()
    names = re.findall(r"`((?:\w+\.)+\w+)`", page)
    assert len(names) > 15
    for name in names:
        module, _, attribute = name.rpartition(".")
        assert hasattr(importlib.import_module(module), attribute), name


def test_the_site_builds_without_a_warning(tmp_path):
    pytest.importorskip("mkdocs", reason="mkdocs is not installed: pip install tentacle-twin[docs]")
    pytest.importorskip("material", reason="mkdocs-material is not installed: pip install tentacle-twin[docs]")
    pytest.importorskip("mkdocstrings", reason="mkdocstrings is not installed: pip install tentacle-twin[docs]")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(tmp_path / "site")]
    quiet = {**os.environ, "NO_MKDOCS_2_WARNING": "1", "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=ROOT, env=quiet, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    effects = (tmp_path / "site" / "reference" / "effects" / "index.html").read_text()
    from affine_model.effects import catalogue

    assert [name for name in catalogue() if f"<strong>{name}</strong>" not in effects] == []
    # nothing of the site is fetched from elsewhere when it is read
    home = (tmp_path / "site" / "index.html").read_text()
    assert re.findall(r'<(?:script|link)[^>]+(?:src|href)="https?://(?!localhost)[^"]+\.(?:js|css)"', home) == []
    shutil.rmtree(tmp_path / "site")
