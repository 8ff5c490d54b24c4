"""tentacle data: measured data of other labs, used by tests and examples."""

from __future__ import annotations

import argparse
from pathlib import Path

from tentacle.cli._output import say, say_text

HELP = "list public measured data sets with source, licence and whether they are here; convert them"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments: nothing (list), or `convert SET OUT`."""
    parser.add_argument("--json", action="store_true", help="print the list as JSON")
    actions = parser.add_subparsers(metavar="convert")
    convert = actions.add_parser("convert", help="write a set's runs as import folders", allow_abbrev=False)
    convert.add_argument("set", choices=["silicone_beam", "trunk_payload", "pressure_arm"], help="name of the data set")
    convert.add_argument("out", type=Path, metavar="OUT", help="folder for the import folders, one per run")
    convert.set_defaults(convert=True)
    parser.set_defaults(convert=False)


def run(arguments: argparse.Namespace) -> int:
    """List, or convert."""
    return _convert(arguments.set, arguments.out) if arguments.convert else _list(as_json=arguments.json)


def _list(*, as_json: bool) -> int:
    import json
    from dataclasses import asdict

    from tentacle.io.external_data import DATA_SETS, check_data_set, data_folder

    folder = data_folder()
    found = [(data_set, *check_data_set(data_set, folder)) for data_set in DATA_SETS]
    if as_json:
        rows = [{**asdict(data_set), "state": state, "paths": paths} for data_set, state, paths in found]
        say_text(json.dumps({"folder": str(folder), "sets": rows}, indent=1))
        return 0
    say(f"looked for in {folder} (TENTACLE_DATA)")
    for data_set, state, paths in found:
        say("", f"{data_set.name}: {state}{': ' + ', '.join(paths) if paths else ''}")
        say(f"  {data_set.what}")
        say(f"  from    {data_set.url}, commit {data_set.commit}, {data_set.path}")
        say(f"  licence {data_set.licence}")
    say("", "checksums (SHA-256): tentacle data --json")
    return 0


def _convert(name: str, out: Path) -> int:
    from tentacle.io.convert_data import convert_data
    from tentacle.io.external_data import data_folder

    for folder in convert_data(name, data_folder(), out):
        say(f"wrote {folder}")
    return 0
