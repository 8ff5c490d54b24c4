"""A summary of a recording after its import: one line for each signal."""

from __future__ import annotations

import numpy as np

from tentacle.recording import Recording
from tentacle.signals import Array

LONGEST_SILENCE = 1.0  # s without a sample that passes without a word, as in a run of the rig


def summarise(recording: Recording) -> dict[str, str]:
    """Signal name -> one line: how many samples, over what time, at what rate, how many missing."""
    lines = {"recording": f"{recording.name}: {_declared(recording)}"}
    if recording.video is not None:
        lines["video"] = f"video: {recording.video.path.name}"
    if recording.motor is not None:
        lines["motor"] = f"motor: {_sampling(recording.motor.t)}"
    if recording.travel is not None:
        path = 1e3 * np.ptp(recording.travel.xy, axis=0)
        ranges = f"travels over {path[0]:.3g} mm in x, {path[1]:.3g} mm in y"
        lines["travel"] = f"base: {ranges}, {_sampling(recording.travel.t)}"
    if recording.load_cell is not None:
        lines["load_cell"] = f"load cell: {_sampling(recording.load_cell.t)}"
    if recording.midline is not None:
        line = f"midline: {len(recording.midline.s)} points, {_sampling(recording.midline.t)}"
        lines["midline"] = line + _missing(recording.midline.xy[..., 0])
    if recording.markers is not None:
        line = f"markers: {', '.join(recording.markers.names)}, {_sampling(recording.markers.t)}"
        lines["markers"] = line + _missing(recording.markers.xy[..., 0])
    if recording.strain is not None:
        line = f"strain: {', '.join(recording.strain.names)}, {_sampling(recording.strain.t)}"
        lines["strain"] = line + _missing(recording.strain.values)
    if recording.acceleration is not None:
        line = f"acceleration: {', '.join(recording.acceleration.names)}, {_sampling(recording.acceleration.t)}"
        lines["acceleration"] = line + _missing(recording.acceleration.values)
    if recording.shape is not None:
        shape = recording.shape
        accepted = f"{int(shape.accepted.sum())} of {len(shape.t)} frames accepted"
        lines["shape"] = f"shape: {accepted}, {_sampling(shape.t)}"
    for key, note in recording.notes.items():
        lines[f"note {key}"] = f"note: {key}: {note}"
    return lines


def _declared(recording: Recording) -> str:
    declaration = recording.declaration
    density = declaration.fluid.density
    fluid = f"in a fluid of {density:g} kg/m3" if density else "in air"
    released = "" if declaration.release_t is None else f", released at {declaration.release_t:g} s"
    specimen = declaration.specimen
    return f"{1000 * specimen.length:g} mm arm of {1000 * specimen.mass:.3g} g {fluid}{released}"


def _sampling(t: Array) -> str:
    if len(t) < 2:
        return f"{len(t)} samples"
    return f"{len(t)} samples, {t[0]:g} to {t[-1]:g} s, {1 / np.median(np.diff(t)):.4g} Hz{gap_words(t)}"


def gap_words(t: Array) -> str:
    """What to say of the longest gap between times (N,) [s]; "" where none is over a second and two steps."""
    steps = np.diff(t)
    longest = int(np.argmax(steps)) if len(steps) else 0
    if not len(steps) or steps[longest] <= max(LONGEST_SILENCE, 2 * float(np.median(steps))):
        return ""
    return f", a gap of {steps[longest]:.4g} s after {t[longest]:.4g} s"


def _missing(values: Array) -> str:
    missing = float(np.isnan(values).mean())
    return f", {100 * missing:.3g} % not seen" if missing else ""
