"""Render, track, compare, over all looks: errors against the Cramer-Rao limit, z-rms, misses, false accepts."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tentacle.recording import Declaration
from tentacle.signals import Array, MotorSignal, ShapeTrack
from vision.coverage import blend_disc
from vision.encode import write_video
from vision.lens import Lens
from vision.looks import LOOKS, Look
from vision.paper_pipeline import paper_track
from vision.picture_limit import picture_information, pose_known_limit, recording_limit
from vision.render import RenderSettings, frame_times, render
from vision.scene import Scene, swaying
from vision.track import Following, Tracking, track_fully

FALSE_SIGMAS, FALSE_ANGLE = 6.0, 0.02  # an accepted q1 this far off, in its own sigmas and in rad, is a false accept


@dataclass(frozen=True)
class LookResult:
    """One look, all its videos together: rms, limit [rad] and their ratio for q1, q2; paper_rms by the paper's method.

    limit is that of a recording whose frames must also show base, offset and length; rms_over_pose_known is the ratio
    to the lower limit for known base, offset and length.

    z_rms: errors of (offset, q) whitened by the stated covariance. missed: share of sound frames that were rejected.
    false_accepts: frames accepted with an error far beyond the stated one. orders: those chosen, one a seed.
    """

    look: str
    frames: int
    rms: tuple[float, float]
    limit: tuple[float, float]
    rms_over_limit: float
    rms_over_pose_known: float
    z_rms: float
    missed: float
    false_accepts: int
    orders: tuple[int, ...]
    paper_rms: tuple[float, float]


@dataclass(frozen=True)
class Filmed:
    """A video with its truth."""

    video: Path
    scene: Scene
    look: Look
    seed: int
    motor: MotorSignal
    declaration: Declaration
    lens: Lens | None


def film_scene(scene: Scene, look: Look, seed: int, folder: Path, disturb: str = "") -> Filmed:
    """Render a scene to folder/video.mp4; disturb "hand" or "second_arm" puts that into the picture."""
    frames = render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, look, seed), scene.theta)
    times = frame_times(scene.t, look, seed)
    if disturb:
        frames = _disturbed(frames, scene, look, disturb)
    video = folder / "video.mp4"
    write_video(video, frames, times)
    size = np.array(scene.size, dtype=float)
    centre = 0.5 * (size - 1.0)
    bend = look.lens + look.refraction
    lens = Lens((float(centre[0]), float(centre[1])), float(np.linalg.norm(0.5 * size)), bend) if bend else None
    motor = MotorSignal(scene.t, scene.theta, scene.theta)
    return Filmed(video, scene, look, seed, motor, Declaration(scene.specimen, camera=scene.camera), lens)


def _disturbed(
    frames: Iterator[NDArray[np.uint8]], scene: Scene, look: Look, disturb: str
) -> Iterator[NDArray[np.uint8]]:
    """A hand (discs as dark as the arm) moves across, or a mirrored copy of the arm lies beside it."""
    width, height = scene.size
    for k, image in enumerate(frames):
        scene_now = image.astype(float)
        if disturb == "second_arm":
            scene_now = np.minimum(scene_now, np.roll(scene_now[:, ::-1], width // 7, axis=1))
        else:
            across = (k / max(len(scene.t) - 1, 1)) * 1.4 - 0.2
            for finger in range(4):
                place = np.array([across * width - 0.03 * finger * width, (0.35 + 0.09 * finger) * height])
                blend_disc(scene_now, place, 0.07 * height, look.arm_level * 1.1, 1.0)
        yield np.rint(scene_now).astype(np.uint8)


def truth_at(scene: Scene, t: Array, size: int) -> Array:
    """True [offset, q1 ..] (T, size) at times t; coordinates that the scene does not have are 0."""
    index = np.searchsorted(scene.t, t - 0.25 / scene.camera.fps)
    truth = np.zeros((len(t), max(size, scene.q.shape[1] + 1)))
    truth[:, 0] = scene.offset
    truth[:, 1 : scene.q.shape[1] + 1] = scene.q[index]
    return truth[:, :size]


def errors(scene: Scene, shape: ShapeTrack) -> tuple[Array, Array]:
    """Errors (T, K) and covariances (T, K, K) of the accepted frames."""
    kept = shape.accepted
    found = shape.coefficients[kept]
    return found - truth_at(scene, shape.t[kept], found.shape[1]), shape.covariance[kept]


def z_squares(error: Array, covariance: Array) -> Array:
    """Squared whitened errors (T,), each divided by the number of coordinates: 1 on average where sigma is right."""
    return np.einsum("ti,tij,tj->t", error, np.linalg.inv(covariance), error) / error.shape[1]


def false_accepts(scene: Scene, shape: ShapeTrack) -> int:
    """Accepted frames whose q1 is far off, and far beyond what is stated."""
    error, covariance = errors(scene, shape)
    off = np.abs(error[:, 1])
    return int(np.sum((off > FALSE_ANGLE) & (off > FALSE_SIGMAS * np.sqrt(covariance[:, 1, 1]))))


def least_rms(filmed: Filmed, order: int) -> tuple[Array, Array]:
    """The recording's own limit (order,) [rad] over the scene's shapes; and that with base, offset and length known."""
    count = len(filmed.scene.t)
    frames = range(count // 10, count, max(count // 4, 1))
    information = picture_information(filmed.scene, filmed.look, filmed.seed, order, frames)
    return recording_limit(information, order, count), pose_known_limit(information, order)


def judge_look(look: Look, seeds: tuple[int, ...], frames: int, size: tuple[int, int]) -> LookResult:
    """Film and track one video for each seed; the data decide the order."""
    squares, limits, known, z, orders, paper, missed, wrong, total = [], [], [], [], [], [], 0, 0, 0
    exposure = 0.004 if look.name.startswith("tank") else 0.0
    for seed in seeds:
        scene = swaying(seed, frames, size=size, exposure=exposure)
        with tempfile.TemporaryDirectory() as folder:
            filmed = film_scene(scene, look, seed, Path(folder))
            tracked = track_fully(filmed.video, filmed.declaration, filmed.motor, following=Following(lens=filmed.lens))
            baseline = paper_track(filmed.video, filmed.declaration, filmed.motor) if seed == seeds[0] else None
        shape = tracked.shape
        error, covariance = errors(scene, shape)
        squares.append(error[:, 1:3] ** 2)
        least, pose_known = least_rms(filmed, shape.coefficients.shape[1] - 1)
        limits.append(least[:2])
        known.append(pose_known[:2])
        z.append(z_squares(error, covariance))
        orders.append(shape.coefficients.shape[1] - 1)
        missed += sum(reason not in ("", "repeats the frame before") for reason in shape.reason)
        wrong += false_accepts(scene, shape)
        total += len(shape.t)
        if baseline is not None:
            paper.append(errors(scene, baseline)[0][:, 1:3] ** 2)
    rms = np.sqrt(np.mean(np.concatenate(squares), axis=0))
    limit = np.sqrt(np.mean(np.square(limits), axis=0))
    pose_known_rms = np.sqrt(np.mean(np.square(known), axis=0))
    paper_rms = np.sqrt(np.mean(np.concatenate(paper), axis=0))
    return LookResult(
        look=look.name,
        frames=total,
        rms=(float(rms[0]), float(rms[1])),
        limit=(float(limit[0]), float(limit[1])),
        rms_over_limit=float(np.max(rms / limit)),
        rms_over_pose_known=float(np.max(rms / pose_known_rms)),
        z_rms=float(np.sqrt(np.mean(np.concatenate(z)))),
        missed=missed / total,
        false_accepts=wrong,
        orders=tuple(orders),
        paper_rms=(float(paper_rms[0]), float(paper_rms[1])),
    )


def judge_disturbed(disturb: str, seed: int, frames: int, size: tuple[int, int]) -> tuple[Tracking, int]:
    """Track a clean scene with a hand or a second arm in it: the tracking, and its false accepts."""
    scene = swaying(seed, frames, size=size)
    with tempfile.TemporaryDirectory() as folder:
        filmed = film_scene(scene, LOOKS["clean"], seed, Path(folder), disturb)
        tracked = track_fully(filmed.video, filmed.declaration, filmed.motor)
    return tracked, false_accepts(scene, tracked.shape)


def look_table(results: list[LookResult]) -> str:
    """The report as text: mrad, ratios, shares."""
    lines = [
        "look        frames  rms q1/q2 mrad  limit q1/q2  rms/limit  pose known  z-rms  missed  false  orders"
        "  paper q1/q2 mrad",
        "-" * 118,
    ]
    for r in results:
        rms, limit, paper = ([1e3 * value for value in pair] for pair in (r.rms, r.limit, r.paper_rms))
        lines.append(
            f"{r.look:10s} {r.frames:7d}   {rms[0]:5.2f}/{rms[1]:6.2f}   {limit[0]:5.2f}/{limit[1]:5.2f}"
            f"   {r.rms_over_limit:8.2f}  {r.rms_over_pose_known:10.2f}"
            f"  {r.z_rms:5.2f}  {100 * r.missed:5.1f}%  {r.false_accepts:5d}"
            f"  {','.join(map(str, r.orders)):6s}  {paper[0]:7.1f}/{paper[1]:7.1f}"
        )
    return "\n".join(lines)


def results_json(results: list[LookResult]) -> list[dict[str, object]]:
    """The report as plain data."""
    return [asdict(result) for result in results]
