"""The pictures of docs/on_real_arms.md, drawn from the measured data that TENTACLE_DATA names.

python docs/real_arms_pictures.py [FOLDER]   (default: docs/pictures)
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from affine_model.arm import parameter_index
from discovery.diagnose import diagnose
from inference.base_fit import Setting, fit_base
from inference.compare import model_run
from inference.fit import unfitted
from inference.initial_state import initial_nuisances
from inference.prepare import prepare
from tentacle.diagnosis import Diagnosis
from tentacle.io.external_data import data_folder
from tentacle.io.pressure_arm import read_pressure_arms
from tentacle.io.silicone_beam import read_beam
from tentacle.io.trunk_payload import read_decays, read_driven
from viz.figures.missing_force import missing_force_figure
from viz.palette import AUGMENTED, BASE, MEASURED

PICTURES = Path(__file__).resolve().parent / "pictures"
ORDER = 3
WEIGHT = 0.052  # kg, as it was weighed
SECONDS = 2.0  # after the release


def draw_beam(data: Path) -> Figure:
    """The loaded beam's tip: measured; the bare beam's model; the same with the weight as it was weighed."""
    bare, loaded = (read_beam(data / "silicone_beam" / f"beam_{kind}_V2_a.csv") for kind in ("gravity", "load52"))
    prepared = prepare(bare, hold_out=False)
    problem, known = fit_base(Setting(bare.declaration, (prepared.experiment,), ORDER), ORDER)
    seen = prepare(loaded, hold_out=False).experiment
    figure, axes = plt.subplots(figsize=(7.2, 3.4), layout="constrained")
    markers = loaded.markers
    assert markers is not None
    release = float(loaded.declaration.release_t or 0.0)
    t = markers.t - release
    shown = (t > -0.1) & (t < SECONDS)
    axes.plot(t[shown], 1e3 * markers.xy[shown, 0, 0], color=MEASURED.hex, lw=2.5, label="measured, 52 g at the tip")
    for role, mass, name in ((BASE, 0.0, "model of the bare beam"), (AUGMENTED, WEIGHT, "the same with 52 g")):
        parameters = known.parameters.copy()
        parameters[parameter_index("tip_mass", "mass")] = mass
        alone = replace(problem, experiments=(seen,), free=(), parameters=parameters)
        fitted = unfitted(alone, (initial_nuisances(seen, ORDER),))
        run = model_run(alone, fitted, 0, markers.s, markers.d)
        axes.plot(t[shown], 1e3 * run.points[shown, 0, 0], role.dash, color=role.hex, lw=1.5, label=name)
    axes.set(xlabel="time after the release [s]", ylabel="height of the upper tip marker [mm]")
    axes.legend(loc="lower right", frameon=False)
    return figure


def draw_others(data: Path) -> Figure:
    """What no passive planar arm does: tendons that leave the plane, and a pressure that comes and goes."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.2, 3.2), layout="constrained")
    decay = read_decays(data / "trunk_payload" / "observations_manual_decay_200g.csv")[4]
    driven = read_driven(data / "trunk_payload" / "observations_controlled_1_0g.csv")
    for recording, colour, name in ((driven, BASE.hex, "tendons"), (decay, MEASURED.hex, "let go by hand")):
        markers, share = recording.markers, recording.declaration.out_of_plane
        assert markers is not None
        assert share is not None
        kept = markers.t < 8.0
        left.plot(
            markers.t[kept],
            1e3 * markers.xy[kept, -1, 0],
            color=colour,
            label=f"{name}: {100 * share:.0f} % out of plane",
        )
    left.set(xlabel="time [s]", ylabel="tip of the trunk, in the plane [mm]")
    left.legend(loc="upper right", frameon=False, fontsize=8)
    for recording, colour in zip(read_pressure_arms(data / "pressure_arm"), (MEASURED.hex, AUGMENTED.hex), strict=True):
        markers = recording.markers
        assert markers is not None
        right.plot(markers.t, 1e3 * markers.xy[:, 0, 0], color=colour, label=recording.name.removeprefix("arm_"))
    right.set(xlabel="time [s]", ylabel="tip of the pressure arm [mm]")
    right.legend(loc="upper left", frameon=False, fontsize=8)
    return figure


def draw_beam_rest(data: Path) -> Figure:
    """What the loaded beam lacks, when the 52 g are declared."""
    loaded = read_beam(data / "silicone_beam" / "beam_load52_V2_a.csv")
    declaration = loaded.declaration
    weighed = replace(declaration, specimen=replace(declaration.specimen, tip_mass=WEIGHT))
    return _missing_force(diagnose([replace(loaded, declaration=weighed)]))


def draw_pressure(data: Path) -> Figure:
    """What a passive arm lacks, to move as the pressure arm does."""
    return _missing_force(diagnose([next(iter(read_pressure_arms(data / "pressure_arm")))]))


def _missing_force(found: Diagnosis) -> Figure:
    """The figure of the missing force; its words are printed."""
    print(found.verdict, *found.missing.words, sep="\n")
    return missing_force_figure(found.missing.maps[0], found.missing.kinds)


DRAWN = {"real_beam": draw_beam, "real_motions": draw_others, "real_beam_rest": draw_beam_rest,
         "real_pressure_force": draw_pressure}  # fmt: skip

if __name__ == "__main__":
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else PICTURES
    for name, draw in DRAWN.items():
        draw(data_folder()).savefig(folder / f"{name}.webp", dpi=130, facecolor="white")
        print(f"wrote {folder / name}.webp")
