"""The validity map: the reduced model's error against the reference over frequency, amplitude, taper and
slenderness.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from tentacle.specimen import Cone, Gravity

if TYPE_CHECKING:
    from pathlib import Path

    from tentacle.model import Model
    from tentacle.runner import Runner
    from tentacle.signals import Array

MAP_ORDERS = (2, 3, 4)
RATIOS = (0.15, 0.3, 0.5, 0.8, 1.2, 1.8)  # driving frequency over the first mode in the fluid
AMPLITUDES = (0.05, 0.1, 0.2, 0.4, 0.8)  # rad
LEVELS = (0.01, 0.05, 0.10)
PERIODS, MEASURED_PERIODS = 7.0, 2.0
VERSION = "2"


@dataclass(frozen=True)
class Validity:
    """Relative errors over amplitude (A,) and frequency ratio (F,), for one arm, by order: shape (O, A, F), thrust
    (O, A, F).

    shape: rms distance of the midlines over the tip's rms motion. thrust: of the mean, NaN where the mean is under 1 %
    of the load's rms or the fluid is air. flexibility (A, F): drag on the arm over its stiffness,
    rho w (2 pi f theta L)^2 L^3 / (2 E I0). frequency (O,): relative error of the first mode. first [Hz]. taper:
    r_tip / r0; slenderness: L / r0 (rectangle: half the width).
    """

    taper: float
    slenderness: float
    first: float
    shape: Array
    thrust: Array
    flexibility: Array
    frequency: Array

    @property
    def label(self) -> str:
        """The arm's dimensionless groups, in words."""
        return f"taper {self.taper:.3g}, L/r0 {self.slenderness:.3g}"

    def reach(self, order: int, level: float, amplitude: int, errors: Array | None = None) -> float:
        """The largest frequency ratio up to which the shape error stays below level; 0 if there is none.

        errors (O, A, F): other errors than the shape's; NaN counts as small.
        """
        row = (self.shape if errors is None else errors)[MAP_ORDERS.index(order), amplitude]
        bad = np.flatnonzero(~(row <= level) if errors is None else row > level)
        return 0.0 if bad.size and bad[0] == 0 else RATIOS[(bad[0] if bad.size else row.size) - 1]


def validity_cell(task: Mapping[str, Any]) -> dict[str, Any]:
    """One cell: the reference and the reduced model of every order under one sine. task: model tables, amplitude,
    Hz."""
    from tentacle.io.model_file import parse_model
    from tentacle.io.toml_table import Table
    from tentacle.waveform import Ramped, Sine
    from validation.model_pair import affine_twin, reference_twin, shape_error

    model = parse_model(Table(dict(task["model"]), file=None))
    frequency = task["frequency"]
    wave = Ramped(Sine(task["amplitude"], frequency), 2.0 / frequency)
    duration, window = PERIODS / frequency, MEASURED_PERIODS / frequency
    fps = 32.0 * frequency
    reference = reference_twin(model, wave, duration, fps, task["links"])
    mean = reference.mean_load(window)
    inside = reference.t > reference.t[-1] - window + 1e-9
    rms = float(np.sqrt(np.mean(reference.load[inside] ** 2)))
    found: dict[str, Any] = {"thrust_n": mean, "shape": [], "thrust": []}
    for order in MAP_ORDERS:
        twin = affine_twin(model, order, wave, duration, fps)
        found["shape"].append(_finite(shape_error(twin, reference, window)[1]))
        told = model.fluid.density > 0.0 and abs(mean) > 0.01 * rms
        found["thrust"].append(_finite(abs(twin.mean_load(window) / mean - 1.0)) if told else None)
    return found


def _finite(number: float) -> float | None:
    return float(number) if np.isfinite(number) else None


def own_taper(model: Model) -> float:
    """r_tip / r0; 1 for a rectangle."""
    section = model.specimen.section
    return section.tip_radius / section.base_radius if isinstance(section, Cone) else 1.0


def own_slenderness(model: Model) -> float:
    """L over half the width at the base."""
    return model.specimen.length / float(0.5 * model.specimen.section.width(0.0))


def variants(model: Model, tapers: Sequence[float], slendernesses: Sequence[float]) -> list[Model]:
    """The model, then it with each of the other tapers, then with each of the other L / r0 (cones only).

    All keep their length.
    """
    section, length = model.specimen.section, model.specimen.length
    if not isinstance(section, Cone):
        return [model]
    taper, radius = own_taper(model), section.base_radius
    wanted = [(t, radius) for t in tapers if abs(t - taper) > 1e-9]
    wanted += [(taper, length / s) for s in slendernesses if abs(s - own_slenderness(model)) > 1e-9]
    cones = [Cone(base, ratio * base) for ratio, base in wanted]
    return [model, *(replace(model, specimen=replace(model.specimen, section=cone)) for cone in cones)]


def validity_maps(models: Sequence[Model], runner: Runner, links: int = 20) -> list[Validity]:
    """A map for each of the models."""
    from mujoco_ref.modes import natural_frequencies
    from mujoco_ref.simulate import make_stepper
    from tentacle.io.model_file import model_tables
    from validation.ladder import affine_frequencies

    firsts, tasks = [], []
    for model in models:
        still = replace(model, gravity=Gravity(0.0, 0.0))
        firsts.append(float(natural_frequencies(make_stepper(still, links=links), count=1)[0]))
        for amplitude in AMPLITUDES:
            tasks += [
                {"model": model_tables(model), "links": links, "amplitude": amplitude, "frequency": ratio * firsts[-1]}
                for ratio in RATIOS
            ]
    results = runner.run(validity_cell, tasks, version=VERSION, words="validity map")
    maps, size = [], len(AMPLITUDES) * len(RATIOS)
    for i, (model, first) in enumerate(zip(models, firsts, strict=True)):
        cells = results[i * size : (i + 1) * size]
        still = replace(model, gravity=Gravity(0.0, 0.0))
        reduced = np.array([affine_frequencies(still, order)[0] for order in MAP_ORDERS])
        maps.append(
            Validity(
                own_taper(model),
                own_slenderness(model),
                first,
                _grid(cells, "shape"),
                _grid(cells, "thrust"),
                flexibility(model, first),
                np.abs(reduced / first - 1.0),
            )
        )
    return maps


def _grid(cells: list[Mapping[str, Any]], name: str) -> Array:
    """(O, A, F) out of the cells, NaN where one has no answer."""
    values = np.array([[np.nan if v is None else v for v in c[name]] for c in cells], dtype=float)
    return values.T.reshape(len(MAP_ORDERS), len(AMPLITUDES), len(RATIOS))


def flexibility(model: Model, first: float) -> Array:
    """Drag over stiffness (A, F), with k(0) L for E I0."""
    from mujoco_ref.chain import flexural
    from mujoco_ref.influence import value
    from mujoco_ref.simulate import plain_parameters

    specimen, parameters = model.specimen, plain_parameters(model)
    E, k0 = (value(parameters, "elasticity", name) for name in ("E", "k0"))
    bending = float(flexural(specimen, 0.0, E, k0, 0.0)) * specimen.length
    speed = 2.0 * np.pi * first * np.outer(AMPLITUDES, RATIOS) * specimen.length
    drag = 0.5 * model.fluid.density * float(specimen.section.width(0.0)) * speed**2
    return drag * specimen.length**3 / bending


def write_cells(maps: list[Validity], file: Path) -> None:
    """The maps as CSV, a line a cell and order."""
    from tentacle.io.csv_table import write_csv

    columns: dict[str, list[float]] = {
        name: [] for name in ("taper", "slenderness", "order", "amplitude_rad", "frequency_ratio", "frequency_hz",
                              "flexibility", "shape_error", "thrust_error")
    }  # fmt: skip
    for found in maps:
        for o, order in enumerate(MAP_ORDERS):
            for a, amplitude in enumerate(AMPLITUDES):
                for f, ratio in enumerate(RATIOS):
                    row = (found.taper, found.slenderness, order, amplitude, ratio, ratio * found.first,
                           found.flexibility[a, f], found.shape[o, a, f], found.thrust[o, a, f])  # fmt: skip
                    for name, number in zip(columns, row, strict=True):
                        columns[name].append(float(number))
    write_csv(file, {name: np.array(values) for name, values in columns.items()})
