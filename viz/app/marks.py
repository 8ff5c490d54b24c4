"""The points clicked on a film's first picture, and the declared arm drawn over the picture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from tentacle.errors import InputError
from tentacle.recording import Camera

Point = tuple[float, float]
MARK_PLACES = ("base", "tip", "width", "ruler start", "ruler end")
MARK_COLOURS = {
    "base": "#d55e00",
    "tip": "#0072b2",
    "width": "#cc79a7",
    "ruler start": "#009e73",
    "ruler end": "#009e73",
}


@dataclass(frozen=True)
class Marks:
    """Points (u, v) [px] by place, lengths [m]: of the arm, and of the ruler whose ends were clicked.

    A length is None while it is not known.
    """

    points: dict[str, Point]
    length: float | None = None
    ruler: float | None = None

    def with_point(self, place: str, point: Point) -> Marks:
        """With one place clicked anew."""
        return replace(self, points={**self.points, place: point})

    @classmethod
    def proposed(cls, base: Point, tip: Point, width: float) -> Marks:
        """Marks at a proposed base and tip, and at the arm's edge beside the base, half its width [px] aside."""
        du, dv = cls({"base": base, "tip": tip}).direction()
        return cls({"base": base, "tip": tip, "width": (base[0] + 0.5 * width * dv, base[1] - 0.5 * width * du)})

    def metres_per_px(self) -> float:
        """The scale: by the ruler where both its ends are clicked, else by the arm from base to tip."""
        names, metres = (("ruler start", "ruler end"), self.ruler)
        if not all(name in self.points for name in names):
            names, metres = ("base", "tip"), self.length
        missing = [name for name in names if name not in self.points]
        if missing:
            raise InputError("not clicked yet", field=" and ".join(missing), expected="a point on the picture")
        if metres is None:
            raise InputError("its length is not given yet", field=" to ".join(names), expected="a length in metres")
        pixels = math.dist(self.points[names[0]], self.points[names[1]])
        if pixels < 2.0 or not metres > 0.0:
            raise InputError("too short to tell the scale", field=" to ".join(names), expected="two points apart")
        return metres / pixels

    def camera(self, fps: float, mirrored: bool = False) -> Camera:
        """The camera that these marks declare."""
        for name in ("base", "tip"):
            if name not in self.points:
                raise InputError("not clicked yet", field=name, expected="a point on the picture")
        return Camera(fps, self.metres_per_px(), self.points["base"], self.direction(), mirrored=mirrored)

    def direction(self) -> Point:
        """Unit vector from base to tip."""
        (u0, v0), (u1, v1) = self.points["base"], self.points["tip"]
        far = math.hypot(u1 - u0, v1 - v0)
        if far < 2.0:
            raise InputError("base and tip are the same point", field="tip", expected="the arm's far end")
        return ((u1 - u0) / far, (v1 - v0) / far)

    def base_radius(self) -> float | None:
        """Half the thickness [m] at the clicked edge of the arm beside its base; None where it was not clicked."""
        if "width" not in self.points or "base" not in self.points:
            return None
        (du, dv), (u0, v0), (u, v) = self.direction(), self.points["base"], self.points["width"]
        return abs((u - u0) * dv - (v - v0) * du) * self.metres_per_px()


def arm_outline(camera: Camera, length: float, radii: tuple[float, float], angle: float) -> list[Point]:
    """The straight arm's four corners [px], turned about its base by angle [rad] as the servo turns it."""
    (nu, nv), (au, av) = camera.normal_px, camera.arm_px
    along = (-math.sin(angle), math.cos(angle))  # in (n, arm): theta turns y towards -x
    across = (math.cos(angle), math.sin(angle))
    corners = []
    for share, side in ((0.0, 1.0), (1.0, 1.0), (1.0, -1.0), (0.0, -1.0)):
        radius = radii[0] + (radii[1] - radii[0]) * share
        x, y = (share * length * a + side * radius * b for a, b in zip(along, across, strict=True))
        u = camera.base_px[0] + (x * nu + y * au) / camera.metres_per_px
        v = camera.base_px[1] + (x * nv + y * av) / camera.metres_per_px
        corners.append((u, v))
    return corners


def drawing(marks: Marks, arm: Sequence[Point], size: float) -> str:
    """SVG over the picture: every mark with its name, the ruler, the declared arm's outline. size [px]: of a mark.

    The page sets --names, by which a name grows on a small screen.
    """
    parts = []
    if arm:
        corners = " ".join(f"{u:.1f},{v:.1f}" for u, v in arm)
        for ink, width in (("#000000a0", 0.8), ("#f0e442", 0.35)):  # seen on light and on dark
            parts.append(f'<polygon points="{corners}" fill="none" stroke="{ink}" stroke-width="{width * size:.1f}"/>')
    ruler = [marks.points[name] for name in ("ruler start", "ruler end") if name in marks.points]
    for (u0, v0), (u1, v1) in pairwise(ruler):
        line = f'x1="{u0:.1f}" y1="{v0:.1f}" x2="{u1:.1f}" y2="{v1:.1f}"'
        parts.append(f'<line {line} stroke="{MARK_COLOURS["ruler start"]}" stroke-width="{0.35 * size:.1f}"/>')
    for place, (u, v) in marks.points.items():
        side, anchor = (-1.5, "end") if place in ("base", "ruler start") else (1.5, "start")
        edge = f'stroke="white" stroke-width="{0.3 * size:.1f}"'
        parts.append(f'<circle cx="{u:.1f}" cy="{v:.1f}" r="{size:.1f}" fill="{MARK_COLOURS[place]}" {edge}/>')
        letters = f"font-size: calc({2.6 * size:.1f}px * var(--names, 1))"
        where = f'x="{u + side * size:.1f}" y="{v:.1f}" text-anchor="{anchor}" style="{letters}"'
        ink = f'fill="{MARK_COLOURS[place]}" stroke="white" stroke-width="{0.5 * size:.1f}" paint-order="stroke"'
        parts.append(f"<text {where} {ink}>{place}</text>")
    return "".join(parts)
