"""Bending moments of the material: elastic, viscous, and with memory; each by two or more published laws.

Moments in N m, curvature c in rad per unit of s; k = E I / L [N m/rad]. Softening (soft spot, drift) scales all elastic
moments, which are zero in the shape in which the arm was cast.
"""

from __future__ import annotations

import numpy as np

from tentacle.compiled import njit
from tentacle.signals import Array

BRANCHES = 5  # of a fractional element, one a factor of 4 in time; the last memory is the friction's
SPREAD = 4.0
EXPONENT = 0.3  # of the fractional element (Scott Blair 1947; .1 to .5 is measured of rubbers)
SLIP_RATE = 0.4  # rad/s at which tanh and Stribeck bend over
STRIBECK = 0.3  # ratio of static to sliding friction
HYSTERETIC = 6.0  # rad/s, the motion at which a hysteretic loss equals the viscous one


@njit(cache=True)
def softening(laws, s: float, t: float) -> float:
    """Factor on k: a soft spot (Gaussian, box or linear taper, or a Gaussian compliance in series) and a drift (linear,
    or settling exponentially).
    """
    if laws.soft_spot_law == 0.0:
        dip = np.exp(-0.5 * ((s - laws.s0) / 0.08) ** 2)
    elif laws.soft_spot_law == 1.0:
        dip = 1.0 if abs(s - laws.s0) < 0.1 else 0.0
    elif laws.soft_spot_law == 2.0:
        dip = max(0.0, 1.0 - abs(s - laws.s0) / 0.2)
    else:
        added = np.exp(-0.5 * ((s - laws.s0) / 0.08) ** 2)
        dip = added / (1.0 - laws.depth * (1.0 - added))
    drift = laws.rate * t
    if laws.stiffness_drift_law == 1.0:
        drift = laws.rate * laws.settling * (1.0 - np.exp(-t / laws.settling))
    return (1.0 - laws.depth * dip) * (1.0 + drift)


@njit(cache=True)
def slides(laws) -> bool:
    """Whether friction is a steep function of the rate (tanh), so that an implicit step needs more iterations."""
    return laws.c_f != 0.0 and laws.dry_friction_law == 0.0


@njit(cache=True)
def bending(
    laws,
    section: tuple[float, float],
    bend: tuple[float, float],
    memories: tuple[Array, Array],
    t: float,
    step: float,
):
    """Moment [N m] at mid-step, and step/2 d moment/dc + d moment/d c_rate.

    section: s and second moment; bend: c and c_rate; memories: at the step's start, and written, at mid-step.
    """
    s, second = section
    c, c_rate = bend
    memory, middle = memories
    half = 0.5 * step
    plain = laws.E * second / laws.length
    k = plain * softening(laws, s, t)
    bent = laws.c0 if laws.intrinsic_curvature_law == 0.0 else 2.0 * laws.c0 * (1.0 - s)
    c = c - bent
    if laws.beta == 0.0:
        moment, over_c = k * c, k
    elif laws.cubic_stiffness_law == 0.0 or laws.beta < 0.0:
        moment, over_c = k * c * (1.0 + laws.beta * c * c), k * (1.0 + 3.0 * laws.beta * c * c)
    else:  # the same third-order term
        a = np.sqrt(6.0 * laws.beta)
        moment, over_c = k * np.sinh(a * c) / a, k * np.cosh(a * c)
    loss = laws.eta * second / laws.length
    if laws.b != 0.0:
        if laws.amplitude_damping_law == 0.0:
            loss += laws.b * k * c * c
        else:  # rate-independent above a rate: the loss per cycle does not depend on the frequency
            loss += laws.b * k * c * c * HYSTERETIC / np.sqrt(c_rate * c_rate + HYSTERETIC**2)
    over_rate = loss
    moment += loss * c_rate
    if laws.g != 0.0:
        count = 1
        if laws.viscoelasticity_law == 1.0:
            count = 2
        elif laws.viscoelasticity_law == 2.0:
            count = BRANCHES
        total = 0.0
        for j in range(count):
            total += SPREAD ** (-EXPONENT * j) if count == BRANCHES else 1.0
        for j in range(count):
            share = (SPREAD ** (-EXPONENT * j) if count == BRANCHES else 1.0) / total
            if count == 1:
                tau = laws.tau
            elif count == 2:
                tau = laws.tau * (0.4 if j == 0 else 2.5)
            else:
                tau = laws.tau * SPREAD ** (j - 2.0)
            held = (memory[j] + half * c_rate) / (1.0 + half / tau)
            middle[j] = held
            moment += laws.g * share * k * held
            over_rate += laws.g * share * k * half / (1.0 + half / tau)
    if laws.c_f != 0.0:
        if laws.dry_friction_law == 0.0:
            grip = np.tanh(c_rate / SLIP_RATE)
            moment += k * laws.c_f * grip
            # The secant, not the tangent: Newton's steps would jump across the steep middle of tanh.
            over_rate += k * laws.c_f * (grip / c_rate if abs(c_rate) > 1e-9 else 1.0 / SLIP_RATE)
        else:
            limit = laws.slip
            if laws.dry_friction_law == 2.0:
                limit *= 1.0 + STRIBECK * np.exp(-((c_rate / SLIP_RATE) ** 2))
            held = (memory[BRANCHES] + half * c_rate) / (1.0 + half * abs(c_rate) / limit)
            middle[BRANCHES] = held
            moment += k * laws.c_f * held / laws.slip
            over_rate += k * laws.c_f / laws.slip * half / (1.0 + half * abs(c_rate) / limit)
    return moment, half * over_c + over_rate
