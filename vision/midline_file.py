"""A shape track as midlines, point by point: CSV that reads back as an import folder's midline.csv, or HDF5.

Columns t_s, s, x_m, y_m, sigma_m, curvature_1_m, width_m; one point a row, base frame. A rejected frame has no x_m and
on. sigma_m is the standard deviation of a point across the arm; the midline moves far less along it.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tentacle.errors import InputError
from tentacle.io.csv_table import write_csv
from tentacle.io.written_file import written_file
from tentacle.signals import Array, ShapeTrack
from tentacle.specimen import Specimen

MIDLINE_FILE_POINTS = 41
FINE_STEPS = 8  # steps of the quadrature between two points
LEAST_SIGMA = 1e-9  # m: at the base, which is the frame's origin up to a shift common to all frames


def midline_columns(
    shape: ShapeTrack, theta: Array, specimen: Specimen, points: int = MIDLINE_FILE_POINTS
) -> dict[str, Array]:
    """Each column (T, points) of the file; theta (T,) [rad] is the motor's angle at the track's times.

    The angle of the midline is phi = theta + offset + sum_j q_j s^j / j (eq. 2), its length is the declared one times
    the measured scale, its base is at the measured place. sigma follows from the coefficients' covariance.
    """
    count = shape.coefficients.shape[1]
    fine = np.linspace(0.0, 1.0, FINE_STEPS * (points - 1) + 1)
    middle = 0.5 * (fine[1:] + fine[:-1])
    powers = np.array([np.ones(len(middle)), *(middle**j / j for j in range(1, count))])
    phi = theta[:, None] + shape.coefficients @ powers
    step = specimen.length * shape.scale * np.diff(fine)
    start = np.zeros((len(theta), 1, 2))
    walk = np.stack([-np.sin(phi), np.cos(phi)], axis=2) * step[None, :, None]
    xy = shape.base_shift + np.concatenate([start, np.cumsum(walk, axis=1)], axis=1)
    turned = -np.stack([np.cos(phi), np.sin(phi)], axis=2) * step[None, :, None]
    moved = np.cumsum(powers.T[None, :, :, None] * turned[:, :, None], axis=1)[:, FINE_STEPS - 1 :: FINE_STEPS]
    normal = np.stack([np.cos(phi), np.sin(phi)], axis=2)[:, FINE_STEPS - 1 :: FINE_STEPS]
    across = np.einsum("tpkx,tpx->tpk", moved, normal)
    variance = np.einsum("tpi,tij,tpj->tp", across, shape.covariance, across)
    s = np.linspace(0.0, 1.0, points)
    bend = sum((shape.coefficients[:, [j]] * s ** (j - 1) for j in range(1, count)), np.zeros((len(theta), points)))
    sigma = np.concatenate([np.zeros((len(theta), 1)), np.sqrt(np.maximum(variance, 0.0))], axis=1)
    width = np.broadcast_to(2.0 * specimen.section.half_thickness(s), bend.shape)
    columns = {
        "t_s": np.repeat(shape.t[:, None], points, axis=1),
        "s": np.repeat(s[None], len(shape.t), axis=0),
        "x_m": xy[:, ::FINE_STEPS, 0],
        "y_m": xy[:, ::FINE_STEPS, 1],
        "sigma_m": np.maximum(sigma, LEAST_SIGMA),
        "curvature_1_m": bend / (specimen.length * shape.scale),
        "width_m": width.copy(),
    }
    for name in ("x_m", "y_m", "sigma_m", "curvature_1_m", "width_m"):
        columns[name] = np.where(shape.accepted[:, None], columns[name], np.nan)
    return columns


def write_midline(shape: ShapeTrack, theta: Array, specimen: Specimen, path: Path) -> None:
    """Write path, .csv or .h5, completely or not at all. HDF5 has each column (T, points), t_s and reason (T,)."""
    path = Path(path)
    columns = midline_columns(shape, theta, specimen)
    with written_file(path) as partial:
        if path.suffix == ".csv":
            write_csv(partial, {name: values.ravel() for name, values in columns.items()})
        elif path.suffix == ".h5":
            _write_hdf5(partial, shape, columns)
        else:
            raise InputError("not a name that says what to write", file=path, field="--midline", expected=".csv or .h5")


def _write_hdf5(path: Path, shape: ShapeTrack, columns: dict[str, Array]) -> None:
    import h5py  # what not everyone needs

    with h5py.File(path, "w") as file:
        file["t_s"], file["s"] = columns["t_s"][:, 0], columns["s"][0]
        for name in ("x_m", "y_m", "sigma_m", "curvature_1_m", "width_m"):
            file[name] = columns[name]
        file["coefficients_rad"], file["covariance_rad2"] = shape.coefficients, shape.covariance
        file["accepted"] = shape.accepted
        file["reason"] = list(shape.reason)
