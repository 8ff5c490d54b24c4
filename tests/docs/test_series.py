"""The page of the trials has the table and the list of misses that the committed results give."""

from benchmarks.series import BEGIN, END, PAGE, all_series, counted, shown


def test_the_page_has_what_the_results_of_every_trial_give():
    between = PAGE.read_text().split(BEGIN)[1].split(END)[0].strip()
    assert between == shown().strip(), "python benchmarks/series.py --write"


def test_a_series_counts_each_trial_once_and_names_each_miss():
    for series in all_series():
        indices = [o.index for o in series.outcomes]
        assert len(set(indices)) == len(indices)
        assert all(found.hits <= found.count for found in counted(series.outcomes).values())
