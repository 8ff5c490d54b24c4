"""`import tentacle`: functions named as the verbs, loaded when called, their results shown by a notebook."""

from __future__ import annotations

import inspect
from dataclasses import replace

import pytest

import tentacle
from tentacle import api
from tentacle.cli import verb_names
from tentacle.errors import InputError
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Sine

MODEL = (
    Model(Specimen(Cone(0.0125, 0.0015), 0.14, 1070.0), WATER)
    .with_effect("elasticity", E=Estimate.exact(2e5))
    .with_effect("damping", eta=Estimate.exact(300.0))
    .with_effect("drag", C_perp=Estimate.exact(1.1))
)


def test_every_function_has_the_name_of_a_verb() -> None:
    functions = {name for name in tentacle.__all__ if name != "__version__"}
    assert functions - {"read"} <= set(verb_names())
    defined = {name for name, f in inspect.getmembers(api, inspect.isfunction) if f.__module__ == api.__name__}
    assert defined >= functions


def test_what_is_not_there_is_said_with_what_is() -> None:
    with pytest.raises(AttributeError, match="identify"):
        _ = tentacle.identity


def test_a_simulated_recording_is_shown_and_read_back(tmp_path) -> None:
    from tentacle.io.recording_rrd import write_rrd

    recording = tentacle.simulate(MODEL, Sine(0.3, 1.0), duration=0.5, fps=20.0)
    write_rrd(recording, tmp_path / "run.rrd")
    again = tentacle.read(tmp_path / "run.rrd")
    shown = again._repr_html_()
    assert "<td>midline</td><td>11</td><td>0.00 to 0.50 s</td>" in shown
    assert "<td>video</td>" not in shown


def test_tracking_without_a_video_is_refused() -> None:
    recording = tentacle.simulate(MODEL, Sine(0.3, 1.0), duration=0.2, fps=20.0)
    with pytest.raises(InputError, match="no video"):
        tentacle.track(replace(recording, name="bare"))
