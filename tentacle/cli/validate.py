"""tentacle validate: the error of tracking on test videos with a known truth, look by look."""

from __future__ import annotations

import argparse
from pathlib import Path

from tentacle.cli._output import say

HELP = "render, track and judge test videos of every look: error over the Cramer-Rao limit, misses, false accepts"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument("--out", type=Path, required=True, metavar="FOLDER", help="where validation.txt and .json go")
    parser.add_argument("--looks", nargs="+", metavar="LOOK", help="some of the looks (default: all)")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3], help="one video each (default: 1 2 3)")
    parser.add_argument("--frames", type=int, default=150, help="frames a video (default: 150)")
    parser.add_argument("--size", type=int, nargs=2, default=(1280, 720), metavar=("W", "H"), help="picture size [px]")


def run(arguments: argparse.Namespace) -> int:
    """Validate look by look, then test the rejection of disturbed frames; print and write the table."""
    import json

    from tentacle.errors import InputError
    from tentacle.io.result_folder import written
    from vision.looks import LOOKS, look_named
    from vision.validate import judge_disturbed, judge_look, look_table, results_json

    size, seeds = tuple(arguments.size), tuple(arguments.seeds)
    if arguments.frames < 8 or min(size) < 120:
        raise InputError("too little to judge by", field="--frames, --size", expected="8 frames, 120 px or more")
    looks = [look_named(name) for name in arguments.looks or LOOKS]
    if arguments.out.exists() and not arguments.out.is_dir():
        raise InputError("is a file", file=arguments.out, expected="a folder to write to")
    results = []
    for look in looks:
        results.append(judge_look(look, seeds, arguments.frames, size))
        lines = look_table(results).splitlines()
        say(*(lines[:3] if len(results) == 1 else lines[-1:]))
    lines = [look_table(results), ""]
    for disturb, words in (("hand", "a hand in the tank"), ("second_arm", "a second arm")):
        tracked, wrong = judge_disturbed(disturb, seeds[0], min(arguments.frames, 60), size)
        accepted = f"{tracked.shape.accepted.mean():.0%} of frames accepted, {wrong} of them wrongly"
        lines.append(f"{words}: {accepted}; {'; '.join(tracked.remarks) or 'nothing to remark'}")
        say(lines[-1])
    with written(arguments.out) as folder:
        (folder / "validation.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
        (folder / "validation.json").write_text(json.dumps(results_json(results), indent=1) + "\n", encoding="utf-8")
    say(f"wrote {arguments.out / 'validation.txt'} and validation.json")
    return 0
