import html5lib
import pytest

from tentacle.cli import main
from tentacle.io.library import open_library
from tentacle.io.library.layers import library_code_version, write_layer
from tentacle.io.recording_rrd import write_rrd
from tests.page import problems
from tests.tentacle.io.test_library import recording


@pytest.fixture
def folder(tmp_path):
    """Four recordings of two arms with verdicts, and one that is new."""
    source = tmp_path / "recordings"
    source.mkdir()
    for k in range(5):
        write_rrd(recording(f"run {k}", 0.14 if k % 2 else 0.2, f"2026-03-0{k + 1}"), source / f"{k}.rrd")
    library = open_library(source, settings={"seed": 0})
    library.refresh()
    for k, row in enumerate(library.table().to_pylist()[:4]):
        parameters = [{"effect": "elasticity", "parameter": "E", "value": 2e5 + 1e3 * k, "low": 1.9e5, "high": 2.1e5,
                       "unit": "Pa"}]  # fmt: skip
        layer = {"sha256": row["sha256"], "code": library_code_version(), "verdict": "effect", "effects": "current",
                 "confidence": 0.9, "before_mm": 0.4, "after_mm": 0.2, "floor_mm": 0.15, "failed": None,
                 "parameters": parameters, "residual_mm": [[0.1, None], [0.2, 0.3]]}  # fmt: skip
        write_layer(layer, library.layer(row["sha256"]))
    return source


def test_one_table_one_page_and_an_exit_code_for_scripts(folder, capsys):
    assert main(["library", str(folder), "--where", "verdict=effect", "--check", "--reverse"]) == 0
    said = capsys.readouterr().out
    assert said.index("run 3") < said.index("run 0")
    assert "run 4" not in said
    assert main(["library", str(folder), "--check", "--no-page"]) == 1  # one is new
    page = (folder.with_name("recordings.library") / "library.html").read_text()
    assert [words for words in problems(page) if "is not inside the page" not in words] == []
    tree = html5lib.parse(page, namespaceHTMLElements=False)
    links = [str(link.get("href")) for link in tree.iter("a")]
    assert sum(link.endswith("session.rrd") for link in links) == 4
    assert len(tree.findall(".//figure")) == 2  # parameters over time, what the models leave


def test_every_column_as_csv(folder, tmp_path):
    assert main(["library", str(folder), "--csv", str(tmp_path / "all.csv"), "--no-page"]) == 0
    lines = (tmp_path / "all.csv").read_text().splitlines()
    assert len(lines) == 6
    assert "sha256" in lines[0]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["nowhere"], "no such folder or list"),
        (["{}", "--watch"], "follows a diagnosis only"),
        (["{}", "--where", "colour=red"], "no column"),
        (["{}", "--sort", "colour"], "no column"),
        (["{}", "{}"], "2 given"),
    ],
)
def test_what_cannot_be_asked_is_said_in_one_line(folder, capsys, arguments, says):
    assert main(["library", *(word.format(folder) for word in arguments)]) == 2
    error = capsys.readouterr().err
    assert says in error
    assert error.count("\n") == 1
