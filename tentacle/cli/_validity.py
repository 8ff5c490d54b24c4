"""The validity map: where, over frequency, amplitude and taper, the reduced model stands for the reference."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from tentacle.specimen import Cone, Gravity

if TYPE_CHECKING:
    from pathlib import Path

    from tentacle.model import Model
    from tentacle.runner import Runner
    from tentacle.signals import Array

ORDERS = (2, 3, 4)
RATIOS = (0.15, 0.3, 0.5, 0.8, 1.2, 1.8)  # driving frequency over the first mode in the fluid
AMPLITUDES = (0.05, 0.1, 0.2, 0.4, 0.8)  # rad
LEVELS = (0.01, 0.05, 0.10)
PERIODS, MEASURED_PERIODS = 7.0, 2.0
VERSION = "1"


@dataclass(frozen=True)
class Validity:
    """Relative errors over amplitude (A,) and frequency ratio (F,), for one taper, by order: shape (O, A, F), thrust
    (O, A, F).

    shape: rms distance of the midlines over the tip's rms motion. thrust: of the mean, NaN where the mean is under 1 %
    of the load's rms or the fluid is air. flexibility (A, F): drag on the arm over its stiffness,
    rho w (2 pi f theta L)^2 L^3 / (2 E I0). frequency (O,): relative error of the first mode. first [Hz].
    """

    taper: float
    first: float
    shape: Array
    thrust: Array
    flexibility: Array
    frequency: Array

    def reach(self, order: int, level: float, amplitude: int) -> float:
        """The largest frequency ratio up to which the shape error stays under level; 0 where it never does."""
        row = self.shape[ORDERS.index(order), amplitude]
        bad = np.flatnonzero(~(row <= level))
        return 0.0 if bad.size and bad[0] == 0 else RATIOS[(bad[0] if bad.size else row.size) - 1]


def cell(task: Mapping[str, Any]) -> dict[str, Any]:
    """One cell: the reference and the reduced model of every order under one sine. task: model tables, amplitude,
    Hz."""
    from tentacle.cli._twins import affine_twin, reference_twin, shape_error
    from tentacle.model_file import parse_model
    from tentacle.toml_table import Table
    from tentacle.waveform import Ramped, Sine

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
    for order in ORDERS:
        twin = affine_twin(model, order, wave, duration, fps)
        found["shape"].append(_finite(shape_error(twin, reference, window)[1]))
        told = model.fluid.density > 0.0 and abs(mean) > 0.01 * rms
        found["thrust"].append(_finite(abs(twin.mean_load(window) / mean - 1.0)) if told else None)
    return found


def _finite(number: float) -> float | None:
    return float(number) if np.isfinite(number) else None


def tapered(model: Model, taper: float) -> Model:
    """The model with another tip radius (cones only)."""
    section = model.specimen.section
    assert isinstance(section, Cone)
    section = Cone(section.base_radius, taper * section.base_radius)
    return replace(model, specimen=replace(model.specimen, section=section))


def own_taper(model: Model) -> float:
    """r_tip / r0; 1 for a rectangle."""
    section = model.specimen.section
    return section.tip_radius / section.base_radius if isinstance(section, Cone) else 1.0


def validity_maps(model: Model, tapers: tuple[float, ...], runner: Runner, links: int = 20) -> list[Validity]:
    """A map for the model's own taper, then one for each of the others (cones only)."""
    from mujoco_ref.modes import natural_frequencies
    from mujoco_ref.simulate import make_stepper
    from tentacle.cli._ladder import affine_frequencies
    from tentacle.model_file import model_tables

    own = own_taper(model)
    others = [t for t in tapers if abs(t - own) > 1e-9] if isinstance(model.specimen.section, Cone) else []
    models = {own: model} | {taper: tapered(model, taper) for taper in others}
    firsts, tasks = {}, []
    for taper, arm in models.items():
        still = replace(arm, gravity=Gravity(0.0, 0.0))
        firsts[taper] = float(natural_frequencies(make_stepper(still, links=links), count=1)[0])
        for amplitude in AMPLITUDES:
            tasks += [
                {"model": model_tables(arm), "links": links, "amplitude": amplitude, "frequency": ratio * firsts[taper]}
                for ratio in RATIOS
            ]
    results = runner.run(cell, tasks, version=VERSION, words="validity map")
    maps, size = [], len(AMPLITUDES) * len(RATIOS)
    for i, (taper, arm) in enumerate(models.items()):
        cells = results[i * size : (i + 1) * size]
        still = replace(arm, gravity=Gravity(0.0, 0.0))
        reduced = np.array([affine_frequencies(still, order)[0] for order in ORDERS])
        maps.append(
            Validity(
                taper,
                firsts[taper],
                _grid(cells, "shape"),
                _grid(cells, "thrust"),
                flexibility(arm, firsts[taper]),
                np.abs(reduced / firsts[taper] - 1.0),
            )
        )
    return maps


def _grid(cells: list[Mapping[str, Any]], name: str) -> Array:
    """(O, A, F) out of the cells, NaN where one has no answer."""
    values = np.array([[np.nan if v is None else v for v in c[name]] for c in cells], dtype=float)
    return values.T.reshape(len(ORDERS), len(AMPLITUDES), len(RATIOS))


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
    from tentacle.csv_table import write_csv

    columns: dict[str, list[float]] = {
        name: [] for name in ("taper", "order", "amplitude_rad", "frequency_ratio", "frequency_hz", "flexibility",
                              "shape_error", "thrust_error")
    }  # fmt: skip
    for found in maps:
        for o, order in enumerate(ORDERS):
            for a, amplitude in enumerate(AMPLITUDES):
                for f, ratio in enumerate(RATIOS):
                    row = (found.taper, order, amplitude, ratio, ratio * found.first, found.flexibility[a, f],
                           found.shape[o, a, f], found.thrust[o, a, f])  # fmt: skip
                    for name, number in zip(columns, row, strict=True):
                        columns[name].append(float(number))
    write_csv(file, {name: np.array(values) for name, values in columns.items()})
