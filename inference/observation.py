"""What a recording shows of the arm, as numbers with a covariance, to be compared with a model's prediction.

    R (measured - predicted) ~ N(0, 1)

One interface, Observation, for all kinds. ShapeObservation: each frame's midline is reduced by least squares to shape
coefficients [base angle offset, shift x, shift y, log scale, z_1 .. z_m]. R is the root of their information matrix. In
this order the last rows of R belong to the highest curvature coordinates alone, so they show directly whether a further
coordinate is needed. Single points: inference.marker_observation. Sensors beside either of them:
inference.sensed_observation.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from affine_model.curvature import Array, legendre_to_monomial, midline
from inference.appearance import Appearance
from inference.sensor import Sensor

# Noise deviations: a tracker states its noise to 30 % (benchmarks/vision.py), and the rest of its error is slow.
TRACKER_ERROR = 0.83
POSE = 4  # base angle offset [rad], shift x, shift y [m], log of the apparent scale
LEAST_ANGLE = 0.02  # rad: a base that turns by more moves the arm


@dataclass(frozen=True)
class Observation(ABC):
    """t (T,) [s]; theta (T,) [rad] the recorded base angle at the frames; length [m] of the arm."""

    t: Array
    theta: Array
    length: float

    @property
    @abstractmethod
    def seen(self) -> NDArray[np.bool_]:
        """Frames (T,) that show something."""

    @property
    @abstractmethod
    def channels(self) -> int:
        """How many numbers K a frame has."""

    @property
    @abstractmethod
    def order(self) -> int:
        """How many curvature coordinates every frame shows without dynamics."""

    @property
    def tracked(self) -> bool:
        """Whether this is a video's track: its base is known, so that a frame has no unknown shift."""
        return False

    @property
    def shapes(self) -> ShapeObservation | None:
        """The whole shapes that were measured; None where single points were."""
        return None

    @property
    def beside(self) -> Array | None:
        """Distances (P,) [m] of the points from the midline; None where they lie on it."""
        return None

    @property
    def sensors(self) -> tuple[Sensor, ...]:
        """G sensors on the arm, whose zeros are unknown. They are the last of the channels."""
        return ()

    @property
    def zero_size(self) -> Array:
        """The largest reading (G,) of each of them."""
        return np.zeros(0)

    @property
    def readings(self) -> Array:
        """What these sensors read (T, G); NaN where nothing was measured."""
        return np.zeros((self.t.size, 0))

    def read(self, seen: Appearance) -> Array:
        """What they would read (T, G, B), were their zeros 0; NaN where that is not known."""
        return np.zeros((self.t.size, 0, seen.q.shape[2]))

    def zero_slopes(self) -> Array:
        """Derivatives (T, G) of the sensors' whitened residuals by their zeros."""
        return np.zeros((self.t.size, 0))

    def moved_places(self, step: float) -> tuple[Self, ...]:
        """The same pictures with each place that was declared by hand moved by `step` [m] along and across the arm."""
        return ()

    @abstractmethod
    def slow_errors(self, frames: NDArray[np.bool_], z: Array) -> Array:
        """Sizes (E,) of which slow errors are a share: the shape's coordinates z (T, n) and the base angle [rad], or
        what is seen of every number in these frames [noise deviations].
        """

    def sensor_errors(self, frames: NDArray[np.bool_]) -> Array:
        """Size, floor, share and time (4, G) of the sensors' own slow errors (inference.latent_force.SeenError). The
        size is the standard deviation of what is read in these frames [noise deviations].
        """
        return np.zeros((4, 0))

    @abstractmethod
    def points(self, s: Array) -> tuple[Array, Array]:
        """Places s (P,) and the points (T, P, 2) [m] that were seen there; NaN where nothing was."""

    @abstractmethod
    def predict(self, seen: Appearance) -> Array:
        """Whitened residuals (T, K, B) of B individuals."""

    @abstractmethod
    def first(self, count: int) -> Self:
        """The first frames alone."""

    @abstractmethod
    def without(self, frames: NDArray[np.bool_]) -> Self:
        """The observation in which these frames (T,) show nothing."""

    @abstractmethod
    def later(self, t: Array, theta: Array) -> Observation:
        """What the same camera would show at other instants t (T,) [s], with these base angles (T,) [rad] and nothing
        measured yet, without sensors.
        """

    @abstractmethod
    def subtract_residual(self, rows: Array) -> Self:
        """The observation minus whitened residuals (T, K): what the model that has these residuals shows."""

    @abstractmethod
    def declared_as(self, length: float, scale: float, values: Mapping[str, float]) -> Self:
        """The same pictures of an arm of another length [m], seen at `scale` times the metres a pixel, with the markers
        at the places s and d that `values` states (`markers.NAME.s`).
        """

    def with_shapes(self, shapes: ShapeObservation) -> Observation:
        """The observation with these shapes in place of its own."""
        return shapes

    @abstractmethod
    def motion(self) -> tuple[Array, Array]:
        """What is seen to move (T, C), NaN where it is not seen, and what is known to move with it (T, D)."""

    @abstractmethod
    def changed(self) -> float:
        """How far the seen frames differ from their mean [noise deviations]; inf where the base turns."""

    def root_offset(self) -> tuple[NDArray[np.bool_], Array]:
        """Frames (T,) whose root was seen, and its direction (T,) [rad] counted from the recorded base angle."""
        return np.zeros(self.t.size, dtype=bool), np.zeros(self.t.size)


@dataclass(frozen=True)
class ShapeObservation(Observation):
    """Shape coefficients of T frames in the order [offset, shift x, shift y, log scale, z_1 .. z_m] (Legendre z).

    The offset is counted from theta. coefficients (T, K); root (T, K, K) upper triangular whitening, 0 where a frame
    was not accepted; residual_chi2 (T,) and residual_count (T,): the chi-square of the frame's points about the fitted
    shape, and its degrees of freedom (0, 0 where unknown).
    """

    coefficients: Array
    root: Array
    residual_chi2: Array
    residual_count: Array

    @property
    def order(self) -> int:
        return self.coefficients.shape[1] - POSE

    @property
    def seen(self) -> NDArray[np.bool_]:
        return np.asarray(self.root[:, -1, -1] > 0)

    @property
    def channels(self) -> int:
        return self.coefficients.shape[1]

    @property
    def tracked(self) -> bool:
        return bool(np.all(self.root[self.seen][:, 1, 1] == 0.0))

    @property
    def shapes(self) -> ShapeObservation:
        return self

    def points(self, s: Array) -> tuple[Array, Array]:
        q = self.coefficients[:, POSE:] @ legendre_to_monomial(self.order).T
        size = np.exp(self.coefficients[:, 3])[:, None, None]
        shown = (
            size * midline(q, self.theta + self.coefficients[:, 0], self.length, s) + self.coefficients[:, None, 1:3]
        )
        return s, np.where(self.seen[:, None, None], shown, np.nan)

    def predict(self, seen: Appearance) -> Array:
        n = seen.q.shape[1]
        z = np.matmul(np.linalg.inv(legendre_to_monomial(n)), seen.q)
        error = np.repeat(self.coefficients[:, :, None], seen.q.shape[2], axis=2)
        error[:, 0] -= seen.theta - self.theta[:, None] + seen.roll
        error[:, 1:3] -= seen.shift
        error[:, 3] -= np.log1p(seen.excess)
        kept = min(n, self.order)
        error[:, POSE : POSE + kept] -= z[:, :kept]
        return np.matmul(self.root, error)

    def first(self, count: int) -> Self:
        frames = ("t", "theta", "coefficients", "root", "residual_chi2", "residual_count")
        return replace(self, **{name: getattr(self, name)[:count] for name in frames})

    def without(self, frames: NDArray[np.bool_]) -> Self:
        return replace(self, root=np.where(frames[:, None, None], 0.0, self.root))

    def later(self, t: Array, theta: Array) -> ShapeObservation:
        live = np.flatnonzero(self.seen)
        root = np.repeat(self.root[live[live.size // 2]][None], t.size, axis=0)
        nothing, none = np.zeros((t.size, self.channels)), np.zeros(t.size)
        return ShapeObservation(t, theta, self.length, nothing, root, none, none)

    def subtract_residual(self, rows: Array) -> Self:
        change = np.einsum("tkl,tl->tk", np.linalg.pinv(self.root), rows)
        return replace(self, coefficients=self.coefficients - change)

    def declared_as(self, length: float, scale: float, values: Mapping[str, float]) -> Self:
        coefficients = self.coefficients.copy()
        if self.tracked:  # midlines and markers come in metres, not in pixels
            coefficients[:, 3] += np.log(scale)
        coefficients[:, 3] -= np.log(length / self.length)
        return replace(self, coefficients=coefficients, length=length)

    def slow_errors(self, frames: NDArray[np.bool_], z: Array) -> Array:
        return np.append(z.std(axis=0), 0.0)

    def motion(self) -> tuple[Array, Array]:
        return self.coefficients[:, POSE : POSE + 1], self.theta[:, None]

    def changed(self) -> float:
        if np.ptp(self.theta[self.seen]) > LEAST_ANGLE:
            return np.inf
        change = self.coefficients[self.seen] - self.coefficients[self.seen].mean(axis=0)
        return float(np.sqrt(np.mean(np.einsum("tkl,tl->tk", self.root[self.seen], change) ** 2)))

    def root_offset(self) -> tuple[NDArray[np.bool_], Array]:
        return self.seen, self.coefficients[:, 0]
