"""The paper's figures show what they say: the folded period, the mean square error, one colour scale for all maps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tentacle.errors import InputError
from tentacle.waveform import Chirp
from viz.figures.extremes import extremes_figure, mean_square_error
from viz.figures.period import average_over_period, fundamental_period, period_figure
from viz.figures.pipeline import PaperStill, pipeline_figure
from viz.figures.regression import regression_figure
from viz.figures.speeds import Swim, speeds_figure
from viz.figures.style import save, svg
from viz.figures.thrust_map import ThrustMap, thrust_map_figure
from viz.midline import affine_projection, midline_points
from viz.palette import MEASURED
from viz.scene import scene_of


def test_the_period_of_the_papers_sine_is_found():
    t = np.arange(0, 39, 1 / 30)
    # 24 cycles in 39 s; the finest step of the search is 5e-4 of a bin, and a bin is 1/24 of the frequency
    assert fundamental_period(t, 0.6 * np.sin(2 * np.pi * t * 24 / 39 + 0.3)) == pytest.approx(39 / 24, rel=3e-5)
    assert fundamental_period(t, 0.6 * np.sin(2 * np.pi * t * 0.633)) == pytest.approx(1 / 0.633, rel=3e-5)
    with pytest.raises(InputError, match="no period"):
        fundamental_period(t, np.zeros_like(t))
    with pytest.raises(InputError, match="does not repeat"):
        fundamental_period(t, Chirp(0.5, 0.3, 2.0, 39.0)(t)[0])


def test_folding_gives_the_mean_and_the_deviation_over_cycles():
    rng = np.random.default_rng(3)
    t = np.arange(0, 400, 0.0103)  # no divisor of the period: the samples of a bin lie evenly in it
    q = np.stack([np.sin(2 * np.pi * t / 2.0), np.cos(2 * np.pi * t / 2.0)], -1) + 0.1 * rng.standard_normal(
        (len(t), 2)
    )
    q[500:520] = np.nan
    phase, mean, deviation = average_over_period(t, q, 2.0)
    # 800 samples a bin: 0.1 / sqrt(800) = 0.0035; a bin 1/50 wide is averaged, which bends the sine by (pi/50)^2 / 6
    np.testing.assert_allclose(mean[:, 0], np.sin(2 * np.pi * phase), atol=0.016)
    # within a bin the sine itself spreads by up to 2 pi / 50 / sqrt(12) = 0.036
    assert np.all((deviation > 0.09) & (deviation < 0.12))


def test_an_arc_is_an_arc():
    s = np.linspace(0, 1, 11)
    drawn = midline_points(np.array([0.0]), np.array([[1.2, 0.0]]), 0.14, s)[0]
    exact = 0.14 / 1.2 * np.stack([np.cos(1.2 * s) - 1, np.sin(1.2 * s)], -1)
    np.testing.assert_allclose(drawn, exact, atol=1e-12)


def test_a_third_coordinate_aliases_as_measured():
    projection = affine_projection(3)
    np.testing.assert_allclose(projection[:, :2], np.eye(2), atol=1e-12)
    legendre = np.array([1.0, -6.0, 6.0])  # a third coordinate that curves as 1 - 6 s + 6 s^2
    np.testing.assert_allclose(projection @ legendre, [0.46, -1.50], atol=0.005)  # measured, to two digits


def test_the_error_is_table_ones_mean_square(case):
    run = case.diagnosis.runs[0]
    scene = scene_of(replace(run, q_base=run.q_measured + np.array([0.3, -0.2])))
    np.testing.assert_allclose(mean_square_error(scene), [0.09, 0.04])


def test_the_worst_stands_left_and_the_best_right(case):
    runs = case.diagnosis.runs
    scenes = [scene_of(runs[0]), scene_of(replace(runs[1], q_base=runs[1].q_measured + 0.01))]
    titles = [axes.get_title() for axes in extremes_figure(scenes).axes]
    assert titles[0].startswith("worst: chirp 1")
    assert titles[1].startswith("best: gait: trial/2\ne = [0.0001, 0.0001]")


def test_all_maps_share_one_colour_scale():
    amplitude, frequency = np.array([0.2, 0.4]), np.array([0.5, 1.0, 1.5])
    small = np.arange(6.0).reshape(2, 3) * 1e-3
    figure = thrust_map_figure(
        [ThrustMap("a", amplitude, frequency, small, small * 2), ThrustMap("b", amplitude, frequency, small)]
    )
    limits = {axes.collections[0].get_clim() for axes in figure.axes if axes.get_xlabel() == "frequency [Hz]"}
    assert limits == {(0.0, 10.0)}  # mN


def test_every_axis_of_every_figure_has_a_unit_and_every_format_is_written(case, tmp_path):
    scene = scene_of(case.diagnosis.runs[0])
    t, q = scene.t, scene.subject.q
    assert q is not None
    swims = [Swim("14 cm", "sine", np.array([0.01, 0.012])), Swim("14 cm", "optimised", np.array([0.03, 0.031]))]
    figures = {
        "period": period_figure(t, q, 1 / 0.6),
        "regression": regression_figure(t, q, q, scene),
        "speeds": speeds_figure(swims, {"sine": (t, scene.theta), "optimised": (t, 2 * scene.theta)}),
        "speeds alone": speeds_figure(swims, {}),
    }
    for name, figure in figures.items():
        labels = [axes.get_ylabel() for axes in figure.axes if axes.axison]
        assert all("[" in label and "]" in label for label in labels), (name, labels)
        for suffix in (".svg", ".pdf", ".png"):
            assert save(figure, tmp_path / f"figure{suffix}").stat().st_size > 1000
    picture = np.full((90, 160, 3), 200, np.uint8)
    steps = pipeline_figure(
        [PaperStill("frame", picture, [(MEASURED, np.array([[0, 0], [10, 40]]))]), PaperStill("mask", picture)]
    )
    assert [axes.get_title() for axes in steps.axes] == ["a) frame", "b) mask"]


def test_an_svg_for_a_page_has_the_pages_ink_and_its_own_ids(case):
    scene = scene_of(case.diagnosis.runs[0])
    assert scene.subject.q is not None
    element = svg(period_figure(scene.t, scene.subject.q, 1 / 0.6), "figure7")
    assert element.startswith("<svg ")
    assert "currentColor" in element
    assert "#010203" not in element
    assert 'id="figure7-figure_1"' in element
