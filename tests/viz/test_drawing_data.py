"""What is computed before anything is drawn: spectra, tubes, residual maps, colours, numbers as texts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tentacle.model import Estimate
from tentacle.rounding import number
from tentacle.specimen import Cone, Specimen
from viz.heat import GAP, HEAT_COLUMNS, colour_limit, heat_map
from viz.palette import AUGMENTED, BASE, MEASURED, WARNING
from viz.scene import scene_of
from viz.spectrum import amplitude_spectrum
from viz.tube import tube


def test_a_sine_reads_its_amplitude_at_its_frequency():
    t = np.arange(0, 20, 0.01)
    frequency, amplitude = amplitude_spectrum(t, 3.0 + 0.7 * np.sin(2 * np.pi * 1.5 * t))
    peak = int(np.argmax(amplitude))
    assert frequency[peak] == pytest.approx(1.5, abs=1e-9)  # 1.5 Hz x 20 s = 30 whole periods: on a bin
    assert amplitude[peak] == pytest.approx(0.7, rel=1e-3)  # numpy's symmetric Hann over N points: 1/N


def test_a_gap_is_bridged_and_a_short_signal_has_no_spectrum():
    t = np.arange(0, 20, 0.01)
    wave = np.sin(2 * np.pi * 0.5 * t)
    wave[300:310] = np.nan
    frequency, amplitude = amplitude_spectrum(t, wave)
    assert frequency[np.argmax(amplitude)] == pytest.approx(0.5)
    assert amplitude.max() == pytest.approx(1.0, rel=5e-3)  # 0.1 s of 2 s periods, bridged by a chord
    assert all(len(part) == 0 for part in amplitude_spectrum(t[:5], wave[:5]))


def test_a_tube_has_the_sections_radius_and_the_midlines_length():
    arm = Specimen(Cone(0.0125, 0.001), 0.14, 1070.0)
    s = np.linspace(0, 1, 25)
    straight = np.stack([np.zeros(25), 0.14 * s], -1)[None]
    drawn = tube(straight, s, arm)
    assert drawn.lengths.tolist() == [24]
    lengths = np.linalg.norm(drawn.ends[:, 1] - drawn.ends[:, 0], axis=1)
    assert lengths.sum() == pytest.approx(0.14, rel=1e-6)  # float32
    middles = (np.arange(24) + 0.5) / 24
    np.testing.assert_allclose(drawn.radius, 0.0125 - 0.0115 * middles, rtol=1e-6)
    # volume of the pieces = volume of the cone but for the frustum's second-order term h^2 (r')^2 / 12 a piece
    volume = np.sum(np.pi * drawn.radius**2 * lengths)
    cone = np.pi * 0.14 / 3 * (0.0125**2 + 0.0125 * 0.001 + 0.001**2)
    assert volume == pytest.approx(cone, rel=1e-3)


def test_the_residual_map_puts_time_and_arc_length_where_it_says(case):
    run = case.diagnosis.runs[0]
    base = run.measured.copy()
    instant, point = 100, 40  # only here does the model miss, by 5 mm
    base[instant, point] += [0.003, 0.004]
    scene = scene_of(replace(run, base=base))
    assert scene.residual_mm(scene.models[0])[instant, point] == pytest.approx(5.0)
    drawn = heat_map(scene, scene.models[0], limit=5.0)
    bright = np.argwhere(drawn.picture[..., 0].astype(int) - drawn.picture[..., 2] > 100)
    assert bright[:, 0].min() == 40 * 8  # 41 bands of 320/41 = 8 rows, and the tip's is the last
    assert abs(bright[:, 1].mean() - drawn.column(run.t[instant])) < 2  # one sample is 600/180 columns wide
    gap = np.flatnonzero((drawn.picture == GAP).all(axis=(0, 2)))
    assert abs(gap.mean() - drawn.column(run.t[20:24].mean())) < 2
    assert drawn.picture.shape[1] == HEAT_COLUMNS


def test_both_maps_share_the_base_models_limit(case):
    scene = scene_of(case.diagnosis.runs[0])
    values = scene.residual_mm(scene.models[0])
    share = np.mean(values[np.isfinite(values)] > colour_limit(scene))
    assert share == pytest.approx(0.01, abs=0.002)


# Machado, Oliveira, Fernandes 2009, severity 1: linear RGB as protanopes, deuteranopes and tritanopes see it
DEFICIENCIES = {
    "protan": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deutan": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "tritan": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}


def lab(linear: np.ndarray) -> np.ndarray:
    xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]) @ linear
    f = np.cbrt(xyz / [0.9505, 1.0, 1.089])
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("deficiency", DEFICIENCIES)
def test_parties_are_told_apart_by_colour_blind_readers(deficiency):
    seen = []
    for role in (MEASURED, BASE, AUGMENTED, WARNING):
        linear = (np.array(role.colour) / 255) ** 2.2
        seen.append(lab(np.clip(np.array(DEFICIENCIES[deficiency]) @ linear, 1e-4, 1)))
    distances = [np.linalg.norm(a - b) for k, a in enumerate(seen) for b in seen[:k]]
    assert min(distances) > 15  # CIE 1976: 2.3 is just noticeable; 15 is plainly another colour


def test_numbers_as_texts():
    values = (None, float("nan"), 0.0, 0.05234, 1234.6, 281_444.0, 2.5e8, 1e-5)
    assert [number(v) for v in values] == ["-", "-", "0", "0.0523", "1230", "281000", "2.50e+08", "1.00e-05"]
    assert Estimate.exact(2.0, "Pa").interval_words == "given"
    assert Estimate(2.0, 1.5, 2.5).interval_words == "1.5 to 2.5"
