"""The output of `optimise`: files, and a few lines on the screen."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from affine_model.swim import Front, GaitTrial, Swimming


def write_swim_answer(
    arguments: argparse.Namespace,
    trial: GaitTrial,
    found: Swimming,
    tables: dict[str, Any],
    front: Front | None,
    folder: Path,
) -> None:
    """gait.toml (for simulate and the rig), result.toml, result.json with the course, session.rrd and report.html."""
    import json
    import shlex
    import sys

    import tomli_w

    from tentacle.cli.pages.swimming import write_swim_film, write_swim_page
    from tentacle.io.provenance import input_hashes, versions
    from tentacle.io.waveform_file import write_waveform
    from viz.report import Origin

    course = {"evaluations": found.evaluations.tolist(), "best": found.best.tolist()}
    everything = {**tables, "course": course} | ({} if front is None else {"front": front_table(front)})
    write_waveform(found.gait, folder / "gait.toml")
    (folder / "result.toml").write_text(tomli_w.dumps(tables), encoding="utf-8", newline="\n")
    (folder / "result.json").write_text(json.dumps(everything, indent=1) + "\n", encoding="utf-8")
    write_swim_film(trial, found, folder / "session.rrd")
    files = [path for path in (arguments.arm, arguments.limits, arguments.hull) if path is not None]
    command = shlex.join(["tentacle", *sys.argv[1:]])
    origin = Origin(command, arguments.seed, versions(), input_hashes(files))
    write_swim_page(trial, found, tables, front, origin, folder / "report.html")


def front_table(front: Front) -> dict[str, list[Any]]:
    """A front as plain data."""
    return {
        "alpha": front.alpha.T.tolist(),
        "speed_m_s": front.speed.tolist(),
        "power_w": front.power.tolist(),
    }


def answer_summary(tables: dict[str, Any]) -> list[str]:
    """The result in a few lines."""
    search, promise, sine = tables["search"], tables["promise"], tables["sine"]["promise"]
    lines = [
        f"{search['objective']}: {search['gain']:.2f} times the best sine that this servo can follow "
        f"({search['evaluations']} gaits, {search['method']}, seed {search['seed']}; "
        f"start of the climb: {search['origin']})",
        f"thrust {1e3 * promise['thrust_n']:.1f} mN (sine {1e3 * sine['thrust_n']:.1f}), "
        f"speed {100 * promise['speed_m_s']:.2f} cm/s (sine {100 * sine['speed_m_s']:.2f}), "
        f"power {1e3 * promise['power_w']:.1f} mW (sine {1e3 * sine['power_w']:.1f})",
    ]
    if "posterior" in tables:
        drawn = tables["posterior"]
        lines.append(
            f"{search['objective']} in 95 % of draws from {drawn['drawn_from']}: {drawn['low']:.4g} to "
            f"{drawn['high']:.4g} {drawn['unit']}"
        )
    if "free_speed_m_s" in promise:
        lines.append(
            f"free hull: {100 * promise['free_speed_m_s']:.2f} cm/s (sine {100 * sine['free_speed_m_s']:.2f}), "
            f"yaw drift {promise['yaw_drift_rad_s']:.4f} rad/s, power {1e3 * promise['free_power_w']:.1f} mW"
        )
    if "reference" in tables:
        reference = tables["reference"]
        lines.append(
            f"MuJoCo: thrust {1e3 * reference['thrust_n']:.1f} mN, speed {100 * reference['speed_m_s']:.2f} cm/s; "
            f"{reference['thrust_gain']:.2f} and {reference['speed_gain']:.2f} times the sine's"
        )
        if "free_speed_m_s" in reference:
            speeds = 100 * reference["free_speed_m_s"], 100 * reference["sine_free_speed_m_s"]
            lines.append(f"MuJoCo, free hull: {speeds[0]:.2f} cm/s (sine {speeds[1]:.2f})")
    if "left_out" in tables:
        lines.append(f"MuJoCo: not checked; {tables['left_out']['reference']}")
    return lines
