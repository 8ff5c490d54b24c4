"""Parts of the documentation that come from the code: the catalogue of effects, the verbs of the command line,
the glossary.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]


def effects_table() -> str:
    """Every effect with its parameters, units, bounds and source, as Markdown."""
    from affine_model.effects import catalogue

    lines = ["| effect | parameters | bounds | source |", "|---|---|---|---|"]
    for effect in catalogue().values():
        names = "<br>".join(f"`{p.name}` [{p.unit}] {p.words}" for p in effect.parameters) or "none"
        bounds = "<br>".join(f"{p.bounds[0]:g} to {p.bounds[1]:g}" for p in effect.parameters)
        where = f"**{effect.name}** ({effect.family})<br>{effect.title}"
        lines.append(f"| {where} | {names} | {bounds} | {effect.source} |")
    return "\n".join(lines)


def verbs_table() -> str:
    """Every verb of the command line with its one line of help, as Markdown."""
    from importlib import import_module

    lines = ["| verb | what it does |", "|---|---|"]
    for file in sorted((ROOT / "tentacle" / "cli").glob("[a-z]*.py")):
        lines.append(f"| `tentacle {file.stem}` | {import_module(f'tentacle.cli.{file.stem}').HELP} |")
    return "\n".join(lines)


def glossary_table() -> str:
    """Every word with its meaning and unit, as Markdown."""
    from viz.glossary import TERMS

    lines = ["| term | meaning | unit |", "|---|---|---|"]
    return "\n".join([*lines, *(f"| {term.name} | {term.meaning} | {term.unit} |" for term in TERMS)])


PARTS = {"<!-- effects -->": effects_table, "<!-- verbs -->": verbs_table, "<!-- glossary -->": glossary_table}


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Put the generated parts where a page asks for them."""
    if str(ROOT) not in sys.path:
        sys.path.insert(0, str(ROOT))
    for mark, make in PARTS.items():
        if mark in markdown:
            markdown = markdown.replace(mark, make())
    return markdown
