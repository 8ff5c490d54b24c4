# %% [markdown]
# # An arm and its reduced twin
#
# The same arm under the same base motion by two models that share no equation: the reference, a chain of 20 links in
# MuJoCo, and the reduced model with two curvature coordinates. What differs is what two coordinates cannot follow.

# %%
from pathlib import Path

import numpy as np

from affine_model.arm import arm_of, parameter_vector
from affine_model.curvature import midline
from affine_model.simulate import Timing
from affine_model.simulate import simulate as simulate_reduced
from mujoco_ref.simulate import Initial, Setup
from mujoco_ref.simulate import simulate as simulate_reference
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Ramped, Sine
from viz.compare import ComparedMotion, motions_scene
from viz.figures.shapes import shapes_figure
from viz.figures.style import save

arm = Specimen(Cone(base_radius=0.0125, tip_radius=0.001), length=0.14, density=1070.0)
model = Model(arm, WATER).with_effect("elasticity", E=Estimate.exact(2e5, "Pa"))
model = model.with_effect("damping", eta=Estimate.exact(300.0, "Pa s")).with_effect("drag", C_perp=Estimate.exact(1.1))
model = model.with_effect("added_mass", C_a=Estimate.exact(1.0))
model  # in a notebook a model shows itself as a table

# %%
duration, fps, s = 4.0, 60.0, np.linspace(0.0, 1.0, 41)
motion = Ramped(Sine(0.4, 3.0), duration=1.0)  # rad, Hz; s of easing in
reference = simulate_reference(model, motion, duration, fps, setup=Setup(s=s, initial=Initial(np.zeros(2))))

# %% [markdown]
# The reduced model integrates a batch of individuals; this batch has one. Its base motion is asked for at the middles
# of the steps.

# %%
step = 1.0 / (4 * fps)
middles = (np.arange(round(duration / step)) + 0.5) * step
batch = simulate_reduced(arm_of(model), parameter_vector(model)[:, None], motion(middles)[:, :, None], Timing(step, 4))
xy = midline(batch.q[:, :, 0], batch.theta[:, 0], arm.length, s)
apart = np.linalg.norm(xy - reference.midline.xy, axis=2)
print(f"distance of the midlines: {1e3 * np.sqrt(np.mean(apart**2)):.2f} mm rms, {1e3 * apart.max():.2f} mm at most")

# %%
motions = {"reference": ComparedMotion(reference.midline.xy), "two coordinates": ComparedMotion(xy)}
figure = shapes_figure(motions_scene("twin", reference.t, s, reference.theta, motions))
save(figure, Path("reduced_twin.png"))
figure
