from pathlib import Path

import numpy as np
import pytest

from tentacle.errors import InputError
from tentacle.io.library import conditions, open_library
from tentacle.io.library.layers import library_code_version, write_layer
from tentacle.io.recording_rrd import write_rrd
from tentacle.recording import Declaration, Recording
from tentacle.signals import Midline
from tentacle.specimen import Cone, Specimen


def recording(name, length=0.14, date="2026-03-01"):
    """A short recording of an arm that hangs still."""
    t, s = np.arange(5) / 30.0, np.linspace(0.0, 1.0, 4)
    xy = np.repeat(np.stack([0.0 * s, length * s], axis=1)[None], len(t), axis=0)
    declared = Declaration(Specimen(Cone(0.0125, 0.005), length, 1070.0))
    return Recording(name, declared, midline=Midline(t, s, xy, np.full(xy.shape[:2], 1e-4)), notes={"date": date})


def add_layer(library, sha256, **values):
    """A verdict beside a recording, as a diagnosis leaves it."""
    code = library_code_version()
    layer = {"sha256": sha256, "code": code, "verdict": "effect", "effects": "current", "confidence": 0.9,
             "failed": None, "parameters": [{"effect": "elasticity", "parameter": "E", "value": 2e5, "low": 1.9e5,
                                             "high": 2.1e5, "unit": "Pa"}]}  # fmt: skip
    write_layer({**layer, **values}, library.layer(sha256))


@pytest.fixture
def folder(tmp_path):
    source = tmp_path / "recordings"
    (source / "day_2").mkdir(parents=True)
    write_rrd(recording("first"), source / "a.rrd")
    write_rrd(recording("second", 0.2, "2026-02-01T12:00:00+00:00"), source / "day_2" / "b.rrd")
    return source


def test_the_index_says_what_the_files_declare(folder):
    library = open_library(folder)
    assert library.refresh() == 2
    rows = library.table().to_pylist()
    assert [row["name"] for row in rows] == ["second", "first"]  # by date
    assert [row["length_mm"] for row in rows] == pytest.approx([200.0, 140.0])
    assert rows[0]["specimen"] != rows[1]["specimen"]
    assert [row["state"] for row in rows] == ["new", "new"]
    assert rows[1]["seconds"] == pytest.approx(4 / 30)
    assert library.home == folder.with_name("recordings.library")


def test_only_what_changed_is_read_again_and_loses_its_verdict(folder):
    library = open_library(folder)
    library.refresh()
    before = {row["name"]: row["sha256"] for row in library.table().to_pylist()}
    for sha256 in before.values():
        add_layer(library, sha256)
    assert library.refresh() == 0
    assert set(library.table().column("state").to_pylist()) == {"done"}
    write_rrd(recording("first", date="2026-03-02"), folder / "a.rrd")
    assert library.refresh() == 1
    assert {row["name"]: row["state"] for row in library.table().to_pylist()} == {"first": "new", "second": "done"}
    write_rrd(recording("first", date="2026-03-03"), folder / "a.rrd")
    assert library.refresh(settled=3600.0) == 0  # a rig is still writing it
    assert library.refresh() == 2  # both are back
    (folder / "a.rrd").unlink()
    library.refresh()
    assert library.table().num_rows == 1


def test_a_recording_that_is_moved_keeps_its_verdict(folder):
    library = open_library(folder)
    library.refresh()
    for row in library.table().to_pylist():
        add_layer(library, row["sha256"])
    (folder / "a.rrd").rename(folder / "day_2" / "a.rrd")
    assert library.refresh() == 1
    assert set(library.table().column("state").to_pylist()) == {"done"}


def test_verdicts_of_other_settings_and_of_older_code_are_told_apart(folder):
    library = open_library(folder, settings={"seed": 0})
    library.refresh()
    first, second = (row["sha256"] for row in library.table().to_pylist())
    add_layer(library, first)
    add_layer(library, second, code="another")
    library.refresh()
    assert sorted(library.table().column("state").to_pylist()) == ["done", "older code"]
    assert open_library(folder).settings == {"seed": 0}  # remembered
    other = open_library(folder, settings={"seed": 1})
    other.refresh()
    assert set(other.table().column("state").to_pylist()) == {"new"}


def test_a_file_that_is_no_recording_is_a_row_with_its_fault(folder):
    (folder / "bad.rrd").write_bytes(b"nothing")
    write_rrd(recording("dated", date="yesterday"), folder / "dated.rrd")
    library = open_library(folder)
    library.refresh()
    faults = {row["name"]: row["fault"] for row in library.table().to_pylist() if row["state"] == "unreadable"}
    assert set(faults) == {"bad", "dated"}
    assert "ISO 8601" in faults["dated"]


def test_conditions_choose_rows(folder):
    library = open_library(folder)
    library.refresh()
    add_layer(library, library.table().to_pylist()[0]["sha256"])
    library.refresh()
    table = library.table()

    def names(*texts):
        return table.filter(conditions(texts, table.schema)).column("name").to_pylist()

    assert names("verdict=effect", "confidence>=0.9") == ["second"]
    assert names("effects~curr") == ["second"]
    assert names("date>2026-02-15") == ["first"]
    assert names("length_mm<150") == ["first"]
    for text, says in (("colour=red", "no column"), ("date>soon", "does not fit"), ("verdict", "no condition"),
                       ("confidence~1", "holds no text")):  # fmt: skip
        with pytest.raises(InputError, match=says):
            conditions([text], table.schema)


@pytest.mark.usefixtures("folder")
def test_a_list_names_its_files(tmp_path):
    (tmp_path / "some.txt").write_text("# one of them\nrecordings/a.rrd  # the first\n\n")
    library = open_library(tmp_path / "some.txt")
    library.refresh()
    assert library.table().column("name").to_pylist() == ["first"]
    (tmp_path / "some.txt").write_text("recordings/a.rrd\nrecordings/c.rrd\n")
    with pytest.raises(InputError, match=r"some.txt:2: .*no such file"):
        library.refresh()
    with pytest.raises(InputError, match="no such folder or list"):
        open_library(tmp_path / "nowhere")


def test_many_files_share_a_child_that_one_of_them_may_end(tmp_path, monkeypatch):
    monkeypatch.setattr("tentacle.io.library.index.FEW", 1)
    for k in range(3):
        write_rrd(recording(f"run {k}"), tmp_path / f"{k}.rrd")
    whole = (tmp_path / "1.rrd").read_bytes()
    (tmp_path / "1.rrd").write_bytes(whole[:60] + bytes(200) + whole[260:])
    library = open_library(tmp_path)
    assert library.refresh() == 3
    states = {Path(row["path"]).stem: row["state"] for row in library.table().to_pylist()}
    assert states["0"] == states["2"] == "new"
    assert states["1"] == "unreadable"
