import json

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import curve_fit

from mujoco_ref.influence import KNOWN, UNCATALOGUED
from mujoco_ref.undeclared import Noise, Scenario, SealedPlan, make_recording
from mujoco_ref.undeclared.strength import SCALED_TOGETHER
from tentacle.errors import InputError
from tentacle.model import Estimate, Model
from tentacle.specimen import AIR, Gravity, Rectangle, Specimen
from tentacle.waveform import Chirp, Rest
from tests.mujoco_ref.arms import CONE, HORIZONTAL, model_of, swimming_model

CATALOGUE = [
    "added_mass", "skin_drag", "linear_drag", "current", "sloshing", "wall", "buoyancy",
    "gravity_tilt", "tip_mass", "cubic_stiffness", "intrinsic_curvature", "viscoelasticity", "dry_friction",
    "soft_spot", "stiffness_drift", "third_curvature", "servo_lag", "backlash", "time_offset", "camera_roll",
    "camera_scale",
]  # fmt: skip
QUIET = Noise(0.0, 0.0, 0.0)
WAVE = Chirp(0.5, 0.3, 2.2, 3.0)


def made(effects, seed=1, noise=QUIET, duration=3.0):
    return make_recording(effects, Scenario(swimming_model(), WAVE, duration, 30.0), seed, noise)


def test_every_catalogue_effect_can_be_hidden():
    assert set(CATALOGUE) | set(UNCATALOGUED) == set(SCALED_TOGETHER)
    assert set(SCALED_TOGETHER) <= set(KNOWN)
    assert len(UNCATALOGUED) >= 4


@pytest.mark.parametrize("effect", [effect for effect in SCALED_TOGETHER if effect != "third_curvature"])
def test_every_effect_moves_the_arm_and_only_when_it_is_there(effect):
    recording, truth = made({effect: 1.0})
    assert truth["moved_mm"] > 0.02
    assert set(truth["effects"]) == {effect}
    assert truth["verdict"] == ("unknown" if effect in UNCATALOGUED else "effect")
    json.dumps(truth)
    assert recording.midline is not None
    assert np.all(np.isfinite(recording.midline.xy))
    if effect not in ("clamp_slip", "mount_resonance"):  # there the smaller number is the stronger effect
        none = dict.fromkeys(truth["effects"][effect], 0.0) | (
            {"reach": 0.07} if effect == "suction" else {"tau": 0.3} if effect == "viscoelasticity" else {}
        )
        assert made({effect: none})[1]["moved_mm"] == 0.0


def test_the_declaration_does_not_mention_what_is_hidden():
    bare, _ = made({})
    hidden, _ = made({"tip_mass": 1.0, "gravity_tilt": 1.0})
    assert hidden.declaration == bare.declaration
    assert hidden.name == bare.name
    assert hidden.motor is not None
    assert bare.motor is not None
    np.testing.assert_array_equal(hidden.motor.angle, bare.motor.angle)


def test_same_seed_same_recording():
    one, other = (made({"current": "faint"}, seed=7, noise=Noise(), duration=1.0) for _ in range(2))
    assert one[1] == other[1]
    assert one[0].midline is not None
    assert other[0].midline is not None
    assert one[0].midline.xy.tobytes() == other[0].midline.xy.tobytes()
    assert made({"current": "faint"}, seed=8, noise=Noise(), duration=1.0)[1] != one[1]


@pytest.mark.parametrize(("size", "low", "high"), [("visible", 6.0, 15.0), ("faint", 0.7, 2.0)])
def test_sizes_are_what_they_say(size, low, high):
    _, truth = made({"added_mass": size}, noise=Noise(), duration=2.0)
    # Sized to 10 % (make), on the same duration.
    assert 0.85 * low < truth["moved_mm"] / truth["noise_mm"] < 1.15 * high


def test_effects_combine():
    together = made({"tip_mass": {"mass": 1e-3}, "camera_scale": {"excess": 0.02}})[0].midline
    alone = made({"tip_mass": {"mass": 1e-3}})[0].midline
    assert together is not None
    assert alone is not None
    np.testing.assert_allclose(together.xy, 1.02 * alone.xy, rtol=1e-12)


def test_time_offset_shows_the_arm_later():
    # 30 frames a second: an offset of two frames is a shift by two rows, but for the swelling in before the start.
    late = made({"time_offset": {"offset": 2 / 30}})[0].midline
    plain = made({})[0].midline
    assert late is not None
    assert plain is not None
    np.testing.assert_allclose(late.xy[:-2], plain.xy[2:], atol=2e-5)


def test_a_drifting_clock_shows_the_arm_later_and_later():
    # A rate that is off by 1/30: frame k shows what frame k (1 + 1/30) of a right clock shows.
    late = made({"time_offset": {"drift": 1 / 30}})[0].midline
    plain = made({})[0].midline
    assert late is not None
    assert plain is not None
    assert len(late.xy) == len(plain.xy)
    np.testing.assert_allclose(late.xy[30], plain.xy[31], atol=2e-5)
    np.testing.assert_allclose(late.xy[60], plain.xy[62], atol=2e-5)


def test_camera_roll_turns_the_picture_about_the_clamp():
    rolled = made({"camera_roll": {"roll": 0.1}})[0].midline
    plain = made({})[0].midline
    assert rolled is not None
    assert plain is not None
    z, w = (m.xy[..., 0] + 1j * m.xy[..., 1] for m in (rolled, plain))
    np.testing.assert_allclose(z, np.exp(0.1j) * w, atol=1e-15)


def test_noise_is_as_stated():
    recording, _ = made({}, noise=Noise(midline=2e-4))
    clean = made({})[0].midline
    assert recording.midline is not None
    assert clean is not None
    rest = recording.midline.xy - clean.xy
    assert np.std(rest) == pytest.approx(2e-4, rel=0.03)  # 7380 samples: 0.8 % standard error
    assert np.all(recording.midline.sigma == 2e-4)


def test_free_decay_with_a_hidden_payload():
    model = model_of(CONE, gravity=HORIZONTAL, damping={"eta": 300.0})
    recording, truth = make_recording(
        {"tip_mass": {"mass": 2e-3}}, Scenario(model, Rest(), 1.5, 60.0, initial_q=np.zeros(2), release_t=0.3), 3, QUIET
    )
    assert recording.motor is None
    assert recording.declaration.release_t == 0.3
    assert truth["moved_mm"] > 1.0
    assert recording.midline is not None
    assert np.ptp(recording.midline.xy[: int(0.3 * 60)], axis=0).max() == 0.0


def test_a_stiff_arm_s_decay_has_the_frequency_of_rayleigh_s_beam():
    """A silicone bar of 30 x 30 x 100 mm in air, let go under 1 % of gravity: it swings at 8.4 Hz about its small sag.

    By Ritz's method with x^2 .. x^9 (converged to all digits shown), rotary inertia counted.
    """
    modulus, bar = 3e5, Specimen(Rectangle(0.03, 0.03), 0.1, 1070.0)
    model = Model(
        bar, AIR, Gravity(-0.5 * np.pi, 0.0981), 2,
        {"elasticity": {"E": Estimate.exact(modulus, "Pa")}, "damping": {"eta": Estimate.exact(100.0, "Pa s")}},
    )  # fmt: skip
    recording, _ = make_recording(
        {}, Scenario(model, Rest(), 2.0, 400.0, initial_q=np.zeros(2), release_t=0.0), 0, QUIET, clean_midline=True
    )
    assert recording.midline is not None
    t, tip = recording.midline.t, recording.midline.xy[:, -1, 0]
    shapes = [np.polynomial.Polynomial([0.0] * k + [1.0]) for k in range(2, 10)]
    area, second_moment, length = 0.03**2, 0.03**4 / 12.0, 0.1

    def product(order: int) -> np.ndarray:
        return np.array([[(a.deriv(order) * b.deriv(order)).integ()(1.0) for a in shapes] for b in shapes])

    mass = 1070.0 * (area * length * product(0) + second_moment / length * product(1))
    squares = eigh(modulus * second_moment / length**3 * product(2), mass, eigvals_only=True)
    decay = 0.5 * 100.0 / modulus * squares[0]
    omega = np.sqrt(squares[0] - decay**2)

    def swing(t, sag, cosine, sine, omega, decay):
        return sag + np.exp(-decay * t) * (cosine * np.cos(omega * t) + sine * np.sin(omega * t))

    first = t > 0.3  # the second mode has died away
    start = (tip[-1], -tip[-1], 0.0, omega, decay)
    found = curve_fit(swing, t[first], tip[first], p0=start)[0]
    # Midpoint rule 6e-5, links 1.3e-4, the second mode's rest.
    assert found[3] == pytest.approx(omega, rel=3e-4)
    assert found[4] == pytest.approx(decay, rel=3e-3)


def test_trials_are_blind_reproducible_and_independent():
    plan = SealedPlan(swimming_model(), WAVE, 11, 1.0, 30.0)
    some, again = [plan.trial(k) for k in range(3)], [plan.trial(k) for k in (1, 0)][::-1]
    assert [t.recording.name for t in some] == ["trial_000", "trial_001", "trial_002"]
    for one, other in zip(some, again, strict=False):
        assert one.truth == other.truth
    for trial in some:
        assert not any(effect in str(trial.recording.notes) for effect in KNOWN)


def test_what_cannot_be_hidden_is_refused():
    for effects in ({"gremlins": 1.0}, {"current": "huge"}, {"current": {"U_z": 1.0}}):
        with pytest.raises(InputError):
            made(effects)
