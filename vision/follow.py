"""Follows one arm through a video, frame by frame: live, or from a file."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tentacle.errors import InputError
from tentacle.signals import Array
from vision.edge_look import EdgeLook, seen_along
from vision.fit import (
    END_PIXELS,
    Exposure,
    FrameFit,
    TrackedArm,
    fit_outline,
    ordinary_misfit,
    refine,
)
from vision.frames import Frame
from vision.judge import Judged, judge_frame
from vision.kinematics import SHARED, Geometry
from vision.light import Light
from vision.locate import locate
from vision.motion import ShapeMotion
from vision.reach import led_to_end, seen_reach
from vision.remedy import remedies
from vision.repeats import Repeats
from vision.settle import Reach, prior_of, settle
from vision.tracked_frame import TrackedFrame, doubted_end, eliminate, refused
from vision.width import usual_widths

LEAST_COARSE_SCORE = 0.45  # of a coarse find
BLURS = (0.7, 0.85, 1.0, 1.2, 1.5, 1.9, 2.5)  # px
BLUR_LIMITS = (0.5, 4.0)  # px
SLOWLY = 0.05  # weight of a frame's own contrast and blur in the running mean
STARTING = (16.0, 8.0, 5.0)  # px, reaches while the recording's parameters are not yet known
LOOK_AGAIN = 5  # frames between searches for a lost arm
END_SHARE = 0.03  # of a short arm: range of the search for its ends, because the reach gives its length this well
SIDES_SHARE = 5e-4  # weight of the sides' information on g at the start, while the shape is known only roughly
MISSED_END, MISSED_SHARE = 1.0, 0.01  # px, of the arm: a fit that ends farther beside the seen end misses it
NEAREST_FRAMES = 3  # frames: a neighbour farther away gives no speed


class Follower:
    """An arm's state between frames: its last shapes, the recording's parameters g, and how its edges look."""

    def __init__(
        self,
        geometry: Geometry,
        exposure: float,
        order: int,
        theta: Callable[[float], float] | None,
        verdicts: Mapping[int, bool] | None = None,
    ) -> None:
        self.verdicts = verdicts or {}  # frame number -> whether a person accepted or rejected it
        self._count, self.repeats = 0, Repeats()
        self.geometry, self.exposure, self.size = geometry, exposure, order + 1
        self._ends = min(END_PIXELS, END_SHARE * geometry.length)
        self._theta, self.prior = theta, prior_of(geometry)
        self.shared = np.zeros(SHARED)
        self.told = (np.zeros((SHARED, SHARED)), np.zeros(SHARED))  # information and gradient of the reach, on shared
        self.sight: EdgeLook | None = None
        self._history: list[tuple[float, Array]] = []
        self._lost = 0
        self._light: Light | None = None
        self._latest: NDArray[np.uint8] | None = None

    def remedies(self) -> list[str]:
        """Possible errors of the declaration, from the last picture that was checked; [] before the first."""
        return [] if self._latest is None else remedies(self._latest, self.geometry, self._theta is not None)

    def theta(self, t: float) -> float:
        """The motor's angle [rad] at a time [s]; 0 where it is not known."""
        return 0.0 if self._theta is None else self._theta(t)

    def start(self, frames: list[Frame]) -> None:
        """Find the arm in the first frames and estimate the recording's parameters from them.

        Raises InputError where no frame shows an arm that the declaration fits.
        """
        self._latest = frames[-1].image
        self.repeats.begin([frame.image for frame in frames])
        found = None
        for index in np.unique(np.linspace(0, len(frames) - 1, 6).astype(int)):
            frame = frames[index]
            where = locate(frame.image, self.geometry, self.shared, self._known(frame.t), coordinates=self.size)
            if found is None or where.score > found[1].score:
                found = (index, where)
            if where.score > 0.7:
                break
        if found is None or found[1].score < LEAST_COARSE_SCORE:
            raise InputError("no arm that fits the declaration is in the first frames", expected="the arm in view")
        index, where = int(found[0]), found[1]
        self.sight = EdgeLook(blur=1.2, polarity=where.polarity, contrast=8.0)
        begin = self._filled(where.x)
        # forward and backward from the frame where the arm was found, so that each start is near
        walk = [range(index, len(frames)), range(index - 1, -1, -1)]
        shapes: dict[int, Array] = {index: begin}
        reaches = (3.0 * max(self.geometry.length / 120.0, 1.0) + 6.0, *STARTING)
        for sweep in range(4):
            fits = {}
            for way in walk:
                for k in way:
                    near = shapes.get(k, shapes.get(k - way.step))
                    if near is None:
                        continue
                    ends = 0.0 if sweep < 2 else self._ends  # the length comes from the reach first
                    motion = self._among(frames, shapes, k) if sweep > 0 else ShapeMotion()
                    fit = self._fit(frames[k], near, motion, reaches if sweep == 0 else STARTING, ends)
                    if fit is not None and fit.sigma < 3.0:
                        shapes[k], fits[k] = fit.x, fit
            if not fits:
                raise InputError("the arm's edges cannot be followed in the first frames", expected="the arm in view")
            reaches_seen = [self._reach(frames[k].image, frames[k].t, fits[k]) for k in fits]
            share = SIDES_SHARE if sweep < 2 else 1.0
            self.shared, self.told = settle(self.shared, self.geometry, list(fits.values()), reaches_seen, share)
            self._look_along(list(fits.values()))
            if sweep < 2:
                motion = self._among(frames, shapes, index)
                self._look_at_edges(frames[index], shapes.get(index, begin), motion, list(fits.values()))
            else:
                self._sharpen(list(fits.values()))
            if sweep == 3:
                widths = usual_widths([(fit.expected, fit.edges, fit.weight) for fit in fits.values()])
                assert self.sight is not None
                self.sight = replace(self.sight, wider=widths)
            if sweep == 2:
                for k in sorted(fits):
                    self._learn(frames[k], fits[k])
        # so that the motion of the first frames is known too, from the later ones
        self._history = [(frames[k].t, shapes[k] + self._turn(frames[k].t)) for k in (2, 1) if k in shapes]

    def _among(self, frames: list[Frame], shapes: dict[int, Array], k: int) -> ShapeMotion:
        """Motion in frame k, from the shapes of the two nearest frames."""
        near = sorted((other for other in shapes if other != k), key=lambda other: abs(other - k))[:2]
        return ShapeMotion(
            tuple((frames[i].t, shapes[i] + self._turn(frames[i].t)) for i in near if abs(i - k) <= NEAREST_FRAMES)
        )

    def _turn(self, t: float) -> Array:
        """The motor's part (K,) of an arm's angles: in the first entry."""
        return self.theta(t) * (np.arange(self.size) == 0)

    def _filled(self, x: Array) -> Array:
        """A shape (K,) from its first coordinates."""
        return np.concatenate([x, np.zeros(max(self.size - len(x), 0))])[: self.size]

    def _known(self, t: float) -> float | None:
        return None if self._theta is None else self._theta(t)

    def _fit(
        self, frame: Frame, x: Array, motion: ShapeMotion, reaches: tuple[float, ...], ends: float | None = None
    ) -> FrameFit | None:
        assert self.sight is not None
        picture = Exposure(frame.image, frame.t, self.exposure, motion, self._light)
        arm = TrackedArm(self.geometry, self.theta(frame.t), self.shared)
        return refine(picture, arm, x, self.sight, reaches, self._ends if ends is None else ends)

    def _learn(self, frame: Frame, fit: FrameFit) -> None:
        """Add a fitted frame to the knowledge of the light."""
        if self._light is None:
            height, width = frame.image.shape
            self._light = Light((width, height))
        outline, beside = fit.expected, fit.edges.plateaus
        sides = (outline.points[outline.kind == 0], outline.points[outline.kind == 1])
        places = outline.points[:, None] + beside[:, :, 2:] * outline.normals[:, None]
        told = np.concatenate([beside[:, :, :2], places], axis=2)
        noise = ordinary_misfit(fit.edges, fit.weight > 0)
        self._light.learn(frame.t, frame.image, self.geometry.lens, sides, (told[:, 0], told[:, 1]), noise)

    def _reach(self, image: NDArray[np.uint8], t: float, fit: FrameFit) -> Reach:
        """How far a picture shows the arm."""
        assert self.sight is not None
        centre, phi = self.geometry.midline(self.theta(t), fit.x, self.shared)
        seen = seen_reach(image, self.geometry, (centre, phi), self.shared, self.sight)
        return Reach(seen.share, self.geometry.heading(float(phi[0])))

    def _look_at_edges(self, frame: Frame, x: Array, motion: ShapeMotion, fits: list[FrameFit]) -> None:
        """Choose contrast and blur from the edges."""
        assert self.sight is not None
        polarity = self.sight.polarity
        contrast = np.median([np.median((polarity * f.edges.contrast)[f.weight > 0.1]) for f in fits])
        self.sight = replace(self.sight, contrast=float(contrast))
        best = np.inf
        chosen = self.sight
        for blur in BLURS:
            self.sight = replace(chosen, blur=blur)
            fit = self._fit(frame, x, motion, (5.0,))
            if fit is None:
                continue
            misfit = float(np.median(fit.edges.misfit[fit.weight > 0.1]))
            if misfit < best:
                best, chosen = misfit, self.sight
        self.sight = chosen

    def _look_along(self, fits: list[FrameFit]) -> None:
        """The contrast's course along the arm, and that of the body's own part in it."""
        assert self.sight is not None
        parts = [np.stack([f.expected.s, f.own_contrast, f.own_light])[:, f.expected.kind < 2] for f in fits]
        self.sight = seen_along(self.sight, *np.concatenate(parts, axis=1))

    def _sharpen(self, fits: list[FrameFit], gain: float = 1.0) -> None:
        """One step of the blur towards that of the fitted edges, by a factor between two thirds and three halves."""
        assert self.sight is not None
        used = [fit.edges.softer[(fit.weight > 0) & (fit.expected.kind < 2)] for fit in fits]
        right, left = np.concatenate(used).sum(axis=0)
        blur = self.sight.blur
        step = float(np.clip(right / max(left, 1e-9), -blur / 3.0, blur / 2.0))
        self.sight = replace(self.sight, blur=float(np.clip(blur + gain * step, *BLUR_LIMITS)))

    def see(self, frame: Frame) -> TrackedFrame:
        """Fit the next frame; start must have been called."""
        assert self.sight is not None
        self._latest = frame.image
        verdict, self._count = self.verdicts.get(self._count), self._count + 1
        repeats = self.repeats.repeats(frame.image)
        if verdict is False:
            return refused(frame.t, self.theta(frame.t), self.size, "rejected by hand")
        if repeats and not verdict:
            return refused(frame.t, self.theta(frame.t), self.size, "repeats the frame before")
        fit, off, reason = None, 0.0, "arm not found"
        for x, motion, reaches in self._starts(frame):
            fit = self._fit(frame, x, motion, reaches)
            if fit is None:
                continue
            fit, judged = self._judged(frame, fit, motion)
            off, reason = judged.end.off, "" if verdict else judged.reason
            if not reason:
                break
        if fit is None or reason:
            self._lost += 1
            return refused(frame.t, self.theta(frame.t), self.size, reason)
        self._lost = 0
        before = [entry for entry in self._history if entry[0] != frame.t]
        self._history = [*before[-2:], (frame.t, fit.x + self._turn(frame.t))]
        seen_contrast = float(np.median((self.sight.polarity * fit.edges.contrast)[fit.weight > 0.1]))
        self.sight = replace(self.sight, contrast=(1.0 - SLOWLY) * self.sight.contrast + SLOWLY * seen_contrast)
        self._sharpen([fit], SLOWLY)
        self._learn(frame, fit)
        covariance, dx_dg, shared_information, shared_gradient = eliminate(fit)
        if self._misses(off):
            covariance = doubted_end(fit, covariance, off)
        return TrackedFrame(
            t=frame.t,
            theta=self.theta(frame.t),
            x=fit.x,
            covariance=covariance,
            reason="",
            dx_dg=dx_dg,
            shared_information=shared_information,
            shared_gradient=shared_gradient,
            sigma=fit.sigma,
            waves=fit.waves,
            outline_px=self.geometry.lens.bend(fit_outline(fit)),
        )

    def _judged(self, frame: Frame, fit: FrameFit, motion: ShapeMotion) -> tuple[FrameFit, Judged]:
        """A fit and its judgement. A fit that misses the seen end is led there; the better of both is taken."""
        assert self.sight is not None
        arm = (self.geometry, self.theta(frame.t), self.shared)
        judged = judge_frame(frame.image, arm, fit, self.sight)
        missed = self._misses(judged.end.off)
        led = self._fit(frame, led_to_end(fit.x, judged.end), motion, (5.0,)) if missed else None
        if led is None:
            return fit, judged
        again = judge_frame(frame.image, arm, led, self.sight)
        better = (bool(again.reason), again.end.off) < (bool(judged.reason), judged.end.off)
        return (led, again) if better else (fit, judged)

    def _misses(self, off: float) -> bool:
        """Whether a fit ends farther [px] beside the seen end than the coarse arcs explain."""
        return off > max(MISSED_END, MISSED_SHARE * self.geometry.length)

    def _starts(self, frame: Frame) -> Iterator[tuple[Array, ShapeMotion, tuple[float, ...]]]:
        """Starts of the fit: constant velocity, then the last shape with longer profiles, then a search of the
        picture.
        """
        assert self.sight is not None
        others = [entry for entry in self._history if entry[0] != frame.t][-2:]
        if others and self._lost < LOOK_AGAIN:
            motion = ShapeMotion(tuple(others))
            t1, last = others[-1]
            last = last - self._turn(t1)
            if len(others) == 2:
                t0, before = others[0]
                rate = (last + self._turn(t0) - before) / (t1 - t0)
                ahead = min(frame.t - t1, 2.0 * abs(t1 - t0)) if self._lost else frame.t - t1
                yield last + rate * ahead, motion, (10.0, 5.0)
            yield last, motion, (24.0, 12.0, 5.0)
        if not self._history or self._lost % LOOK_AGAIN == 0:
            polarities = (self.sight.polarity,)
            found = locate(frame.image, self.geometry, self.shared, self._known(frame.t), polarities, self.size)
            if found.score > LEAST_COARSE_SCORE:
                widest = 3.0 * max(self.geometry.length / 120.0, 1.0) + 6.0
                yield self._filled(found.x), ShapeMotion(), (widest, 10.0, 5.0)
