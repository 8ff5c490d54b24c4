"""Unknown forces and errors, as Gaussian processes that act beside the model.

    y(t_k) = h(x(t_k); parameters, effects) + H_k (z + b + e) + noise_k,        noise_k white, unit after whitening
    M z'' + D z' + K z = a F (f(t) + f_0) + Q(t) c - (M_b b'' + D_b b' + K_b b)

f: forces and bending moments along the arm, in units of those that act there and then, correlated over
CORRELATION_LENGTH arm lengths and, in time, a Matern-3/2 process of ELL times the motion's own time; f_0 the same,
constant. c: the laws' coefficients are known up to a slow variation along the arm, and Q(t) c is what it does. b: a
slow error of the base's angle, a times the base's motion; e: slow and constant errors of the measured shape, of size a
times the shape's motion, and of where the markers sit; a tracker's are at any a as large and as correlated as its noise
(inference.linearise). All are Gaussian, of unit size but for what is said here. a, the share of the acting forces that
is unknown, is the one hyperparameter. M, D, K are those of the model's laws, averaged along the fitted motion; of modes
faster than FASTEST the mass is scaled up until they are as slow: a force so smooth moves them by their stiffness alone.
One Kalman pass whitens any number of residual columns alike, and what is constant is marginalised out of them
(inference.unknown_constants): the sum of squares of the whitened rows and log_determinant are the marginal likelihood,
linear in frames.

An accelerometer's rows see e alone. They would see z'' and b'', and b'' is white noise, as a Matern-3/2 process has one
derivative. So its e stands for all that z, c and b do to it. An unknown share of the acting forces accelerates
the arm by about that share of its usual acceleration, as fast as it moves: e is a times what is read, and at least
LAW_KNOWN of it, of the motion's own time.

Sources: Hartikainen and Sarkka 2010 (Gaussian processes as state-space models); Alvarez, Luengo and Lawrence 2009
(latent forces); Kennedy and O'Hagan 2001 (a model's discrepancy as a Gaussian process).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import eigh, expm

from affine_model.curvature import Array
from inference.cells import CELLS, Cells
from inference.innovations import Innovations, rotation_to_seeing
from inference.unknown_constants import UnknownConstants

ELL = 1.0  # of the motion's own time, rms angle over rms rate: time scale of the latent force
CORRELATION_LENGTH = 0.3  # arm lengths: of the latent force
POSE_SHARE = 0.03  # of a: constant errors of the camera's scale [1] and roll [rad]
PLACE = 3e-4  # m: standard deviation of a marker's declared place
POSE_FLOOR = 3e-4  # the same at any a: lengths and angles of a set-up are not measured more accurately
SHAPE_SHARE = 0.3  # of the force's share a: the error of few coordinates follows the motion itself
SHAPE_TIME = 2.0  # of the latent force's time: that of the measured shape's own slow error
ACCELERATION_SHARE, ACCELERATION_TIME = 1.0, 1.0  # the same of what an accelerometer reads
LAW_KNOWN, LAW_FOUND = 0.03, 0.3  # relative variation along the arm of a declared law, and of an effect that is sought
FASTEST_MODE = 4.0 * np.pi * CELLS  # of the latent force's rate: twice what cells can show
DOUBLINGS = 12


@dataclass(frozen=True)
class Linearised:
    """An arm's small motions about its fitted run: mass, damping, stiffness (n, n + 1), the last column the base
    angle's; time [s] of the latent force; force_root (n, n): of the latent generalised forces' covariance at a = 1;
    laws (C, n, J): generalised forces in each cell of the laws' J unit variations; envelope (C,): size of the motion
    about each cell over its rms along the run; base_rms [rad] of the base's motion.
    """

    mass: Array
    damping: Array
    stiffness: Array
    time: float
    force_root: Array
    laws: Array
    envelope: Array
    base_rms: float


@dataclass(frozen=True)
class Filter:
    """What whitens one recording's rows at one share a of unknown forces: the Kalman filter of what changes in time,
    and the constants; pose: the camera's among these, of that variance.
    """

    share: float
    cells: Cells
    innovations: Innovations
    constants: UnknownConstants
    pose: slice
    pose_variance: float

    @property
    def log_determinant(self) -> float:
        """Half the logarithm of the determinant of the rows' covariance [nats]."""
        return self.innovations.log_determinant + self.constants.log_determinant

    @property
    def rows(self) -> int:
        """How many whitened rows there are."""
        return self.constants.columns.shape[0]

    def whiten(self, rows: Array) -> Array:
        """Residual rows (T, K, B) as independent ones of unit variance (C K, B)."""
        return self.constants.freed(self.innovations.of(self.cells.averaged(rows)))

    def pose_rows(self) -> Array:
        """Whitened rows (C K, 2) that unit errors of the camera's roll [rad] and scale [1] cause."""
        return self.constants.freed(self.constants.columns[:, self.pose]) / np.sqrt(self.pose_variance)


@dataclass(frozen=True)
class SeenError:
    """Slow errors of the observation: how each cell sees them, rows (C, K, E); the size (E,) of which they are a share;
    and their part that is there at any a, floor (E,). Both in the unit of the rows. share (E,): of that size at a = 1;
    time (E,): over the latent force's.
    """

    rows: Array
    size: Array
    floor: Array
    share: Array
    time: Array


@dataclass(frozen=True)
class LatentForce:
    """One recording's unknown forces and errors, for any share a; seen (C, K, n + 2 + P): rows that each cell sees of a
    change of shape, base angle, scale, and of P markers' places [m].
    """

    linearised: Linearised
    cells: Cells
    seen: Array
    error: SeenError

    @cached_property
    def seeing(self) -> Array | None:
        """The rotation of each cell's rows to those that see the state (inference.innovations)."""
        return rotation_to_seeing(self.error.rows)

    def _places(self) -> dict[str, slice]:
        """Where each part of the state stands."""
        n = self.linearised.mass.shape[0]
        sizes = {"z": n, "v": n, "g": n, "b": 1, "turn": 1, "f": n, "e": self.error.size.size}
        ends = np.cumsum(list(sizes.values())).tolist()
        return {name: slice(end - size, end) for (name, size), end in zip(sizes.items(), ends, strict=True)}

    def state_equation(self, a: float) -> tuple[Array, Array, Array]:
        """Drift F (N, N), diffusion G (N, N) and initial covariance of the state [z, z', f', b, b', f, e].

        What f does to z' is not in F. z and z' begin at zero, as the initial state is an unknown of the fit.
        """
        lin, at = self.linearised, self._places()
        n, rate, size = lin.mass.shape[0], np.sqrt(3.0) / lin.time, at["e"].stop
        slow = self.error.time * lin.time
        inverse = np.linalg.inv(lin.mass[:, :n])
        drift, start = np.zeros((size, size)), np.zeros(size)
        z, v, f, g, b, turn = (at[name] for name in ("z", "v", "f", "g", "b", "turn"))
        drift[z, v] = np.eye(n)
        drift[v, z], drift[v, v] = -inverse @ lin.stiffness[:, :n], -inverse @ lin.damping[:, :n]
        mass, damping, stiffness = (inverse @ columns[:, n:] for columns in (lin.mass, lin.damping, lin.stiffness))
        drift[v, b], drift[v, turn] = rate**2 * mass - stiffness, 2.0 * rate * mass - damping
        for value, slope in ((f, g), (b, turn)):
            count = value.stop - value.start
            drift[value, slope] = np.eye(count)
            drift[slope, value], drift[slope, slope] = -(rate**2) * np.eye(count), -2.0 * rate * np.eye(count)
        drift[at["e"], at["e"]] = np.diag(-1.0 / slow)
        base = a * lin.base_rms + 1e-7
        error = np.hypot(self.error.floor, a * self.error.share * self.error.size)
        strike = np.zeros(size)  # the white noise that drives b'' strikes the arm with it
        strike[turn], strike[v] = 1.0, -mass[:, 0]
        diffusion = 4.0 * rate**3 * base**2 * np.outer(strike, strike)
        diffusion[g, g] += 4.0 * rate**3 * np.eye(n)
        diffusion[at["e"], at["e"]] += np.diag(2.0 / slow * error**2)
        for place, deviation in ((f, 1.0), (g, rate), (b, base), (turn, rate * base), (at["e"], error)):
            start[place] = np.square(deviation)
        return drift, diffusion, np.diag(start)

    def filter(self, a: float, coarsening: float = 1.0) -> Filter:
        """What whitens the rows at that share. coarsening: T of the likelihood (discovery.decide); the variance of the
        set-up's own prior is divided by it.
        """
        at, lin = self._places(), self.linearised
        n, cells = lin.mass.shape[0], self.cells
        drift, diffusion, start = self.state_equation(a)
        transition, added, held = discretised(drift, diffusion, cells.interval)
        pushed = held[: 2 * n, at["v"]] @ np.linalg.inv(lin.mass[:, :n])  # by unit generalised forces
        forced = np.ascontiguousarray(a * pushed @ lin.force_root)
        rows = np.zeros((*self.seen.shape[:2], len(start)))
        rows[:, :, at["z"]], rows[:, :, at["b"]] = self.seen[:, :, :n], self.seen[:, :, n : n + 1]
        rows[:, :, at["e"]] = lin.envelope[:, None, None] * self.error.rows
        motion = (transition, forced, lin.envelope, at["f"].start)
        innovations = Innovations.along(motion, (added, start), rows, self.seeing)
        variance = pose_variance(a, coarsening)
        places = self.seen.shape[2] - n - 2
        directly = self.seen[:, :, n:] * np.repeat([np.sqrt(variance), PLACE], [2, places])
        constant = np.repeat(forced[None], lin.laws.shape[0], axis=0)
        push = np.concatenate(
            [np.zeros((len(constant), 2 * n, directly.shape[2])), constant, pushed @ lin.laws], axis=2
        )
        shown = np.zeros((*self.seen.shape[:2], push.shape[2]))
        shown[:, :, : directly.shape[2]] = directly
        constants = UnknownConstants.of(innovations.of(shown, push))
        return Filter(a, cells, innovations, constants, slice(0, 2), variance)


def pose_variance(a: float, coarsening: float = 1.0) -> float:
    """Variance of the constant errors of scale [1] and roll [rad]: of the model's form, and of the set-up."""
    return (POSE_SHARE * a) ** 2 + POSE_FLOOR**2 / coarsening


def with_scaled_mass(mass: Array, stiffness: Array, time: float) -> Array:
    """Mass (n, n + 1), its first n columns scaled up in the modes that are faster than FASTEST over that time [s]."""
    n = mass.shape[0]
    squares, modes = eigh(stiffness[:, :n], mass[:, :n])
    inverse = np.linalg.inv(modes)
    scaled = inverse.T @ np.diag(np.maximum(1.0, squares * (time / FASTEST_MODE) ** 2)) @ inverse
    return np.concatenate([scaled, mass[:, n:]], axis=1)


def discretised(drift: Array, diffusion: Array, interval: float) -> tuple[Array, Array, Array]:
    """Transition, added covariance and the integral of the transition (N, N) over an interval [s], by doubling from a
    short one (exact for any F). The short one is so short that no exponential overflows.
    """
    size, doublings = drift.shape[0], DOUBLINGS
    if np.linalg.norm(drift) * interval > 2.0**DOUBLINGS:
        fastest = float(np.abs(np.linalg.eigvals(drift)).max())
        doublings = max(DOUBLINGS, math.ceil(math.log2(fastest * interval)))
    short = interval / 2.0**doublings
    block = np.zeros((2 * size, 2 * size))
    block[:size, :size], block[:size, size:], block[size:, size:] = drift, diffusion, -drift.T
    whole: Array = np.asarray(expm(block * short), dtype=np.float64)
    transition: Array = np.array(whole[:size, :size])
    added: Array = whole[:size, size:] @ transition.T
    held: Array = short * (np.eye(size) + 0.5 * short * drift)
    for _ in range(doublings):
        added = transition @ added @ transition.T + added
        held = held + transition @ held
        transition = transition @ transition
    return np.array(transition, order="C"), np.array(0.5 * (added + added.T), order="C"), held
