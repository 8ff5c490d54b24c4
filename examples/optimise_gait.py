# %% [markdown]
# # Optimise a gait
#
# Which base motion of eq. 20 swims fastest, within what a hobby servo can do? The batched reduced model tries thousands
# of gaits; the best sine that the same servo can follow stands beside the result.

# %%
from pathlib import Path

import numpy as np

from affine_model.swim import OBJECTIVES, SearchPlan, assumed_model, optimise_gait, paper_cone, trial_of
from viz.figures.motion import motion_figure
from viz.figures.style import save

trial = trial_of(assumed_model(paper_cone(0.21), "dragon-skin-10"))
found = optimise_gait(trial, OBJECTIVES["speed"], SearchPlan(evaluations=1500, seed=1))
best, sine = found.promise, found.sine_promise
print(f"on a rail it swims {100 * best.speed:.2f} cm/s, the best sine {100 * sine.speed:.2f}: {found.gain:.2f} times")
print(f"clamped it pulls {1e3 * best.thrust:.1f} mN, the sine {1e3 * sine.thrust:.1f} mN")
print(f"it asks {found.peaks[0]:.2f} rad, {found.peaks[1]:.2f} rad/s and {found.peaks[2]:.0f} rad/s2 of the servo")

# %%
t = np.linspace(0.0, 4.0, 801)
figure = motion_figure({"best gait": (t, found.gait(t)[0]), "best sine": (t, found.sine(t)[0])})
save(figure, Path("optimise_gait.png"))
figure
