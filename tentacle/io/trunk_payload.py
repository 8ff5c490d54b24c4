"""The ASL trunk's motion capture (see tentacle.io.external_data) as recordings, one for each trajectory.

The measured frame: y vertically up, in metres; the arm hangs along -y from y = 0. Three discs are tracked, the third at
the tip. The source does not state the following; these values were chosen:

- A disc is a marker on the axis, at the depth that all discs have at rest to 1 mm. Its d is where it lies at rest
  beside the vertical under the clamp: the arm at rest counts as straight. Rest is the end of the decay itself: the tip
  comes to rest up to 10 mm from where it did before. The clamp is above the first disc.
- The plane of motion is the one of the tip's displacements (tentacle.plane). Its out-of-plane share is declared.
- The time of the release comes from the tip's path (tentacle.release), with its standard deviation.
- The tendon-driven runs have no release and no known rest. They are declared as a passive clamped arm that is straight.
- The arm's mass and section are not known. Declared are a cone of 25 to 15 mm and a density of 800 +- 400 kg/m3: a mass
  of 0.32 +- 0.16 kg. Payloads are declared as 200 g also where 300 g hang there: that is the effect to be found.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from tentacle.declared import Uncertain
from tentacle.io.csv_table import CsvTable, read_csv
from tentacle.plane import plane_of_motion
from tentacle.recording import Declaration, Recording
from tentacle.release import find_release
from tentacle.signals import Array, Markers
from tentacle.specimen import AIR, HANGING_DOWN, Cone, Specimen

DECAYS = ("observations_manual_decay_200g", "observations_manual_decay_200g_2", "observations_manual_decay_300g")
DRIVEN = ("observations_controlled_1_0g", "observations_controlled_1_100g")
DISCS = ("disc1", "disc2", "disc3")
RATE = 100.0  # Hz
LAST_FRAMES = 145  # frames at a decay's end: two periods of 1.4 Hz, over which the remaining swing averages out
DENSITY, DENSITY_SD = 800.0, 400.0  # kg/m^3
DECLARED_PAYLOAD = 0.2  # kg, in the decays
DOWN = np.array([0.0, -1.0, 0.0])
CLAMP_PLACE = np.array([0.1006, 0.0, 0.1044])  # m
LENGTH = 0.3215  # m
DISC_S = np.array([0.3294, 0.6311, 1.0])


def read_trunk(folder: Path) -> Iterator[Recording]:
    """Every run of the set as a recording; InputError where a file is not such a CSV."""
    for name in DECAYS:
        yield from read_decays(folder / f"{name}.csv")
    for name in DRIVEN:
        yield read_driven(folder / f"{name}.csv")


def read_decays(file: Path) -> list[Recording]:
    """The decays of one file, in the order of their ID; InputError where the file is not such a CSV."""
    table = read_csv(file, ("ID", *_columns()), extra_allowed=True)
    number, points = table["ID"], _points(table)
    stem = file.stem.removeprefix("observations_manual_")
    return [_decay(f"{stem}_{k:02d}", points[number == ID]) for k, ID in enumerate(np.unique(number))]


def read_driven(file: Path) -> Recording:
    """A run whose tendons move the arm, declared as a passive arm; InputError where the file is not such a CSV."""
    points = _points(read_csv(file, _columns(), extra_allowed=True))
    straight = CLAMP_PLACE + LENGTH * DISC_S[:, None] * DOWN
    return _recording(file.stem.removeprefix("observations_"), points, straight, 0.0)


def _columns() -> tuple[str, ...]:
    return tuple(f"{axis}{disc}" for disc in (1, 2, 3) for axis in "xyz")


def _points(table: CsvTable) -> Array:
    """The discs (T, 3, 3) [m]."""
    return np.stack([np.stack([table[f"{axis}{disc}"] for axis in "xyz"], axis=-1) for disc in (1, 2, 3)], axis=1)


def _decay(name: str, points: Array) -> Recording:
    t = np.arange(points.shape[0]) / RATE
    release = find_release(t, points[:, -1])
    recording = _recording(name, points, points[-LAST_FRAMES:].mean(axis=0), DECLARED_PAYLOAD)
    if release is None:
        return recording
    number = Uncertain("release.t_s", release.time, release.sd, 0.0)
    declaration = recording.declaration
    declared = replace(declaration, release_t=release.time, uncertain=(*declaration.uncertain, number))
    return Recording(name, declared, markers=recording.markers, notes=recording.notes)


def _recording(name: str, points: Array, rest: Array, payload: float) -> Recording:
    plane = plane_of_motion(points[:, -1] - rest[-1], DOWN)
    specimen = Specimen(Cone(0.025, 0.015), LENGTH, DENSITY, payload)
    markers = Markers(
        t=np.arange(points.shape[0]) / RATE,
        names=DISCS,
        s=DISC_S,
        d=np.round(plane.coordinates(rest - CLAMP_PLACE)[:, 0], 6),
        xy=np.round(plane.coordinates(points - CLAMP_PLACE), 7),
    )
    density = Uncertain("specimen.density_kg_m3", DENSITY, DENSITY_SD, 10.0)
    notes = {
        "source": "github.com/StanfordASL/trunk-stack",
        "geometry": "see tentacle/io/trunk_payload.py",
    }
    share = round(plane.out_of_plane, 4)
    declaration = Declaration(specimen, AIR, HANGING_DOWN, out_of_plane=share, uncertain=(density,))
    return Recording(name, declaration, markers=markers, notes=notes)
