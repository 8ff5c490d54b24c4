"""A folder of results: complete or as it was, nothing of others lost, and told what stands there before."""

from __future__ import annotations

from pathlib import Path

import pytest

from tentacle.errors import InputError
from tentacle.io.result_folder import told_before, written

REST = "files of the same name are replaced, all others stay"


def holding(folder: Path, *names: str) -> Path:
    """The folder with a file of each name; a name that ends with / is a folder."""
    for name in names:
        (folder / name).mkdir(parents=True) if name.endswith("/") else put(folder / name, "old")
    return folder


def put(file: Path, text: str) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)


def write_new(folder: Path, *names: str) -> None:
    """New results of these names."""
    with written(folder) as partial:
        for name in names:
            put(partial / name, "new")


@pytest.mark.parametrize(
    ("names", "held"),
    [
        (("verdict.json", "report.html", "laws/law.toml"), "earlier results of tentacle diagnose"),
        (("identification.json", "verdict.json"), "earlier results of tentacle diagnose and identify"),
        (("verdict.json", "notes.txt"), "earlier results of tentacle diagnose and other files (notes.txt)"),
        (("recording.toml", "video.mp4"), "files (recording.toml, video.mp4)"),
        (("model.toml",), "files (model.toml)"),  # a file of one's own, as far as anyone can tell
        (("a", "b", "c", "d", "e"), "files (a, b, c and 2 more)"),
    ],
)
def test_what_a_folder_holds_is_told(tmp_path: Path, names: tuple[str, ...], held: str) -> None:
    folder = holding(tmp_path / "answer", *names)
    assert told_before(folder) == f"{folder} holds {held}: {REST}"


def test_nothing_is_told_of_a_folder_without_results(tmp_path: Path) -> None:
    assert told_before(tmp_path / "none") == ""
    assert told_before(holding(tmp_path / "hidden", ".DS_Store")) == ""


def test_a_file_in_the_folder_s_place_is_refused_before_the_work(tmp_path: Path) -> None:
    (tmp_path / "answer").write_text("mine")
    with pytest.raises(InputError, match="is a file"):
        told_before(tmp_path / "answer")


def test_what_is_told_is_what_happens(tmp_path: Path) -> None:
    folder = holding(tmp_path / "answer", "verdict.json", "notes.txt", "laws/mine.toml", "laws/law.toml")
    write_new(folder, "verdict.json", "report.html", "laws/law.toml")
    found = {str(file.relative_to(folder)): file.read_text() for file in folder.rglob("*") if file.is_file()}
    assert found == {
        "verdict.json": "new",
        "report.html": "new",
        "notes.txt": "old",
        "laws/law.toml": "new",
        "laws/mine.toml": "old",
    }
    assert [path.name for path in tmp_path.iterdir() if "partial" in path.name] == []


@pytest.mark.parametrize(("there", "new"), [("laws", "laws/law.toml"), ("report.html/", "report.html")])
def test_a_file_in_the_place_of_a_folder_is_named_and_nothing_changes(tmp_path: Path, there: str, new: str) -> None:
    folder = holding(tmp_path / "answer", there, "verdict.json")
    with pytest.raises(InputError, match="or another folder for the results"):
        write_new(folder, "verdict.json", new)
    assert (folder / "verdict.json").read_text() == "old"
