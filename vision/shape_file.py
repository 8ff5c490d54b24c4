"""A shape track as a CSV file: one row a frame, coefficients, the upper triangle of their covariance, why rejected."""

from __future__ import annotations

from pathlib import Path

from tentacle.io.written_file import write_text
from tentacle.signals import ShapeTrack


def write_shape(shape: ShapeTrack, path: Path) -> None:
    """Write t_s, accepted, offset_rad, q1_rad .., cov_j_k [rad^2] (0 is the offset), reason; whole or not at all.

    All digits are kept; a rejected frame has blank cells.
    """
    size = shape.coefficients.shape[1]
    pairs = [(j, k) for j in range(size) for k in range(j, size)]
    names = ["t_s", "accepted", "offset_rad", *(f"q{j}_rad" for j in range(1, size))]
    lines = [",".join([*names, *(f"cov_{j}_{k}" for j, k in pairs), "reason"])]
    for row, t in enumerate(shape.t.tolist()):
        values = [*shape.coefficients[row].tolist(), *(float(shape.covariance[row, j, k]) for j, k in pairs)]
        cells = ["" if value != value else repr(value) for value in values]
        lines.append(",".join([repr(t), str(int(shape.accepted[row])), *cells, shape.reason[row].replace(",", ";")]))
    write_text(Path(path), "\n".join(lines) + "\n")
