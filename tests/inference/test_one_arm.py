"""Recordings of one arm with their own declared geometry: the material is shared, other arms are refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from inference.base_fit import Setting, fit_base
from inference.identify import identify
from inference.one_arm import one_arm, same_arm
from inference.prepare import prepare
from tentacle.declared import Uncertain, with_values
from tentacle.errors import InputError
from tentacle.recording import Declaration, Recording
from tentacle.specimen import AIR, WATER, Cone, Rectangle
from tests.made_recordings import SPECIMEN, TRUTH, Run, record_declared

LENGTH, ANGLE = "specimen.length_m", "gravity.angle_rad"


def second(**values: float) -> Recording:
    """A recording of the same silicone, clamped shorter and askew: as it was, and as it is declared."""
    declaration = with_values(Declaration(SPECIMEN, WATER), {LENGTH: 0.133, ANGLE: 0.1, **values})
    return replace(record_declared(declaration, {}, Run(seconds=6.0, seed=1)), name="second")


def declaring(recording: Recording, **changes) -> Recording:
    specimen = replace(recording.declaration.specimen, **changes)
    return replace(recording, name="other", declaration=replace(recording.declaration, specimen=specimen))


def test_two_lengths_and_clamps_show_one_material(recorded):
    """Each keeps its own length and clamp; declared alike, 7 mm of length would make E 15 % wrong."""
    found = identify([recorded(seconds=6.0), second()], order=2)
    # 1e-4 m of noise over 700 frames: deviations of .1 to 1 %
    assert found.model.parameters["elasticity"]["E"].value == pytest.approx(TRUTH["elasticity", "E"], rel=0.01)
    assert found.errors.midline_mm < 1.05 * 1e-1 * np.sqrt(2.0)  # the noise alone
    assert any(LENGTH in sentence and ANGLE in sentence for sentence in found.words)
    assert found.model.specimen.length == SPECIMEN.length  # the first recording's


def test_a_number_that_one_recording_alone_does_not_know_is_its_own(recorded):
    doubtful = second()
    number = Uncertain(LENGTH, 0.130, 0.004, 1e-6)
    declaration = replace(with_values(doubtful.declaration, {LENGTH: 0.130}), uncertain=(number,))
    prepared = [prepare(r, hold_out=False) for r in (recorded(seconds=6.0), replace(doubtful, declaration=declaration))]
    declared, both = one_arm(prepared)
    problem, fitted = fit_base(Setting(declared, tuple(p.experiment for p in both), 2), 2)
    place = fitted.free.index(("declared", f"{LENGTH} of second"))
    assert fitted.values[place] == pytest.approx(0.133, abs=4.0 * np.sqrt(fitted.covariance[place, place]))
    known, _ = problem.known(fitted.parameters)
    lengths = [experiment.arm(known.arm).specimen.length for experiment in known.experiments]
    assert lengths[0] == SPECIMEN.length
    assert lengths[1] == pytest.approx(0.133, abs=1e-4)


def test_a_number_that_all_state_alike_is_one_number(recorded):
    number = Uncertain(LENGTH, SPECIMEN.length, 0.002, 1e-6)
    stating = replace(recorded().declaration, uncertain=(number,))
    prepared = [prepare(replace(recorded(), declaration=stating, name=name), hold_out=False) for name in "ab"]
    declared, both = one_arm(prepared)
    assert declared.uncertain == (number,)
    assert all(p.experiment.differs == () for p in both)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"length": 0.25}, ("length_m", "0.25", "0.14")),
        ({"density": 1300.0}, ("density_kg_m3", "1300", "1070")),
        ({"section": Cone(0.016, 0.0064)}, ("base_radius_m, tip_radius_m", "32 mm", "25 mm", "0 mm from")),
        ({"section": Rectangle(0.02, 0.02)}, ("section", "rectangle", "cone")),
        ({"stiffness": "affine"}, ("stiffness", "affine", "section")),
    ],
)
def test_what_one_arm_cannot_be_is_refused_with_both_values(recorded, changes, told):
    with pytest.raises(InputError) as refused:
        same_arm([recorded(), declaring(recorded(), **changes)])
    assert all(word in str(refused.value) for word in told)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("section", "told"),
    [
        (Rectangle(0.02, 0.012), "specimen.height_m: is 0.012 here and 0.01 in"),  # 1.7 times as stiff
        (Rectangle(0.024, 0.01), "specimen.width_m: is 0.024 here and 0.02 in"),
    ],
)
def test_a_beam_s_thickness_is_compared_with_its_thickness_and_not_with_its_width(recorded, section, told):
    beam = declaring(recorded(), section=Rectangle(0.02, 0.01))
    same_arm([beam, declaring(beam, section=Rectangle(0.0215, 0.0107))])  # 7 %: callipers on soft silicone
    with pytest.raises(InputError) as refused:
        same_arm([beam, declaring(beam, section=section)])
    assert told in str(refused.value)


def test_one_arm_clamped_elsewhere_cut_loaded_or_in_air_is_accepted(recorded):
    """A cone clamped 20 mm further out has another base radius; one cut by 20 mm has another tip."""
    whole = recorded()
    further, cut = Cone(0.01143, 0.005), Cone(0.0125, 0.00607)  # 7.5 mm of radius over 140 mm
    loaded = declaring(whole, tip_mass=0.01, tip_mass_reach=0.005)
    dry = replace(whole, declaration=replace(whole.declaration, fluid=AIR))
    same_arm([whole, declaring(whole, length=0.12, section=further), declaring(whole, length=0.12, section=cut)])
    same_arm([whole, loaded, dry])
