"""The input of tracking: a recording on the disk, or a plain video with the arm's numbers."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import av
import numpy as np

from tentacle.errors import InputError
from tentacle.io.reading import read_recording
from tentacle.recording import Camera, Declaration, Recording
from tentacle.signals import Video
from tentacle.specimen import Cone, Specimen
from vision.arm_proposal import ArmProposal
from vision.known_arm import KnownArm
from vision.lens import Lens
from vision.propose import propose_in

WATER_DENSITY = 1000.0  # kg/m3; tracking does not use the density
LEAST_RADIUS = 1e-4  # m: thinner silicone tips do not exist; a thinner one in a picture is an error
USUAL_FPS = 30.0  # where a film states no rate
FOUND = "found"  # note of a recording: what was found in its film


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


def recording_of(source: Path, numbers: DeclaredNumbers, lens: Lens | None) -> Recording:
    """The recording at a path, or one made of a plain video and the arm's numbers. What these leave open is found in
    the film; the recording's note FOUND tells it.
    """
    if is_recording(source):
        return read_recording(source)
    section, at, scale = _section(numbers), numbers.base_px, _scale(numbers, lens)
    if section is None or at is None or scale is None:
        found, declaration = found_in(source, numbers, lens)
        if found.doubts:
            expected = "--base-px of the arm, other numbers, or --pick, which shows what is found"
            raise InputError("; ".join(found.doubts), file=source, expected=expected)
        assert declaration.camera is not None
        # nobody has looked at it: a film may begin with a bent arm, so that its mean direction tells no more than this
        declaration = replace(declaration, camera=replace(declaration.camera, arm_px=found.nearest_axis_px()))
        return Recording(source.stem, declaration, video=Video(source), notes={FOUND: _words(found, declaration)})
    camera = Camera(numbers.fps or USUAL_FPS, scale, at, (0.0, 1.0), numbers.exposure)
    declaration = Declaration(Specimen(section, _length(numbers), density=WATER_DENSITY), camera=camera)
    return Recording(source.stem, declaration, video=Video(source))


def found_in(source: Path, numbers: DeclaredNumbers, lens: Lens | None = None) -> tuple[ArmProposal, Declaration]:
    """The arm in a plain video, and its declaration: the given numbers, and the film's where none are given.

    Raises InputError where nothing is found, or the length is missing, because a film alone shows only lengths in px.
    """
    length, scale = _length(numbers), _scale(numbers, lens)
    known = KnownArm(
        numbers.base_px,
        None if scale is None else length / scale,
        None if numbers.base_radius is None else 0.5 * length / numbers.base_radius,
    )
    found = propose_in(source, numbers.fps, known, numbers.patience)
    camera = found.camera(length, numbers.fps or _fps(source, numbers.patience), numbers.exposure)
    if scale is not None:
        camera = replace(camera, metres_per_px=scale)
    if lens is not None:
        u, v = lens.straighten(np.array(found.base_px))
        camera = replace(camera, base_px=(float(u), float(v)))
    radii = [0.5 * width * camera.metres_per_px for width in found.width_px]
    section = Cone(numbers.base_radius or radii[0], numbers.tip_radius or max(radii[1], LEAST_RADIUS))
    return found, Declaration(Specimen(section, length, density=WATER_DENSITY), camera=camera)


def _length(numbers: DeclaredNumbers) -> float:
    if numbers.length is None:
        raise InputError("a film tells no metres", field="--length", expected="the arm's length from base to tip [m]")
    return numbers.length


def _section(numbers: DeclaredNumbers) -> Cone | None:
    base, tip = numbers.base_radius, numbers.tip_radius
    return None if base is None or tip is None else Cone(base, tip)


def _scale(numbers: DeclaredNumbers, lens: Lens | None) -> float | None:
    """Metres a px, where they are known."""
    return numbers.metres_per_px or (None if lens is None else lens.metres_per_px)


def _words(found: ArmProposal, declaration: Declaration) -> str:
    """What was found in the film, and what a person should check."""
    camera, section = declaration.camera, declaration.specimen.section
    assert camera is not None
    (u, v), (x, y) = found.base_px, found.tip_px
    radii = " to ".join(f"{1e3 * float(section.half_thickness(s)):.3g}" for s in (0.0, 1.0))
    words = (
        f"found in the film: base ({u:.0f}, {v:.0f}) px, tip ({x:.0f}, {y:.0f}) px, {found.length_px:.0f} px long,"
        f" {camera.metres_per_px:.4g} m per px, radius {radii} mm"
    )
    return "; ".join([words, *found.words])


def _fps(video: Path, patience: float) -> float:
    """The mean frame rate that a file states; the usual one of pictures, a camera and a film that is being written."""
    if video.is_dir() or video.is_char_device() or patience:
        return USUAL_FPS
    with av.open(str(video)) as container:
        rate = container.streams.video[0].average_rate if container.streams.video else None
        return float(rate) if rate else USUAL_FPS
