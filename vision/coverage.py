"""Exact area coverage of polygons and discs on the pixel grid (pixel centres at integers), for the renderer only."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from tentacle.compiled import njit

Array = NDArray[np.float64]
FINE_PIXELS = 3  # fine pixels per pixel side, on which the blur acts


@njit(cache=True)
def _accumulate(signed_area: Array, polygon: Array) -> None:
    """Add each edge's signed area to signed_area (H, W + 2), whose running sum along a row is the winding coverage."""
    height, width = signed_area.shape[0], signed_area.shape[1] - 2
    count = polygon.shape[0]
    for k in range(count):
        x0, y0 = polygon[k, 0] + 0.5, polygon[k, 1] + 0.5
        x1, y1 = polygon[(k + 1) % count, 0] + 0.5, polygon[(k + 1) % count, 1] + 0.5
        if y0 == y1:
            continue
        sign = 1.0
        if y0 > y1:
            x0, y0, x1, y1, sign = x1, y1, x0, y0, -1.0
        slope = (x1 - x0) / (y1 - y0)
        top, bottom = max(y0, 0.0), min(y1, float(height))
        row = int(np.floor(top))
        while row < bottom:
            a, b = max(top, float(row)), min(bottom, row + 1.0)
            if b > a:
                left = min(max(x0 + (a - y0) * slope, 0.0), float(width))
                right = min(max(x0 + (b - y0) * slope, 0.0), float(width))
                if left > right:
                    left, right = right, left
                piece = sign * (b - a)
                first, last = int(np.floor(left)), int(np.floor(right))
                if first == last:  # within one pixel: a trapezoid to the right of the edge
                    share = first + 1.0 - 0.5 * (left + right)
                    signed_area[row, first] += piece * share
                    signed_area[row, first + 1] += piece * (1.0 - share)
                else:
                    total = right - left
                    for column in range(first, last + 1):
                        begin, end = max(left, float(column)), min(right, column + 1.0)
                        height_here = piece * (end - begin) / total
                        inside = height_here * (column + 1.0 - 0.5 * (begin + end))
                        signed_area[row, column] += inside
                        signed_area[row, column + 1] += height_here - inside
            row += 1


def polygon_coverage(polygon: Array, size: tuple[int, int]) -> Array:
    """Share of each pixel that lies inside a polygon (P, 2) [px], overlaps counted once; (height, width)."""
    width, height = size
    coverage = np.zeros((height, width))
    left, top = np.clip(np.floor(polygon.min(axis=0)).astype(int) - 1, 0, size)
    right, bottom = np.clip(np.ceil(polygon.max(axis=0)).astype(int) + 2, 0, size)
    if left < right and top < bottom:
        signed_area = np.zeros((bottom - top, right - left + 2))
        _accumulate(signed_area, np.ascontiguousarray(polygon - (left, top), dtype=float))
        np.cumsum(signed_area, axis=1, out=signed_area)
        coverage[top:bottom, left:right] = np.minimum(np.abs(signed_area[:, :-2]), 1.0)
    return coverage


def blurred_coverage(polygons: list[Array], size: tuple[int, int], blur: float) -> Array:
    """Mean coverage (height, width) by polygons (P, 2) [px], seen through a normal blur of that many px.

    A lens blurs the light before the pixels collect it. A blur of the pixels' values would move an edge along a row by
    up to 0.01 px, depending on its place in the pixel. Therefore the blur acts on finer pixels here.
    """
    coverage = np.zeros(size[::-1])
    margin = int(4.0 * blur) + 2
    ends = np.array([[polygon.min(axis=0), polygon.max(axis=0)] for polygon in polygons])
    first = np.maximum(np.floor(ends[:, 0].min(axis=0)).astype(int), 0) - margin
    last = np.minimum(np.ceil(ends[:, 1].max(axis=0)).astype(int) + 1, size) + margin
    if np.any(last - first <= 2 * margin):
        return coverage
    width, height = (last - first).tolist()
    fine = np.zeros((FINE_PIXELS * height, FINE_PIXELS * width))
    for polygon in polygons:
        fine += polygon_coverage(
            (polygon - first + 0.5) * FINE_PIXELS - 0.5, (FINE_PIXELS * width, FINE_PIXELS * height)
        )
    fine = cv2.GaussianBlur(fine, (0, 0), FINE_PIXELS * blur)
    window = fine.reshape(height, FINE_PIXELS, width, FINE_PIXELS).mean(axis=(1, 3)) / len(polygons)
    left, top = np.maximum(first, 0)
    right, bottom = np.minimum(last, size)
    coverage[top:bottom, left:right] = window[top - first[1] : bottom - first[1], left - first[0] : right - first[0]]
    return coverage


def blend_disc(image: Array, centre: Array, radius: float, level: float, opacity: float) -> None:
    """Blend a disc into image (H, W), in place; coverage by distance, exact to some 0.01 px for radii above 1 px."""
    height, width = image.shape
    u, v = float(centre[0]), float(centre[1])
    left, right = max(int(u - radius - 2), 0), min(int(u + radius + 3), width)
    top, bottom = max(int(v - radius - 2), 0), min(int(v + radius + 3), height)
    if left >= right or top >= bottom:
        return
    columns, rows = np.arange(left, right), np.arange(top, bottom)[:, None]
    share = opacity * np.clip(radius + 0.5 - np.hypot(columns - u, rows - v), 0.0, 1.0)
    patch = image[top:bottom, left:right]
    patch += share * (level - patch)
