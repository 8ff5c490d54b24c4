"""The page of the trials has the table and the list of misses that the committed results give."""

from benchmarks.readme_table import with_rows
from benchmarks.series import MARK, PAGE, all_series, counted, misses, shown


def test_the_page_has_what_the_results_of_every_trial_give():
    page = PAGE.read_text(encoding="utf-8")
    assert with_rows(page, shown(), MARK) == page, "python benchmarks/series.py --write"


def test_a_series_counts_each_trial_once_and_names_each_miss():
    for series in all_series():
        indices = [o.index for o in series.outcomes]
        assert len(set(indices)) == len(indices)
        wrong = sum(found.count - found.hits for found in counted(series.outcomes).values())
        assert sum(line.startswith(f"- {series.seed}, ") for line in misses([series])) == wrong
