"""No example counts as a number of the arm; what was declared before is shown again, and what is by hand stays."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

pytest.importorskip("nicegui", reason="nicegui is not installed: pip install tentacle-twin[app]")

from tentacle.errors import InputError
from tentacle.io.recording_template import Answers, recording_text
from tentacle.recording import Camera
from tentacle.specimen import Cone
from viz.app.desk import Desk, Proposed
from viz.app.earlier import read_earlier
from viz.app.numbers import ASKED, required_numbers, typed_number

ANSWERS = Answers(
    0.16, Cone(0.011, 0.004), 1080.0, 998.0, Camera(30.0, 3.3333e-4, (492.0, 110.5), (0.0523360, 0.9986295))
)


def test_a_decimal_comma_is_one_and_an_empty_field_is_no_number() -> None:
    assert typed_number("length", " 0,16 ") == 0.16
    assert typed_number("length", "  ") is None
    assert typed_number("fluid_density", "0") == 0.0


@pytest.mark.parametrize("text", ["x", "0", "-1", "inf", "nan", "1e999"])
def test_a_number_that_no_arm_has_is_named(text: str) -> None:
    with pytest.raises(InputError, match=r"length of the arm \[m\]: .* expected a number, for example 0.14"):
        typed_number("length", text)


def test_all_that_is_missing_is_named_at_once() -> None:
    with pytest.raises(InputError) as refused:
        required_numbers({"length": "0.16", "density": ""}, [name for name in ASKED if name != "ruler"])
    assert refused.value.field is not None
    for name in ("base_radius", "tip_radius", "density", "fluid_density"):
        assert ASKED[name].words in refused.value.field
    assert ASKED["length"].words not in refused.value.field


def test_what_the_page_wrote_is_read_back_and_may_be_written_anew(tmp_path: Path) -> None:
    file = tmp_path / "recording.toml"
    file.write_text(recording_text(ANSWERS))
    earlier = read_earlier(file)
    assert not earlier.by_hand
    assert earlier.answers is not None
    numbers = [earlier.number(name) for name in ("length", "base_radius", "tip_radius", "density", "fluid_density")]
    assert numbers == [0.16, 0.011, 0.004, 1080.0, 998.0]
    camera = earlier.marks().camera(30.0)
    # five digits of the scale and a tenth of a pixel stand in the file
    assert camera.metres_per_px == pytest.approx(3.3333e-4, rel=1e-4)
    assert camera.base_px == (492.0, 110.5)
    assert camera.arm_px == pytest.approx(ANSWERS.camera.arm_px, abs=1e-5)  # type: ignore[union-attr]


@pytest.mark.parametrize(
    "added", ["[gravity]\nangle_rad = 3.1416\n", "tip_mass_kg = 0.005\n", "# a note of one's own\n"]
)
def test_what_somebody_added_by_hand_is_seen(tmp_path: Path, added: str) -> None:
    text = recording_text(ANSWERS)
    changed = {
        "[": text.replace("[gravity]\nangle_rad = 0.0", added),
        "t": text.replace("# tip_mass_kg", f"{added}# tip_mass_kg"),
        "#": text + added,
    }[added[0]]
    assert changed != text
    (tmp_path / "recording.toml").write_text(changed)
    assert read_earlier(tmp_path / "recording.toml").by_hand


def test_what_a_verb_would_refuse_is_not_written(tmp_path: Path) -> None:
    desk = Desk(tmp_path, _nothing)
    desk.declare("arm", ANSWERS)
    before = (tmp_path / "arm" / "recording.toml").read_bytes()
    with pytest.raises(InputError, match=r"length_m: 160\.0 is out of range"):  # millimetres by mistake
        desk.declare("arm", replace(ANSWERS, length=160.0))
    assert (tmp_path / "arm" / "recording.toml").read_bytes() == before


def _nothing(film: Path) -> Proposed:
    raise InputError("no arm", file=film)


def test_a_file_that_cannot_be_read_is_left_to_its_author(tmp_path: Path) -> None:
    (tmp_path / "recording.toml").write_text("[specimen\n")
    assert read_earlier(tmp_path / "recording.toml").by_hand


def test_an_arm_that_the_page_does_not_ask_for_is_left_to_its_author(tmp_path: Path) -> None:
    (tmp_path / "recording.toml").write_text(recording_text(replace(ANSWERS, camera=None)))
    earlier = read_earlier(tmp_path / "recording.toml")
    assert earlier.by_hand
    assert earlier.answers is None
    assert earlier.marks().points == {}
