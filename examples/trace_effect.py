# %% [markdown]
# # Trace a hidden effect
#
# A sinker of 1.5 g hangs at the tip, and the declaration says nothing of it. The loop fits the declared model, finds
# that it leaves more than noise, scores every effect of the catalogue against the residual, refits the best, and judges
# on a third of the recording, on which nothing was fitted.

# %%
from pathlib import Path

import numpy as np

from discovery.diagnose import diagnose
from mujoco_ref.simulate import simulate
from tentacle.model import Estimate, Model
from tentacle.recording import Declaration, Recording
from tentacle.signals import Midline, MotorSignal
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Chirp, Ramped
from viz.figures.ranking import ranking_figure
from viz.figures.style import save

arm = Specimen(Cone(base_radius=0.0125, tip_radius=0.006), length=0.14, density=1070.0)
model = Model(arm, WATER).with_effect("elasticity", E=Estimate.exact(2e5, "Pa"))
model = model.with_effect("damping", eta=Estimate.exact(800.0, "Pa s")).with_effect("drag", C_perp=Estimate.exact(1.1))
motion = Ramped(Chirp(0.5, 0.3, 2.0, 6.0), duration=1.0)  # rad, Hz, Hz, s
run = simulate(model, motion, duration=6.0, fps=30.0, hidden={"tip_mass": {"mass": 0.0015}})  # kg
noise = np.random.default_rng(2).normal(0.0, 1.5e-4, run.midline.xy.shape)
midline = Midline(run.t, run.midline.s, run.midline.xy + noise, np.full(noise.shape[:2], 1.5e-4))
recording = Recording("sinker", Declaration(arm, WATER), MotorSignal(run.t, run.command, run.theta), midline=midline)

# %%
found = diagnose([recording])
print(found.headline)
for effect, parameters in found.parameters.items():
    for name, e in parameters.items():
        print(f"{effect}.{name} = {e.value:.4g} {e.unit} ({e.low:.4g} to {e.high:.4g})")

# %% [markdown]
# In a notebook a diagnosis shows itself: the sentence, the errors before and after, what was found.

# %%
found

# %%
figure = ranking_figure(found.ranking, found.effects)
save(figure, Path("trace_effect.png"))
figure
