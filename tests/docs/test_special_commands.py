"""The table of specially run commands holds only commands that the docs show, and the docs hide none."""

from tests.docs.shown import PAGES, ROOT, shown, stray
from tests.docs.special_commands import ELSEWHERE, SPECIAL


def test_the_table_holds_only_what_is_shown_and_no_block_hides_a_command() -> None:
    assert set(SPECIAL) | set(ELSEWHERE) <= set(shown([ROOT / "README.md", *PAGES]))
    assert {page.name: stray(page) for page in PAGES if stray(page)} == {}
