"""What a process of its own compiles ahead is what a verb would otherwise compile itself."""

from __future__ import annotations

from affine_model.warm import not_compiled
from tentacle.cli._compile_ahead import start


def test_the_verb_finds_the_kernels_and_the_filter_compiled(tmp_path, monkeypatch):
    monkeypatch.setenv("TENTACLE_KERNELS", str(tmp_path / "kernels"))
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "functions"))
    assert not_compiled() != []
    assert start(["kernels", "fit"]).wait() == 0
    assert not_compiled() == []
    kept = {file.name.split("-")[0].removeprefix("kalman.") for file in (tmp_path / "functions").rglob("*.nbc")}
    assert {"gains_along", "whitened_along"} <= kept
