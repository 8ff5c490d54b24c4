"""Fills the caches of compiled functions in a process of its own: python -m validation.compile_ahead PART...

Parts: tracking, kernels (of the model), fit. It tracks a short film that it draws, and runs the fit's filter on a few
numbers. Nothing of that is kept.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

FRAMES, FPS, SIZE = 24, 30.0, (320, 240)


def start(parts: list[str]) -> subprocess.Popen[bytes]:
    """A process that compiles these parts."""
    words = [sys.executable, "-m", __name__, *parts]
    return subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def compile_tracking() -> None:
    """Every compiled function between a film and its shapes."""
    import numpy as np

    from tentacle.recording import Declaration, Recording
    from tentacle.signals import Midline, MotorSignal
    from tentacle.specimen import WATER, Cone, Specimen
    from validation.film import filmed
    from vision.track import track

    arm = Specimen(Cone(0.0125, 0.004), 0.14, 1070.0)
    t, s = np.arange(FRAMES) / FPS, np.linspace(0.0, 1.0, 30)
    servo = 0.3 * np.sin(2.0 * np.pi * 2.0 * t)
    heading = servo[:, None] * (1.0 - s)
    steps = np.stack([-np.sin(heading), np.cos(heading)], axis=2)[:, :-1] * arm.length * np.diff(s)[:, None]
    xy = np.concatenate([np.zeros((FRAMES, 1, 2)), np.cumsum(steps, axis=1)], axis=1)
    motor = MotorSignal(t, servo, servo)
    swing = Recording("swing", Declaration(arm, WATER), motor, midline=Midline(t, s, xy, np.full(xy.shape[:2], 1e-4)))
    with tempfile.TemporaryDirectory() as scratch:
        file = Path(scratch) / "video.mp4"
        track(file, filmed(swing, file, "tank", SIZE, 1).declaration, motor)


def compile_fit() -> None:
    """The filter and the interpolation that the fit of a model goes through: one state, seen twice."""
    import numpy as np

    from inference.interpolate import at_times
    from inference.kalman import filtered_along, gains_along, smoothed_along, whitened_along

    one, seen, none = np.eye(2), np.ones((2, 1, 2)), np.zeros((2, 1, 1))
    motion = (one, np.zeros((1, 1)), np.ones(2), 0)
    means, covariances, _ = filtered_along(np.zeros((2, 1)), seen, one, one, one)
    smoothed_along(means, covariances, one, one)
    gain, root, _ = gains_along(motion, one, one, seen)
    whitened_along(none, none, motion, seen, gain, root)
    at_times(np.arange(2.0), none, none, np.zeros((1, 1)))


def compile_kernels() -> None:
    """The reduced model's kernels."""
    from affine_model.warm import compile_orders

    compile_orders()


PARTS = {"tracking": compile_tracking, "kernels": compile_kernels, "fit": compile_fit}

if __name__ == "__main__":
    for part in sys.argv[1:]:
        PARTS[part]()
