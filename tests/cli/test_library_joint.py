"""tentacle library joint: recordings in, sentences, a column, a page and an exit code out; nothing made twice."""

from __future__ import annotations

import json
from dataclasses import replace

import html5lib
import pytest

from tentacle.cli import main
from tentacle.io.library import open_library
from tentacle.io.recording_rrd import write_rrd
from tests.made_recordings import record
from tests.page import problems


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Six recordings of one arm, a strong current in the last two."""
    source = tmp_path_factory.mktemp("joint") / "recordings"
    source.mkdir()
    for k in range(6):
        made = record({("current", "U_x"): 0.02} if k > 3 else {}, seconds=3.0, seed=k)
        write_rrd(replace(made, name=f"run {k}", notes={"date": f"2026-03-0{k + 1}"}), source / f"{k}.rrd")
    return source


@pytest.mark.long
def test_a_joint_answer_is_said_shown_and_made_once(folder, capsys):
    assert main(["library", "joint", str(folder), "--workers", "1", "--changed"]) == 1
    said = capsys.readouterr().out
    assert "current acts in 2 of 6 recordings: run 4 to run 5; in none before." in said
    assert "6 recordings together" in said
    library = open_library(folder)
    column = {row["name"]: row["joint"] for row in library.table().to_pylist()}
    assert column == {f"run {k}": "current" if k > 3 else "" for k in range(6)}
    page = (library.home / "library.html").read_text()
    assert [words for words in problems(page) if "is not inside the page" not in words] == []
    tree = html5lib.parse(page, namespaceHTMLElements=False)
    assert len(tree.findall(".//figure")) == 1  # the current over the recordings
    assert "acts in 2 of 6 recordings" in page

    files = {file: file.stat().st_mtime_ns for file in (library.home / "evidence").iterdir()}
    assert len(files) == 6
    before = (folder / "0.rrd").stat().st_mtime_ns
    assert main(["library", "joint", str(folder), "--workers", "1", "--no-page"]) == 0
    assert {file: file.stat().st_mtime_ns for file in (library.home / "evidence").iterdir()} == files
    assert (folder / "0.rrd").stat().st_mtime_ns == before  # nothing is written into a recording
    assert main(["library", str(folder), "--where", "joint~current", "--no-page"]) == 0
    assert "2 recordings" in capsys.readouterr().out


def test_two_recordings_are_too_few_for_a_joint_answer(folder, tmp_path, capsys):
    few = tmp_path / "few.txt"
    few.write_text(f"{folder}/0.rrd\n{folder}/1.rrd\n")
    assert main(["library", "joint", str(few), "--changed"]) == 0
    assert "needs 3 or more" in capsys.readouterr().err
    assert json.loads((tmp_path / "few.library" / "joint.json").read_text())["arms"] == []


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["{}", "--changed"], "tells of a joint answer"),
        (["joint", "{}", "--baseline", "{}"], "is not known to a joint answer"),
        (["together", "{}"], "diagnose or joint and one"),
    ],
)
def test_what_cannot_be_asked_together_is_said_in_one_line(folder, capsys, arguments, says):
    assert main(["library", *(word.format(folder) for word in arguments)]) == 2
    error = capsys.readouterr().err
    assert says in error
    assert error.count("\n") == 1
