"""The gallery: every script of examples/ as a page with its picture and what it printed, and as a notebook.

A script is cut into cells by lines that begin with `# %%`; a `# %% [markdown]` cell holds comments, which are prose.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[2]
SCRIPTS = sorted((ROOT / "examples").glob("*.py"))
RUN = "pictures/examples"  # what running a script left there: NAME.webp and NAME.txt
MARK = re.compile(r"^# %%( \[markdown\])?$", re.MULTILINE)


@dataclass(frozen=True)
class Cell:
    """One cell of a script: prose (without the comment signs) or code."""

    kind: Literal["markdown", "code"]
    text: str


def cells(script: str) -> list[Cell]:
    """The cells of a script. ValueError where it does not begin with one."""
    parts = MARK.split(script)
    if parts[0].strip():
        raise ValueError(f"a script begins with a cell, not with {parts[0].splitlines()[0]!r}")
    found = []
    for mark, body in zip(parts[1::2], parts[2::2], strict=True):
        if mark:
            found.append(Cell("markdown", "\n".join(line[1:].strip() for line in body.strip().splitlines())))
        else:
            found.append(Cell("code", body.strip()))
    return found


def notebook(script: str) -> dict[str, Any]:
    """The script as a Jupyter notebook (format 4.5), not run; its first code cell lets figures show themselves."""

    def lines(text: str) -> list[str]:
        return text.splitlines(keepends=True)

    made = []
    for number, cell in enumerate([Cell("code", "%matplotlib inline"), *cells(script)]):
        extra = {"execution_count": None, "outputs": []} if cell.kind == "code" else {}
        made.append(
            {"id": f"cell-{number}", "cell_type": cell.kind, "metadata": {}, "source": lines(cell.text), **extra}
        )
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    return {"nbformat": 4, "nbformat_minor": 5, "metadata": {"kernelspec": kernel}, "cells": made}


def page(name: str, script: str) -> str:
    """The script as a page: prose, code, then its picture and what it printed."""
    parts = [cell.text if cell.kind == "markdown" else f"```python\n{cell.text}\n```" for cell in cells(script)]
    printed = (ROOT / "docs" / RUN / f"{name}.txt").read_text(encoding="utf-8").strip()
    title, rest = parts[0].split("\n", 1)
    links = f"[Notebook](../notebooks/{name}.ipynb) of `examples/{name}.py`; it runs in a few seconds."
    picture = f"![{title.lstrip('# ')}](../{RUN}/{name}.webp)"
    return (
        "\n\n".join([title, links, picture, rest.strip(), *parts[1:], "It prints", f"```text\n{printed}\n```"]) + "\n"
    )


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add a page and a notebook for every script."""
    for script in SCRIPTS:
        text = script.read_text(encoding="utf-8")
        files.append(File.generated(config, f"examples/{script.stem}.md", content=page(script.stem, text)))
        content = json.dumps(notebook(text), indent=1)
        files.append(File.generated(config, f"notebooks/{script.stem}.ipynb", content=content))
    return files
