"""Pictures of `optimise`'s report: the motion, the map of sines, the search, the Pareto front."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from affine_model.swim import Front, GaitTrial, Swimming
    from viz.report import Picture, ReportSection

NAMES = ("optimised gait", "best sine")


def motion_picture(found: Swimming) -> Picture:
    """Base angle of both motions over three periods."""
    import numpy as np

    from viz.figures.motion import motion_figure
    from viz.report import Picture

    strongest = int(np.argmax(np.abs(found.gait.alpha[:3])))
    t = np.linspace(0.0, 3.0 * 2.0 * np.pi / found.gait.alpha[3 + strongest], 600)
    motions = {NAMES[0]: (t, found.gait(t)[0]), NAMES[1]: (t, found.sine(t)[0])}
    return Picture(motion_figure(motions), "Angle of the servo over three periods of the gait's strongest wave.")


def path_picture(trial: GaitTrial, found: Swimming, seconds: float) -> Picture:
    """The free hull's way under both motions."""
    from affine_model.swim.film import swim_film
    from viz.figures.free_swim import free_swim_figure
    from viz.report import Picture

    films = [swim_film(trial.afloat(), gait, seconds) for gait in (found.gait, found.sine)]
    swims = {name: (film.t, film.xy) for name, film in zip(NAMES, films, strict=True)}
    words = f"The free hull's way from rest in {seconds:g} s, and the arm behind it; a dot is the hull."
    return Picture(free_swim_figure(swims), words)


def map_section(trial: GaitTrial, found: Swimming) -> ReportSection:
    """Mean thrust of sines over amplitude and frequency, within the servo's limits (the paper's Fig. 9)."""
    import numpy as np

    from affine_model.swim import OBJECTIVES, sine_map
    from viz.figures.thrust_map import ThrustMap, thrust_map_figure
    from viz.report import Picture, ReportSection

    limits = trial.limits
    amplitudes = np.round(np.linspace(0.15, 1.0, 7) * limits.servo.angle, 3)
    frequencies = np.round(np.linspace(limits.lowest_frequency, limits.highest_frequency, 10), 3)
    mapped = sine_map(trial, OBJECTIVES["thrust"], amplitudes, frequencies)
    name = f"{100 * trial.arm.specimen.length:.0f} cm arm, sines"
    figure = thrust_map_figure([ThrustMap(name, amplitudes, frequencies, mapped.values)])
    words = f"The gait gives {1e3 * found.promise.thrust:.1f} mN. The map is empty where the servo cannot follow."
    return ReportSection("Thrust of sines", (words,), (), (Picture(figure, "Mean forward thrust of plain sines."),))


def convergence_picture(found: Swimming, unit: str) -> Picture:
    """Best value over the number of gaits tried."""
    import numpy as np

    from viz.figures.search import search_figure
    from viz.report import Picture

    sine = (found.evaluations[[0, -1]], np.full(2, found.sine_value))
    gait = (found.evaluations[[0, -1]], np.full(2, found.value))
    courses = {NAMES[0]: gait, NAMES[1]: sine, found.method: (found.evaluations, found.best)}
    figure = search_figure(courses, f"{found.objective} [{unit}]")
    return Picture(
        figure,
        "Best value of the search over the number of gaits tried; the two horizontal lines use the finer time step.",
    )


def front_section(found: Swimming, front: Front) -> ReportSection:
    """The Pareto front of speed against power, with both motions."""
    from viz.figures.front import front_figure
    from viz.report import Picture, ReportSection

    promises = zip(NAMES, (found.promise, found.sine_promise), strict=True)
    marks = {name: (promise.speed, promise.power) for name, promise in promises}
    picture = Picture(
        front_figure(front.speed, front.power, marks), "Each point: no tried gait is faster at less power."
    )
    return ReportSection("Speed against power", (), (), (picture,))
