"""The ASL trunk's motion capture (see tentacle.io.external_data) as recordings, one for each trajectory.

The measured frame: y vertically up, in metres; the arm hangs along -y from y = 0. Three discs are tracked, the third at
the tip. The source does not state the following; these values were chosen:

- A disc is a marker on the axis, at the depth that all discs have at rest to 1 mm. Its d is where it lies at rest
  beside the vertical under the clamp: the arm at rest counts as straight. Rest is the end of the decay itself: the tip
  comes to rest up to 10 mm from where it did before. The clamp is above the first disc.
  The rest of an arm with friction is not known better than it repeats: REST_SD.
- The plane of motion is the one of the tip's displacements (tentacle.plane). Its out-of-plane share is declared.
- A decay begins where the arm is free. The hand lets go of the tip first: the middle disc stays where it is for some
  0.13 s more. So the frames before the middle disc has gone BEGUN of its way are left out, and no release is declared.
- Friction acts in this arm: its moment follows its bend in loops with a steep turn at every reversal.
- The tendon-driven runs have no release and no known rest. They are declared as a passive clamped arm that is straight.
- The arm's mass and section are not known. Declared are a cone of 25 to 15 mm and a density of 800 +- 400 kg/m3: a mass
  of 0.32 +- 0.16 kg. Payloads are declared as 200 g also where 300 g hang there: that is the effect to be found.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from tentacle.declared import Uncertain
from tentacle.io.csv_table import CsvTable, read_csv
from tentacle.plane import plane_of_motion
from tentacle.recording import Declaration, Recording
from tentacle.signals import Array, Markers
from tentacle.specimen import AIR, HANGING_DOWN, Cone, Specimen

DECAYS = ("observations_manual_decay_200g", "observations_manual_decay_200g_2", "observations_manual_decay_300g")
DRIVEN = ("observations_controlled_1_0g", "observations_controlled_1_100g")
DISCS = ("disc1", "disc2", "disc3")
RATE = 100.0  # Hz
BEGUN = 0.1  # of the middle disc's way to rest: from there on the arm is free
REST_SD = (0.0003, 0.0016, 0.006)  # m: of each disc's rest, between the decays of one file
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
    rest = points[-LAST_FRAMES:].mean(axis=0)
    return _recording(name, points, rest, DECLARED_PAYLOAD, _first_free(points[:, 1], rest[1]))


def _first_free(path: Array, rest: Array) -> int:
    """The first frame at which a disc (T, 3) [m] has gone BEGUN of its way to rest."""
    gone = np.linalg.norm(path - path[0], axis=1)
    return int(np.argmax(gone > BEGUN * np.linalg.norm(path[0] - rest)))


def _recording(name: str, points: Array, rest: Array, payload: float, first: int = 0) -> Recording:
    """The recording of the frames from `first` on."""
    plane = plane_of_motion(points[:, -1] - rest[-1], DOWN)
    specimen = Specimen(Cone(0.025, 0.015), LENGTH, DENSITY, payload, laws=("dry_friction",))
    points = points[first:]
    markers = Markers(
        t=(first + np.arange(points.shape[0])) / RATE,
        names=DISCS,
        s=DISC_S,
        d=np.round(plane.coordinates(rest - CLAMP_PLACE)[:, 0], 6),
        xy=np.round(plane.coordinates(points - CLAMP_PLACE), 7),
    )
    density = Uncertain("specimen.density_kg_m3", DENSITY, DENSITY_SD, 10.0)
    beside = zip(DISCS, markers.d.tolist(), REST_SD, strict=True)
    places = (Uncertain(f"markers.{disc}.d", d, sd) for disc, d, sd in beside)
    notes = {
        "source": "github.com/StanfordASL/trunk-stack",
        "geometry": "see tentacle/io/trunk_payload.py",
    }
    share = round(plane.out_of_plane, 4)
    declaration = Declaration(specimen, AIR, HANGING_DOWN, out_of_plane=share, uncertain=(density, *places))
    return Recording(name, declaration, markers=markers, notes=notes)
