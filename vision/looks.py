"""Named presets of test videos: light, dirt, lens and camera faults."""

from __future__ import annotations

from dataclasses import dataclass

from tentacle.errors import InputError


@dataclass(frozen=True)
class Look:
    """One look of a rendered tank. Grey levels are 0 to 255; lengths in px, shares in 0 to 1.

    arm_level, ground_level: grey of arm and ground. noise: standard deviation of a pixel [grey]. blur: standard
    deviation of the lens' point spread [px]. unevenness: how much darker the light gets from one corner to the other.
    bubbles, edge_bubbles, specks: numbers of rising bubbles, of bubbles on the arm's outline, of drifting specks.
    reflection: strength of the mirror image in the glass. lens, refraction: relative radial displacement at half the
    picture's diagonal (negative: barrel). jpeg_quality: 0 compresses nothing. dropped, duplicated: share of the frames.
    clamp, wall: drawn or not.
    """

    name: str
    arm_level: float = 50.0
    ground_level: float = 200.0
    noise: float = 1.5
    blur: float = 0.8
    unevenness: float = 0.0
    bubbles: int = 0
    edge_bubbles: int = 0
    specks: int = 0
    reflection: float = 0.0
    lens: float = 0.0
    refraction: float = 0.0
    jpeg_quality: int = 0
    dropped: float = 0.0
    duplicated: float = 0.0
    clamp: bool = False
    wall: bool = False


CLEAN = Look("clean")
LIGHT_ARM = Look("light_arm", arm_level=210.0, ground_level=40.0)
UNEVEN = Look("uneven", arm_level=70.0, ground_level=190.0, unevenness=0.7, noise=2.5)
BUBBLES = Look("bubbles", bubbles=25, edge_bubbles=12, specks=20)
FAINT = Look("faint", arm_level=120.0, ground_level=145.0, noise=4.0, blur=1.0)
TANK = Look(
    "tank",
    arm_level=60.0,
    ground_level=180.0,
    noise=2.5,
    blur=1.0,
    unevenness=0.5,
    bubbles=20,
    edge_bubbles=6,
    specks=30,
    reflection=0.08,
    jpeg_quality=85,
    dropped=0.01,
    duplicated=0.01,
    clamp=True,
    wall=True,
)
TANK_LENS = Look(**{**TANK.__dict__, "name": "tank_lens", "lens": -0.012, "refraction": 0.006})

LOOKS = {look.name: look for look in (CLEAN, LIGHT_ARM, UNEVEN, BUBBLES, FAINT, TANK, TANK_LENS)}


def look_named(name: str) -> Look:
    """The preset of that name; InputError where there is none."""
    if name not in LOOKS:
        raise InputError(f"{name!r} is not a look", field="look", expected=", ".join(LOOKS))
    return LOOKS[name]
