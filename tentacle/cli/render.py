"""tentacle render: a test video whose truth is known."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "render a test video of a swaying arm, or of a recording's midline; the truth is stored apart"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument(
        "recording", type=Path, nargs="?", metavar="RECORDING", help="whose midline to render (default: a swaying cone)"
    )
    parser.add_argument(
        "--out", type=Path, required=True, metavar="FOLDER", help="import folder to write; FOLDER.truth.csv beside it"
    )
    parser.add_argument(
        "--look", default="clean", help="clean (default), light_arm, uneven, bubbles, faint, tank, tank_lens, mujoco"
    )
    parser.add_argument("--seed", type=int, required=True, help="the same seed gives the same video")
    parser.add_argument("--size", type=int, nargs=2, default=(1280, 720), metavar=("W", "H"), help="picture size [px]")
    parser.add_argument(
        "--compress", type=int, default=0, metavar="CRF", help="H.264 quality, 0 lossless (default) to 51"
    )
    swaying = parser.add_argument_group("the swaying cone")
    swaying.add_argument("--seconds", type=float, default=4.0, help="how long (default: 4)")
    swaying.add_argument("--fps", type=float, default=60.0, help="frames per second (default: 60)")
    swaying.add_argument(
        "--order", type=int, choices=(1, 2, 3, 4, 5), default=2, help="curvature coordinates (default: 2)"
    )
    swaying.add_argument(
        "--amplitude", type=float, default=0.9, metavar="RAD", help="size of the curvature (default: 0.9)"
    )
    swaying.add_argument("--frequency", type=float, default=0.6, metavar="HZ", help="of the sway (default: 0.6)")
    swaying.add_argument("--exposure", type=float, default=0.004, metavar="S", help="shutter time (default: 0.004)")


def run(arguments: argparse.Namespace) -> int:
    """Render, write the import folder, its truth and, where the look has one, its lens."""
    import os
    import tempfile
    from dataclasses import replace

    import numpy as np

    if arguments.look == "mujoco":
        os.environ.setdefault("MUJOCO_GL", "egl")  # MuJoCo reads it when it is imported
    from tentacle.errors import InputError
    from tentacle.io.csv_table import write_csv
    from tentacle.io.reading import read_recording
    from tentacle.io.write_folder import write_folder
    from tentacle.recording import Declaration, Recording
    from tentacle.signals import MotorSignal, Video
    from validation.film import MUJOCO
    from vision.encode import write_video
    from vision.lens import Lens
    from vision.lens_file import format_lens
    from vision.looks import look_named
    from vision.render import frame_times, render
    from vision.scene import swaying

    mujoco = arguments.look == MUJOCO
    look = look_named("clean" if mujoco else arguments.look)
    size, out = tuple(arguments.size), arguments.out
    if min(size) < 16 or not 0 <= arguments.compress <= 51:
        raise InputError("cannot be rendered", field="--size, --compress", expected="16 px or more, and 0 to 51")
    for name in ("seconds", "fps", "frequency"):
        if not getattr(arguments, name) > 0:
            raise InputError(f"{getattr(arguments, name)} is not usable", field=f"--{name}", expected="above zero")
    truth: dict[str, np.ndarray] = {}
    if arguments.recording is None:
        frames = max(round(arguments.seconds * arguments.fps), 1)
        scene = swaying(
            arguments.seed, frames, arguments.fps, size, arguments.order, arguments.amplitude, arguments.frequency,
            arguments.exposure,
        )  # fmt: skip
        midline, theta = scene.midline, scene.theta
        recording = Recording(
            out.name,
            Declaration(scene.specimen, camera=scene.camera),
            motor=MotorSignal(scene.t, scene.theta, scene.theta),
        )
        truth = {"theta_rad": theta, "offset_rad": np.full(frames, scene.offset)}
        truth |= {f"q{j + 1}_rad": scene.q[:, j] for j in range(scene.q.shape[1])}
    else:
        recording = read_recording(arguments.recording)
        midline, camera = recording.midline, recording.declaration.camera
        if midline is None or camera is None:
            raise InputError(
                "needs a midline and a [camera]", file=arguments.recording, expected="both, to be rendered"
            )
        motor = recording.motor
        theta = None if motor is None else np.interp(midline.t, motor.t, motor.angle)
    camera = recording.declaration.camera
    assert camera is not None
    times = frame_times(midline.t, look, arguments.seed)
    for place, k in ((axis, k) for k in range(len(midline.s)) for axis in (0, 1)):
        truth[f"{'xy'[place]}{k}_m"] = midline.xy[:, k, place]
    out.absolute().parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        video = Path(folder) / "video.mp4"
        specimen = recording.declaration.specimen
        if mujoco:
            from mujoco_ref.camera import film

            pictures = film(midline, specimen, camera, size)
        else:
            pictures = render(midline, specimen, camera, size, look, arguments.seed, theta)
        count = write_video(video, pictures, times, arguments.compress)
        filmed = replace(recording, name=out.name, midline=None, markers=None, shape=None, video=Video(video))
        write_folder(filmed, out)
    write_csv(out.with_name(out.name + ".truth.csv"), {"t_s": midline.t, **truth})
    if look.lens or look.refraction:
        centre = 0.5 * (np.array(size, dtype=float) - 1.0)
        reference = float(np.linalg.norm(0.5 * np.array(size, dtype=float)))
        lens = Lens((float(centre[0]), float(centre[1])), reference, look.lens + look.refraction)
        out.with_name(out.name + ".lens.toml").write_text(format_lens(lens), encoding="utf-8")
    print(f"wrote {count} frames to {out}, the truth to {out.name}.truth.csv")
    return 0
