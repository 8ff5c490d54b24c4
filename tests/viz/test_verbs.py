"""tentacle view and tentacle figure, as a user calls them: what they draw, and the one line that bad input gets."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from affine_model.arm import Arm, neutral_parameters, parameter_index
from affine_model.curvature import midline
from affine_model.run_forces import rest_load
from affine_model.simulate import Timing, simulate
from inference.measured_coordinates import beside_model, coordinates, regression_sides
from tentacle.cli import main
from tentacle.cli.pages.paper_figures import thrust
from tentacle.io.model_file import write_model
from tentacle.io.write_folder import write_folder
from tentacle.model import Estimate, Model
from tentacle.recording import Camera, Declaration, Recording
from tentacle.signals import LoadCellSignal, Midline, MotorSignal, Video
from tentacle.specimen import WATER, Cone, Gravity, Specimen
from tentacle.waveform import Sine
from vision.paper_pipeline import paper_steps
from viz.midline import perimeter

ARM = Specimen(Cone(0.0125, 0.003), 0.14, 1070.0)
VALUES = {"elasticity": ("E", 2e5, "Pa"), "damping": ("eta", 2e3, "Pa s"), "drag": ("C_perp", 1.1, "1")}
MODEL = Model(ARM, WATER, parameters={e: {n: Estimate.exact(v, u)} for e, (n, v, u) in VALUES.items()})
PERIOD = 1.25


@pytest.fixture(scope="module")
def swing() -> Recording:
    """Six periods of a sine, the model's own motion seen with 0.02 mm of noise; t in [0, 7.5] s."""
    parameters = neutral_parameters()
    for effect, (name, value, _) in VALUES.items():
        parameters[parameter_index(effect, name)] = value
    wave, step, count = Sine(0.4, 1 / PERIOD), 1 / 400, 3000
    base = wave((np.arange(count) + 0.5) * step)[:, :, None]
    moved = simulate(Arm(ARM, WATER, Gravity()), parameters[:, None], base, Timing(step, 10))
    s = np.linspace(0.0, 1.0, 21)
    xy = midline(moved.q[:, :, 0], moved.theta[:, 0], ARM.length, s)
    xy += 2e-5 * np.random.default_rng(0).standard_normal(xy.shape)
    t = np.arange(-0.5, 8.5, 0.01)
    return Recording(
        "swing", Declaration(ARM, WATER), motor=MotorSignal(t, wave(t)[0], wave(t)[0]),
        load_cell=LoadCellSignal(moved.force_t, moved.load[:, 0] - rest_load(MODEL)),  # tared, as cells are
        midline=Midline(moved.t, s, xy, np.full(xy.shape[:2], 2e-5)),
    )  # fmt: skip


@pytest.fixture(scope="module")
def folder(swing, tmp_path_factory) -> Path:
    place = tmp_path_factory.mktemp("verbs")
    write_folder(swing, place / "swing")
    write_model(MODEL, place / "model.toml")
    (place / "speeds.csv").write_text("arm,motion,speed_m_s\n14 cm,sine,0.0012\n14 cm,sine,0.0010\n14 cm,best,0.0066\n")
    return place


def test_an_arm_that_is_the_model_lies_on_it(swing):
    run = beside_model(swing, MODEL)
    distance = np.linalg.norm(run.augmented - run.measured, axis=-1)[run.judged]
    # noise of 0.02 mm in both directions, and 1/300 s steps of the fit against 1/400 s of the truth
    assert np.sqrt(np.mean(distance**2)) < 1e-4


def test_measured_coordinates_are_those_of_the_motion(swing):
    t, q = coordinates(swing)
    drawn = midline(q, np.interp(t, swing.motor.t, swing.motor.angle), ARM.length, swing.midline.s)
    # a few hundredths of a millimetre of noise, some of it taken up by the camera's pose
    assert np.sqrt(np.mean((drawn - swing.midline.xy) ** 2)) < 2e-4


def test_both_sides_of_the_regression_agree_at_the_true_parameters(swing):
    t, delta, prediction = regression_sides(swing, MODEL)
    inside = slice(10, -10)  # quartics over seven samples say little at the ends
    assert len(t) == len(delta)
    correlation = np.corrcoef(delta[inside, 0], prediction[inside, 0])[0, 1]
    assert correlation > 0.9  # twice differentiated noise stays in delta


def test_the_steps_of_figure_3_find_the_shape_that_was_filmed(tmp_path):
    """A picture of a known shape: the contour encloses the cone's area, the grid's best lies within a pixel or so."""
    q, camera = np.array([0.6, 0.8]), Camera(30.0, 0.0006, (160.0, 30.0), (0.0, 1.0))
    s = np.linspace(0.0, 1.0, 81)
    outline = camera.to_pixels(perimeter(midline(q[None], np.zeros(1), ARM.length, s)[0], s, ARM.section))
    picture = np.full((300, 320), 200, np.uint8)
    cv2.fillPoly(picture, [np.round(16 * outline).astype(np.int32)], 50, cv2.LINE_AA, 4)
    drawn, declaration = tmp_path / "drawn", Declaration(ARM, WATER, camera=camera)
    drawn.mkdir()
    for number in range(3):
        cv2.imwrite(str(drawn / f"{number:05d}.png"), picture)
    write_folder(Recording("swing", declaration, video=Video(drawn)), tmp_path / "swing")
    steps = paper_steps(drawn, declaration, None, 0.05)
    area = ARM.length * (0.0125 + 0.003) / camera.metres_per_px**2
    # fillPoly also fills the pixels that the outline touches: half a pixel all round
    assert cv2.contourArea(steps.contour.astype(np.float32)) == pytest.approx(area, rel=0.06)
    # the method's own weakness: the axis' ends lie on the contour's corners, so q1 and q2 trade; the shape is right
    truth = midline(q[None], np.zeros(1), ARM.length, np.linspace(0.0, 1.0, 41))[0]
    assert np.sqrt(np.mean(np.sum((steps.fitted - truth) ** 2, axis=1))) < 1.5 * camera.metres_per_px
    arguments = ["figure", "3", str(tmp_path / "swing"), "--at", "0.05", "--out", str(tmp_path / "steps.svg")]
    assert main(arguments) == 0
    assert "largest contour" in (tmp_path / "steps.svg").read_text()


@pytest.mark.parametrize("number", [4, 5, 8, 9, 10])
def test_a_figure_is_drawn(folder, number, tmp_path, capsys):
    inputs = {9: [], 10: [str(folder / "speeds.csv")]}.get(number, [str(folder / "swing")])
    model = ["--model", str(folder / "model.toml")] if number in (5, 8, 9) else []
    assert main(["figure", str(number), *inputs, *model, "--out", str(tmp_path / "figure.svg")]) == 0
    drawn = (tmp_path / "figure.svg").read_text()
    assert "<svg" in drawn
    expected = {
        4: "the period of 1.250 s",
        5: "delta and Y pi",
        8: "only: swing",
        9: "mean forward thrust [mN]",
        10: "swimming speed [cm/s]",
    }
    assert expected[number] in drawn
    assert capsys.readouterr().out.strip().endswith("figure.svg")


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["figure", "4", "swing", "--out", "figure.doc"], "--out: not a figure's name; expected .svg .pdf .png"),
        (["figure", "5", "swing", "--out", "figure.svg"], "--model: figure 5 needs a model"),
        (["figure", "4", "--out", "figure.svg"], "RECORDING: nothing to draw"),
        (["figure", "3", "swing", "--out", "figure.svg"], "swing: has no video"),
        (["figure", "4", "swing", "--at", "1", "--out", "figure.svg"], "--at: only figure 3 shows one frame"),
        (["figure", "6", "swing", "--out", "figure.svg"], "swing: has no tracked video"),
        (["figure", "10", "bad.csv", "--out", "figure.svg"], "bad.csv:3: speed_m_s: 'fast' is no number"),
        (["view", "absent.rrd"], "absent.rrd: no such file"),
        (["view", "speeds.csv"], "speeds.csv: is not a Rerun recording"),
        (["view", "absent.rrd", "--at", "3"], "--at: only a screenshot has an instant"),
        (["view", "absent.rrd", "--screenshot", "out.jpg"], "--screenshot: not a picture's name"),
    ],
)
def test_bad_input_is_one_line_and_nothing_is_written(arguments, line, folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    (folder / "bad.csv").write_text("arm,motion,speed_m_s\na,b,0.1\na,b,fast\n")
    before = sorted(folder.iterdir())
    assert main(arguments) == 2
    said = capsys.readouterr().err.strip()
    assert line in said
    assert "\n" not in said
    assert sorted(folder.iterdir()) == before


def test_measured_and_modelled_mean_thrust_agree_where_the_arm_is_the_model(swing):
    measured, modelled = (axes.collections[0].get_array() for axes in thrust([swing], MODEL).axes[:2])
    assert measured.shape == modelled.shape == (1, 1)
    # the load cell also reads inertia, which a mean over six periods from rest leaves a little of: 2 % here
    assert float(measured[0, 0]) == pytest.approx(float(modelled[0, 0]), rel=0.1)
    assert float(measured[0, 0]) > 0  # mN: it swims base first
