"""tentacle optimise: the gait of eq. 20 that swims best with this arm and this servo."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from affine_model.swim import Front, ServoLimits, Swimming
    from tentacle.model import Model

HELP = "find the base motion that swims best, within the servo's limits"

# Named here, not imported, so that --help stays quick; a test holds them to the package's own.
OBJECTIVES = ("thrust", "speed", "transport")
METHODS = ("cmaes", "ga", "random")
SILICONES = ("dragon-skin-10", "dragon-skin-20", "ecoflex-00-30")
PROMISES = {
    "thrust_n": ("mean thrust, clamped", "mN", 1e3),
    "speed_m_s": ("speed on the rail", "cm/s", 1e2),
    "power_w": ("mechanical power", "mW", 1e3),
    "peak_torque_n_m": ("largest torque", "mN m", 1e3),
    "transport_j_m": ("cost of transport", "J/m", 1.0),
}
LIMITS = {
    "angle_rad": "angle",
    "speed_rad_s": "speed",
    "acceleration_rad_s2": "acceleration",
    "torque_n_m": "torque",
    "bandwidth_hz": "bandwidth",
    "lowest_frequency_hz": "lowest_frequency",
    "highest_frequency_hz": "highest_frequency",
}


def configure(parser: argparse.ArgumentParser) -> None:
    """Arguments of the verb."""
    parser.add_argument(
        "arm", type=Path, help="model.toml of identify or diagnose, a recording.toml, or an import folder"
    )
    parser.add_argument("--out", type=Path, required=True, help="folder for result.toml, session.rrd, report.html")
    parser.add_argument("--objective", choices=OBJECTIVES, default="thrust", help="default: thrust (eq. 21)")
    parser.add_argument("--method", choices=METHODS, default="cmaes", help="ga is the paper's; default: cmaes")
    parser.add_argument("--evaluations", type=int, default=5000, help="gaits tried; default: the paper's 50 x 100")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--limits", type=Path, help=f"TOML with a [limits] table of {', '.join(LIMITS)}")
    parser.add_argument("--silicone", choices=SILICONES, default=SILICONES[0], help="of an arm without a fitted model")
    parser.add_argument("--robust", type=int, default=0, metavar="N", help="over N samples of the model's intervals")
    parser.add_argument("--front", action="store_true", help="also trace the front of speed against power")
    parser.add_argument("--no-reference", action="store_true", help="leave out the check on the MuJoCo reference")


def run(arguments: argparse.Namespace) -> int:
    """Search, check, write; an interrupted search goes on where it stopped when called again."""
    import json

    import tomli_w
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    from affine_model.swim import OBJECTIVES as OBJECTIVE_TABLE
    from affine_model.swim import optimise, robust_trial, trial_of
    from tentacle.cli._swimming import SearchNotes, result_tables, write_whole
    from tentacle.errors import InputError
    from tentacle.model_file import model_tables
    from tentacle.waveform_file import waveform_table

    if arguments.evaluations < 50:
        raise InputError(f"{arguments.evaluations} is too few", field="--evaluations", expected="50 or more")
    if arguments.robust < 0 or arguments.robust == 1:
        raise InputError(f"{arguments.robust} is not usable", field="--robust", expected="2 or more samples")
    model, limits = read_arm(arguments.arm, arguments.silicone), read_limits(arguments.limits)
    trial = trial_of(model, limits)
    if arguments.robust:
        trial = robust_trial(trial, model, arguments.robust, arguments.seed)
    arguments.out.mkdir(parents=True, exist_ok=True)
    names = ("objective", "method", "evaluations", "seed", "robust")
    inputs = {
        "model": model_tables(model),
        "limits": vars(limits),
        **{name: getattr(arguments, name) for name in names},
    }
    notes = SearchNotes(arguments.out / "search.jsonl", inputs)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed:.0f} gaits"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, transient=True) as progress:
        task = progress.add_task(f"{arguments.method}, {arguments.objective}", total=arguments.evaluations)

        def watch(generation: Any) -> None:
            notes.note(generation)
            progress.update(task, completed=generation.evaluations)

        found = optimise(
            trial,
            OBJECTIVE_TABLE[arguments.objective],
            method=arguments.method,
            evaluations=arguments.evaluations,
            seed=arguments.seed,
            noted=notes.scores(),
            watch=watch,
        )
    tables = result_tables(found, waveform_table)
    if not arguments.no_reference:
        tables["reference"] = check_on_reference(model, found)
    details: dict[str, Any] = {"evaluations": found.evaluations.tolist(), "best": found.best.tolist()}
    if arguments.front:
        details["front"] = front_table(trace_front(model, limits, arguments.seed))
    write_whole(arguments.out / "result.toml", tomli_w.dumps(tables))
    write_whole(arguments.out / "result.json", json.dumps({**tables, "course": details}, indent=1))
    lines = summary(tables)
    show(found, tables, lines, arguments.out)
    for line in lines:
        print(line)
    print(f"written to {arguments.out}")
    return 0


def show(found: Swimming, tables: dict[str, Any], lines: list[str], out: Path) -> None:
    """Write session.rrd and report.html: the search's course, the motion found and the best sine, what they promise."""
    import shlex
    import sys

    import numpy as np

    from affine_model.swim import OBJECTIVES as OBJECTIVE_TABLE
    from viz.optimise import Search, write_optimisation
    from viz.report import Origin, write_report
    from viz.verb_reports import optimisation_report
    from viz.words import number

    t = np.linspace(0.0, 5.0, 501)
    ends, level = found.evaluations[[0, -1]], np.full(2, found.sine_value)
    searches = {
        found.method: Search(found.evaluations, found.best, t, found.gait(t)[0]),
        "best sine": Search(ends, level, t, found.sine(t)[0]),
    }
    promise, sine = tables["promise"], tables["sine"]["promise"]
    rows = [
        (name, unit, number(scale * promise[key]), number(scale * sine[key]) if key in sine else "-")
        for key, (name, unit, scale) in PROMISES.items()
        if key in promise
    ]
    objective = OBJECTIVE_TABLE[found.objective]
    quantity = f"{objective.words} [{objective.unit}]"
    command = shlex.join(["tentacle", *sys.argv[1:]])
    page = optimisation_report(searches, quantity, rows, lines[0], Origin(command, found.seed))
    write_optimisation(searches, quantity, out / "session.rrd")
    write_report(page, out / "report.html")


def read_arm(path: Path, silicone: str) -> Model:
    """The model in a model.toml, or textbook numbers for the specimen of a recording.toml or import folder."""
    from affine_model.swim import assumed_model
    from tentacle.declaration_file import read_recording_file
    from tentacle.model_file import read_model
    from tentacle.specimen import WATER
    from tentacle.toml_table import read_toml

    file = path / "recording.toml" if path.is_dir() else path
    _, values = read_toml(file)
    if "effects" in values:
        return read_model(file)
    declaration = read_recording_file(file).declaration
    fluid = declaration.fluid if "fluid" in values else WATER
    return assumed_model(declaration.specimen, silicone, fluid, declaration.gravity)


def read_limits(path: Path | None) -> ServoLimits:
    """The servo's limits in a TOML file, defaults where it says nothing; InputError names what is wrong."""
    from affine_model.swim import ServoLimits
    from tentacle.toml_table import Table, read_toml

    if path is None:
        return ServoLimits()
    text, values = read_toml(path)
    document = Table(values, file=path, text=text)
    table = document.required_table("limits")
    given = {field: table.number(name, above=0) for name, field in LIMITS.items() if name in table}
    table.finish()
    document.finish()
    return ServoLimits(**given)


def check_on_reference(model: Model, found: Swimming) -> dict[str, float]:
    """What MuJoCo gives for the gait and the best sine: speeds on the rail, mean thrust clamped, and the gains."""
    from tentacle.cli._swimming import reference_speed, reference_thrust

    speed, sine_speed = reference_speed(model, found.gait), reference_speed(model, found.sine)
    thrust, sine_thrust = reference_thrust(model, found.gait), reference_thrust(model, found.sine)
    return {
        "speed_m_s": speed,
        "sine_speed_m_s": sine_speed,
        "speed_gain": speed / sine_speed,
        "thrust_n": thrust,
        "sine_thrust_n": sine_thrust,
        "thrust_gain": thrust / sine_thrust,
    }


def trace_front(model: Model, limits: ServoLimits, seed: int) -> Front:
    """The front of speed against power at the model's estimates."""
    from affine_model.swim import PAPER_RAIL, pareto_front, search_box, trial_of

    return pareto_front(trial_of(model, limits, PAPER_RAIL), search_box(limits), evaluations=1500, seed=seed)


def front_table(front: Front) -> dict[str, list[Any]]:
    """A front as plain data."""
    return {
        "alpha": front.alpha.T.tolist(),
        "speed_m_s": front.speed.tolist(),
        "power_w": front.power.tolist(),
    }


def summary(tables: dict[str, Any]) -> list[str]:
    """The result in a few lines."""
    search, promise, sine = tables["search"], tables["promise"], tables["sine"]["promise"]
    lines = [
        f"{search['objective']}: {search['gain']:.2f} times the best sine that this servo can follow "
        f"({search['evaluations']} gaits, {search['method']}, seed {search['seed']})",
        f"thrust {1e3 * promise['thrust_n']:.1f} mN (sine {1e3 * sine['thrust_n']:.1f}), "
        f"speed {100 * promise['speed_m_s']:.2f} cm/s (sine {100 * sine['speed_m_s']:.2f}), "
        f"power {1e3 * promise['power_w']:.1f} mW (sine {1e3 * sine['power_w']:.1f})",
    ]
    if "reference" in tables:
        reference = tables["reference"]
        lines.append(
            f"MuJoCo: thrust {1e3 * reference['thrust_n']:.1f} mN, speed {100 * reference['speed_m_s']:.2f} cm/s; "
            f"{reference['thrust_gain']:.2f} and {reference['speed_gain']:.2f} times the sine's"
        )
    return lines
