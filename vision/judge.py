"""Checks of a fitted frame: the rendered silhouette against the picture, lost edges, coils, the border."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from tentacle.signals import Array
from vision.edge_look import EdgeLook
from vision.edges import grey_at
from vision.fit import FrameFit
from vision.kinematics import Geometry, Outline
from vision.reach import SeenEnd, seen_reach

LEAST_FOUND = 0.5  # share of the arm's stretches that must be seen, by a quarter of their side edges
STRETCHES, TIP_SEEN = 20, 0.85  # of the arm: share up to which the sides must be seen if the tip is seen
MOST_DISAGREEMENT = 0.12  # share of the silhouette's probes with the wrong grey
MOST_SCATTER = 1.0  # px, standard deviation of an edge of full weight
LAST, LEAST_TIP = 0.08, 0.35  # of the arm: place of the check of the tip's contrast; its least share of the usual
INSIDE_PROBES = np.array([-0.6, 0.0, 0.6])  # of the radius: probes inside
TIP_OFF, LEAST_TIP_OFF = 0.025, 2.0  # of the arm, px: range beside the fit in which a tip is searched
GOES_ON, LEAST_ON = 0.03, 4.0  # of the arm, px: range beyond the fit's end in which the arm is searched
MARGINS = np.array([4.0, 7.0])  # px beyond the edge: probes outside
_MIDDLES = (np.arange(STRETCHES) + 0.5) / STRETCHES


class Judged(NamedTuple):
    """The reason of a rejection in a short phrase, "" for an accepted frame; and where its arm is seen to end."""

    reason: str
    end: SeenEnd


def judge_frame(image: NDArray[np.uint8], arm: tuple[Geometry, float, Array], fit: FrameFit, sight: EdgeLook) -> Judged:
    """Whether a fitted frame can be trusted. arm: geometry, motor's angle [rad], recording's parameters (G,)."""
    geometry, theta, shared = arm
    end = seen_reach(image, geometry, geometry.midline(theta, fit.x, shared), shared, sight)
    return Judged(_why_rejected(image, arm, fit, sight, end), end)


def _why_rejected(
    image: NDArray[np.uint8], arm: tuple[Geometry, float, Array], fit: FrameFit, sight: EdgeLook, end: SeenEnd
) -> str:
    geometry, theta, shared = arm
    height, width = image.shape
    centre, phi = geometry.midline(theta, fit.x, shared)
    radius = geometry.radius_at(shared)
    expected = fit.expected
    carries = fit.weight > 0.05
    sides = expected.kind < 2
    there = _seen_stretches(expected, sides, sides & carries)
    until = float(np.flatnonzero(there)[-1] + 1) / len(there) if there.any() else 0.0  # beyond it: extrapolated
    off, beyond = end.off, (end.share - 1.0) * geometry.length
    seen = geometry.lens.bend(centre)
    inside = (seen > 1.0).all(axis=1) & (seen[:, 0] < width - 2) & (seen[:, 1] < height - 2)
    hidden_tip = (until <= TIP_SEEN and not abs(beyond) < LEAST_ON) or not inside[-1]
    followed = slice(0, max(round(until * (len(centre) - 1)), 2) if hidden_tip else None)
    centre, phi, radius = centre[followed], phi[followed], radius[followed]
    if inside[followed].mean() < 0.95:
        return "the arm leaves the picture"
    if np.ptp(phi) > 1.7 * np.pi or _touches_itself(centre, radius):
        return "coiled"
    if there.mean() < LEAST_FOUND:
        return "edges lost"
    if fit.sigma > MOST_SCATTER:
        return "edges scatter"
    if hidden_tip:
        course = geometry.midline(theta, fit.x, shared)
        on, off = seen_reach(image, geometry, course, shared, sight, until)[:2]
        if off > LEAST_TIP_OFF and (on - until) * geometry.length > LEAST_ON:
            return "the arm goes on beside the fit"
    else:
        if _tip_contrast(image, geometry, centre, phi, radius, sight) < LEAST_TIP:
            return "the tip is not where the fit ends"
        if off > max(TIP_OFF * geometry.length, LEAST_TIP_OFF):
            return "the tip is not where the fit ends"
        if beyond > max(GOES_ON * geometry.length, LEAST_ON):
            return "the arm goes on beyond the fit's end"
    stations = np.interp(np.arange(len(centre)) / (len(geometry.radius) - 1), _MIDDLES, there) > 0.5
    if _disagreement(image, geometry, (centre, phi, radius), sight, stations) > MOST_DISAGREEMENT:
        return "silhouette disagrees"
    return ""


def _seen_stretches(expected: Outline, sides: NDArray[np.bool_], carry: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether each stretch (STRETCHES,) of the arm has a quarter of its side edges."""
    bins = np.linspace(0.0, 1.0, STRETCHES + 1)
    return np.histogram(expected.s[carry], bins)[0] > 0.25 * np.histogram(expected.s[sides], bins)[0]


def _tip_contrast(
    image: NDArray[np.uint8], geometry: Geometry, centre: Array, phi: Array, radius: Array, sight: EdgeLook
) -> float:
    """Contrast of the arm's last stretch with its surroundings, over the usual one of such a thin stretch."""
    pick = np.unique(np.linspace((1.0 - LAST) * (len(centre) - 1), len(centre) - 2, 16).astype(int))
    normals = np.cos(phi[pick])[:, None] * geometry.normal + np.sin(phi[pick])[:, None] * geometry.arm
    aside = (radius[pick] + MARGINS[0])[:, None] * normals
    probes = np.concatenate([centre[pick], centre[pick] + aside, centre[pick] - aside])
    grey = grey_at(image, geometry.lens.packed, np.ascontiguousarray(probes)).reshape(3, -1)
    seen = sight.polarity * (0.5 * (grey[1] + grey[2]) - grey[0])
    usual = sight.contrast_at(pick / (len(centre) - 1.0)) * erf(radius[pick] / (np.sqrt(2.0) * sight.blur))
    there = np.isfinite(seen)
    return float(np.median((seen / usual)[there])) if np.count_nonzero(there) > len(pick) // 2 else 1.0


def _touches_itself(centre: Array, radius: Array) -> bool:
    """True where two parts of the arm that are not neighbours overlap in the picture."""
    pick = np.linspace(0, len(centre) - 1, 40).astype(int)
    points, thick = centre[pick], radius[pick]
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    apart = np.linalg.norm(points[:, None] - points[None], axis=2)
    reach = thick[:, None] + thick[None]
    return bool(np.any((apart < reach) & (np.abs(arc[:, None] - arc[None]) > 2.0 * reach + 4.0)))


def _disagreement(
    image: NDArray[np.uint8],
    geometry: Geometry,
    course: tuple[Array, Array, Array],
    sight: EdgeLook,
    stations: NDArray[np.bool_],
) -> float:
    """Share of probes whose grey lies on the wrong side of the local threshold half way between inside and outside.

    course: centre, phi, radius of each station; those with edges (S + 1,) are looked at.
    """
    centre, phi, radius = course
    pick = np.linspace(0, len(centre) - 1, 62).astype(int)[1:-1]
    pick = pick[stations[pick]]
    cosine, sine = np.cos(phi[pick])[:, None], np.sin(phi[pick])[:, None]
    normals = cosine * geometry.normal + sine * geometry.arm
    within = radius[pick, None] * INSIDE_PROBES
    beyond = radius[pick, None] + MARGINS
    distance = np.concatenate([within, beyond, -beyond], axis=1)
    probes = (centre[pick, None] + distance[:, :, None] * normals[:, None]).reshape(-1, 2)
    grey = sight.polarity * grey_at(image, geometry.lens.packed, np.ascontiguousarray(probes)).reshape(distance.shape)
    whole = np.isfinite(grey).all(axis=1)  # a station at the picture's border has too few pixels
    if np.count_nonzero(whole) < 20:
        return 1.0
    grey, radius = grey[whole], radius[pick][whole]
    middle = np.median(grey[:, : len(INSIDE_PROBES)], axis=1)
    outside = np.median(grey[:, len(INSIDE_PROBES) :], axis=1)
    # the light changes slowly along the arm: a wide median is not biased by a hidden part
    middles = np.arange(5, len(grey), 10)
    half_way = 0.5 * (middle + outside)
    wide = [np.median(half_way[max(i - 15, 0) : i + 16]) for i in middles]
    threshold = np.interp(np.arange(len(grey)), middles, wide)
    wrong_inside = grey[:, : len(INSIDE_PROBES)] > threshold[:, None]
    wrong_outside = grey[:, len(INSIDE_PROBES) :] < threshold[:, None]
    wrong_inside &= radius[:, None] > 2.0  # at a thinner tip arm and ground mix in one pixel
    return float(np.concatenate([wrong_inside, wrong_outside], axis=1).mean())
