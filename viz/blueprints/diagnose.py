"""diagnose: the verdict on the left, a tab for each run."""

from __future__ import annotations

from collections.abc import Sequence

import rerun.blueprint as rrb

from viz.blueprints.run import Shown, run_page
from viz.blueprints.views import page


def diagnose_blueprint(runs: Sequence[Shown]) -> rrb.Blueprint:
    """The layout of session.rrd of `tentacle diagnose`."""
    verdict = rrb.TextDocumentView(origin="verdict", name="verdict")
    return page(rrb.Horizontal(verdict, rrb.Tabs(*(run_page(shown) for shown in runs)), column_shares=[1, 3]))
