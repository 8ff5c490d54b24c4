"""A series of blind trials on a Dask cluster: the same results as here, and nothing done twice."""

import json
from pathlib import Path

import pytest

from tentacle.cli import main

# Two short recordings, of the plant that runs faster.
SERIES = ("blind-trial", "2", "--kinds", "null", "--plant", "stranger", "--video-share", "0", "--seed", "149")


@pytest.mark.long
def test_a_cluster_gives_what_this_machine_gives_and_a_second_run_does_nothing_again(tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    here, away = tmp_path / "here", tmp_path / "away"
    made = {"n_workers": 2, "threads_per_worker": 1, "host": "127.0.0.1", "dashboard_address": "127.0.0.1:0"}
    with distributed.LocalCluster(**made) as cluster:
        assert main([*SERIES, "--out", str(away), "--cluster", cluster.scheduler_address]) in (0, None)
    assert main([*SERIES, "--out", str(here), "--workers", "2"]) in (0, None)
    found = (away / "results.json").read_text()
    assert found == (here / "results.json").read_text()
    assert len(json.loads(found)["trials"]) == 2
    # Without a scheduler now: had one trial to be done again, this would wait for the one that is gone.
    kept = {file: file.stat().st_mtime_ns for file in (away / "trials").rglob("*") if file.is_file()}
    (away / "report.html").unlink()
    assert main([*SERIES, "--out", str(away), "--workers", "1"]) in (0, None)
    assert (away / "report.html").exists()
    assert {file: file.stat().st_mtime_ns for file in kept} == kept
