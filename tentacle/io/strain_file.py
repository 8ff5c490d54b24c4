"""strain.csv and [strain] of recording.toml: what strain gauges on the arm measure, and where they sit.

strain.csv: t_s, then NAME_strain for each gauge; a blank cell means: not measured. [strain] NAME = {s, d}, and if they
are known its length along the arm, length_m, and its noise, sigma.
"""

from __future__ import annotations

from pathlib import Path

from tentacle.io.readings_file import read_readings, write_readings
from tentacle.io.toml_table import Table
from tentacle.signals import StrainGauge, StrainSignal

SHARPEST = 50.0  # curvature times arm length [rad]; strains that need more are microstrain by mistake
A_STRAIN = "a strain, 0.001 for 1000 microstrain"


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
    columns = {_column(name): largest_strain(gauge, length) for name, gauge in gauges.items()}
    found = read_readings(file, ("strain", "gauges", "name = {s, d}"), columns, A_STRAIN)
    return None if found is None else StrainSignal(found[0], tuple(gauges), tuple(gauges.values()), found[1])


def write_strain(strain: StrainSignal, file: Path) -> None:
    """The CSV that read_strain gives back."""
    write_readings(file, strain.t, tuple(_column(name) for name in strain.names), strain.values)


def _column(name: str) -> str:
    return f"{name}_strain"
