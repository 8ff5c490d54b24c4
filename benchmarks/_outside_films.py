"""Films of arms drawn by a program of their own: no line is shared with vision, neither its renderer nor its model.

A midline is laid out by steps along a heading. Its outline, with a rounded tip, is drawn four times enlarged by the Agg
library that Matplotlib brings (right to .001 px). The picture is then blurred, shrunk, lit, dirtied, coded by JPEG or
H.264, and decoded again.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from io import BytesIO

import av
import cv2
import numpy as np
from _outside_motion import REST, STEPS, Array, Film, base_of, midline, motion
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.path import Path
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray
from PIL import Image

Grey = NDArray[np.uint8]
FINE = 4  # drawn pixels to a pixel's side
REPEATABLE = {"threads": "1", "x264-params": "asm=0"}  # x264's vector code, or threads, code equal pictures unequally


def _body(points: Array, widths: Array) -> Array:
    """Outline (N, 2) of a body of full widths (N,) about points (N, 2) [px], its tip round."""
    along = np.gradient(points, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    end = 0.5 * widths[-1]
    to_tip = np.append(np.linalg.norm(np.diff(points, axis=0), axis=1)[::-1].cumsum()[::-1], 0.0)
    half = np.where(to_tip < end, np.sqrt(np.clip(end**2 - (end - to_tip) ** 2, 0, None)), 0.5 * widths)
    return np.concatenate([points + half[:, None] * across, (points - half[:, None] * across)[::-1]])


def _share(film: Film, polygons: list[Array]) -> Array:
    """Coverage (H, W) by polygons (N, 2) [px] through the lens."""
    width, height = film.size
    if not polygons:
        return np.zeros((height, width))
    agg = RendererAgg(width * FINE, height * FINE, 72)
    pen = agg.new_gc()
    pen.set_linewidth(0)
    pen.set_snap(False)
    place = Affine2D().translate(0.5, 0.5).scale(FINE, -FINE).translate(0, height * FINE)
    for polygon in polygons:
        agg.draw_path(pen, Path(np.vstack([polygon, polygon[:1]]), closed=True), place, (1.0, 1.0, 1.0, 1.0))
    canvas = np.asarray(agg.buffer_rgba())[:, :, 3].astype(np.float32)
    blurred = cv2.GaussianBlur(canvas, (0, 0), film.blur * FINE)
    return cv2.resize(blurred, (width, height), interpolation=cv2.INTER_AREA).astype(float) / 255.0


def _holder(film: Film, base: Array, heading: float) -> list[Array]:
    """Polygons of what holds the arm."""
    along = np.array([np.cos(heading), np.sin(heading)])
    across = np.array([-along[1], along[0]])
    if film.at_base in ("clamp", "dark"):
        w, d = 1.3 * film.widths[0], 2.0 * film.widths[0]
        return [base + np.array([w * across, -w * across, -w * across - d * along, w * across - d * along])]
    if film.at_base == "body":  # trunk that widens into a head
        back = np.linspace(0, 0.55 * film.length, 60)
        half = 0.5 * film.widths[0] * (1 + 2.2 / (1 + np.exp(-(back - 0.2 * film.length) / (0.05 * film.length))))
        half *= np.sqrt(np.clip(1 - (back / back[-1]) ** 6, 0, 1))
        middle = base + (2.0 - back[:, None]) * along  # over the arm's end: they are one body
        return [np.concatenate([middle + half[:, None] * across, (middle - half[:, None] * across)[::-1]])]
    return []


def _delivered(film: Film, plain: list[Array], seed: int) -> list[Grey]:
    """With noise, whole greys and coding."""
    rng = np.random.default_rng([seed, 5])
    noisy = [np.clip(np.rint(p + film.noise * rng.standard_normal(p.shape)), 0, 255).astype(np.uint8) for p in plain]
    kind, _, number = film.codec.partition(" ")
    if kind == "jpeg":
        packed = [cv2.imencode(".jpg", p, [cv2.IMWRITE_JPEG_QUALITY, int(number)])[1] for p in noisy]
        return [np.asarray(cv2.imdecode(p, cv2.IMREAD_GRAYSCALE), dtype=np.uint8) for p in packed]
    if kind == "gif":
        return [np.asarray(Image.fromarray(p).convert("RGB").quantize(int(number)).convert("L")) for p in noisy]
    if kind == "h264":
        buffer = BytesIO()
        with av.open(buffer, "w", format="matroska") as container:
            options = {"crf": number, **REPEATABLE}
            stream = container.add_stream("libx264", rate=Fraction(60), options=options)
            stream.width, stream.height, stream.pix_fmt = film.size[0], film.size[1], "yuv420p"
            for p in noisy:
                container.mux(stream.encode(av.VideoFrame.from_ndarray(p, format="gray")))
            container.mux(stream.encode(None))
        buffer.seek(0)
        with av.open(buffer, "r") as container:
            pictures = [frame.to_ndarray(format="gray") for frame in container.decode(video=0)]
            return [np.asarray(picture, dtype=np.uint8) for picture in pictures]
    return noisy


class Painter:
    """A film's scene without noise; a frame may be painted with another midline in the true one's place."""

    def __init__(self, film: Film, seed: int) -> None:
        self.film, self.seed = film, seed
        rng = np.random.default_rng([seed, 3])
        width, height = film.size
        self.base, self.rest = base_of(film), REST[film.side]
        self.theta, self.bends = motion(film, seed)
        self.widths = np.linspace(*film.widths, STEPS + 1)
        self._light = 1.0 - film.uneven * np.add.outer(np.linspace(0, 0.5, height), np.linspace(0, 0.5, width))
        dirt = sum(cv2.GaussianBlur(rng.standard_normal((height, width)), (0, 0), s) * s for s in (1.5, 4.0, 10.0))
        self.dirt = np.asarray(film.texture * dirt / max(float(np.std(dirt)), 1e-9), dtype=float)

    def line(self, k: int, turn: Array | float = 0.0, shift: Array | float = 0.0, longer: float = 0.0) -> Array:
        """Frame k's midline (STEPS + 1, 2) [px], turned by turn (STEPS,) [rad], shifted (2,) [px] and made longer."""
        heading = self.rest + self.theta[k] + turn
        return midline(self.base + shift, heading, self.bends[k], self.film.length * (1.0 + longer), self.film.wave)

    def paint(self, k: int, line: Array) -> tuple[Array, float]:
        """Grey (H, W) of frame k, and the share of its own length where something hides the middle or an edge."""
        film, (width, height) = self.film, self.film.size
        scene = np.asarray(film.ground + self.dirt, dtype=float)
        if film.intruder == "second_arm":
            aside = np.array([0.2 * width, 0.0])
            bends = -0.7 * self.bends[(k + 7) % film.frames]
            other = midline(self.base + aside, self.rest - self.theta[k], bends, 0.8 * film.length)
            scene = _over(scene, _share(film, [_body(other, self.widths)]), film.arm)
        arm = _share(film, [_body(line, self.widths)])
        if film.halo:
            rim = _share(film, [_body(line, self.widths + 5.0)])
            scene += film.halo * np.clip(rim - arm, 0.0, 1.0)
        seen = film.arm + 0.3 * self.dirt
        if film.fade:
            seen = seen + film.fade * (film.ground - film.arm) * _nearest_station(line, film.size) ** 2
        scene = _over(scene, arm, seen)
        if film.core:
            core = _share(film, [_body(line, 0.35 * self.widths)])
            scene += film.core * core * (film.ground - seen)
        turned = self.rest + (self.theta[k] if film.servo else 0.0)
        held = _share(film, _holder(film, self.base, turned))
        scene = _over(scene, held, 0.4 * film.arm if film.at_base == "dark" else film.arm)
        hidden, grey = self._in_front(k)
        scene = _over(scene, hidden, grey) * self._light * (1.0 + film.flicker * np.sin(2.3 * k))
        outline = _body(self.line(k), self.widths).reshape(2, -1, 2)
        body = np.rint([self.line(k), outline[0], outline[1, ::-1]]).astype(int)  # middle and both edges
        at = np.clip(body, 2, [width - 3, height - 3])
        gone = (hidden[at[..., 1], at[..., 0]] > 0.05) | np.any(body != at, axis=2)
        return scene, float(np.mean(gone.any(axis=0)))

    def _in_front(self, k: int) -> tuple[Array, float]:
        """Coverage (H, W) by the intruder of frame k, and its grey."""
        film, (width, height) = self.film, self.film.size
        ahead = np.array([np.cos(self.rest), np.sin(self.rest)])
        if film.intruder == "hand":
            u = (k / max(film.frames - 1, 1) * 1.5 - 0.25) * width
            fingers = [[u - 0.05 * finger * width, (0.3 + 0.1 * finger) * height, 0.09 * height] for finger in range(4)]
            return _share(film, _discs(fingers)), 0.9 * film.arm
        if film.intruder == "debris":
            u, v = self.base + 0.55 * film.length * ahead
            return _share(film, _discs([[u + 12.0, v, 6.0], [u + 19.0, v + 5.0, 5.0]])), 0.9 * film.arm
        if film.intruder in ("post", "glare"):
            place = self.base + film.length * (0.62 if film.intruder == "post" else 0.4) * ahead
            return _share(film, _bar(place, self.rest, film)), (film.ground if film.intruder == "post" else 250.0)
        return np.zeros((height, width)), 0.0


@dataclass(frozen=True)
class Drawn:
    """A film as delivered: pictures, times [s], servo angle (T,) [rad], true midlines (T, STEPS + 1, 2) [px].

    covered (T,): share of the arm that something hides. fresh (T,): False where a picture is shown again.
    plain (T,): pictures without noise and coding.
    """

    painter: Painter
    pictures: list[Grey]
    plain: list[Array]
    t: Array
    theta: Array
    midlines: Array
    covered: Array
    fresh: NDArray[np.bool_]


def _over(scene: Array, share: Array, grey: Array | float) -> Array:
    return np.asarray(scene + share * (grey - scene), dtype=float)


def draw_film(film: Film, seed: int = 1) -> Drawn:
    """All pictures of a film, with their truth."""
    painter = Painter(film, seed)
    lines = np.array([painter.line(k) for k in range(film.frames)])
    painted = [painter.paint(k, line) for k, line in enumerate(lines)]
    order = np.arange(film.frames)
    if film.repeats:
        order = np.repeat(order, np.random.default_rng([seed, 9]).integers(2, 4, film.frames))
    pictures = _delivered(film, [painted[k][0] for k in order] if film.codec else [scene for scene, _ in painted], seed)
    return Drawn(
        painter,
        pictures if film.codec else [pictures[k] for k in order],
        [painted[k][0] for k in order],
        np.arange(len(order)) / 60.0,
        painter.theta[order],
        lines[order],
        np.array([share for _, share in painted])[order],
        np.concatenate([[True], np.diff(order) > 0]),
    )


def _discs(discs: list[list[float]]) -> list[Array]:
    turn = np.linspace(0.0, 2.0 * np.pi, 60)
    return [np.column_stack([u + radius * np.cos(turn), v + radius * np.sin(turn)]) for u, v, radius in discs]


def _nearest_station(line: Array, size: tuple[int, int]) -> Array:
    """Share (H, W) of the arm's length at which its midline is nearest to each pixel."""
    rows, columns = np.mgrid[: size[1], : size[0]]
    far = (columns[..., None] - line[::6, 0]) ** 2 + (rows[..., None] - line[::6, 1]) ** 2
    return np.argmin(far, axis=2) / (len(line[::6]) - 1.0)


def _bar(place: Array, heading: float, film: Film) -> list[Array]:
    """A bar across the straight arm, an eighth of its length deep (a glare: a spot of that size)."""
    along = np.array([np.cos(heading), np.sin(heading)])
    across = np.array([-along[1], along[0]])
    deep, wide = 0.06 * film.length * along, (3.0 if film.intruder == "post" else 0.15) * film.length * across
    return [place + np.array([deep + wide, deep - wide, -deep - wide, -deep + wide])]
