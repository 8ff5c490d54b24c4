"""tentacle optimise: the gait of eq. 20 that swims best with this arm and this servo."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from affine_model.swim import Front, GaitLimits, Generation, Swimming, Trial
    from tentacle.model import Model

HELP = "find the base motion that swims best, within the servo's limits"

# Named here, not imported, so that --help stays quick; a test holds them to the package's own.
OBJECTIVES = ("thrust", "speed", "transport")
METHODS = ("cmaes", "ga", "random")
SILICONES = ("dragon-skin-10", "dragon-skin-20", "ecoflex-00-30")
SERVO = ("angle_rad", "speed_rad_s", "acceleration_rad_s2")
DRIVE = ("torque_n_m", "bandwidth_hz", "lowest_frequency_hz", "highest_frequency_hz")


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
    parser.add_argument("--limits", type=Path, help=f"TOML with a [limits] table of {', '.join(SERVO + DRIVE)}")
    parser.add_argument("--silicone", choices=SILICONES, default=SILICONES[0], help="of an arm without a fitted model")
    parser.add_argument("--robust", type=int, default=0, metavar="N", help="over N samples of the model's intervals")
    parser.add_argument("--restarts", type=int, default=1, metavar="N", help="searches from N seeds side by side")
    parser.add_argument("--cluster", metavar="ADDRESS", help="Dask scheduler for the searches (default: processes)")
    parser.add_argument("--device", default="auto", help="cpu, cuda, cuda:1; auto (default): CUDA where there is one")
    parser.add_argument("--front", action="store_true", help="also trace the front of speed against power")
    parser.add_argument("--no-reference", action="store_true", help="leave out the check on the MuJoCo reference")


def run(arguments: argparse.Namespace) -> int:
    """Search, check, write; an interrupted search goes on where it stopped when called again."""
    from dataclasses import replace

    from affine_model.swim import robust_trial, trial_of
    from affine_model.swim.device import chosen_device
    from tentacle.cli._swim_work import best_of_restarts
    from tentacle.cli._swimming import result_tables
    from tentacle.errors import InputError
    from tentacle.io.result_folder import written
    from tentacle.io.waveform_file import waveform_table

    if arguments.evaluations < 50:
        raise InputError(f"{arguments.evaluations} is too few", field="--evaluations", expected="50 or more")
    if arguments.robust < 0 or arguments.robust == 1:
        raise InputError(f"{arguments.robust} is not usable", field="--robust", expected="2 or more samples")
    if arguments.restarts < 1:
        raise InputError(f"{arguments.restarts} is not usable", field="--restarts", expected="1 or more")
    model, limits = read_arm(arguments.arm, arguments.silicone), read_limits(arguments.limits)
    device = chosen_device(arguments.device)
    at_estimates = replace(trial_of(model, limits), device=device)
    trial = robust_trial(at_estimates, model, arguments.robust, seed=0) if arguments.robust else at_estimates
    if arguments.restarts > 1 or arguments.cluster:
        settings = {name: getattr(arguments, name) for name in ("objective", "method", "evaluations", "robust")}
        settings["device"] = device
        seeds = range(arguments.seed, arguments.seed + arguments.restarts)
        found = best_of_restarts(model, limits, settings, seeds, arguments.out / "searches", arguments.cluster)
    else:
        found = search_with_progress(arguments, trial, model)
    tables = result_tables(found, waveform_table)
    if not arguments.no_reference:
        try:
            tables["reference"] = check_on_reference(model, found)
        except InputError as error:  # an effect of the reduced model that the reference lacks
            tables["left_out"] = {"reference": str(error)}
    front = trace_front(at_estimates, found) if arguments.front else None
    with written(arguments.out) as folder:
        write_answer(arguments, at_estimates, found, tables, front, folder)
    for line in summary(tables):
        print(line)
    print(f"report: {arguments.out / 'report.html'}   replay: tentacle view {arguments.out / 'session.rrd'}")
    return 0


def search_with_progress(arguments: argparse.Namespace, trial: Trial, model: Model) -> Swimming:
    """The search with a bar on standard error, noted generation by generation in OUT/search.jsonl."""
    from dataclasses import asdict

    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    from affine_model.swim import OBJECTIVES as OBJECTIVE_TABLE
    from affine_model.swim import optimise
    from tentacle.cli._swim_work import VERSION
    from tentacle.cli._swimming import SearchNotes
    from tentacle.io.model_file import model_tables

    settings = {name: getattr(arguments, name) for name in ("objective", "method", "evaluations", "seed", "robust")}
    inputs = {"version": VERSION, "model": model_tables(model), "limits": asdict(trial.limits), **settings}
    notes = SearchNotes(arguments.out / "search.jsonl", inputs)
    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.completed:.0f} gaits"))
    with Progress(*columns, TimeRemainingColumn(), transient=True, console=Console(stderr=True)) as progress:
        task = progress.add_task(f"{arguments.method}, {arguments.objective}", total=arguments.evaluations)

        def watch(generation: Generation) -> None:
            notes.note(generation)
            progress.update(task, completed=generation.evaluations)

        return optimise(
            trial,
            OBJECTIVE_TABLE[arguments.objective],
            method=arguments.method,
            evaluations=arguments.evaluations,
            seed=arguments.seed,
            noted=notes.scores(),
            watch=watch,
        )


def write_answer(
    arguments: argparse.Namespace,
    trial: Trial,
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

    from tentacle.cli.pages.swimming import write_film, write_page
    from tentacle.io.provenance import input_hashes, versions
    from tentacle.io.waveform_file import write_waveform
    from viz.report import Origin

    course = {"evaluations": found.evaluations.tolist(), "best": found.best.tolist()}
    everything = {**tables, "course": course} | ({} if front is None else {"front": front_table(front)})
    write_waveform(found.gait, folder / "gait.toml")
    (folder / "result.toml").write_text(tomli_w.dumps(tables), encoding="utf-8", newline="\n")
    (folder / "result.json").write_text(json.dumps(everything, indent=1) + "\n", encoding="utf-8")
    write_film(trial, found, folder / "session.rrd")
    files = [path for path in (arguments.arm, arguments.limits) if path is not None]
    command = shlex.join(["tentacle", *sys.argv[1:]])
    origin = Origin(command, arguments.seed, versions(), input_hashes(files))
    write_page(trial, found, tables, front, origin, folder / "report.html")


def read_arm(path: Path, silicone: str) -> Model:
    """The model in a model.toml, or textbook numbers for the specimen of a recording.toml or import folder."""
    from affine_model.swim import assumed_model
    from tentacle.io.declaration_file import read_recording_file
    from tentacle.io.model_file import read_model
    from tentacle.io.toml_table import read_toml
    from tentacle.specimen import WATER

    file = path / "recording.toml" if path.is_dir() else path
    _, values = read_toml(file)
    if "effects" in values:
        return read_model(file)
    declaration = read_recording_file(file).declaration
    fluid = declaration.fluid if "fluid" in values else WATER
    return assumed_model(declaration.specimen, silicone, fluid, declaration.gravity)


def read_limits(path: Path | None) -> GaitLimits:
    """The servo's limits in a TOML file, defaults where it says nothing; InputError names what is wrong."""
    from dataclasses import replace

    from affine_model.swim import HOBBY_SERVO, GaitLimits
    from tentacle.io.toml_table import Table, read_toml

    if path is None:
        return GaitLimits()
    text, values = read_toml(path)
    document = Table(values, file=path, text=text)
    table = document.required_table("limits")
    servo = {name: table.number(name, above=0) for name in SERVO if name in table}
    drive = {name: table.number(name, above=0) for name in DRIVE if name in table}
    table.finish()
    document.finish()

    def field(name: str) -> str:  # bandwidth_hz -> bandwidth
        return next(
            name.removesuffix(unit) for unit in ("_rad_s2", "_rad_s", "_rad", "_n_m", "_hz") if name.endswith(unit)
        )

    limited = replace(HOBBY_SERVO, **{field(name): value for name, value in servo.items()})
    return GaitLimits(limited, **{field(name): value for name, value in drive.items()})


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


def trace_front(trial: Trial, found: Swimming) -> Front:
    """The front of speed against power at the model's estimates."""
    import numpy as np

    from affine_model.swim import PAPER_RAIL, pareto_front, search_box

    known, box = np.array([found.gait.alpha, found.sine.alpha]).T, search_box(trial.limits)
    return pareto_front(trial.on_rail(PAPER_RAIL), box, known=known, evaluations=8000, seed=found.seed)


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
        f"({search['evaluations']} gaits, {search['method']}, seed {search['seed']}; climbed from: {search['origin']})",
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
    if "left_out" in tables:
        lines.append(f"MuJoCo: not checked; {tables['left_out']['reference']}")
    return lines
