"""The runner: each task once, results whole, and a run that was killed goes on where it was."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from distributed import LocalCluster
from rich.console import Console

from tentacle.errors import InputError
from tentacle.runner import Runner, is_stored, load_result, progress_bar, store_result

WORK = """\
import os, signal, time
from pathlib import Path
import numpy as np

def square(task):
    with open(task["log"], "a") as log:
        log.write(f"{task['x']}\\n")
    if task["x"] < 0:
        raise ValueError("negative")
    if task.get("die"):
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(task.get("wait", 0))
    found = {"y": task["x"] ** 2, "powers": np.arange(3.0) ** task["x"]}
    return {**found, "process": os.getpid(), "threads": os.environ.get("OMP_NUM_THREADS")}
"""


@pytest.fixture
def square(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """A task in a module of its own, which the worker processes can import."""
    (tmp_path / "squares_of_a_test.py").write_text(WORK)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}{os.pathsep}{os.environ.get('PYTHONPATH', '')}")
    import squares_of_a_test  # pyright: ignore[reportMissingImports]

    yield squares_of_a_test.square
    del sys.modules["squares_of_a_test"]


def tasks(folder: Path, *numbers: int, wait: float = 0.0) -> list[dict[str, Any]]:
    return [{"x": x, "log": str(folder / "log.txt"), "wait": wait} for x in numbers]


def finished(folder: Path) -> int:
    return sum(not file.name.startswith(".") for file in (folder / "results").glob("*.npz"))


def test_results_come_in_order_and_no_task_runs_twice(tmp_path: Path, square: Any) -> None:
    runner = Runner(tmp_path / "results", workers=2, quiet=True)
    first = runner.run(square, tasks(tmp_path, 3, 1, 2))
    assert [result["y"] for result in first] == [9, 1, 4]
    np.testing.assert_array_equal(first[2]["powers"], [0, 1, 4])
    again = runner.run(square, tasks(tmp_path, 2, 3, 5, 5))
    assert [result["y"] for result in again] == [4, 9, 25, 25]
    assert sorted((tmp_path / "log.txt").read_text().split()) == ["1", "2", "3", "5"]
    runner.run(square, tasks(tmp_path, 3), version="2")
    assert (tmp_path / "log.txt").read_text().split().count("3") == 2


def test_what_a_task_raises_is_raised_and_its_neighbours_are_kept(tmp_path: Path, square: Any) -> None:
    runner = Runner(tmp_path / "results", workers=1, quiet=True)
    with pytest.raises(ValueError, match="negative"):
        runner.run(square, tasks(tmp_path, 4, -1))
    assert is_stored(runner.file_of(square, tasks(tmp_path, 4)[0]))


def test_a_killed_run_goes_on_where_it_was(tmp_path: Path, square: Any) -> None:
    script = (
        "from pathlib import Path; from tentacle.runner import Runner; from squares_of_a_test import square\n"
        "if __name__ == '__main__':\n"
        f"    tasks = [{{'x': x, 'log': {str(tmp_path / 'log.txt')!r}, 'wait': 0.1}} for x in range(40)]\n"
        f"    Runner(Path({str(tmp_path / 'results')!r}), workers=1, quiet=True).run(square, tasks)\n"
    )
    (tmp_path / "many.py").write_text(script)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([*sys.path, os.environ["PYTHONPATH"]])}
    process = subprocess.Popen([sys.executable, str(tmp_path / "many.py")], env=environment, start_new_session=True)
    deadline = time.monotonic() + 30
    while finished(tmp_path) < 3 and time.monotonic() < deadline:
        time.sleep(0.02)
    os.kill(process.pid, signal.SIGKILL)  # the worker sees that it is alone, and ends
    process.wait()
    time.sleep(0.5)
    kept = finished(tmp_path)
    time.sleep(0.5)
    assert finished(tmp_path) == kept
    assert 3 <= kept < 40
    runner = Runner(tmp_path / "results", workers=1, quiet=True)
    before = len((tmp_path / "log.txt").read_text().split())
    results = runner.run(square, tasks(tmp_path, *range(40), wait=0.1))
    assert [result["y"] for result in results] == [x**2 for x in range(40)]
    assert len((tmp_path / "log.txt").read_text().split()) == before + 40 - kept


def test_a_result_is_stored_without_pickle(tmp_path: Path) -> None:
    store_result({"a": 1.5, "b": [1, None, "c"]}, tmp_path / "plain")
    assert load_result(tmp_path / "plain") == {"a": 1.5, "b": [1, None, "c"]}
    with pytest.raises(ValueError, match="objects"):
        store_result({"a": np.array([{}], dtype=object)}, tmp_path / "bad")
    assert not is_stored(tmp_path / "bad")


def test_a_scheduler_and_two_workers_do_the_same(tmp_path: Path, square: Any) -> None:
    # A real scheduler on a port, and two worker processes.
    made: dict[str, Any] = {"threads_per_worker": 1, "dashboard_address": "127.0.0.1:0", "host": "127.0.0.1"}
    cluster: Any
    with LocalCluster(n_workers=2, processes=True, **made) as cluster:
        runner = Runner(tmp_path / "results", scheduler=cluster.scheduler_address, quiet=True)
        found = runner.run(square, tasks(tmp_path, 3, 2, 5, 7, wait=0.2))
        assert [result["y"] for result in found] == [9, 4, 25, 49]
        assert len({result["process"] for result in found}) == 2
        assert os.getpid() not in {result["process"] for result in found}
        with pytest.raises(ValueError, match="negative"):
            runner.run(square, tasks(tmp_path, 4, -1, wait=0.2))
        assert is_stored(runner.file_of(square, tasks(tmp_path, 4, wait=0.2)[0]))
    local = Runner(tmp_path / "results", workers=1, quiet=True)
    assert [result["y"] for result in local.run(square, tasks(tmp_path, 2, 3, wait=0.2))] == [4, 9]
    assert sorted((tmp_path / "log.txt").read_text().split()) == ["-1", "2", "3", "4", "5", "7"]


def test_no_workers_are_refused(tmp_path: Path, square: Any) -> None:
    with pytest.raises(InputError, match="1 or more"):
        Runner(tmp_path / "results", workers=0, quiet=True).run(square, tasks(tmp_path, 1))
    assert not (tmp_path / "results").exists()


def test_where_no_scheduler_answers_one_line_says_so(tmp_path: Path, square: Any) -> None:
    for address in ("nonsense", "tcp://nowhere", "tcp://127.0.0.1:1"):  # nothing listens at port 1
        with pytest.raises(InputError, match="no Dask scheduler answers"):
            Runner(tmp_path / "results", scheduler=address, quiet=True).run(square, tasks(tmp_path, 1))


def test_a_worker_that_is_killed_is_one_line_too(tmp_path: Path, square: Any) -> None:
    with pytest.raises(InputError, match="was killed"):
        Runner(tmp_path / "results", workers=1, quiet=True).run(square, [{**tasks(tmp_path, 1)[0], "die": True}])


def test_workers_share_the_cores(tmp_path: Path, square: Any) -> None:
    cores = os.cpu_count() or 1
    before = os.environ.get("OMP_NUM_THREADS")
    found = Runner(tmp_path / "results", workers=cores, quiet=True).run(square, tasks(tmp_path, *range(cores)))
    assert {result["threads"] for result in found} == {"1"}
    assert os.environ.get("OMP_NUM_THREADS") == before


def test_progress_tells_the_time_left_of_tasks_longer_than_a_minute() -> None:
    now = [0.0]
    progress = progress_bar(Console(file=StringIO()), clock=lambda: now[0])
    line = progress.add_task("running", total=10, completed=4)  # four stand from an earlier run
    for _ in range(2):
        now[0] += 90.0
        progress.advance(line)
    assert progress.tasks[0].time_remaining == pytest.approx(4 * 90.0)


def test_tasks_that_are_no_plain_data_are_refused(tmp_path: Path, square: Any) -> None:
    with pytest.raises(InputError, match="plain data"):
        Runner(tmp_path).file_of(square, {"x": {1, 2}})
    with pytest.raises(InputError, match="plain data"):
        Runner(tmp_path).file_of(square, {"x": float("nan")})
