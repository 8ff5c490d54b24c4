"""The missing force over one coordinate of the motion: on what it depends.

    Q_j(t) = l_j(s, t) f(t) + rest,        l_j = (dr/dz_j . n)(s)
    f(t) = g(x(t)) + rest,        predicted = 1 - var(rest) / var(f),        on stretches that g was not drawn from

Q: the missing generalised force; s: the place at which one normal force f explains most of it; x: a coordinate of that
place; g: means in bins of equal count. predicted is a cross-validated correlation ratio: it is near 0 where f does not
depend on x, however curved the dependence may be. One x is the phase at the frequency that is strongest in f. It is
left out where the base turns with that phase too: every force then repeats with the base.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import hilbert

from affine_model.arm import Arm
from affine_model.curvature import Array, curvature_basis
from discovery.laws.along import shown_instants
from inference.missing_force import SeenMotion
from tentacle.proposed_law import ForceOver

PLACES = np.linspace(0.1, 1.0, 19)  # of s
BINS, FOLDS, STRETCH = 16, 5, 1.0  # bins of a curve, folds of the cross-validation, s of a stretch
DEPENDS = 0.3  # predicted share of the variance, below which no single coordinate stands out
TURNS = 0.1  # of the base's own variance, from which a frequency is the base's
FEWEST_PERIODS, PADDED = 3.0, 16  # of a period that is looked for, in the recording; of the transform
HIGHEST = 20.0  # Hz


@dataclass(frozen=True)
class Place:
    """A place on the arm along a motion of T instants: position, velocity and acceleration (T, 2) in SI units, angle
    and curvature (T,) [rad], and the arm's normal and tangent there (T, 2).
    """

    position: Array
    velocity: Array
    acceleration: Array
    angle: Array
    curvature: Array
    normal: Array
    tangent: Array


def over_coordinates(name: str, arm: Arm, motion: SeenMotion) -> tuple[ForceOver, ...]:
    """The force of a recording over each coordinate of the place where it acts, the one that predicts most first."""
    keep = shown_instants(motion)
    s, explained, force = acting_place(arm, motion, keep)
    place, t = place_along(arm, motion, s, keep), motion.t[keep]
    turning = motion.u[:, arm.order] - motion.u[:, arm.order].mean()
    coordinates = {
        ("x", "m"): place.position[:, 0],
        ("y, the depth below the clamp", "m"): place.position[:, 1],
        ("angle", "rad"): place.angle,
        ("curvature", "1/m"): place.curvature / arm.specimen.length,
        ("normal velocity", "m/s"): np.sum(place.velocity * place.normal, axis=1),
        ("tangential velocity", "m/s"): np.sum(place.velocity * place.tangent, axis=1),
        ("normal acceleration", "m/s^2"): np.sum(place.acceleration * place.normal, axis=1),
        ("time", "s"): t,
        ("phase of the base", "rad"): np.angle(np.asarray(hilbert(turning), dtype=np.complex128))[keep],
    }
    found = [
        ForceOver(name, s, explained, coordinate, unit, *curve(values, force), predicted(t, values, force))
        for (coordinate, unit), values in coordinates.items()
    ]
    frequency = strongest_frequency(t, force)
    phase = 2.0 * np.pi * np.mod(frequency * t, 1.0)
    if predicted(t, phase, turning[keep]) < TURNS:
        bins, share = curve(phase, force), predicted(t, phase, force)
        found.append(ForceOver(name, s, explained, f"phase at {frequency:.3g} Hz", "rad", *bins, share, frequency))
    return tuple(sorted(found, key=lambda one: -one.predicted))


def acting_place(arm: Arm, motion: SeenMotion, keep: NDArray[np.intp]) -> tuple[float, float, Array]:
    """The place s at which one normal force explains most of the missing generalised force, the share that it explains
    (of its square over its variance), and the force (T,) [N] there.
    """
    whole, left, forces = one_force(arm, motion, keep)
    best = int(np.argmin(left))
    return float(PLACES[best]), 1.0 - float(left[best]) / max(whole, 1e-300), forces[best]


def one_force(arm: Arm, motion: SeenMotion, keep: NDArray[np.intp]) -> tuple[float, Array, Array]:
    """The square of the missing generalised force over its variance, what of it one normal force at each of PLACES
    leaves (P,), and these forces (P, T) [N].
    """
    weight = 1.0 / np.maximum(motion.spread[keep], 1e-12 * np.abs(motion.force).max())
    u, asked = motion.u[keep], motion.force[keep] * weight
    left, forces = np.zeros(PLACES.size), np.zeros((PLACES.size, keep.size))
    for place, s in enumerate(PLACES):
        levers = _levers(arm, u, s) * weight
        forces[place] = np.sum(levers * asked, axis=1) / np.maximum(np.sum(levers**2, axis=1), 1e-300)
        left[place] = np.sum((asked - levers * forces[place][:, None]) ** 2)
    return float(np.sum(asked**2)), left, forces


def _levers(arm: Arm, u: Array, s: float) -> Array:
    """(dr/dz_j . n)(s), the generalised forces (T, n) [m] of a unit normal force."""
    n, rule = arm.order, arm.rule
    basis = arm.angles_at(s * rule.s)
    phi = u[:, n : n + 1] + u[:, :n] @ basis.T
    end = u[:, n] + u[:, :n] @ arm.angles_at([s])[0]
    return arm.specimen.length * s * (np.cos(phi - end[:, None]) * -rule.weights) @ basis


def place_along(arm: Arm, motion: SeenMotion, s: float, keep: NDArray[np.intp]) -> Place:
    """The motion of the place s at the chosen instants, in the frame in which the clamp starts."""
    n, L, rule = arm.order, arm.specimen.length, arm.rule
    basis = np.concatenate([arm.angles_at(s * rule.s), np.ones((rule.s.size, 1))], axis=1)
    u, rate, acceleration = (rows[keep] for rows in (motion.u, motion.rate, motion.acceleration))
    phi, phi_rate, phi_acceleration = (rows[:, : n + 1] @ basis.T for rows in (u, rate, acceleration))
    normal, tangent = np.stack([np.cos(phi), np.sin(phi)], -1), np.stack([-np.sin(phi), np.cos(phi)], -1)
    rail = np.array([0.0, 1.0])

    def reached(values: Array, travel: Array) -> Array:
        return L * s * np.einsum("i,tix->tx", rule.weights, values) + travel[:, n + 1 :] * rail

    end = u[:, : n + 1] @ np.append(arm.angles_at([s])[0], 1.0)
    turning = -normal * phi_acceleration[:, :, None] - tangent * phi_rate[:, :, None] ** 2
    return Place(
        reached(tangent, u), reached(-normal * phi_rate[:, :, None], rate), reached(turning, acceleration), end,
        u[:, :n] @ curvature_basis(n, [s])[0], np.stack([np.cos(end), np.sin(end)], -1),
        np.stack([-np.sin(end), np.cos(end)], -1),
    )  # fmt: skip


def curve(x: Array, force: Array) -> tuple[Array, Array, Array]:
    """Mean coordinate, mean force and standard deviation of the force (B,) in bins of equal count."""
    parts = np.array_split(np.argsort(x, kind="stable"), BINS)
    rows = [(x[part].mean(), force[part].mean(), force[part].std()) for part in parts]
    middle, mean, deviation = np.array(rows).T
    return middle, mean, deviation


def predicted(t: Array, x: Array, force: Array) -> float:
    """The share of the force's variance that a curve over x predicts on stretches it was not drawn from, 0 .. 1."""
    fold = ((t - t[0]) / STRETCH).astype(int) % FOLDS
    if np.bincount(fold).max() > t.size - BINS:  # too short for such stretches: the others would not fill a curve
        fold = np.arange(t.size) * FOLDS // t.size
    left = 0.0
    for k in range(FOLDS):
        middle, mean, _ = curve(x[fold != k], force[fold != k])
        left += float(np.sum((force[fold == k] - np.interp(x[fold == k], middle, mean)) ** 2))
    return max(0.0, 1.0 - left / max(float(np.sum((force - force.mean()) ** 2)), 1e-300))


def strongest_frequency(t: Array, force: Array) -> float:
    """The frequency [Hz] of the largest part of a force (T,) that repeats FEWEST_PERIODS times or more, at the times t
    (T,) [s].
    """
    even = np.linspace(t[0], t[-1], t.size)
    values = np.interp(even, t, force - force.mean())
    frequencies = np.fft.rfftfreq(PADDED * t.size, even[1] - even[0])
    power = np.abs(np.fft.rfft(values, PADDED * t.size)) ** 2
    sought = (frequencies >= FEWEST_PERIODS / (t[-1] - t[0])) & (frequencies <= HIGHEST)
    return float(frequencies[sought][np.argmax(power[sought])])


def over_words(found: tuple[ForceOver, ...]) -> str:
    """Sentences about where the force acts and the coordinate that it follows, with the evidence of both."""
    best, second = found[:2]
    acts = f"One normal force at {best.place} explains {share_words(best.explained)} of the missing force."
    if best.predicted < DEPENDS:
        return f"{acts} It follows no single coordinate."
    share = f"{share_words(best.predicted)} of its variance on stretches that the curve was not drawn from"
    beside = f"; one over {second.coordinate} {share_words(second.predicted)}" if second.predicted >= DEPENDS else ""
    if best.frequency is not None:
        return f"{acts} It is periodic at {best.frequency:.3g} Hz: a curve over that period predicts {share}{beside}."
    return f"{acts} It follows {best.coordinate}: a curve over it predicts {share}{beside}."


def share_words(share: float) -> str:
    """A share in whole per cent; one that would round to 0 as a bound."""
    return f"{100.0 * share:.0f} %" if share >= 0.005 else "less than 1 %"
