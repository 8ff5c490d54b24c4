"""Waveforms as TOML tables, in files ([waveform] ...) and in verdict.json's next_experiment.

| kind | fields |
|---|---|
| rest | angle_rad = 0 |
| sine | amplitude_rad, frequency_hz, phase_rad = 0 |
| chirp | amplitude_rad, start_hz, stop_hz, duration_s |
| multisine | amplitudes_rad, frequencies_hz, phases_rad: lists of one length |
| gait | alpha: the nine numbers of eq. 20; bandwidth_hz = 5 |
| samples | t_s, angle_rad: lists of one length, times rising; between them a spline (tentacle.base_motion) |

Every kind takes ramp_s: it then starts from rest at theta = 0 over that time (tentacle.waveform.Ramped).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from tentacle.errors import InputError
from tentacle.gait import GAIT_PARAMETERS, Gait
from tentacle.io.sound_recording import LONGEST_SPAN
from tentacle.io.toml_table import Table, read_toml
from tentacle.io.written_file import write_text
from tentacle.waveform import Chirp, Multisine, Ramped, Rest, Sine, Waveform

WAVEFORM_KINDS = ("rest", "sine", "chirp", "multisine", "gait", "samples")
# Generous limits of a base motion; squares of larger numbers overflow.
LARGEST_ANGLE = 1000.0  # rad, of an amplitude or a phase
HIGHEST_FREQUENCY = 10_000.0  # Hz
SHORTEST = 1e-6  # s


def read_waveform(file: Path) -> Waveform:
    """The waveform in a TOML file's [waveform] table, whatever else is in it; InputError names what is wrong."""
    text, values = read_toml(Path(file))
    document = Table(values, file=Path(file), text=text)
    return parse_waveform(document.required_table("waveform"))


def write_waveform(waveform: Waveform, file: Path) -> None:
    """A waveform as a TOML file, every digit kept."""
    write_text(Path(file), tomli_w.dumps({"waveform": waveform_table(waveform)}))


def parse_waveform(table: Table) -> Waveform:
    """A [waveform] table, checked."""
    kind = table.choice("kind", WAVEFORM_KINDS)
    ramp = table.number("ramp_s", least=SHORTEST, most=LONGEST_SPAN) if "ramp_s" in table else None
    waveform = _PARSERS[kind](table)
    table.raw("ramp_s", "seconds", None)
    table.finish()
    return waveform if ramp is None else Ramped(waveform, ramp)


def waveform_from_table(values: dict[str, Any]) -> Waveform:
    """A waveform from plain data, such as verdict.json's next_experiment."""
    return parse_waveform(Table(values, file=None, name="waveform"))


def waveform_table(waveform: Waveform) -> dict[str, Any]:
    """A waveform as plain data. TypeError for a kind that has no table, such as a fitted base motion."""
    match waveform:
        case Rest(angle):
            return {"kind": "rest", "angle_rad": angle}
        case Sine(amplitude, frequency, phase):
            return {"kind": "sine", "amplitude_rad": amplitude, "frequency_hz": frequency, "phase_rad": phase}
        case Chirp(amplitude, start, stop, duration):
            head = {"kind": "chirp", "amplitude_rad": amplitude}
            return {**head, "start_hz": start, "stop_hz": stop, "duration_s": duration}
        case Multisine(amplitudes, frequencies, phases):
            head = {"kind": "multisine", "amplitudes_rad": list(amplitudes)}
            return {**head, "frequencies_hz": list(frequencies), "phases_rad": list(phases)}
        case Gait(alpha, bandwidth):
            return {"kind": "gait", "alpha": list(alpha), "bandwidth_hz": bandwidth}
        case Ramped(inner, duration) if not isinstance(inner, Ramped):
            return {**waveform_table(inner), "ramp_s": duration}
    raise TypeError(f"{type(waveform).__name__} has no table; sample it and write kind = samples")


def _rest(table: Table) -> Waveform:
    return Rest(_angle(table, "angle_rad", 0.0))


def _sine(table: Table) -> Waveform:
    return Sine(_angle(table, "amplitude_rad"), _frequency(table, "frequency_hz"), _angle(table, "phase_rad", 0.0))


def _chirp(table: Table) -> Waveform:
    return Chirp(
        _angle(table, "amplitude_rad"),
        _frequency(table, "start_hz"),
        _frequency(table, "stop_hz"),
        table.number("duration_s", least=SHORTEST, most=LONGEST_SPAN),
    )


def _multisine(table: Table) -> Waveform:
    amplitudes = table.numbers("amplitudes_rad", most=LARGEST_ANGLE)
    return Multisine(
        amplitudes,
        table.numbers("frequencies_hz", len(amplitudes), most=HIGHEST_FREQUENCY),
        table.numbers("phases_rad", len(amplitudes), most=LARGEST_ANGLE),
    )


def _gait(table: Table) -> Waveform:
    alpha = table.numbers("alpha", GAIT_PARAMETERS, most=2.0 * np.pi * HIGHEST_FREQUENCY)
    return Gait(alpha, table.number("bandwidth_hz", Gait.bandwidth, above=0, most=HIGHEST_FREQUENCY))


def _samples(table: Table) -> Waveform:
    from tentacle.base_motion import fit_samples  # scipy.interpolate takes 0.2 s to import, and only this kind needs it

    t = np.array(table.numbers("t_s"))
    angle = np.array(table.numbers("angle_rad", len(t), most=LARGEST_ANGLE))
    if (np.diff(t) <= 0).any():
        raise table.error("times go back or repeat", "t_s", "times that rise")
    try:
        return fit_samples(t, angle)
    except InputError as error:
        raise table.error(error.problem, "t_s", error.expected) from None


def _angle(table: Table, key: str, *default: float) -> float:
    return table.number(key, *default, least=-LARGEST_ANGLE, most=LARGEST_ANGLE)


def _frequency(table: Table, key: str) -> float:
    return table.number(key, least=0, most=HIGHEST_FREQUENCY)


_PARSERS = {
    "rest": _rest,
    "sine": _sine,
    "chirp": _chirp,
    "multisine": _multisine,
    "gait": _gait,
    "samples": _samples,
}
