# %% [markdown]
# # Track a video, and hold it against the truth
#
# A motion is simulated, filmed as a tank camera would see it, and tracked without knowing the truth. The tracker gives
# curvature coordinates with their covariance, so it can be asked whether its error bars are honest.

# %%
from pathlib import Path

import numpy as np

from mujoco_ref.simulate import simulate
from tentacle.model import Estimate, Model
from tentacle.recording import Camera, Declaration, Recording
from tentacle.signals import MotorSignal
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Ramped, Sine
from vision.encode import write_picture, write_video
from vision.frames import read_frames
from vision.looks import look_named
from vision.overlay import contact_sheet
from vision.render import RenderSettings, frame_times, render
from vision.track import track_fully
from viz.figures.style import house_style, new_figure
from viz.track import track_scene

arm = Specimen(Cone(base_radius=0.0125, tip_radius=0.003), length=0.14, density=1070.0)
model = Model(arm, WATER).with_effect("elasticity", E=Estimate.exact(2e5, "Pa"))
model = model.with_effect("damping", eta=Estimate.exact(2e3, "Pa s")).with_effect("drag", C_perp=Estimate.exact(1.1))
motion = Ramped(Sine(0.6, 1.2), duration=0.5)  # rad, Hz; s
run = simulate(model, motion, 1.5, 30.0)

camera, look = Camera(30.0, 0.0006, (240.0, 40.0), (0.0, 1.0)), look_named("tank")
frames = render(run.midline, arm, camera, RenderSettings((480, 360), look, 1))
write_video(Path("tank.mp4"), frames, frame_times(run.t, look, seed=1), crf=6)

# %%
motor = MotorSignal(run.t, run.command, run.theta)
tracked = track_fully(Path("tank.mp4"), Declaration(arm, WATER, camera=camera), motor)
shape = tracked.shape
print(f"{shape.accepted.sum()} of {len(shape.t)} frames accepted, {shape.coefficients.shape[1] - 1} coordinates")
print(*tracked.remarks, sep="\n")

# %% [markdown]
# The contact sheet shows frames with the fitted outline; a rejected frame says why.

# %%
sheet = contact_sheet(read_frames(Path("tank.mp4")), tracked.seen)
write_picture(Path("track_video.png"), sheet)
with house_style():
    figure = new_figure(4.2)
    axes = figure.subplots()
    axes.imshow(sheet)
    axes.set_axis_off()
figure

# %%
seen = track_scene(Recording("tank", Declaration(arm, WATER, camera=camera), motor=motor, shape=shape)).subject.xy
places = np.linspace(0.0, 1.0, seen.shape[1])
truth = np.stack([np.interp(places, run.midline.s, run.midline.xy[-1][:, axis]) for axis in (0, 1)], axis=1)
print(f"last frame: {1e3 * np.sqrt(np.mean(np.sum((seen[-1] - truth) ** 2, axis=1))):.3f} mm from the truth, rms")
