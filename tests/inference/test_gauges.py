"""Strain gauges: what they see of a shape, their readings at the frames, and what they add to a single marker."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from affine_model.curvature import legendre_to_monomial
from inference.appearance import Appearance
from inference.frame_readings import at_frames
from inference.identify import Identification, identify
from inference.marker_observation import MarkerObservation
from inference.prepare import prepare
from inference.sensed_observation import with_sensors
from inference.sensor import mean_curvature
from mujoco_ref.undeclared import Noise, Scenario, make_recording
from tentacle.errors import InputError
from tentacle.model import Estimate, Model
from tentacle.recording import Declaration, Recording
from tentacle.signals import Array, Markers, Midline, StrainGauge, StrainSignal
from tentacle.specimen import WATER
from tests.made_recordings import SPECIMEN, TRUTH, WAVE

LINKS, SPAN = 20, 0.15  # a gauge reaches from the middle of one link to that of another
NOISE = 2e-5  # of a strain
ZEROS = (0.004, -0.002)


def link_angle(seen: Midline, at: float) -> Array:
    """The angle (T,) of the chain's link with its middle there."""
    k = int(np.argmin(np.abs(seen.s - at)))
    along = seen.xy[:, k + 1] - seen.xy[:, k - 1]
    return np.unwrap(np.arctan2(-along[:, 0], along[:, 1]))


@pytest.fixture(scope="module")
def pair() -> tuple[Recording, Recording]:
    """A run of the MuJoCo chain in water as a marker at the tip shows it, and as two gauges show it too."""
    tables: dict[str, dict[str, Estimate]] = {}
    for (effect, name), value in TRUTH.items():
        tables.setdefault(effect, {})[name] = Estimate.exact(value)
    scene = Scenario(Model(SPECIMEN, WATER, parameters=tables), WAVE, 8.0, 200.0, s=np.linspace(0, 1, 41), links=LINKS)
    made, _ = make_recording({}, scene, 1, Noise(1e-4, 0.0, 0.0), clean_midline=True)
    seen, random = made.midline, np.random.default_rng(3)
    assert seen is not None
    gauges = (StrainGauge(0.1, 0.01, SPAN * SPECIMEN.length), StrainGauge(0.5, -0.008, SPAN * SPECIMEN.length))
    readings = []
    for gauge, zero in zip(gauges, ZEROS, strict=True):
        first, last = gauge.ends(SPECIMEN.length)
        bent = (link_angle(seen, last) - link_angle(seen, first)) / (SPAN * SPECIMEN.length)
        readings.append(gauge.d * bent + zero + NOISE * random.standard_normal(seen.t.size))
    strain = StrainSignal(seen.t, ("root", "middle"), gauges, np.stack(readings, axis=1))
    tip = seen.xy[::4, -1:] + 3e-4 * random.standard_normal((seen.t[::4].size, 1, 2))
    marked = replace(made, midline=None, markers=Markers(seen.t[::4], ("tip",), np.ones(1), np.zeros(1), tip))
    return marked, replace(marked, strain=strain)


@pytest.fixture(scope="module")
def identified(pair: tuple[Recording, Recording]) -> tuple[Identification, Identification]:
    """Both identified, with as many coordinates."""
    marked, gauged = pair
    return identify([marked], order=4), identify([gauged], order=4)


@pytest.mark.parametrize("ends", [(0.1, 0.3), (0.0, 1.0), (0.4, 0.4)])
def test_a_gauge_sees_the_mean_slope_of_the_angle(ends: tuple[float, float]) -> None:
    q = np.array([0.3, -0.7, 0.4, 0.2])
    angle = np.polynomial.Polynomial([0.0, *(q / np.arange(1, 5))])
    expected = angle.deriv()(ends[0]) if ends[0] == ends[1] else (angle(ends[1]) - angle(ends[0])) / (ends[1] - ends[0])
    assert mean_curvature(ends, q[None, :, None])[0, 0] == pytest.approx(expected, abs=1e-12)


def test_a_reading_outside_of_the_bend_is_positive() -> None:
    """Bent towards -x, the side at +x is stretched: d along the normal, which is +x at the clamp."""
    q = legendre_to_monomial(2) @ np.array([0.5, 0.0])
    bare = MarkerObservation(np.array([0.0, 1.0]), np.zeros(2), 0.1, np.ones(1), np.zeros(1), np.zeros((2, 1, 2)), 1e-4)
    for d, sign in ((0.01, 1.0), (-0.01, -1.0)):
        strain = StrainSignal(np.array([0.0, 1.0]), ("g",), (StrainGauge(0.5, d, sigma=1.0),), np.zeros((2, 1)))
        seen, _ = with_sensors(bare, Recording("bent", Declaration(SPECIMEN), strain=strain))
        rows = seen.predict(Appearance.as_declared(np.repeat(q[None, :, None], 2, axis=0), np.zeros((2, 1))))
        assert -rows[0, -1, 0] == pytest.approx(sign * 0.01 * q[0] / 0.1, rel=1e-9)  # constant curvature


def test_readings_at_the_frames_follow_a_parabola_exactly_and_state_their_noise() -> None:
    fine, frames = np.arange(0.0, 4.0, 1e-3), np.arange(0.1, 3.9, 0.02)
    curve = np.polynomial.Polynomial([0.3, -1.0, 2.0])
    found, share = at_frames(frames, fine, curve(fine))
    np.testing.assert_allclose(found, curve(frames), atol=1e-9)
    noisy, _ = at_frames(frames, fine, np.random.default_rng(1).standard_normal(fine.size))
    assert np.std(noisy) == pytest.approx(share, rel=0.2)  # 190 values: 5 % of a standard deviation, four times that


def test_where_readings_are_rare_only_the_frames_next_to_one_have_a_value() -> None:
    frames, rare = np.arange(0.0, 2.0, 0.02), np.arange(0.005, 2.0, 0.2)
    found, share = at_frames(frames, rare, np.sin(rare))
    assert share == 1.0
    there = frames[np.isfinite(found)]
    assert 8 <= there.size <= rare.size
    assert np.abs(there[:, None] - rare).min(axis=1).max() <= 0.01 + 1e-12


def test_the_stiffness_is_right_and_more_certain_with_gauges(
    identified: tuple[Identification, Identification],
) -> None:
    alone, gauged = (one.model.parameters["elasticity"]["E"] for one in identified)
    for one in (alone, gauged):
        assert one.value == pytest.approx(TRUTH["elasticity", "E"], rel=0.004)  # four coordinates against twenty links
    assert gauged.high - gauged.low < 0.3 * (alone.high - alone.low)


def test_the_zeros_are_found_and_change_nothing_else(
    pair: tuple[Recording, Recording], identified: tuple[Identification, Identification]
) -> None:
    strain = pair[1].strain
    assert strain is not None
    moved = replace(pair[1], strain=replace(strain, values=strain.values + np.array([0.01, -0.02])))
    again = identify([moved], order=4).model.parameters["elasticity"]["E"]
    before = identified[1].model.parameters["elasticity"]["E"]
    assert again.value == pytest.approx(before.value, abs=0.05 * (before.high - before.low))


def test_a_gauge_states_its_noise_or_has_it_found(pair: tuple[Recording, Recording]) -> None:
    prepared = prepare(pair[1], hold_out=False)
    said = [words for words in prepared.words if words.startswith("Gauge root")]
    assert len(said) == 1
    assert float(said[0].split("a strain of ")[1].split()[0]) == pytest.approx(NOISE, rel=0.1)  # 1600 readings: 4 %


def test_a_gauge_that_was_off_is_told(pair: tuple[Recording, Recording]) -> None:
    strain = pair[1].strain
    assert strain is not None
    silent = strain.values.copy()
    silent[:, 1] = np.nan
    with pytest.raises(InputError, match=r"strain\.middle: has no reading"):
        prepare(replace(pair[1], strain=replace(strain, values=silent)), hold_out=False)


def test_a_gauge_that_reads_nothing_for_a_while_or_zero_has_a_size_and_no_slow_error(
    pair: tuple[Recording, Recording],
) -> None:
    strain = pair[1].strain
    assert strain is not None
    values = np.stack([np.where(strain.t < 4.0, np.nan, strain.values[:, 0]), 0.0 * strain.t], axis=1)
    gauges = tuple(replace(one, sigma=NOISE) for one in strain.gauges)
    quiet = replace(pair[1], strain=replace(strain, values=values, gauges=gauges))
    early = prepare(quiet, hold_out=False).experiment.observation.first(100)  # 2 s
    np.testing.assert_array_equal(early.zero_size, [NOISE, NOISE])
    np.testing.assert_array_equal(early.sensor_errors(early.seen)[0], [0.0, 0.0])
    found = identify([quiet], order=4).model.parameters["elasticity"]["E"]
    assert np.isfinite([found.low, found.value, found.high]).all()


def test_few_readings_that_state_no_noise_are_refused(pair: tuple[Recording, Recording]) -> None:
    strain = pair[1].strain
    assert strain is not None
    few = replace(strain, t=strain.t[::200], values=strain.values[::200])
    with pytest.raises(InputError, match="too few readings to find its noise"):
        prepare(replace(pair[1], strain=few), hold_out=False)
