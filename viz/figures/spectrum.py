"""Amplitude spectra of the tip: its motion and what each model leaves of it."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from tentacle.diagnosis import RunComparison
from viz.figures.style import draw, house_style, legend_above, new_figure
from viz.palette import AUGMENTED, BASE, MEASURED
from viz.spectrum import amplitude_spectrum


def spectrum_figure(run: RunComparison, height: float = 2.2, width: float = 7.2) -> Figure:
    """Amplitude [mm] of the tip's x over frequency [Hz], logarithmic, up to twice where 99.9 % of the power lies."""
    with house_style():
        figure = new_figure(height, width)
        axes = figure.subplots()
        tip = int(np.argmax(run.s))
        measured = run.measured[:, tip, 0]
        frequency, amplitude = amplitude_spectrum(run.t, measured)
        if len(frequency):
            draw(axes, MEASURED, frequency, 1e3 * amplitude, "measured motion")
            power = np.cumsum(amplitude**2)
            axes.set_xlim(0, max(2.0 * frequency[min(np.searchsorted(power, 0.999 * power[-1]), len(power) - 1)], 2.0))
            for role, model in ((BASE, run.base), (AUGMENTED, run.augmented)):
                frequency, amplitude = amplitude_spectrum(run.t, model[:, tip, 0] - measured)
                draw(axes, role, frequency, 1e3 * amplitude, f"residual, {role.name}")
            axes.set_yscale("log")
            legend_above(figure, axes)
        axes.set_xlabel("frequency [Hz]")
        axes.set_ylabel("tip, amplitude [mm]")
        return figure
