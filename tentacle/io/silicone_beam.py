"""The silicone beam's motion capture (see tentacle.io.external_data) as recordings.

The measured frame: x vertically up, z along the beam, y across it. The base frame of the recordings: y along the beam,
n up; gravity pulls along -n, so its angle is -pi/2. The source does not state the geometry. It was chosen as follows:

- Before the release the beam is supported straight. A marker is a point of the material, and its (s, d) is where it
  lies in that straight pose. Curvature vanishes at the free end, so this holds for a marker that stands off the face.
- The foremost tip marker is assumed on the tip face, s = 1. The clamp's face is then 100 mm behind it, at z = -24.5 mm
(gravity) and -27.6 mm (load52). The clamp's markers lie at -18 to -24 mm, their balls in front of that
  face. The drop under its own weight, 6.6 mm, over the rotation of the tip markers, 0.079 rad, gives 101 mm (bending
  and shear).
- The axis is halfway between the upper and the lower tip marker, which are 29 mm apart on a face of 30 mm.
- The release is the time at which the first 3 mm of free fall extrapolate to zero; the samples of a run agree to 3 ms.
The supporting hand does not let go at once: load52_V2_b moves by 0.15 mm in the 0.1 s before.
- load52 is declared as the bare beam; the clamp moves by 0.1 mm, which is left out.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from tentacle.io.csv_table import CsvTable, read_csv
from tentacle.recording import Declaration, Recording
from tentacle.signals import Array, Markers
from tentacle.specimen import AIR, STANDARD_GRAVITY, Gravity, Rectangle, Specimen

BEAM_FILES = ("beam_gravity_V2_a", "beam_gravity_V2_b", "beam_load52_V2_a", "beam_load52_V2_b")
BEAM_MARKERS = ("Tip-1", "Tip-2", "Tip-3")
BEAM = Specimen(Rectangle(0.03, 0.03), length=0.1, density=1070.0)
QUIET_SECONDS = 0.3  # from the start: supported in all four runs
SMALLEST_FALL, LARGEST_FALL = 0.1e-3, 3.0e-3  # m: over the noise and the hand's tremor; still a free fall
FALL_SECONDS = 0.05


def read_beams(folder: Path) -> Iterator[Recording]:
    """Every run of the set as a recording; InputError where a file is not such a CSV."""
    for name in BEAM_FILES:
        yield read_beam(folder / f"{name}.csv")


def read_beam(file: Path) -> Recording:
    """One run's CSV as a recording with markers; InputError where the file is not such a CSV."""
    columns = [f"{marker}_{axis}_mm" for marker in BEAM_MARKERS for axis in "xz"]
    table = read_csv(file, ("t_s", *columns), extra_allowed=True)
    table.require_rising("t_s")
    t = table["t_s"]
    height, along = (np.stack([_metres(table, marker, axis) for marker in BEAM_MARKERS], axis=1) for axis in "xz")
    quiet = t < QUIET_SECONDS
    straight_height, straight_along = height[quiet].mean(axis=0), along[quiet].mean(axis=0)
    clamp = straight_along.max() - BEAM.length
    axis_height = 0.5 * (straight_height.max() + straight_height.min())
    markers = Markers(
        t=t,
        names=BEAM_MARKERS,
        s=(straight_along - clamp) / BEAM.length,
        d=straight_height - axis_height,
        xy=np.stack([height - axis_height, along - clamp], axis=-1),
    )
    return Recording(
        name=file.stem,
        declaration=Declaration(
            BEAM, AIR, Gravity(-0.5 * np.pi), release_t=release_time(t, straight_height.mean() - height.mean(axis=1))
        ),
        markers=markers,
        notes={"source": "github.com/srl-ethz/diffPD_sim2real", "geometry": "see tentacle/io/silicone_beam.py"},
    )


def _metres(table: CsvTable, marker: str, axis: str) -> Array:
    return np.round(1e-3 * table[f"{marker}_{axis}_mm"], 8)  # the file has 0.1 micrometre


def release_time(t: Array, drop: Array) -> float:
    """Start of a fall from rest [s]: t (N,) [s], drop (N,) [m] of the tip.

    Except near its root, a released beam first falls freely: drop = g (t - release)^2 / 2.
    """
    first = int(np.argmax(drop > LARGEST_FALL))
    falling = np.arange(len(t)) < first
    falling &= (drop > SMALLEST_FALL) & (t > t[first] - FALL_SECONDS)
    return float(np.median(t[falling] - np.sqrt(2.0 * drop[falling] / STANDARD_GRAVITY)))
