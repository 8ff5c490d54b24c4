"""Scale and lens from a ChArUco board in the arm's plane, in the water; the lens then includes the refraction."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from tentacle.errors import InputError
from tentacle.signals import Array
from vision.frames import Frame
from vision.lens import Lens

LEAST_CORNERS = 12
MOST_VIEWS = 30
LEAST_MARKER = 0.1  # of its square; smaller ones are not drawn with six pixels
# Number of markers -> the smallest dictionary that has so many.
DICTIONARIES = {
    50: cv2.aruco.DICT_4X4_50,
    100: cv2.aruco.DICT_4X4_100,
    250: cv2.aruco.DICT_4X4_250,
    1000: cv2.aruco.DICT_4X4_1000,
}


@dataclass(frozen=True)
class CharucoBoard:
    """A ChArUco board: squares across and down, side of a square and of a marker [m], markers of 4 x 4 cells.

    InputError where there is no such board.
    """

    across: int = 8
    down: int = 6
    square: float = 0.02
    marker: float = 0.015

    def __post_init__(self) -> None:
        if min(self.across, self.down) < 3 or self.markers > max(DICTIONARIES):
            raise InputError(
                f"{self.across} by {self.down} squares are no board", field="--across, --down",
                expected=f"3 squares or more, at most {2 * max(DICTIONARIES)} in all",
            )  # fmt: skip
        if not LEAST_MARKER * self.square <= self.marker < self.square:
            raise InputError(
                f"a marker of {self.marker:g} m in a square of {self.square:g} m", field="--marker, --square",
                expected=f"at least {LEAST_MARKER:g} of the square, and less than it",
            )  # fmt: skip

    @property
    def markers(self) -> int:
        """Number of markers: one in each white square."""
        return self.across * self.down // 2

    def charuco(self) -> cv2.aruco.CharucoBoard:
        """OpenCV's board."""
        smallest = min(count for count in DICTIONARIES if count >= self.markers)
        words = cv2.aruco.getPredefinedDictionary(DICTIONARIES[smallest])
        return cv2.aruco.CharucoBoard((self.across, self.down), self.square, self.marker, words)

    def picture(self, px_per_square: int = 100) -> NDArray[np.uint8]:
        """The board to print, with a margin of half a square."""
        size = (self.across * px_per_square, self.down * px_per_square)
        return np.asarray(self.charuco().generateImage(size, marginSize=0), dtype=np.uint8)


@dataclass(frozen=True)
class LensCalibration:
    """lens with its scale, rms of the corners [px], tilt of the board against the picture [rad], number of views."""

    lens: Lens
    rms_px: float
    tilt: float
    views: int


def find_corners(image: NDArray[np.uint8], board: CharucoBoard) -> tuple[Array, Array]:
    """Corners seen: on the board (N, 2) [m] and in the picture (N, 2) [px]; both empty where there is no board."""
    charuco = board.charuco()
    found = cv2.aruco.CharucoDetector(charuco).detectBoard(image)
    corners, ids = found[0], found[1]
    if ids is None or corners is None or len(ids) < LEAST_CORNERS:
        return np.zeros((0, 2)), np.zeros((0, 2))
    grid = np.asarray(charuco.getChessboardCorners(), dtype=float)[:, :2]
    return grid[np.asarray(ids, dtype=np.intp).ravel()], np.asarray(corners, dtype=float).reshape(-1, 2)


def calibrate_lens(frames: Iterable[Frame], board: CharucoBoard) -> LensCalibration:
    """Fit one radial lens term and scale, and for each view its place, turn and tilt (a plane seen in perspective).

    Raises InputError where too few corners are found, or the board is tilted by more than the scale can bear.
    """
    views: list[tuple[Array, Array]] = []
    shape = (0, 0)
    for frame in frames:
        on_board, in_picture = find_corners(frame.image, board)
        if len(on_board):
            views.append((on_board, in_picture))
            shape = frame.image.shape
        if len(views) == MOST_VIEWS:
            break
    if not views:
        raise InputError(f"fewer than {LEAST_CORNERS} corners of the board are seen", expected="the board in full view")
    size = np.array(shape[::-1], dtype=float)
    centre, reference = 0.5 * (size - 1.0), float(np.linalg.norm(0.5 * size))
    starts = [_homography(board_points, picture - centre) for board_points, picture in views]

    def residual(parameters: Array) -> Array:
        lens = Lens((0.0, 0.0), reference, float(parameters[0]))
        parts = []
        for k, (board_points, picture) in enumerate(views):
            h = np.append(parameters[1 + 8 * k : 9 + 8 * k] * scales[k], 1.0).reshape(3, 3)
            flat = np.column_stack([board_points, np.ones(len(board_points))]) @ h.T
            parts.append(lens.bend(flat[:, :2] / flat[:, 2:]) - (picture - centre))
        return np.concatenate(parts).ravel()

    scales = [np.maximum(np.abs(start), 1e-3) for start in starts]
    begin = np.concatenate([[0.0], *(start / scale for start, scale in zip(starts, scales, strict=True))])
    fit = least_squares(residual, begin, loss="soft_l1")
    if not fit.success:
        raise InputError("the lens fit does not converge", expected="more views of the whole board")
    final = [np.append(fit.x[1 + 8 * k : 9 + 8 * k] * scales[k], 1.0).reshape(3, 3) for k in range(len(views))]
    per_metre, tilts = zip(
        *(_scale_and_tilt(h, points) for h, (points, _) in zip(final, views, strict=True)), strict=True
    )
    flattest = int(np.argmin(tilts))
    lens = Lens((float(centre[0]), float(centre[1])), reference, float(fit.x[0]), 0.0, 1.0 / per_metre[flattest])
    rms = float(np.sqrt(2.0 * np.mean(residual(fit.x) ** 2)))
    return LensCalibration(lens, rms, float(tilts[flattest]), len(views))


def _homography(board_points: Array, picture: Array) -> Array:
    h, _ = cv2.findHomography(board_points, picture)
    if h is None:
        raise InputError("the board's corners lie on one line", expected="the board in full view")
    return np.asarray(h, dtype=float).ravel()[:8] / float(h[2, 2])


def _scale_and_tilt(h: Array, board_points: Array) -> tuple[float, float]:
    """px per metre at the board's middle (mean of both directions), and the tilt from its anisotropy b / a."""
    middle = board_points.mean(axis=0)
    w = h[2, :2] @ middle + h[2, 2]
    seen = (h[:2, :2] @ middle + h[:2, 2]) / w
    jacobian = (h[:2, :2] - np.outer(seen, h[2, :2])) / w
    large, small = np.linalg.svd(jacobian, compute_uv=False)
    return float(np.sqrt(large * small)), float(np.arccos(min(small / large, 1.0)))
