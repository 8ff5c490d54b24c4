"""report.html and session.rrd of `optimise`: the gait, its search, the best sine, and the check on the reference."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from tentacle.cli.pages.swim_pictures import (
    NAMES,
    convergence_picture,
    front_section,
    map_section,
    motion_picture,
    path_picture,
)
from tentacle.cli.pages.swim_words import free_words, limits_words, posterior_words, search_words
from viz.swimming import SearchCourse

if TYPE_CHECKING:
    from affine_model.swim import Front, GaitTrial, Swimming
    from viz.report import Origin, ReportTable

FILM_S = 10.0


def write_swim_film(trial: GaitTrial, found: Swimming, path: Path) -> None:
    """The gait and the best sine swimming side by side, as a Rerun session."""
    from affine_model.swim import OBJECTIVES, PAPER_RAIL
    from affine_model.swim.film import swim_film
    from viz.swimming import Swimmer, write_swimming

    ready = trial.afloat() if OBJECTIVES[found.objective].free else trial.on_rail(PAPER_RAIL)
    films = [swim_film(ready, gait, FILM_S) for gait in (found.gait, found.sine)]
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
    way = (path_picture(trial, found, FILM_S),) if objective.free else ()
    unchecked = [f"No check on the reference: {why}" for why in tables.get("left_out", {}).values()]
    sections = [
        ReportSection(
            "What it does",
            (objective.words + ".", *free_words(tables), *posterior_words(tables), *unchecked),
            (_promise_table(tables),),
            way,
        ),
        ReportSection("The gait", limits_words(trial, found), (), (motion_picture(found),)),
        map_section(trial, found),
        ReportSection(
            "The search",
            search_words(found),
            (),
            (convergence_picture(found, objective.unit),),
        ),
    ]
    if front is not None:
        sections.append(front_section(found, front))
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
        "peak torque [mN\u00a0m]",
        "energy per distance [J/m]",
    )
    return ReportTable(
        "Forward thrust with the base clamped; all else swimming on the rail.", header, rows, (2, 3, 4, 5, 6)
    )
