"""The input of tracking: a recording on the disk, or a plain video with the arm's numbers."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from tentacle.errors import InputError
from tentacle.io.reading import read_recording
from tentacle.recording import Camera, Declaration, Recording
from tentacle.signals import Video
from tentacle.specimen import Cone, Specimen
from vision.frames import read_frames
from vision.guess import guess_camera
from vision.lens import Lens

WATER_DENSITY = 1000.0  # kg/m3; tracking does not use the density


@dataclass(frozen=True)
class DeclaredNumbers:
    """The numbers that a user gives for a plain video; None for the others. Lengths in m, base_px (u, v), fps
    in 1/s.
    """

    length: float | None = None
    base_radius: float | None = None
    tip_radius: float | None = None
    base_px: tuple[float, float] | None = None
    metres_per_px: float | None = None
    fps: float | None = None
    exposure: float = 0.0
    patience: float = 0.0


def is_recording(source: Path) -> bool:
    """Whether a path is a recording, not a plain video."""
    return source.suffix == ".rrd" or (source / "recording.toml").exists()


def _arm(numbers: DeclaredNumbers) -> Specimen:
    length, base, tip = numbers.length, numbers.base_radius, numbers.tip_radius
    if length is None or base is None or tip is None:
        missing = "--length" if length is None else "--base-radius" if base is None else "--tip-radius"
        expected = "metres, or --pick with --length alone"
        raise InputError("a plain video says nothing of the arm", field=missing, expected=expected)
    return Specimen(Cone(base, tip), length, density=WATER_DENSITY)


def recording_of(source: Path, numbers: DeclaredNumbers, lens: Lens | None) -> Recording:
    """The recording at a path, or one made of a plain video and the arm's numbers."""
    if is_recording(source):
        return read_recording(source)
    specimen = _arm(numbers)
    fps = numbers.fps or 30.0
    metres_per_px = numbers.metres_per_px or (lens.metres_per_px if lens is not None else None)
    if numbers.base_px is not None and metres_per_px is not None:
        camera = Camera(fps, metres_per_px, numbers.base_px, (0.0, 1.0), numbers.exposure)
    elif numbers.base_px is None and metres_per_px is None:
        first = next(iter(read_frames(source, numbers.fps, numbers.patience)))
        camera = guess_camera(first.image, specimen, fps, numbers.exposure)
    else:
        raise InputError("base and scale go together", field="--base-px, --m-per-px", expected="both, or neither")
    return Recording(source.stem, Declaration(specimen, camera=camera), video=Video(source))
