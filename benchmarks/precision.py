"""Work and precision: processor time over error, ours and other programs', on arms, motions and media.

    python benchmarks/precision.py --json FILE [--short] [--picture FILE.svg] [--only "soft slow air" ...]
                                   [--pyelastica PYTHON] [--soromox PYTHON]

Every case is kept in a file in the folder FILE.cases as soon as it is measured: the same command goes on after an
interruption, and measures anew what another commit measured.

Three cones (soft, middle, stiff), a slow and a fast motion, without fluid and in water with eq. 15's drag alone; no
gravity; the same law on both sides. Error, the larger of two: rms distance of the midline over the rms of the bending
(the distance from the straight arm that turns with the base), and, in water, the mean thrust's relative error. Truth:
our MuJoCo chain at 20 and 40 links, extrapolated in links and step (Richardson 1911); beside it, by other equations,
the reduced model at order 6. reference_gap is the largest error of the one judged by the other. A level is judged in a
case only where the two differ by less than half of it; unresolved_at_* counts the cases where they do not.

ratio_at_3_percent, ratio_at_1_percent, ratio_at_03_percent: least over the cases of the best other program's time over
ours, each by its cheapest setting tried that errs no more. Ours runs in batches of 512; *_single is one arm alone,
*_native is against MuJoCo's own chain alone (of the two chains ours is the faster). MuJoCo's own chain does not know
eq. 15: in water it runs in its own water and is judged, midline alone, by its own 20 links at the finest step.
lost_at_*: cases that no setting of ours meets. floor_order_n: the least error of n curvatures, worst case.
PyElastica and SoRoMoX run where an interpreter that has them is named, as the scripts of `tentacle export`: pinned to
one core, timed in the child, without what they compile. Their midline alone is judged.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

# benchmarks/vision.py and benchmarks/rig.py must not stand for the rooms of those names.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks._commit import commit_of
from benchmarks._precision_programs import FRAMES, Case, Material, Motion, Run, S, chain, cone, native, ours
from benchmarks._precision_rods import SETTINGS, rod
from tentacle.signals import Array

ARMS = (
    Material("soft", cone(0.21, 0.0125, 0.0025), 1e5, 1e3),
    Material("middle", cone(0.14, 0.0125, 0.0025), 2e5, 1e3),
    Material("stiff", cone(0.14, 0.0125, 0.005), 5e5, 3e3),
)
MOTIONS = {"slow": Motion(0.5, 0.5), "fast": Motion(0.5, 1.5)}
DENSITIES = {"air": 0.0, "water": 1000.0}
LEVELS = {"3": 0.03, "1": 0.01, "03": 0.003}
ORDERS, OWN_STEPS = (2, 3, 4, 5, 6), (1, 2, 3, 4, 6, 8, 12, 16, 24)
LINKS, CHAIN_STEPS, NATIVE_STEPS = (3, 5, 8, 12, 20), (1, 2, 4), (2, 5, 10, 20, 50)
INTEGRATORS = ("discrete", "implicitfast")  # Euler and RK4 are stable at far finer steps alone (physics)
MOST = 400  # links times steps a frame of MuJoCo's own chain: finer costs more than any that counts
FINEST = 12  # steps a frame of the reference
NATIVE = ("MuJoCo's own chain", "MuJoCo's own chain in its own water")
RODS = {"pyelastica": "PyElastica", "soromox": "SoRoMoX"}
NAMES = ("ours", "our MuJoCo chain", *NATIVE, *RODS.values())


@dataclass(frozen=True)
class Point:
    """One setting of one program on one case: error, cost [s of processor a simulated second], what was set."""

    program: str
    error: float
    cost: float
    setting: str


def bending(case: Case, xy: Array) -> float:
    """Rms [m] of the distance from the straight arm that turns with the base, over the frames of xy (F, P, 2)."""
    step = 1.0 / (FRAMES * case.motion.frequency)
    first = case.motion.periods * FRAMES - len(xy) + 1
    theta = case.motion((first + np.arange(len(xy))) * step)[0][:, None]
    reach = S * case.material.specimen.length
    straight = np.stack([-np.sin(theta) * reach, np.cos(theta) * reach], axis=-1)
    return float(np.sqrt(np.mean(np.sum((xy - straight) ** 2, axis=-1))))


def error_of(case: Case, run: Run, truth: Run) -> float:
    """The larger of the midline's error and, where the run knows it, the mean thrust's."""
    frames = min(len(run.xy), len(truth.xy))
    distance = np.sqrt(np.mean(np.sum((run.xy[-frames:] - truth.xy[-frames:]) ** 2, axis=-1)))
    error = float(distance / bending(case, truth.xy[-frames:]))
    if case.density and np.isfinite(run.thrust):
        error = max(error, abs(run.thrust / truth.thrust - 1.0))
    return error


def extrapolated(case: Case, coarse: int, fine: int) -> Run:
    """Our chain without its errors of second order, that of the links and that of the step."""
    slow, a, b = (
        chain(case, links, steps, timed=False)
        for links, steps in ((coarse, FINEST), (coarse, 2 * FINEST), (fine, 2 * FINEST))
    )
    share = coarse**2 / (fine**2 - coarse**2)
    xy = b.xy + share * (b.xy - a.xy) + (a.xy - slow.xy) / 3.0
    return Run(xy, b.thrust + share * (b.thrust - a.thrust) + (a.thrust - slow.thrust) / 3.0, np.nan)


def points(case: Case, truth: Run, short: bool, pythons: dict[str, str]) -> Iterator[Point]:
    """Every program at every setting; settings that run away are left out."""

    def tried(program: str, work: object, against: Run, *setting: object, **more: object) -> Iterator[Point]:
        try:
            run = work(case, *setting, **more)  # type: ignore[operator]
        except FloatingPointError:
            return
        error = error_of(case, run, against)
        if np.isfinite(error) and error < 1.0:
            yield Point(program, error, run.cost, " ".join(map(str, setting)))

    for order in ORDERS[: 1 if short else None]:
        for substeps in OWN_STEPS[:: 4 if short else 1]:
            yield from tried(NAMES[0], ours, truth, order, substeps)
            yield from tried("alone", ours, truth, order, substeps, count=1)
    for links in LINKS[: 2 if short else None]:
        for substeps in CHAIN_STEPS[:: 2 if short else 1]:
            yield from tried(NAMES[1], chain, truth, links, substeps)
    own = bool(case.density)
    against = native(case, 20, 200, "discrete", own, timed=False) if own else truth
    for links in LINKS[: 2 if short else None]:
        for substeps in NATIVE_STEPS[:: 3 if short else 1]:
            for integrator in INTEGRATORS[: 1 if short else None]:
                if links * substeps <= MOST:
                    yield from tried(NAMES[3 if own else 2], native, against, links, substeps, integrator, own)
    for to, python in pythons.items():
        for setting in SETTINGS[to][:: 5 if short else 1]:
            yield from tried(RODS[to], rod, truth, *setting, to=to, python=python)


def measured(case: Case, short: bool, pythons: dict[str, str]) -> tuple[float, list[Point]]:
    """The gap between the case's two references, and every program's points."""
    truth = extrapolated(case, *((10, 20) if short else (20, 40)))
    gap = error_of(case, ours(case, max(ORDERS), 96, count=1), truth) if not short else 0.0
    return gap, list(points(case, truth, short, pythons))


def kept(case: Case, short: bool, file: Path, pythons: dict[str, str]) -> tuple[float, list[Point]]:
    """measured(case, short, pythons), from the file where this commit measured it already; else it is written there."""
    head = {"commit": commit_of(Path(__file__).parent), "short": short, "rods": sorted(pythons)}
    if file.exists():
        known = json.loads(file.read_text(encoding="utf-8"))
        if {name: known.get(name) for name in head} == head:
            return known["gap"], [Point(**point) for point in known["points"]]
    gap, found = measured(case, short, pythons)
    whole = {**head, "gap": gap, "points": [asdict(point) for point in found]}
    file.parent.mkdir(parents=True, exist_ok=True)
    partial = file.with_suffix(".part")
    partial.write_text(json.dumps(whole, indent=1) + "\n", encoding="utf-8")
    partial.replace(file)
    return gap, found


def cheapest(found: list[Point], programs: tuple[str, ...], level: float) -> Point | None:
    """The cheapest setting of these programs that errs no more than level."""
    good = [point for point in found if point.program in programs and point.error <= level]
    return min(good, key=lambda point: point.cost, default=None)


def judged(name: str, found: list[Point], gap: float, figures: dict[str, float]) -> None:
    """Adds a case, whose two references differ by gap, to the figures: least ratios, cases lost and unresolved."""
    for suffix, level in LEVELS.items():
        if gap > 0.5 * level:
            figures[f"unresolved_at_{suffix}_percent"] += 1.0
            continue
        best_other = cheapest(found, NAMES[1:], level)
        native_best = cheapest(found, NATIVE, level)
        for program in RODS.values():
            alone, rods = cheapest(found, ("alone",), level), cheapest(found, (program,), level)
            if alone is not None and rods is not None:
                words = f"{alone.setting} {alone.cost:.2e} s against {rods.setting} {rods.cost:.2e} s"
                times = rods.cost / alone.cost
                print(f"  {name} at {100 * level:g} % alone over {program}: {times:.0f} times ({words})", flush=True)
        for own, ending, other in (
            (NAMES[0], "", best_other),
            ("alone", "_single", best_other),
            (NAMES[0], "_native", native_best),
        ):
            best, key = cheapest(found, (own,), level), f"ratio_at_{suffix}_percent{ending}"
            if best is None:
                figures[f"lost_at_{suffix}_percent"] += float(not ending)
            elif other is not None:
                ratio = other.cost / best.cost
                figures[key] = min(figures.get(key, np.inf), ratio)
                words = f"{best.setting} {best.cost:.2e} s against {other.program} {other.setting} {other.cost:.2e} s"
                print(f"  {name} at {100 * level:g} % {own}: {ratio:.0f} times ({words})", flush=True)


def picture(cases: dict[str, list[Point]], path: Path) -> None:
    """The diagram as a file."""
    from viz.figures.work_precision import work_precision_figure

    curves = {
        name: {program: [(p.error, p.cost) for p in found if p.program == program] for program in NAMES}
        for name, found in cases.items()
    }
    work_precision_figure(curves).savefig(path)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, required=True)
    parser.add_argument("--short", action="store_true", help="one arm, few settings: a smoke test")
    parser.add_argument("--picture", type=Path, help="where the diagram goes (.svg, .png)")
    parser.add_argument("--only", nargs="+", metavar="CASE", help="these cases alone, as 'soft slow air'")
    for to, program in RODS.items():
        parser.add_argument(
            f"--{to}", metavar="PYTHON", help=f"interpreter that has {program}; without it, it is left out"
        )
    arguments = parser.parse_args()
    pythons = {to: python for to in RODS if (python := getattr(arguments, to)) is not None}
    figures: dict[str, float] = {f"{name}_at_{k}_percent": 0.0 for name in ("lost", "unresolved") for k in LEVELS}
    folder = arguments.json.with_name(arguments.json.name + ".cases")
    figures["reference_gap"], cases = 0.0, dict[str, list[Point]]()
    floors: dict[int, float] = dict.fromkeys(ORDERS, 0.0)
    for material in ARMS[1 : 2 if arguments.short else None] if arguments.short else ARMS:
        for motion_name, motion in MOTIONS.items():
            for medium, density in DENSITIES.items():
                case, name = Case(material, motion, density), f"{material.name} {motion_name} {medium}"
                if arguments.only and name not in arguments.only:
                    continue
                gap, cases[name] = kept(case, arguments.short, folder / f"{name.replace(' ', '_')}.json", pythons)
                found = cases[name]
                figures["reference_gap"] = max(figures["reference_gap"], gap)
                print(f"{name}: the two references differ by {100 * gap:.3f} %", flush=True)
                judged(name, found, gap, figures)
                for order in ORDERS:
                    own = [p.error for p in found if p.program == NAMES[0] and p.setting.startswith(f"{order} ")]
                    floors[order] = max([floors[order], *([min(own)] if own else [])])
                whole = figures | {f"floor_order_{order}": floor for order, floor in floors.items() if floor}
                arguments.json.write_text(json.dumps({"figures": whole}, indent=1) + "\n", encoding="utf-8")
                if arguments.picture is not None:
                    picture(cases, arguments.picture)
    print(arguments.json.read_text(encoding="utf-8"))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
