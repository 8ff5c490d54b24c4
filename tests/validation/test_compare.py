import numpy as np
import pytest

from tentacle.io.model_file import model_tables
from tentacle.model import Estimate, Model
from tentacle.runner import Runner
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Ramped, Sine
from tests.cli.test_reports import made_up
from tests.page import problems
from validation import validity_map
from validation.ladder import affine_frequencies, run_ladder, theory_frequencies
from validation.model_pair import affine_twin, net_weight, reference_twin, shape_error
from validation.validity_advice import sentence, serves
from validation.validity_map import (
    AMPLITUDES,
    MAP_ORDERS,
    RATIOS,
    Validity,
    own_slenderness,
    own_taper,
    validity_cell,
    variants,
)


def swimmer() -> Model:
    model = Model(Specimen(Cone(0.0125, 0.00125), 0.14, 1070.0), WATER)
    model = model.with_effect("elasticity", E=Estimate.exact(2e5)).with_effect("damping", eta=Estimate.exact(300.0))
    return model.with_effect("drag", C_perp=Estimate.exact(1.1)).with_effect("added_mass", C_a=Estimate.exact(1.0))


def test_two_implementations_agree_where_they_should():
    # Neither shares an equation with the other. Six coordinates follow the arm to 10 micrometres of 70 mm.
    wave = Ramped(Sine(0.5, 1.3), 0.8)
    reference = reference_twin(swimmer(), wave, 3.0, 50.0, links=40)
    affine = affine_twin(swimmer(), 6, wave, 3.0, 50.0)
    assert shape_error(affine, reference, 2.0)[0] < 0.02
    # Raw q1, q2 of six coordinates are other quantities than the two nearest to a shape, in which both are told; a
    # cone's thin tip, whose angle the midline hardly shows, leaves 4 % of q2.
    assert np.abs(reference.q - affine.q).max() < 0.06 * np.abs(reference.q).max()
    window = 2 / 1.3
    # Both at 2 to 3 ms a step; the reduced model's load cell agrees to 1 % of the mean.
    assert affine.mean_load(window) == pytest.approx(reference.mean_load(window), abs=1e-4)


@pytest.mark.parametrize(
    ("effect", "numbers", "apart"),
    [("servo_lag", {"tau": 0.05}, 0.05), ("backlash", {"play": 0.03}, 0.2)],  # mm; the play's corners are rounded
)
def test_both_models_turn_behind_the_same_servo(effect, numbers, apart):
    wave = Ramped(Sine(0.5, 1.3), 0.4)
    model = swimmer().with_effect(effect, **{name: Estimate.exact(value) for name, value in numbers.items()})
    affine, reference = affine_twin(model, 6, wave, 1.5, 50.0), reference_twin(model, wave, 1.5, 50.0, links=40)
    assert shape_error(affine, reference, 1.0)[0] < apart


def test_an_arm_at_rest_weighs_what_it_should():
    still = reference_twin(swimmer(), Sine(0.0, 1.0), 0.5, 50.0)
    assert np.abs(still.load).max() < 1e-9
    arm = affine_twin(swimmer(), 2, Sine(0.0, 1.0), 0.5, 50.0)
    assert np.abs(arm.load).max() < 1e-6 + 1e-6 * net_weight(swimmer())


@pytest.fixture(scope="module")
def ladder():
    return run_ladder(swimmer(), 0.4)


def test_the_ladder_climbs(ladder):
    first = ladder.rungs[0]
    theory = theory_frequencies(swimmer())
    assert theory is not None
    assert first.theory == pytest.approx(theory[0])
    assert first.best == pytest.approx(theory[0], rel=5e-3)  # rotary inertia
    for rung in ladder.rungs:
        assert rung.spread < 0.2 * rung.error(2), rung.name  # the reference can judge
        assert rung.error(4) <= rung.error(2) + 1e-3, rung.name
    assert ladder.rungs[1].error(2) > 0.08  # the second mode, which two coordinates cannot follow


def test_affine_frequencies_are_those_of_the_rayleigh_ritz_targets():
    # Rayleigh-Ritz: taper .1, order 2: 7.2113 and 21.28 times sqrt(E I0 / rho A0 L^4).
    from dataclasses import replace

    from tentacle.specimen import AIR, Gravity

    thin = Specimen(Cone(0.00125, 0.000125), 0.14, 1070.0)
    model = replace(swimmer(), specimen=thin, fluid=AIR, gravity=Gravity(0.0, 0.0))
    rate = np.sqrt(2e5 * np.pi / 4 * 0.00125**4 / (1070 * np.pi * 0.00125**2 * 0.14**4)) / (2 * np.pi)
    np.testing.assert_allclose(affine_frequencies(model, 2) / rate, [7.2113, 21.28], rtol=1e-3)


def test_a_cell_of_the_map():
    found = validity_cell({"model": model_tables(swimmer()), "links": 20, "amplitude": 0.4, "frequency": 1.7})
    assert found["shape"][2] < found["shape"][0] < 0.02
    assert found["thrust_n"] < 0.0


def validity(shape: np.ndarray, thrust: np.ndarray | None = None) -> Validity:
    size = (len(MAP_ORDERS), len(AMPLITUDES), len(RATIOS))
    told = np.full(size, 0.001) if thrust is None else thrust
    return Validity(0.1, 11.0, 3.0, shape, told, np.ones(size[1:]), np.zeros(3))


def test_reach_ends_where_the_error_passes_the_level():
    shape = np.full((len(MAP_ORDERS), len(AMPLITUDES), len(RATIOS)), 0.001)
    shape[0, 0, 3:] = 0.2
    shape[0, 1, :] = 0.2
    found = validity(shape)
    assert found.reach(2, 0.01, 0) == RATIOS[2]
    assert found.reach(2, 0.01, 1) == 0.0
    assert found.reach(3, 0.01, 0) == RATIOS[-1]


def test_the_sentence_says_whether_the_affine_model_serves():
    shape = np.full((len(MAP_ORDERS), len(AMPLITUDES), len(RATIOS)), 0.001)
    shape[0, :, 4:] = 0.2
    assert serves(validity(shape))
    words = sentence(validity(shape))
    # The first mode is 3 Hz; two coordinates end at .8 of it, three go on.
    assert "serves for this arm" in words
    assert "within 5 % up to 2.4 Hz (0.8 of its first mode)" in words
    assert "With 3 coordinates the shape stays within 5 % up to 5.4 Hz" in words
    shape[0, 1] = 0.2
    assert not serves(validity(shape))
    assert "does not serve for this arm" in sentence(validity(shape))
    assert "not even at 0.15" in sentence(validity(shape))
    air = validity(shape, np.full_like(shape, np.nan))
    assert "thrust" not in sentence(air)


def test_variants_change_the_tip_or_the_radius_alone():
    own, blunt, slender = variants(swimmer(), (0.5, own_taper(swimmer())), (20.0,))
    assert own == swimmer()
    assert own_taper(blunt) == pytest.approx(0.5)
    assert own_slenderness(blunt) == pytest.approx(own_slenderness(own))
    assert own_slenderness(slender) == pytest.approx(20.0)
    assert own_taper(slender) == pytest.approx(own_taper(own))
    assert {model.specimen.length for model in (blunt, slender)} == {own.specimen.length}


def test_modulus_drops_out_of_the_map_over_the_first_mode():
    # In water, at a given amplitude, frequency over first mode and loss angle, E only sets the clock; gravity off.
    from dataclasses import replace

    from tentacle.specimen import Gravity

    cells = []
    for modulus in (1e5, 4e5):
        model = replace(swimmer(), gravity=Gravity(0.0, 0.0)).with_effect("elasticity", E=Estimate.exact(modulus))
        model = model.with_effect("damping", eta=Estimate.exact(300.0 * np.sqrt(modulus / 2e5)))
        first = 3.45 * np.sqrt(modulus / 2e5)
        cells.append(
            validity_cell({"model": model_tables(model), "links": 10, "amplitude": 0.4, "frequency": 0.8 * first})
        )
    # The steps of both models follow the frequency only roughly.
    np.testing.assert_allclose(cells[0]["shape"], cells[1]["shape"], rtol=0.05)


def test_flexibility_is_drag_over_stiffness():
    assert np.all(validity_map.flexibility(swimmer(), 3.0) > 0.0)
    np.testing.assert_allclose(
        validity_map.flexibility(swimmer(), 6.0), 4.0 * validity_map.flexibility(swimmer(), 3.0), rtol=1e-12
    )


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--amplitude", "0"), "above 0"),
        (("--tapers", "1.5"), "from 0 to 1"),
        (("--slenderness", "1"), "above 2"),
        (("--workers", "0"), "1 to 1024"),
        (("--cluster", "nonsense"), "no Dask scheduler answers"),
    ],
)
def test_bad_options_are_one_line_and_nothing_is_written(tmp_path, capsys, monkeypatch, options, words):
    from tentacle.cli import main
    from tentacle.io.model_file import write_model
    from validation import ladder as rungs

    monkeypatch.setattr(rungs, "run_ladder", lambda *_: None)  # seconds, and not what this is about
    write_model(swimmer(), tmp_path / "arm.toml")
    assert main(["compare", str(tmp_path / "arm.toml"), "--out", str(tmp_path / "out"), *options]) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.strip().count("\n") == 0
    assert not list(tmp_path.glob("out/*.*"))


def test_a_grid_of_arms_is_one_page_beside_theirs(tmp_path, capsys, monkeypatch, ladder):
    from tentacle.cli import main
    from tentacle.io.model_file import write_model
    from validation import ladder as rungs

    files = [tmp_path / "one.toml", tmp_path / "two.toml"]
    for file, modulus in zip(files, (2e5, 4e5), strict=True):
        write_model(swimmer().with_effect("elasticity", E=Estimate.exact(modulus)), file)
    monkeypatch.setattr(rungs, "run_ladder", lambda *_: ladder)
    monkeypatch.setattr(Runner, "run", made_up)  # a map takes minutes
    assert main(["compare", *map(str, files), "--out", str(tmp_path / "grid")]) == 0
    assert [line.split(",")[0] for line in (tmp_path / "grid" / "grid.csv").read_text().splitlines()] == [
        "arm", "one", "two"
    ]  # fmt: skip
    for name in ("report.html", "one/report.html", "one/session.rrd", "two/ladder.csv"):
        assert (tmp_path / "grid" / name).stat().st_size > 0
    for page in (tmp_path / "grid").rglob("report.html"):
        assert problems(page.read_text()) == []
    assert "order 4" in capsys.readouterr().out
