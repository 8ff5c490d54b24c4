"""report.html and session.rrd of `optimise`: the gait, its search, the best sine, and the check on the reference."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from viz.swimming import SearchCourse

if TYPE_CHECKING:
    from affine_model.swim import Front, GaitTrial, Swimming
    from viz.report import Origin, Picture, ReportSection, ReportTable

FILM_S = 10.0
NAMES = ("optimised gait", "best sine")


def write_swim_film(trial: GaitTrial, found: Swimming, path: Path) -> None:
    """The gait and the best sine swimming side by side, as a Rerun session."""
    from affine_model.swim import PAPER_RAIL
    from affine_model.swim.film import swim_film
    from viz.swimming import Swimmer, write_swimming

    level = trial.on_rail(PAPER_RAIL)
    films = [swim_film(level, gait, FILM_S) for gait in (found.gait, found.sine)]
    swimmers = [Swimmer(name, one.theta, one.travel, one.xy) for name, one in zip(NAMES, films, strict=True)]
    specimen = trial.arm.specimen
    write_swimming(swimmers, films[0].t, films[0].s, specimen, SearchCourse(found.evaluations, found.best), path)


def write_swim_page(
    trial: GaitTrial, found: Swimming, tables: dict[str, Any], front: Front | None, origin: Origin, path: Path
) -> None:
    """report.html: headline, results of each gait, convergence, gait over a period, thrust map, front."""
    from affine_model.swim import OBJECTIVES
    from viz.report import Report, ReportSection, render_report, write_report

    objective = OBJECTIVES[found.objective]
    unchecked = [f"No check on the reference: {why}" for why in tables.get("left_out", {}).values()]
    sections = [
        ReportSection("What it does", (objective.words + ".", *unchecked), (_promise_table(tables),)),
        ReportSection("The gait", _limits_words(trial, found), (), (_motion_picture(found),)),
        _map_section(trial, found),
        ReportSection(
            "The search",
            _search_words(found),
            (),
            (_convergence_picture(found, objective.unit),),
        ),
    ]
    if front is not None:
        sections.append(_front_section(found, front))
    headline = f"{found.gain:.2f} times the {found.objective} of the best sine that this servo can follow."
    page = render_report(Report("optimise", "Optimal swimming", headline, sections, origin))
    write_report(page, path)


def _promise_table(tables: dict[str, Any]) -> ReportTable:
    from viz.report import ReportTable

    rows = []
    for name, promise in ((NAMES[0], tables["promise"]), (NAMES[1], tables["sine"]["promise"])):
        cost = f"{promise['transport_j_m']:.2f}" if "transport_j_m" in promise else "-"
        numbers = (1e3 * promise["thrust_n"], 100 * promise["speed_m_s"], 1e3 * promise["power_w"])
        torque = 1e3 * promise["peak_torque_n_m"]
        rows.append((name, "model", *(f"{number:.2f}" for number in numbers), f"{torque:.1f}", cost))
    if "reference" in tables:
        measured = tables["reference"]
        for name, prefix in zip(NAMES, ("", "sine_"), strict=True):
            thrust, speed = 1e3 * measured[f"{prefix}thrust_n"], 100 * measured[f"{prefix}speed_m_s"]
            rows.append((name, "MuJoCo", f"{thrust:.2f}", f"{speed:.2f}", "-", "-", "-"))
    header = (
        "motion",
        "by",
        "thrust [mN]",
        "speed [cm/s]",
        "power [mW]",
        "peak torque [mN m]",
        "energy per distance [J/m]",
    )
    return ReportTable(
        "Forward thrust with the base clamped; all else swimming on the rail.", header, rows, (2, 3, 4, 5, 6)
    )


def _limits_words(trial: GaitTrial, found: Swimming) -> tuple[str, ...]:
    servo = trial.limits.servo
    angle, speed, acceleration = found.peaks.tolist()
    return (
        f"It turns by at most {angle:.3f} of {servo.angle:.3f} rad, {speed:.2f} of {servo.speed:.2f} rad/s and "
        f"{acceleration:.0f} of {servo.acceleration:.0f} rad/s2, over 300 s; harmonics end at "
        f"{trial.limits.bandwidth:g} Hz.",
        "alpha = " + ", ".join(f"{value:.4g}" for value in found.gait.alpha),
    )


def _search_words(found: Swimming) -> tuple[str, ...]:
    return (
        "First grids of sines and of single waves (one term of eq. 20 with its phase), refined around their best; then "
        f"{found.evaluations[-1]} gaits by {found.method}, seed {found.seed}. A quasi-Newton method starts at the best "
        "wave, and at the search's best when it exceeds all earlier results.",
        f"The winner was chosen with a third of the step. Start of its climb: {found.origin}.",
    )


def _motion_picture(found: Swimming) -> Picture:
    import numpy as np

    from viz.figures.motion import motion_figure
    from viz.report import Picture

    strongest = int(np.argmax(np.abs(found.gait.alpha[:3])))
    t = np.linspace(0.0, 3.0 * 2.0 * np.pi / found.gait.alpha[3 + strongest], 600)
    motions = {NAMES[0]: (t, found.gait(t)[0]), NAMES[1]: (t, found.sine(t)[0])}
    return Picture(motion_figure(motions), "Angle of the servo over three periods of the gait's strongest wave.")


def _map_section(trial: GaitTrial, found: Swimming) -> ReportSection:
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


def _convergence_picture(found: Swimming, unit: str) -> Picture:
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


def _front_section(found: Swimming, front: Front) -> ReportSection:
    from viz.figures.front import front_figure
    from viz.report import Picture, ReportSection

    promises = zip(NAMES, (found.promise, found.sine_promise), strict=True)
    marks = {name: (promise.speed, promise.power) for name, promise in promises}
    picture = Picture(
        front_figure(front.speed, front.power, marks), "Each point: no tried gait is faster at less power."
    )
    return ReportSection("Speed against power", (), (), (picture,))
