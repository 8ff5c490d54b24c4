"""Signals over time as named lines: one colour a party, a band as two faint lines."""

from __future__ import annotations

import numpy as np
import rerun as rr

from tentacle.signals import Array
from viz.palette import Role
from viz.topics.paths import seconds


def style_line(session: rr.RecordingStream, path: str, role: Role, width: float = 1.5) -> None:
    """Name and colour of the line at path."""
    session.log(path, rr.SeriesLines(colors=[role.colour], names=[role.name], widths=[width]), static=True)


def log_samples(session: rr.RecordingStream, path: str, t: Array, values: Array) -> None:
    """Values (T,) at t (T,) [s] on the line at path. A missing value (NaN) is a gap."""
    session.send_columns(path, [seconds(t)], rr.Scalars.columns(scalars=values))


def log_line(session: rr.RecordingStream, path: str, role: Role, t: Array, values: Array) -> None:
    """One line: values (T,) at t (T,) [s]."""
    style_line(session, path, role)
    log_samples(session, path, t, values)


def log_band(session: rr.RecordingStream, path: str, role: Role, t: Array, middle: Array, half_width: Array) -> None:
    """A band middle +- half_width (T,) as two faint lines."""
    for side, sign in (("low", -1.0), ("high", 1.0)):
        style = rr.SeriesLines(colors=[role.faint()], names=["95 %"], widths=[0.75])
        session.log(f"{path}/{side}", style, static=True)
        log_samples(session, f"{path}/{side}", t, middle + sign * np.asarray(half_width))
