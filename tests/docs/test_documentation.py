"""The documentation builds without a warning, its marked blocks run, and what it names exists."""

from __future__ import annotations

import importlib
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.docs.desk import environment, film_an_arm
from tests.docs.shown import PAGES, ROOT, Block, blocks


def marked(page: Path) -> list[Block]:
    return [block for block in blocks(page) if block.marked]


@pytest.mark.parametrize("page", [p for p in PAGES if marked(p)], ids=lambda p: p.stem)
def test_marked_blocks_run(page, tmp_path):
    """Bash blocks in order; the Python blocks of a page as one program."""
    film_an_arm(tmp_path / "my_arm")
    shell = environment(tmp_path)
    commands = [["bash", "-eu", "-c", block.code] for block in marked(page) if block.language == "bash"]
    program = "\n".join(block.code for block in marked(page) if block.language == "python")
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
