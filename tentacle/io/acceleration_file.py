"""acceleration.csv and [acceleration] of recording.toml: what accelerometers on the arm read, and where they sit.

acceleration.csv: t_s, then NAME_m_s2 for each axis of a sensor; a blank cell means: not measured. [acceleration]
NAME = {s, d, axis}, and its noise, sigma, if that is known. axis: "normal" or "tangent".
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast

from tentacle.io.readings_file import read_readings, write_readings
from tentacle.io.toml_table import Table
from tentacle.signals import AccelerationSignal, Accelerometer

AXES = ("normal", "tangent")
LARGEST_ACCELERATION = 500.0  # m/s^2; more is thousandths of g, or counts, by mistake
AN_ACCELERATION = "an acceleration in m/s^2; in g? then multiply by 9.80665"


def parse_acceleration(table: Table) -> dict[str, Accelerometer]:
    """[acceleration]: the axes of accelerometers by name."""
    found = {}
    for name in table:
        one = table.required_table(name)
        found[name] = Accelerometer(
            s=one.measured("s", least=0, most=1),
            d=one.measured("d"),
            axis=cast(Any, one.choice("axis", AXES)),
            sigma=one.number("sigma", above=0) if "sigma" in one else None,
        )
        one.finish()
    return found


def acceleration_table(accelerometers: dict[str, Accelerometer]) -> dict[str, dict[str, float | str]]:
    """[acceleration] as recording.toml writes it."""
    tables: dict[str, dict[str, float | str]] = {}
    for name, one in accelerometers.items():
        known: dict[str, float | str] = {"sigma": one.sigma} if one.sigma is not None else {}
        tables[name] = {"s": one.s, "d": one.d, "axis": one.axis} | known
    return tables


def read_acceleration(file: Path, accelerometers: dict[str, Accelerometer]) -> AccelerationSignal | None:
    """The readings out of their CSV; None where there is no such file and no accelerometer is declared."""
    columns = {_column(name): LARGEST_ACCELERATION for name in accelerometers}
    section = ("acceleration", "accelerometers", "name = {s, d, axis}")
    found = read_readings(file, section, columns, AN_ACCELERATION)
    if found is None:
        return None
    return AccelerationSignal(found[0], tuple(accelerometers), tuple(accelerometers.values()), found[1])


def write_acceleration(acceleration: AccelerationSignal, file: Path) -> None:
    """The CSV that read_acceleration gives back."""
    write_readings(file, acceleration.t, tuple(_column(name) for name in acceleration.names), acceleration.values)


def _column(name: str) -> str:
    return f"{name}_m_s2"
