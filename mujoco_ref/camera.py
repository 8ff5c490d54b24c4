"""MuJoCo's own camera on an arm: a lit, round, dark arm on a light ground, drawn from its midline.

It needs an offscreen backend (MUJOCO_GL=egl or osmesa, set before mujoco is imported). The camera is orthographic, as a
declared camera is, so a pixel is where `Camera.to_pixels` says.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from mujoco_ref.engine import mujoco
from tentacle.errors import InputError
from tentacle.recording import Camera
from tentacle.signals import Array, Midline
from tentacle.specimen import Specimen

CYLINDERS = 120  # cylinders along the arm: shorter than the arm is thick, so the outline is smooth to .05 px
DISTANCE = 1.0  # m from the arm's plane; an orthographic picture does not depend on it
ARM_COLOUR, GROUND_COLOUR = (0.16, 0.17, 0.20, 1.0), (0.80, 0.83, 0.85)
NO_BACKEND = "an offscreen backend: apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri, then MUJOCO_GL=egl"


def mujoco_film(
    midline: Midline, specimen: Specimen, camera: Camera, size: tuple[int, int]
) -> Iterator[NDArray[np.uint8]]:
    """Yield an RGB frame (height, width, 3) for each time of the midline; size (width, height) [px].

    The midline is in the base frame and reaches from base to tip. InputError where there is no backend to draw with,
    or the midline has gaps.
    """
    if not np.all(np.isfinite(midline.xy)):
        raise InputError("a midline with gaps cannot be filmed", field="midline", expected="finite points")
    model = _stage(camera, size)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    try:
        renderer = mujoco.Renderer(model, size[1], size[0], max_geom=2 * CYLINDERS + 20)
    except Exception as error:  # whatever the backend raises where there is none
        raise InputError(f"MuJoCo cannot draw ({error})", field="--video mujoco", expected=NO_BACKEND) from None
    s = np.linspace(0.0, 1.0, CYLINDERS + 1)
    radius = specimen.section.half_thickness(0.5 * (s[1:] + s[:-1]))
    with renderer:
        for points in midline.xy:
            renderer.update_scene(data, camera="tank")
            _draw(renderer.scene, CubicSpline(midline.s, points)(s), radius)
            image = renderer.render()
            yield np.ascontiguousarray(image[:, ::-1] if camera.mirrored else image)


def _stage(camera: Camera, size: tuple[int, int]):
    """An empty, lit world with the camera in it."""
    spec = mujoco.MjSpec()
    spec.visual.headlight.ambient, spec.visual.headlight.diffuse = [0.5] * 3, [0.5] * 3
    spec.visual.headlight.specular = [0.1] * 3
    spec.visual.global_.offwidth, spec.visual.global_.offheight = size
    spec.visual.map.znear, spec.visual.map.zfar = 0.01, 100.0
    sky = spec.add_texture(name="ground", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX)
    sky.builtin, sky.width, sky.height = mujoco.mjtBuiltin.mjBUILTIN_FLAT, 16, 96
    sky.rgb1, sky.rgb2 = GROUND_COLOUR, GROUND_COLOUR
    spec.stat.extent, spec.stat.center = 1.0, [0.0, 0.0, 0.0]
    # A mirrored picture is drawn unmirrored and turned over, about the middle column.
    middle = 0.5 * (np.array(size, dtype=float) - 1.0)
    axes = np.array([camera.normal_px, camera.arm_px])  # of x and y, in the picture
    base = np.array(camera.base_px, dtype=float)
    if camera.mirrored:
        axes, base = axes * np.array([-1.0, 1.0]), np.array([size[0] - 1.0 - base[0], base[1]])
    right, up = axes[:, 0], -axes[:, 1]  # the picture's u and -v, in x and y
    centre = camera.metres_per_px * (axes @ (middle - base))
    away = np.cross([*right, 0.0], [*up, 0.0])
    rotation = np.stack([[*right, 0.0], [*up, 0.0], away], axis=1)
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, rotation.ravel())
    eye = spec.worldbody.add_camera(name="tank", pos=[*centre, 0.0] + DISTANCE * away, quat=quat)
    eye.proj, eye.fovy = mujoco.mjtProjection.mjPROJ_ORTHOGRAPHIC, camera.metres_per_px * size[1]
    return spec.compile()


def _draw(scene, points: Array, radius: Array) -> None:
    """Add a cylinder between each two points (N + 1, 2), and a ball at each, so that bends have no notches."""
    start, end = np.zeros(3), np.zeros(3)
    for i, r in enumerate(radius):
        start[:2], end[:2] = points[i], points[i + 1]
        for kind in (mujoco.mjtGeom.mjGEOM_CYLINDER, mujoco.mjtGeom.mjGEOM_SPHERE):
            geom = scene.geoms[scene.ngeom]
            if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
                mujoco.mjv_initGeom(geom, kind, np.zeros(3), np.zeros(3), np.eye(3).ravel(), np.array(ARM_COLOUR, "f4"))
                mujoco.mjv_connector(geom, kind, r, start, end)
            elif np.linalg.norm(points[i] - points[0]) > r:
                mujoco.mjv_initGeom(
                    geom, kind, np.full(3, r), start, np.eye(3).ravel(), np.array(ARM_COLOUR, "f4")
                )  # fmt: skip
            else:
                continue  # the end at the clamp is flat
            scene.ngeom += 1
