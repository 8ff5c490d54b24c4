"""tentacle library: many recordings as one table, diagnosed where they are new or changed, on one page."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from tentacle.cli._library_arguments import configure
from tentacle.cli._output import remark, say

if TYPE_CHECKING:
    from tentacle.io.library import Library

__all__ = ["HELP", "configure", "run"]
HELP = "index a folder of recordings, diagnose what is new or changed, show all as one table and one page"
COMPLETE, INCOMPLETE = 0, 1  # with --check and --changed
DIAGNOSE, JOINT = "diagnose", "joint"


def run(arguments: argparse.Namespace) -> int:
    """Refresh the index, diagnose where asked, show."""
    from tentacle.cli.pages.library import print_joint, print_rows, write_library_page
    from tentacle.errors import InputError
    from tentacle.io.library import open_library
    from tentacle.io.library.joint import read_joint, something_found
    from tentacle.io.library.listing import all_done, chosen, write_listing_csv
    from tentacle.io.output_lock import owned_outputs
    from tentacle.io.provenance import input_hashes

    command = arguments.source[0] if len(arguments.source) == 2 else ""
    diagnosing, joining = command == DIAGNOSE, command == JOINT
    if command not in ("", DIAGNOSE, JOINT) or len(arguments.source) > 2:
        raise InputError(
            f"{len(arguments.source)} given", field="DIR|LIST", expected="one, or diagnose or joint and one"
        )
    if arguments.watch and not diagnosing:
        raise InputError("follows a diagnosis only", field="--watch", expected="tentacle library diagnose DIR --watch")
    if arguments.changed and not joining:
        raise InputError("tells of a joint answer", field="--changed", expected="tentacle library joint DIR --changed")
    if joining and arguments.baseline:
        raise InputError("is not known to a joint answer", field="--baseline", expected="tentacle library diagnose")
    settings = None
    if diagnosing:
        settings = {"seed": arguments.seed, "baseline": sorted(input_hashes(arguments.baseline).values())}
    library = open_library(Path(arguments.source[-1]), arguments.home, settings)
    _refresh(library)
    with owned_outputs([library.home] if diagnosing or joining else []):
        failures = _diagnose(library, arguments) if diagnosing else _join(library, arguments) if joining else []
    table = chosen(library.table(), arguments.where, arguments.sort, arguments.reverse)
    if arguments.csv is not None:
        write_listing_csv(table, arguments.csv)
        say(f"wrote {arguments.csv}: {table.num_rows} recordings")
    else:
        print_rows(table)
    if joining:
        print_joint(library)
    if not arguments.no_page:
        say(f"page: {write_library_page(library)}")
    for line in failures:
        remark(line)
    incomplete = arguments.check and not all_done(table)
    changed = arguments.changed and something_found(read_joint(library.joint_file))
    return INCOMPLETE if incomplete or changed else COMPLETE


def _refresh(library: Library) -> None:
    from rich.console import Console

    from tentacle.runner import progress_bar

    console = Console(stderr=True)
    with progress_bar(console, quiet=not console.is_terminal) as progress:
        line = progress.add_task("reading", total=None)
        library.refresh(lambda done, of: progress.update(line, completed=done, total=of))


def _diagnose(library: Library, arguments: argparse.Namespace) -> list[str]:
    from tentacle.cli._library_work import diagnose_missing, follow
    from tentacle.runner import Runner

    runner = Runner(library.runs, arguments.workers, arguments.cluster)
    once = {"baseline": arguments.baseline, "seed": arguments.seed}
    failures = diagnose_missing(library, runner, renew=arguments.renew, **once)
    if arguments.watch:
        follow(library, runner, **once)
    return failures


def _join(library: Library, arguments: argparse.Namespace) -> list[str]:
    from tentacle.cli._library_joint import join
    from tentacle.runner import Runner

    return join(library, Runner(library.runs, arguments.workers, arguments.cluster), renew=arguments.renew)
