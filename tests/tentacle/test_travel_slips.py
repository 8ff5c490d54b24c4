"""The pictures show how the clamp moves: a path of the base with a wrong sign or wrong axes is found beside them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tentacle.errors import InputError
from tentacle.recording import Recording
from tentacle.signals import BaseTravel
from tentacle.slips import find_slips, refuse_slips
from tentacle.travel_slips import seen_clamp
from tests.made_recordings import as_markers

PLACES = (0.15, 0.35, 0.55, 0.75, 1.0)


def path_at(t: np.ndarray) -> np.ndarray:
    """Where the base is (T, 2) [m]: 8 mm to and fro across, 3 mm along, at two frequencies."""
    return np.stack([0.008 * np.sin(2.0 * np.pi * 0.9 * t), 0.003 * np.sin(2.0 * np.pi * 1.7 * t + 1.0)], axis=-1)


@pytest.fixture(scope="module")
def carried(recorded) -> Recording:
    """An arm that a servo turns by +-20 degrees on a cart, seen from the ground at five markers."""
    seen = as_markers(recorded(seconds=4.0), PLACES)
    markers = seen.markers
    assert markers is not None
    moved = replace(markers, xy=markers.xy + path_at(markers.t)[:, None])
    t = np.arange(0.0, 4.01, 0.01)
    return replace(seen, markers=moved, travel=BaseTravel(t, path_at(t)))


def from_base(recording: Recording) -> Recording:
    """The same counted from the base, and declared so."""
    markers = recording.markers
    assert markers is not None
    counted = replace(markers, xy=markers.xy - path_at(markers.t)[:, None])
    return replace(recording, markers=counted, declaration=replace(recording.declaration, seen_from="base"))


def with_path(recording: Recording, change: np.ndarray) -> Recording:
    assert recording.travel is not None
    return replace(recording, travel=replace(recording.travel, xy=recording.travel.xy @ change.T))


def declared_from(recording: Recording, seen_from) -> Recording:
    return replace(recording, declaration=replace(recording.declaration, seen_from=seen_from))


def scaled(recording: Recording, factor: float) -> Recording:
    assert recording.markers is not None
    return replace(recording, markers=replace(recording.markers, xy=factor * recording.markers.xy))


def test_the_pictures_show_the_clamp_s_path(carried) -> None:
    shown = seen_clamp(carried)
    assert shown is not None
    t, clamp, _ = shown
    error = (clamp - clamp.mean(axis=0)) - (path_at(t) - path_at(t).mean(axis=0))
    assert np.sqrt(np.mean(error**2)) < 1e-3  # of 8 mm, beside an arm that bends by as much as the servo turns it


def test_a_path_that_the_pictures_show_has_no_slip(carried) -> None:
    assert find_slips(carried) == []
    assert find_slips(from_base(carried)) == []


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ([[-1.0, 0.0], [0.0, 1.0]], "with the sign of x_m reversed"),
        ([[-1.0, 0.0], [0.0, -1.0]], "with both signs reversed"),
        ([[0.0, 1.0], [1.0, 0.0]], "with x_m and y_m exchanged"),
    ],
    ids=["x", "both", "exchanged"],
)
def test_a_wrong_sign_and_exchanged_axes_of_the_path_are_refused(carried, change, told) -> None:
    with pytest.raises(InputError) as refused:
        refuse_slips(with_path(carried, np.array(change)))
    assert "base.csv: x_m, y_m: the clamp, as markers.csv shows it" in refused.value.line()
    assert f"{told}; expected" in refused.value.line()


def test_a_wrong_seen_from_is_advice(carried) -> None:
    """An arm that stays behind a fast base looks as one that is counted from it."""
    for wrong, right in (
        (declared_from(carried, "base"), "ground"),
        (declared_from(from_base(carried), "ground"), "base"),
    ):
        (slip,) = find_slips(wrong)
        assert (slip.field, slip.certain) == ("base.seen_from", False)
        assert slip.remedy.startswith(f'seen_from = "{right}"')


def test_the_tip_alone_shows_no_clamp(carried) -> None:
    """Where the clamp is not seen, nothing is said of its path."""
    markers = carried.markers
    tip = replace(markers, names=("tip",), s=markers.s[-1:], d=markers.d[-1:], xy=markers.xy[:, -1:])
    assert find_slips(with_path(replace(carried, markers=tip), -np.eye(2))) == []


@pytest.mark.parametrize(("factor", "named"), [(2.54, "2.54 times too large"), (0.1, "10 times too small")])
def test_markers_in_other_units_beside_a_travelling_base_are_the_markers_fault(carried, factor, named) -> None:
    """How far they are from each other does not depend on the base."""
    (slip,) = find_slips(scaled(carried, factor))
    assert (slip.file, slip.certain) == ("markers.csv", True)
    assert "apart; on the arm they are 35 mm apart" in slip.seen  # .25 of 140 mm
    assert named in slip.remedy
