"""A servo's log as a lab's own program wrote it, read into the signal that motor.csv holds.

Accepted: commas, semicolons or tabs between columns, decimal commas where columns are not separated by them, times in
s, ms or us, angles in rad or degrees, a log with one angle alone. Nothing is guessed in silence: names and units come
from the header or from the caller, and the words say what was read as what.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tentacle.errors import InputError
from tentacle.io.csv_table import write_csv
from tentacle.io.plain_file import read_plain
from tentacle.io.written_file import written_file
from tentacle.signals import Array, MotorSignal

SEPARATORS = (";", "\t", ",")
TIME_NAMES = ("t", "time", "timestamp", "elapsed", "zeit", "temps")
COMMAND_NAMES = ("command", "commanded", "cmd", "target", "goal", "setpoint", "set", "desired", "reference", "soll")
ANGLE_NAMES = ("angle", "actual", "measured", "position", "pos", "feedback", "encoder", "theta", "servo", "ist")
TIME_UNITS = {"s": 1.0, "sec": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6}
DEGREE = np.pi / 180.0  # rad
ANGLE_UNITS = {"rad": 1.0, "deg": DEGREE, "degree": DEGREE, "degrees": DEGREE, "grad": DEGREE}  # grad: in German


@dataclass(frozen=True)
class ServoColumns:
    """What the header does not say: names of the time, the command and the angle column (the last may be left out), and
    the angles' unit, "rad" or "deg". None: as the header says.
    """

    names: Sequence[str] | None = None
    unit: str | None = None


AS_THE_HEADER_SAYS = ServoColumns()


def write_motor_log(motor: MotorSignal, file: Path) -> None:
    """motor.csv of the signal."""
    file.parent.mkdir(parents=True, exist_ok=True)
    with written_file(file) as partial:
        write_csv(partial, {"t_s": motor.t, "command_rad": motor.command, "angle_rad": motor.angle})


def read_servo_log(file: Path, stated: ServoColumns = AS_THE_HEADER_SAYS) -> tuple[MotorSignal, str]:
    """The signal in s and rad, and in words what was read as what. InputError names file, row and column."""
    header_row, names, rows = _table(file)
    time, command, angle = _chosen(file, names, stated)
    time_unit, seconds = _time_unit(time)
    units = {name: _angle_unit(file, name, stated.unit) for name in (command, angle)}
    column = {name: _numbers(file, header_row, names, rows, name) for name in dict.fromkeys((time, command, angle))}
    t = seconds * column[time]
    wrong = np.flatnonzero(np.diff(t) <= 0.0)
    if len(wrong):
        row = header_row + 2 + int(wrong[0])
        raise InputError("time repeats or goes back", file=file, row=row, field=time, expected="times that rise")
    words = f"{file.name}: {time} is the time in {time_unit}, {command} the command"
    words += f", {angle} the angle" if angle != command else " and, as there is no other, the angle"
    if any(unit != 1.0 for unit in units.values()):
        words += "; degrees are turned into rad"
    return MotorSignal(t, units[command] * column[command], units[angle] * column[angle]), words


def _table(file: Path) -> tuple[int, list[str], list[list[str]]]:
    """The header's row, its names, and the cells below it."""
    data = read_plain(file, "a servo's log").removeprefix(b"\xef\xbb\xbf")
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        text = data.decode("cp1252", errors="replace")  # a degree sign as Windows writes it
    lines = text.splitlines()
    first = next((k for k, line in enumerate(lines) if line.strip() and not line.lstrip().startswith("#")), None)
    if first is None:
        raise InputError("empty file", file=file, expected="a header of column names, then rows of numbers")
    separator = max(SEPARATORS, key=lines[first].count)
    cells = list(csv.reader(lines[first:], delimiter=separator))
    names = [name.strip() for name in cells[0]]
    if all(re.fullmatch(r"[-+.,\deE]+", name) for name in names):
        raise InputError("no header", file=file, row=first + 1, expected="names in the first row: time_s,command_deg")
    if len(set(names)) != len(names):
        raise InputError("a column occurs twice", file=file, row=first + 1, field=",".join(names))
    return first + 1, names, cells[1:]


def _chosen(file: Path, names: list[str], stated: ServoColumns) -> tuple[str, str, str]:
    """Names of the time, command and angle columns."""
    if stated.names is not None:
        for name in stated.names:
            if name not in names:
                raise InputError("no such column", file=file, field=name, expected="one of " + ", ".join(names))
        return stated.names[0], stated.names[1], stated.names[-1]
    time, command, angle = (_named(names, kinds) for kinds in (TIME_NAMES, COMMAND_NAMES, ANGLE_NAMES))
    angle = [name for name in angle if name not in command and name not in time] or command
    command = command or angle
    if len(time) != 1 or len(command) != 1 or len(angle) != 1:
        problem = f"the columns {', '.join(names)} do not say which is the time, the command and the angle"
        raise InputError(problem, file=file, expected="names such as time_s,command_deg,angle_deg, or --motor-columns")
    return time[0], command[0], angle[0]


def _named(names: list[str], kinds: Sequence[str]) -> list[str]:
    return [name for name in names if set(_words(name)) & set(kinds)]


def _words(name: str) -> list[str]:
    """The parts of a column's name: servo_angle [deg] has servo, angle and deg."""
    return re.findall(r"[a-z]+", name.lower().replace("\N{DEGREE SIGN}", " deg ").replace("\N{MICRO SIGN}", "u"))


def _angle_unit(file: Path, name: str, stated: str | None) -> float:
    """Radians in one of the angle's units, which the caller or the column's name states."""
    said = [stated] if stated is not None else [word for word in _words(name) if word in ANGLE_UNITS]
    if not said:
        expected = "a name such as angle_deg or angle_rad, or --motor-unit deg"
        raise InputError("the column's name has no unit", file=file, field=name, expected=expected)
    return ANGLE_UNITS[said[-1]]


def _time_unit(name: str) -> tuple[str, float]:
    """The unit of the time that the column's name states, and how many seconds it is; s where it states none."""
    said = [word for word in _words(name) if word in TIME_UNITS] or ["s"]
    return said[-1], TIME_UNITS[said[-1]]


def _numbers(file: Path, header_row: int, names: list[str], rows: list[list[str]], name: str) -> Array:
    """One column (N,) of all rows that are not blank."""
    at, values = names.index(name), []
    for row, cells in enumerate(rows, start=header_row + 1):
        if not any(cell.strip() for cell in cells):
            continue
        if len(cells) != len(names):
            raise InputError(f"{len(cells)} cells", file=file, row=row, expected=f"{len(names)}: {','.join(names)}")
        try:
            value = float(cells[at].strip().replace(",", "."))
        except ValueError:
            value = np.nan
        if not np.isfinite(value):
            raise InputError(f"{cells[at][:40]!r} is no number", file=file, row=row, field=name, expected="a number")
        values.append(value)
    if len(values) < 2:
        raise InputError("fewer than two rows", file=file, row=header_row, expected="rows of numbers under the header")
    return np.array(values)
