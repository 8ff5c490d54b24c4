"""Every link of the repository's pages leads to a file and a heading that are there.

The site's own links are checked when it is built (test_documentation.py). Addresses elsewhere are not asked for.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.docs.shown import PAGES, ROOT

ALL_PAGES = [*sorted(ROOT.glob("*.md")), *PAGES]
LINK = re.compile(r"\]\(([^)\s]+)\)")
GENERATED = (ROOT / "docs" / "examples", ROOT / "docs" / "notebooks")  # docs/hooks make these pages of the site


def prose(page: Path) -> str:
    """The page without its fenced blocks and spans of code."""
    return re.sub(r"`[^`\n]*`", "", re.sub(r"^```.*?^```", "", page.read_text(), flags=re.DOTALL | re.MULTILINE))


def headings(page: Path) -> set[str]:
    """The names under which a page's headings are linked: lower case, no punctuation, a hyphen for each blank."""
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)
    titles = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    plain = [re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", title) for title in titles]
    return {re.sub(r"[^\w\- ]", "", title.strip().lower()).replace(" ", "-") for title in plain}


def broken(page: Path) -> list[str]:
    """Links of a page that lead nowhere."""
    found = []
    for link in LINK.findall(prose(page)):
        if re.match(r"[a-z]+:", link):
            continue
        name, _, heading = link.partition("#")
        target = (page.parent / name).resolve() if name else page
        if target.parent in GENERATED and target.suffix in (".md", ".ipynb"):
            continue
        if not target.exists() or (heading and target.suffix == ".md" and heading not in headings(target)):
            found.append(link)
    return found


@pytest.mark.parametrize("page", ALL_PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_link_leads_somewhere(page: Path) -> None:
    assert broken(page) == []


def test_a_link_to_nothing_is_seen(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("# One heading: two\n\n[a](page.md#one-heading-two) [b](page.md#no) [c](none.md) `[d](none.md)`\n")
    assert broken(page) == ["page.md#no", "none.md"]


def test_every_picture_is_shown_somewhere() -> None:
    text = "\n".join(page.read_text() for page in ALL_PAGES)
    pictures = [path for path in (ROOT / "docs" / "pictures").iterdir() if path.is_file()]
    assert [path.name for path in pictures if path.name not in text] == []
