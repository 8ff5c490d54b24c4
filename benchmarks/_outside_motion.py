"""What each film of an outside arm shows: its arm, its ground, its motion. benchmarks/_outside_films.py draws it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
STEPS = 240  # along the arm


@dataclass(frozen=True)
class Film:
    """What is drawn. Lengths in px, greys 0 to 255, angles in rad.

    side: where in the picture the base is. widths: full width at base and tip. at_base: "", "clamp" (a block of the
    arm's grey), "body" (a head and trunk of it) or "dark" (a block darker than the arm). intruder: "", "debris" (a
    blob that touches the arm), "second_arm", "hand", "post" (a bar of the ground's grey before the arm), "glare".
    codec: "", "jpeg 30" (quality), "h264 35" (crf), "gif 24" (greys, dithered). repeats: True, every frame is shown two
    or three times. fade: share of its contrast that the tip has lost; core: share of it that a stripe along the middle
    lets through; halo: grey of a light rim about it, as phase contrast makes; wave: True, a wave runs down the arm,
    which no polynomial is.
    """

    name: str
    size: tuple[int, int] = (320, 240)
    side: str = "top"
    length: float = 170.0
    widths: tuple[float, float] = (16.0, 5.0)
    arm: float = 60.0
    ground: float = 180.0
    noise: float = 2.0
    blur: float = 0.9
    texture: float = 0.0
    uneven: float = 0.0
    flicker: float = 0.0
    at_base: str = ""
    intruder: str = ""
    codec: str = ""
    repeats: bool = False
    servo: bool = True
    sway: float = 0.4
    bend: float = 0.8
    frames: int = 60
    fade: float = 0.0
    core: float = 0.0
    halo: float = 0.0
    wave: bool = False


FILMS = (
    Film(
        "fish", (200, 140), "left", 98.0, (7.0, 3.0), 95.0, 150.0, at_base="body", repeats=True, servo=False, sway=0.1
    ),
    Film("fish_light", (140, 200), "bottom", 98.0, (7.0, 3.0), 170.0, 60.0, at_base="body", repeats=True, servo=False),
    Film(
        "fish_real",
        (220, 150),
        "right",
        98.0,
        (7.0, 3.0),
        90.0,
        150.0,
        at_base="body",
        repeats=True,
        servo=False,
        sway=0.0,
        fade=0.6,
        core=0.4,
        halo=12.0,
        wave=True,
        texture=4.0,
        codec="h264 26",
        bend=0.9,
    ),
    Film("gif", codec="gif 16", side="bottom", at_base="clamp", servo=False),
    Film("thin", (320, 240), "right", 170.0, (5.0, 3.0)),
    Film("thin_12", (320, 240), "left", 220.0, (12.0, 3.5), codec="jpeg 50"),
    Film("small", (100, 90), "top", 60.0, (9.0, 3.0)),
    Film("faint", arm=130.0, ground=150.0, noise=3.0),
    Film("texture", texture=16.0),
    Film("flicker", uneven=0.5, flicker=0.15),
    Film("jpeg", codec="jpeg 25"),
    Film("h264", codec="h264 33"),
    Film("light", arm=200.0, ground=70.0, side="bottom"),
    Film("clamp", at_base="clamp"),
    Film("dark_clamp", at_base="dark", side="right", servo=False),
    Film("debris", intruder="debris"),
    Film("second_arm", intruder="second_arm"),
    Film("hand", intruder="hand"),
    Film("post", intruder="post"),
    Film("glare", intruder="glare"),
)
REST = {"top": 0.5 * np.pi, "bottom": -0.5 * np.pi, "left": 0.0, "right": np.pi}  # heading of the straight arm


def base_of(film: Film) -> Array:
    """Where the arm is held (2,) [px]."""
    width, height = film.size
    inset = 0.10 * film.length + (0.14 * film.length if film.at_base == "body" else 0.0)
    places = {"top": (0.5 * width, inset), "bottom": (0.5 * width, height - inset)}
    places |= {"left": (inset, 0.5 * height), "right": (width - inset, 0.5 * height)}
    return np.array(places[film.side]) + np.array([1.3, -0.7])


def motion(film: Film, seed: int) -> tuple[Array, Array]:
    """Servo angle (T,) and bending (T, 4) [rad]: the heading is rest + servo + sum_k bend_k s^k / k."""
    rng = np.random.default_rng([seed, 77])
    t = np.arange(film.frames) / 60.0
    phase = rng.uniform(0, 2 * np.pi, 5)
    wave = 2 * np.pi * 0.9 * t
    theta = film.sway * np.sin(wave + phase[4])
    sizes = film.bend * np.array([1.0, 1.0, 0.6, 0.0])
    if film.wave:  # amplitudes of a running wave's sine and cosine, at 1.3 waves along the arm
        return theta, film.bend * np.stack([np.sin(wave), np.cos(wave), 0 * t, 0 * t], axis=1)
    bends = sizes * np.sin(wave[:, None] + phase[:4]) + 0.2 * sizes * np.sin(2 * wave[:, None] + phase[[1, 2, 3, 0]])
    return theta, bends


def midline(base: Array, heading: Array | float, bends: Array, length: float, wave: bool = False) -> Array:
    """Points (STEPS + 1, 2) from base to tip, by the middle of each step."""
    middle = (np.arange(STEPS) + 0.5) / STEPS
    if wave:
        turn = 2.0 * np.pi * 1.1 * middle
        angle = heading + middle * (bends[0] * np.sin(turn) + bends[1] * np.cos(turn)) + bends[2] * middle
    else:
        angle = heading + sum(bends[k] * middle ** (k + 1) / (k + 1) for k in range(len(bends)))
    steps = length / STEPS * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return base + np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
