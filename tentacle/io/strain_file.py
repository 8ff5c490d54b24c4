"""strain.csv and [strain] of recording.toml: what strain gauges on the arm measure, and where they sit.

strain.csv: t_s, then NAME_strain for each gauge; a blank cell means: not measured. [strain] NAME = {s, d}, and if they
are known its length along the arm, length_m, and its noise, sigma.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tentacle.errors import InputError
from tentacle.io.csv_table import read_csv, write_csv
from tentacle.io.plain_file import is_there
from tentacle.io.toml_table import Table
from tentacle.signals import StrainGauge, StrainSignal

SHARPEST = 50.0  # curvature times arm length [rad]; strains that need more are microstrain by mistake


def parse_strain(table: Table, length: float) -> dict[str, StrainGauge]:
    """[strain]: the gauges by name. length [m]: of the arm."""
    gauges = {}
    for name in table:
        one = table.required_table(name)
        gauge = StrainGauge(
            s=one.measured("s", least=0, most=1),
            d=one.measured("d"),
            length=one.number("length_m", 0.0, least=0, most=length),
            sigma=one.number("sigma", above=0) if "sigma" in one else None,
        )
        one.finish()
        if gauge.d == 0.0:
            raise one.error("a gauge on the midline is not stretched", "d", "metres from the midline, along the normal")
        first, last = gauge.ends(length)
        if first < 0.0 or last > 1.0:
            expected = f"a gauge on the arm, from {gauge.length / 2:g} to {length - gauge.length / 2:g} m along it"
            raise one.error(f"the gauge reaches from {first * length:.4g} to {last * length:.4g} m", "s", expected)
        gauges[name] = gauge
    return gauges


def strain_table(gauges: dict[str, StrainGauge]) -> dict[str, dict[str, float]]:
    """[strain] as recording.toml writes it."""
    tables = {}
    for name, gauge in gauges.items():
        known = {"sigma": gauge.sigma} if gauge.sigma is not None else {}
        tables[name] = {"s": gauge.s, "d": gauge.d} | ({"length_m": gauge.length} if gauge.length else {}) | known
    return tables


def largest_strain(gauge: StrainGauge, length: float) -> float:
    """The largest strain that a gauge on an arm of this length [m] can measure."""
    return SHARPEST * abs(gauge.d) / length


def read_strain(file: Path, gauges: dict[str, StrainGauge], length: float) -> StrainSignal | None:
    """The strains out of their CSV; None where there is no such file and no gauge is declared."""
    if not is_there(file):
        if gauges:
            raise InputError("no such file, and [strain] declares gauges", file=file)
        return None
    if not gauges:
        raise InputError(
            "missing, and there is strain.csv", file=file.parent / "recording.toml", field="strain",
            expected="name = {s, d}",
        )  # fmt: skip
    columns = [f"{name}_strain" for name in gauges]
    table = read_csv(file, ("t_s", *columns), blank_allowed=True)
    table.require_values("t_s")
    table.require_rising("t_s")
    for column, gauge in zip(columns, gauges.values(), strict=True):
        table.require_within(column, largest_strain(gauge, length), "a strain, 0.001 for 1000 microstrain")
    values = np.stack([table[column] for column in columns], axis=-1)
    return StrainSignal(table["t_s"], tuple(gauges), tuple(gauges.values()), values)


def write_strain(strain: StrainSignal, file: Path) -> None:
    """The CSV that read_strain gives back."""
    columns = {f"{name}_strain": strain.values[:, k] for k, name in enumerate(strain.names)}
    write_csv(file, {"t_s": strain.t, **columns})
