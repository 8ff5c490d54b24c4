"""The page beside a comparison is as wide as its widest table needs, and leaves the views half of the window."""

import pytest

from viz.compare import page_share


@pytest.mark.parametrize(
    ("page", "share"),
    [
        ("# Words alone, however long the line may be: " + 300 * "x", 0.25),
        ("| a | b |\n|---|---|\n| 1 | 2 |", 0.25),
        ("| " + 100 * "x" + " |", 104 * 7.5 / 1920.0),
        ("| " + 400 * "x" + " |", 0.5),
    ],
)
def test_a_page_is_as_wide_as_its_table(page: str, share: float) -> None:
    assert page_share(page) == pytest.approx(share)
