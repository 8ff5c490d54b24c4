"""Sentences of `optimise`'s report: the free swim, the posterior's interval, the servo's limits, the search."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from affine_model.swim import GaitTrial, Swimming


def posterior_words(tables: dict[str, Any]) -> tuple[str, ...]:
    """The objective's interval over the model's posterior."""
    if "posterior" not in tables:
        return ()
    drawn = tables["posterior"]
    within = f"{drawn['low']:.4g} to {drawn['high']:.4g} {drawn['unit']}"
    return (f"In 95 % of draws from {drawn['drawn_from']} it gives {within}; the model's own error comes on top.",)


def free_words(tables: dict[str, Any]) -> tuple[str, ...]:
    """What the free hull does, by the model and by the reference."""
    promise, sine, reference = tables["promise"], tables["sine"]["promise"], tables.get("reference", {})
    if "free_speed_m_s" not in promise:
        return ()
    checked = f" MuJoCo: {100 * reference['free_speed_m_s']:.2f} cm/s." if "free_speed_m_s" in reference else ""
    return (
        f"With a free hull the gait swims {100 * promise['free_speed_m_s']:.2f} cm/s, the best sine "
        f"{100 * sine['free_speed_m_s']:.2f} cm/s.{checked} It turns by {promise['yaw_drift_rad_s']:.4f} rad/s and "
        f"takes {1e3 * promise['free_power_w']:.1f} mW.",
    )


def limits_words(trial: GaitTrial, found: Swimming) -> tuple[str, ...]:
    """How near the gait comes to the servo's limits, and its nine numbers."""
    servo = trial.limits.servo
    angle, speed, acceleration = found.peaks.tolist()
    return (
        f"It turns by at most {angle:.3f} of {servo.angle:.3f} rad, {speed:.2f} of {servo.speed:.2f} rad/s and "
        f"{acceleration:.0f} of {servo.acceleration:.0f} rad/s2, over 300 s; harmonics end at "
        f"{trial.limits.bandwidth:g} Hz.",
        "alpha = " + ", ".join(f"{value:.4g}" for value in found.gait.alpha),
    )


def search_words(found: Swimming) -> tuple[str, ...]:
    """How the gait was found."""
    return (
        "First grids of sines and of single waves (one term of eq. 20 with its phase), refined around their best; then "
        f"{found.evaluations[-1]} gaits by {found.method}, seed {found.seed}. A quasi-Newton method starts at the best "
        "wave, and at the search's best when it exceeds all earlier results.",
        f"The winner was chosen with a third of the step. Start of its climb: {found.origin}.",
        *([] if found.polished is None else [f"The climb with the exact gradient: {found.polished.message}"]),
    )
