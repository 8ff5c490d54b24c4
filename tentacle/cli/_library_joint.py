"""A library's joint answer: the evidence of each recording, made once by many processes, and their combination."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tentacle.io.library import Library
    from tentacle.runner import Runner

SECONDS_A_DAY = 86400.0
FEWEST = 3  # recordings of an arm that are put together: fewer have no spread


def join(library: Library, runner: Runner, *, renew: bool) -> list[str]:
    """Write the joint answer of every arm; a line for each recording, or arm, that could not be taken in."""
    from tentacle.io.library.joint import write_joint
    from tentacle.io.library.layers import library_code_version

    rows = [row for row in library.table().to_pylist() if row["fault"] is None]
    once = {row["sha256"]: row for row in rows}  # a copy of a recording is the same recording
    arms: dict[str, list[dict[str, Any]]] = {}
    for row in once.values():
        arms.setdefault(row["specimen"], []).append(row)
    failures, answers = list[str](), []
    for specimen, own in arms.items():
        if len(own) < FEWEST:
            failures.append(f"arm {specimen}: {len(own)} recordings; a joint answer needs {FEWEST} or more")
            continue
        known, failed = _evidence(library, runner, own, renew=renew)
        failures += failed
        if len(known) < FEWEST:
            failures.append(f"arm {specimen}: {len(known)} usable recordings; a joint answer needs {FEWEST} or more")
            continue
        answers.append({"specimen": specimen, **_answer(known)})
    write_joint(answers, library_code_version(), library.joint_file)
    return failures


def _evidence(
    library: Library, runner: Runner, rows: Sequence[Mapping[str, Any]], *, renew: bool
) -> tuple[list[tuple[Mapping[str, Any], Path]], list[str]]:
    """The files of an arm's evidence, by date, and a line for each recording without."""
    from discovery.library.tasks import evidence_work, order_work
    from tentacle.io.library.layers import library_code_version

    results = runner.run(order_work, [_task(row) for row in rows], words="orders")
    orders = sorted(result["order"] for result in results if result["failed"] is None)
    failures = [f"{result['path']}: {result['failed']}" for result in results if result["failed"] is not None]
    if not orders:
        return [], failures
    order = orders[len(orders) // 2]
    usable = [row for row, result in zip(rows, results, strict=True) if result["failed"] is None]
    wanted = []
    for row in usable:
        file = library.evidence(row["sha256"], order)
        if not file.exists() or (renew and _code_of(file) != library_code_version()):
            wanted.append(_task(row) | {"order": order, "file": str(file), "code": library_code_version()})
    for task in wanted:  # the files are what counts: a result whose file is gone is made again
        runner.file_of(evidence_work, task).with_suffix(".json").unlink(missing_ok=True)
    results = runner.run(evidence_work, wanted, words="evidence") if wanted else []
    failures += [f"{result['path']}: {result['failed']}" for result in results if result["failed"] is not None]
    files = [(row, library.evidence(row["sha256"], order)) for row in usable]
    return [(row, file) for row, file in files if file.exists()], failures


def _task(row: Mapping[str, Any]) -> dict[str, Any]:
    return {"path": row["path"], "content": row["sha256"]}


def _code_of(file: Path) -> str:
    from discovery.library.evidence import read_evidence
    from discovery.library.tasks import CODE

    return read_evidence(file)[1].get(CODE, "")


def _answer(known: Sequence[tuple[Mapping[str, Any], Path]]) -> dict[str, Any]:
    """The joint answer of an arm as plain data, by date."""
    import numpy as np
    from rich.console import Console

    from discovery.library.evidence import read_evidence
    from discovery.library.joint import combine
    from discovery.library.joint_data import joint_data
    from tentacle.runner import progress_bar

    days = np.array([row["date"].timestamp() / SECONDS_A_DAY for row, _ in known])
    console = Console(stderr=True)
    with progress_bar(console, quiet=not console.is_terminal) as progress:
        line = progress.add_task("together", total=1.0)
        answer = combine(
            [read_evidence(file)[0] for _, file in known], days, lambda done: progress.update(line, completed=done)
        )
    return joint_data(answer, [row["sha256"] for row, _ in known])
