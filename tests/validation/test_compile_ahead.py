"""What a process of its own compiles ahead is what a verb would otherwise compile itself."""

from __future__ import annotations

from validation.compile_ahead import start


def test_the_verb_finds_the_filter_compiled(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert start(["fit"]).wait() == 0
    kept = {file.name.split("-")[0].removeprefix("kalman.") for file in tmp_path.rglob("*.nbc")}
    assert {"gains_along", "whitened_along", "filtered_along", "smoothed_along"} <= kept
