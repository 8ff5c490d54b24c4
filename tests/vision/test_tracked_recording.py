"""An error about a film names what the user gave: the film of an .rrd lies in a cache that nobody chose."""

from __future__ import annotations

from pathlib import Path

import pytest

from tentacle.errors import InputError
from tentacle.signals import Video
from vision.tracked_recording import errors_about

FILM = Path("cache/1234.mp4")


@pytest.mark.parametrize(("about", "named"), [(FILM, "my_arm.rrd"), (Path("lens.toml"), "lens.toml")])
def test_an_error_about_the_film_names_the_recording(about: Path, named: str) -> None:
    with pytest.raises(InputError) as caught, errors_about(Path("my_arm.rrd"), Video(FILM)):
        raise InputError("the root turns the other way", file=about, field="angle_rad", expected="the other sign")
    assert caught.value.line() == f"{named}: angle_rad: the root turns the other way; expected the other sign"
