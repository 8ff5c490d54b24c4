"""The picture of docs/loop.md: python docs/decision_picture.py

Two blind trials of benchmarks/results/blind_1400001.jsonl, one with an effect of the catalogue and one with a force
outside it: what each set of effects is worth beside any share of unknown forces, and the mass that follows.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from benchmarks.sensitivity import Searched, searched  # noqa: E402
from discovery.decide import FORM, log_masses, missing_of  # noqa: E402
from validation.trials.plant_design import plant_designs  # noqa: E402
from viz.figures.style import house_style, new_figure  # noqa: E402
from viz.palette import AUGMENTED, BASE, MEASURED, NEUTRAL, REFERENCE  # noqa: E402

PICTURE = ROOT / "docs" / "pictures" / "decision.webp"
SERIES_SEED, TRIALS = 1400001, (0, 3)
SHOWN = 3  # sets beside none
DEEPEST = -30.0  # nats below the best: what lies deeper has no mass
SETS = (AUGMENTED, BASE, REFERENCE, MEASURED)  # their colours, best first
DPI, QUALITY = 170, 90


def draw(left: Axes, right: Axes, trial: Searched) -> None:
    """Left: coarsened evidence over the share of unknown forces; right: the mass of each set, known and with more."""
    hypotheses = list(trial.hypotheses)
    missing = missing_of(hypotheses)
    logs = np.array([log_masses(h, missing) for h in hypotheses])
    mass = np.exp(logs - np.logaddexp.reduce(logs.ravel()))
    none = next(k for k, h in enumerate(hypotheses) if not h.effects)
    others = sorted((k for k in range(len(hypotheses)) if k != none), key=lambda k: -mass[k].sum())
    chosen = [*others[:SHOWN], none]
    profiles = [hypotheses[k].profile(missing.temperature) for k in chosen]
    best = max(float(evidence.max()) for _, evidence in profiles)
    form = float(np.hypot(missing.declared, FORM * missing.share))
    left.axvspan(100.0 * profiles[0][0][0], 100.0 * form, color=NEUTRAL.hex, alpha=0.2, lw=0)
    for place, (k, (shares, evidence)) in enumerate(zip(chosen, profiles, strict=True)):
        colour = SETS[place].hex
        left.plot(100.0 * shares, (evidence - best) / missing.temperature, SETS[place].dash, color=colour)
        right.barh(-place, mass[k, 0], color=colour, height=0.6)
        right.barh(-place, mass[k, 1], left=mass[k, 0], color="none", edgecolor=colour, hatch="////", height=0.6, lw=0)
    names = [" + ".join(hypotheses[k].effects).replace("_", " ") or "none" for k in chosen]
    right.set(yticks=[-place for place in range(len(chosen))], yticklabels=names, xlim=(0.0, 1.0))
    hidden = " + ".join(trial.outcome.hidden).replace("_", " ")
    left.set(xscale="log", ylim=(DEEPEST, 2.0), ylabel="log evidence / T [nats]", title=f"hidden: {hidden}")
    right.set_title(f"answer: {trial.outcome.answer.replace('_', ' ')} ({trial.outcome.confidence:.2f})")


def main() -> None:
    """Draw it."""
    designs = plant_designs(max(TRIALS) + 1, SERIES_SEED, video_share=0.0)
    found = [searched(designs[place]) for place in TRIALS]
    with house_style():
        figure = new_figure(4.6)
        rows = figure.subplots(len(found), 2, width_ratios=(3, 2))
        for (left, right), trial in zip(rows, found, strict=True):
            if trial is None:
                raise SystemExit("a trial was refused")
            draw(left, right, trial)
        rows[-1, 0].set_xlabel("share of the acting forces that no law explains [%]")
        rows[-1, 1].set_xlabel("posterior mass")
        figure.savefig(PICTURE, dpi=DPI, facecolor="white", pil_kwargs={"quality": QUALITY})


if __name__ == "__main__":
    main()
