"""An error about a film names what the user gave: the film of an .rrd lies in a cache that nobody chose."""

from __future__ import annotations

from pathlib import Path

import pytest

from tentacle.errors import InputError
from tentacle.recording import Declaration, Recording
from tentacle.signals import Video
from tentacle.specimen import Cone, Specimen
from vision.tracked_recording import errors_about

FILM = Path("cache/1234.mp4")


RECORDING = Recording("my_arm", Declaration(Specimen(Cone(0.0125, 0.002), 0.14, density=1000.0)), video=Video(FILM))


@pytest.mark.parametrize(("about", "named"), [(FILM, "my_arm.rrd"), (Path("lens.toml"), "lens.toml")])
def test_an_error_about_the_film_names_the_recording(about: Path, named: str) -> None:
    with pytest.raises(InputError) as caught, errors_about(Path("my_arm.rrd"), RECORDING):
        raise InputError("the root turns the other way", file=about, field="angle_rad", expected="the other sign")
    assert caught.value.line() == f"{named}: angle_rad: the root turns the other way; expected the other sign"


def test_an_error_about_a_plain_film_names_pick() -> None:
    with pytest.raises(InputError) as caught, errors_about(FILM, RECORDING):
        raise InputError("no arm is in the first frames", file=FILM, expected="the arm in view")
    assert caught.value.line().startswith(f"{FILM}: no arm is in the first frames; expected the arm in view, or --pick")
