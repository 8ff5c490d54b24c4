"""Amplitude spectra of the tip: its motion and what each model leaves of it."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from viz.figures.style import draw_line, house_style, legend_above, new_figure
from viz.scene import ViewedRun
from viz.spectrum import amplitude_spectrum


def spectrum_figure(scene: ViewedRun, height: float = 2.2, width: float = 7.2) -> Figure:
    """Amplitude [mm] of the tip's x over frequency [Hz], logarithmic, up to twice where 99.9 % of the power lies."""
    with house_style():
        figure = new_figure(height, width)
        axes = figure.subplots()
        motion = scene.subject.xy[:, scene.tip, 0]
        frequency, amplitude = amplitude_spectrum(scene.t, motion)
        if len(frequency):
            draw_line(axes, scene.subject.role, frequency, 1e3 * amplitude, f"{scene.subject.role.name} motion")
            power = np.cumsum(amplitude**2)
            axes.set_xlim(0, max(2.0 * frequency[min(np.searchsorted(power, 0.999 * power[-1]), len(power) - 1)], 2.0))
            for party in scene.models:
                frequency, amplitude = amplitude_spectrum(scene.t, party.xy[:, scene.tip, 0] - motion)
                draw_line(axes, party.role, frequency, 1e3 * amplitude, f"residual, {party.role.name}")
            axes.set_yscale("log")
            legend_above(figure, axes)
        axes.set_xlabel("frequency [Hz]")
        axes.set_ylabel("tip, amplitude [mm]")
        return figure
