"""diagnose: the verdict on the left, a tab for each run."""

from __future__ import annotations

from collections.abc import Sequence

import rerun.blueprint as rrb

from viz.blueprints.run import LoggedTopics, run_page
from viz.blueprints.views import blueprint_page


def diagnose_blueprint(runs: Sequence[LoggedTopics]) -> rrb.Blueprint:
    """The layout of session.rrd of `tentacle diagnose`."""
    verdict = rrb.TextDocumentView(origin="verdict", name="verdict")
    return blueprint_page(rrb.Horizontal(verdict, rrb.Tabs(*(run_page(shown) for shown in runs)), column_shares=[1, 3]))
