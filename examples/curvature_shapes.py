# %% [markdown]
# # Shapes of two coordinates
#
# The paper's arm has curvature c(s) = q1 + q2 s (eq. 1): q1 bends it evenly, q2 more towards the tip. Any further
# coordinate is one more power of s. Shapes are drawn in the base frame: x along the normal, y along the straight arm.

# %%
from pathlib import Path

import numpy as np

from affine_model.curvature import midline
from viz.figures.style import house_style, new_figure, save
from viz.palette import AUGMENTED, BASE, MEASURED

length, s = 0.14, np.linspace(0.0, 1.0, 61)
amounts = np.linspace(-1.2, 1.2, 5)  # rad
families = {
    "q1": np.outer(amounts, [1.0, 0.0, 0.0]),
    "q2": np.outer(amounts, [0.0, 2.0, 0.0]),
    "q3, which two coordinates cannot follow": np.outer(amounts, [1.0, -6.0, 6.0]),  # a Legendre polynomial
}
shapes = {name: midline(q, np.zeros(len(q)), length, s) for name, q in families.items()}

# %% [markdown]
# `midline` takes a whole batch of shapes at once and gives positions in metres. Every arm keeps its length:

# %%
steps = np.linalg.norm(np.diff(shapes["q1"], axis=1), axis=2).sum(axis=1)
print("lengths [mm]:", np.round(1e3 * steps, 3))

# %%
with house_style():
    figure = new_figure(2.8)
    panels = figure.subplots(1, 3, sharex=True, sharey=True)
    for axes, (name, xy), role in zip(panels, shapes.items(), (MEASURED, BASE, AUGMENTED), strict=True):
        for shape in xy:
            axes.plot(1e3 * shape[:, 0], 1e3 * shape[:, 1], role.dash, color=role.hex, label=name)
            name = None  # one entry a family in the legend
        axes.set_aspect("equal")
        axes.set_xlabel("x along n [mm]")
    panels[0].set_ylabel("y along the straight arm [mm]")
    panels[0].invert_yaxis()  # it hangs
    figure.legend(loc="outside upper center", ncols=3)
save(figure, Path("curvature_shapes.png"))
figure
