# %% [markdown]
# # Identify an arm
#
# A recording gives the arm's midline over time (from a video, or as here from the reference with 0.15 mm of noise). The
# declared model's stiffness, damping and drag are fitted to the whole trajectory; the paper's regression (eq. 18-19),
# which differentiates the data twice, stands beside it.

# %%
from pathlib import Path

import numpy as np

from inference.identify import identify
from mujoco_ref.simulate import simulate
from tentacle.model import Estimate, Model
from tentacle.recording import Declaration, Recording
from tentacle.signals import Midline, MotorSignal
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Chirp, Ramped
from viz.figures.coordinates import coordinates_figure
from viz.figures.style import save
from viz.scene import model_scene

arm = Specimen(Cone(base_radius=0.0125, tip_radius=0.006), length=0.14, density=1070.0)
truth = {"elasticity.E": 2.0e5, "damping.eta": 800.0, "drag.C_perp": 1.1}  # Pa, Pa s, 1
model = Model(arm, WATER).with_effect("elasticity", E=Estimate.exact(truth["elasticity.E"], "Pa"))
model = model.with_effect("damping", eta=Estimate.exact(truth["damping.eta"], "Pa s"))
model = model.with_effect("drag", C_perp=Estimate.exact(truth["drag.C_perp"]))
run = simulate(model, Ramped(Chirp(0.5, 0.3, 2.0, 6.0), duration=1.0), duration=6.0, fps=30.0)
noise = np.random.default_rng(1).normal(0.0, 1.5e-4, run.midline.xy.shape)
midline = Midline(run.t, run.midline.s, run.midline.xy + noise, np.full(noise.shape[:2], 1.5e-4))
recording = Recording("chirp", Declaration(arm, WATER), MotorSignal(run.t, run.command, run.theta), midline=midline)

# %%
found = identify([recording])
for name, true in truth.items():
    effect, parameter = name.split(".")
    e = found.model.parameters[effect][parameter]
    print(f"{name}: true {true:.4g}, fitted {e.value:.4g} ({e.low:.4g} to {e.high:.4g}) {e.unit}, "
          f"by the paper's regression {found.regression[name]:.4g}")  # fmt: skip
print(f"error {found.errors.midline_mm:.2f} mm rms", *found.words, sep="\n")

# %%
found.model  # shows itself, intervals included

# %%
figure = coordinates_figure(model_scene(found.runs[0]))
save(figure, Path("identify_arm.png"))
figure
