"""Diagnoses of a library's recordings: the work that tentacle.runner hands to processes or Dask, as plain data."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tentacle.cli._output import remark, say

if TYPE_CHECKING:
    from tentacle.io.library import Library
    from tentacle.runner import Runner

POLLED = 2.0  # s between two looks at a folder that is followed
UNCHANGED_FOR = 5.0  # s since a file's last change: until then a rig is still writing it


def diagnose_missing(library: Library, runner: Runner, *, renew: bool, baseline: list[Path], seed: int) -> list[str]:
    """Diagnose recordings without a layer (renew: also those with a layer of older code); a line for each failure."""
    from tentacle.io.library.layers import library_code_version

    wanted = ("new", "failed", "older code") if renew else ("new",)
    rows = [row for row in library.table().to_pylist() if row["state"] in wanted]
    once = {row["sha256"]: row for row in rows}  # a copy of a recording is the same recording
    tasks = [
        {
            "path": row["path"],
            "content": row["sha256"],
            "layer": str(library.layer(row["sha256"])),
            "baseline": [str(path) for path in baseline],
            "seed": seed,
            "code": library_code_version(),
        }
        for row in once.values()
    ]
    for task in tasks:  # the layers are what counts: a result whose layer is gone is made again
        runner.file_of(diagnose_work, task).with_suffix(".json").unlink(missing_ok=True)
    results = runner.run(diagnose_work, tasks, words="recordings") if tasks else []
    library.gather()
    return [f"{result['path']}: {result['failed']}" for result in results if result["failed"] is not None]


def follow(library: Library, runner: Runner, *, baseline: list[Path], seed: int) -> None:
    """Diagnose new recordings in the folder and update the page, until Ctrl-C."""
    import time

    from tentacle.cli.pages.library import write_library_page

    say(f"following {library.source} (Ctrl-C ends it); page: {write_library_page(library)}")
    while True:
        try:
            time.sleep(POLLED)
            if library.refresh(settled=UNCHANGED_FOR) == 0:
                continue
            for line in diagnose_missing(library, runner, renew=False, baseline=baseline, seed=seed):
                remark(line)
            write_library_page(library)
        except KeyboardInterrupt:
            return
        states = library.table().column("state").to_pylist()
        say(f"{states.count('done')} of {len(states)} recordings have a verdict")


def diagnose_work(task: Mapping[str, Any]) -> dict[str, Any]:
    """Write one recording's layer completely; if the diagnosis fails, the layer has the reason."""
    from discovery.diagnose import diagnose
    from discovery.library.layer import failed_layer, layer_of
    from tentacle.cli.pages.diagnosis import write_answer
    from tentacle.errors import InputError
    from tentacle.io.library.layers import LAYER, write_layer
    from tentacle.io.result_folder import written
    from vision.tracked_recording import read_tracked

    path, baseline = Path(task["path"]), [Path(file) for file in task["baseline"]]
    home, failed = Path(task["layer"]), None
    home.joinpath(LAYER).unlink(missing_ok=True)
    try:
        recording = read_tracked(path, _quiet)
        known = [read_tracked(file, _quiet) for file in baseline]
        found = diagnose([recording], known, [], seed=task["seed"])
        layer = layer_of(found, task["content"], task["code"])
        with written(home) as folder:
            write_answer(found, [recording], folder, f"tentacle library diagnose {path}", [path])
    except InputError as error:
        failed = error.line()
        layer = failed_layer(failed, task["content"], task["code"])
    write_layer(layer, home)  # last: a layer counts from here on
    return {"path": task["path"], "failed": failed}


def _quiet(words: str, done: float = 0.0) -> None:
    """Progress of one recording among many is not shown."""
    del words, done
