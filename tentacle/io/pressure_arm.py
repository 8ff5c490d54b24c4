"""The pneumatic arm's motion capture (see tentacle.io.external_data) as recordings.

The measured frame, in mm: x along the arm, from the clamp (about 22.7) to the tip plate (about 127); it bends mostly
along y. The source does not state the following; these values were chosen:

- The base's markers lie in the clamp's face: the arm's length is the tip markers' distance from it.
- The tip's markers are points of the tip plate, s = 1; the axis is halfway between the lowest and the highest of them.
  An arm at rest counts as straight.
- The arm is declared as a passive cone of silicone, which it is not. Its pressure was not recorded: the missing cause.
- The direction of gravity is not stated. Its angle is declared as a range from -pi to pi.
- The section and the mass are not stated: a radius of 20 mm and, as the chambers are hollow, 700 +- 300 kg/m3.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from tentacle.declared import Uncertain
from tentacle.io.csv_table import CsvTable, read_csv
from tentacle.plane import plane_of_motion
from tentacle.recording import Declaration, Recording
from tentacle.signals import Array, Markers
from tentacle.specimen import AIR, Cone, Gravity, Specimen

PRESSURE_FILES = ("arm_150mbar", "arm_300mbar")
BASE, TIP = ("base1", "base2", "base3", "base4"), ("tip1", "tip2", "tip3")
FRAMES_AT_REST = 50  # frames before the pressure comes, in both runs
RADIUS = 0.02  # m
DENSITY, DENSITY_SD = 700.0, 300.0  # kg/m^3


def read_pressure_arms(folder: Path) -> Iterator[Recording]:
    """Every run of the set as a recording; InputError where a file is not such a CSV."""
    for name in PRESSURE_FILES:
        yield read_pressure_arm(folder / f"{name}.csv")


def read_pressure_arm(file: Path) -> Recording:
    """One run's CSV as a recording with markers; InputError where the file is not such a CSV."""
    columns = [f"{marker}_{axis}_mm" for marker in (*BASE, *TIP) for axis in "xyz"]
    table = read_csv(file, ("t_s", *columns), extra_allowed=True)
    table.require_rising("t_s")
    clamp = _metres(table, BASE)[:FRAMES_AT_REST].mean(axis=(0, 1))
    points = _metres(table, TIP)
    rest = points[:FRAMES_AT_REST].mean(axis=0)
    plane = plane_of_motion((points - rest).mean(axis=1), np.array([1.0, 0.0, 0.0]))
    at_rest = plane.coordinates(rest)
    axis = 0.5 * (at_rest[:, 0].min() + at_rest[:, 0].max())
    foot = np.array([axis, plane.coordinates(clamp)[1]])
    length = round(float(at_rest[:, 1].max() - foot[1]), 5)
    markers = Markers(
        t=table["t_s"],
        names=TIP,
        s=np.round(np.minimum((at_rest[:, 1] - foot[1]) / length, 1.0), 5),
        d=np.round(at_rest[:, 0] - foot[0], 7),
        xy=np.round(plane.coordinates(points) - foot, 8),
    )
    declaration = Declaration(
        Specimen(Cone(RADIUS, RADIUS), length, DENSITY),
        AIR,
        Gravity(0.0),
        out_of_plane=round(plane.out_of_plane, 4),
        uncertain=(
            Uncertain("specimen.density_kg_m3", DENSITY, DENSITY_SD, 10.0),
            Uncertain("gravity.angle_rad", 0.0, None, -math.pi, math.pi),
        ),
    )
    notes = {
        "source": "github.com/srl-ethz/diffPD_sim2real",
        "geometry": "see tentacle/io/pressure_arm.py",
    }
    return Recording(file.stem, declaration, markers=markers, notes=notes)


def _metres(table: CsvTable, markers: tuple[str, ...]) -> Array:
    """Markers (T, M, 3) [m]."""
    return 1e-3 * np.stack(
        [np.stack([table[f"{name}_{axis}_mm"] for axis in "xyz"], axis=-1) for name in markers], axis=1
    )
