"""What a library of 200 recordings shows together that no single one does: an effect of R = .3 in 20 of them.

R: rms of what the effect leaves after a refit of the arm's parameters, in noise sigmas per measured number. The
recordings are the reduced model's own, of one arm with three motions in turn: 4 s at 30 frames/s, 21 points, .1 mm of
noise, 1 210 numbers. Stiffness, damping and drag vary between recordings by 1, 5 and 3 %, and the stiffness falls by
4 % over the library. The models err in nothing but what is hidden: these figures say what noise and the variation of
the arm allow, not what the error of a declared law does.

Every recording is simulated and fitted (a quarter of a second of a core each), or, with --linear, drawn in the linear
model of one recording of its motion that was simulated and fitted: its sensitivities, with new noise and new
parameters. What is not linear in an effect, and how a fit ends, is then left out.

Ten libraries, an effect each; in every other one the 20 recordings follow each other, in the others they are drawn at
random. The 20 are made for their library. The 180 beside them are chosen, place by place, from so many (--replicates)
recordings without an effect; the ten libraries without an effect are made likewise. With --linear each has its own.
Evidence is kept in --keep, so that an interrupted run goes on. joint_f1_90: the share of libraries in which the effect,
alone or in a group that the motions cannot separate, is found with an F1 of .9 or more.

Printed beside: the signal-to-noise ratio of one recording in white noise, R sqrt(N), and in the likelihood of a
diagnosis; the largest F1 that any rule can reach that judges each recording by itself at that ratio; and how many of
the 20 recordings would name the effect by themselves (their first-order evidence over the prior of a diagnosis).
"""

from __future__ import annotations

import argparse
import json
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from _library_recordings import DRIFT, HIDDEN, MOTIONS, Made, alone, drawn, made, strength_of
from scipy.stats import norm

from discovery.decide import log_prior_of_set
from discovery.library.evidence import RecordingEvidence, base_hypothesis, evidence_of, read_evidence, write_evidence
from discovery.library.joint import JointAnswer, combine
from tentacle.signals import Array

RECORDINGS, WITH_IT, R = 200, 20, 0.3
DAYS: Array = np.arange(float(RECORDINGS)) / 2.0  # two a day


def evidence(of: Made, hidden: dict[str, dict[str, float]], file: Path) -> RecordingEvidence:
    """A recording's evidence, made or read again."""
    if not file.exists():
        write_evidence(evidence_of(base_hypothesis(made(of, hidden), 2)), file)
    return read_evidence(file)[0]


def limit(ratio: float, share: float = WITH_IT / RECORDINGS) -> float:
    """The largest F1 of a threshold on estimates N(0, 1) in 1 - share of the recordings, N(ratio, 1) in the others."""
    level = np.linspace(-2.0, ratio + 4.0, 2001)
    hit, false = share * norm.sf(level - ratio), (1.0 - share) * norm.sf(level)
    return float(np.max(2.0 * hit / (hit + false + share)))


@dataclass(frozen=True)
class Source:
    """Where recordings come from: the folder in which evidence is kept, how many recordings without an effect there are
    for each place, and whether they are drawn in a linear model instead.
    """

    keep: Path
    replicates: int
    linear: bool

    def reference(self, motion: int) -> RecordingEvidence:
        """The evidence of a recording of that motion without an effect, from the middle of the library."""
        return evidence(Made(0.5, motion, 10**6 + motion), {}, self.keep / f"reference_{motion}.npz")


def strengths(library: int, source: Source) -> list[float]:
    """The hidden strength under each motion."""
    return [strength_of(source.reference(m), HIDDEN[library], R) for m in range(len(MOTIONS))]


def with_effect(library: int) -> list[int]:
    """The places of the recordings in which the effect acts."""
    random = np.random.default_rng(library)
    if library % 2:
        return sorted(random.choice(RECORDINGS, WITH_IT, replace=False).tolist())
    first = int(random.integers(0, RECORDINGS - WITH_IT))
    return list(range(first, first + WITH_IT))


def library_of(number: int, source: Source, places: list[int]) -> list[RecordingEvidence]:
    """A library's evidence, the hidden effect at those places."""
    if source.linear:
        return linear_library(number, source, places)
    random = np.random.default_rng([number, len(places)])
    drawn_from = random.integers(0, source.replicates, RECORDINGS)
    effect, parameter, shapes = HIDDEN[number]
    sizes, found = strengths(number, source) if places else [], []
    for k in range(RECORDINGS):
        place, motion = k / (RECORDINGS - 1), k % len(MOTIONS)
        if k in places:
            hidden = {effect: {parameter: sizes[motion], **shapes}}
            of = Made(place, motion, 10**5 * (number + 1) + k)
            found.append(evidence(of, hidden, source.keep / f"{effect}_{k:03d}.npz"))
        else:
            of = Made(place, motion, int(1000 * drawn_from[k] + k))
            found.append(evidence(of, {}, source.keep / f"none_{of.seed:05d}.npz"))
    return found


def linear_library(number: int, source: Source, places: list[int]) -> list[RecordingEvidence]:
    """The same, drawn in the linear models of the references."""
    references = [source.reference(m) for m in range(len(MOTIONS))]
    sizes, found = strengths(number, source), []
    for k in range(RECORDINGS):
        one = references[k % len(MOTIONS)]
        column = column_of(one, number)
        strength = sizes[k % len(MOTIONS)] / one.scale[column] if k in places else 0.0
        seed = 10**5 * (number + 1) + k + 50000 * (not places)
        found.append(drawn(one, Made(k / (RECORDINGS - 1), k % len(MOTIONS), seed), column, strength))
    return found


def column_of(one: RecordingEvidence, library: int) -> int:
    """The place of the hidden effect's column among those of roots."""
    effect, parameter, shapes = HIDDEN[library]
    return len(one.free) + one.columns.index((effect, parameter, tuple(shapes.values())))


def ratios(library: int, recordings: list[RecordingEvidence], places: list[int], share: int, source: Source) -> Array:
    """(20, 3): signal-to-noise ratio in white noise, in a diagnosis, and in a diagnosis coarsened."""
    sizes, found = strengths(library, source), []
    for k in places:
        one = recordings[k]
        column = column_of(one, library)
        strength = sizes[k % len(MOTIONS)] / one.scale[column]
        white, seen = (strength * alone(root, len(one.free), column) for root in (one.noise_root, one.roots[share]))
        found.append([white, seen, seen / np.sqrt(one.coarsening)])
    return np.array(found)


def named_alone(library: int, recordings: list[RecordingEvidence], places: list[int]) -> int:
    """In how many of these recordings the effect's own evidence, coarsened, exceeds the prior odds against it."""
    count = 0
    for one in (recordings[k] for k in places):
        root, free = one.roots[int(np.argmax(one.log_evidence))], len(one.free)
        column = column_of(one, library)
        basis, _ = np.linalg.qr(root[:, :free])
        rest, own = (root[:, c] - basis @ (basis.T @ root[:, c]) for c in (-1, column))
        size = float(np.linalg.norm(own))
        strength = -float(own @ rest) / size**2
        price = np.log(np.pi * (1.0 + strength**2) * size / np.sqrt(2.0 * np.pi))
        gain = (0.5 * (strength * size) ** 2 - price) / one.coarsening
        count += bool(gain > log_prior_of_set(0) - log_prior_of_set(1))
    return count


def score(answer: JointAnswer, effect: str, places: list[int]) -> dict[str, float | str]:
    """How one library was answered."""
    truth = np.zeros(RECORDINGS, dtype=bool)
    truth[places] = True
    own = next((one for one in answer.effects if effect in one.names), None)
    claimed = np.zeros(RECORDINGS, dtype=bool) if own is None else own.claimed
    right = int((claimed & truth).sum())
    total = sum(int(one.claimed.sum()) for one in answer.effects)
    change = answer.trends[("elasticity", "E")]
    assert change.change is not None
    fell, low, high = (value / change.start for value in change.change)
    return {
        "effect": effect,
        "named": " / ".join(own.names) if own is not None else "-",
        "alone": float(own is not None and own.names == (effect,)),
        "f1": 2.0 * right / max(int(claimed.sum()) + len(places), 1),
        "others": " ".join(one.names[0] for one in answer.effects if one is not own),
        "claims": float(total),
        "false_claims": float(total - right),
        "stated_false_share": answer.false_claims,
        "E_change": fell,
        "E_low": low,
        "E_high": high,
        "E_interval_holds": float(low <= DRIFT <= high),
    }


def figures(source: Source, count: int) -> dict[str, object]:
    """All libraries, with an effect and without."""
    rows, empty = [], []
    for number in range(count):
        places = with_effect(number)
        recordings = library_of(number, source, places)
        answer = combine(recordings, DAYS)
        row = score(answer, HIDDEN[number][0], places)
        three = ratios(number, recordings, places, answer.pool.share, source)
        row |= {
            "in_a_row": float(number % 2 == 0),
            "named_by_one_recording": float(named_alone(number, recordings, places)),
            "ratio_white": float(np.median(three[:, 0])),
            "ratio_diagnosis": float(np.median(three[:, 1])),
            "ratio_coarsened": float(np.median(three[:, 2])),
            "f1_limit_diagnosis": limit(float(np.median(three[:, 1]))),
            "f1_limit_coarsened": limit(float(np.median(three[:, 2]))),
        }
        rows.append(row)
        print(json.dumps(row), flush=True)
        answer = combine(library_of(number, source, []), DAYS)
        empty.append([one.names[0] for one in answer.effects if one.claimed.any()])
        print(json.dumps({"without": empty[-1], "mass_of_none": answer.mass_of_none}), flush=True)
    alone_and_right = [float(row["alone"]) * (float(row["f1"]) >= 0.9) for row in rows]
    found = [float(row["named"] != "-") for row in rows]
    claims = sum(float(row["claims"]) for row in rows)
    return {
        "libraries": rows,
        "libraries_without": empty,
        "joint_found": float(np.mean(found)),
        "joint_f1_90": float(np.mean([float(row["f1"]) >= 0.9 for row in rows])),
        "joint_alone_and_f1_90": float(np.mean(alone_and_right)),
        "joint_f1_median": float(np.median([float(row["f1"]) for row in rows])),
        "joint_false_libraries": float(np.mean([bool(one) for one in empty])),
        "joint_false_share": sum(float(row["false_claims"]) for row in rows) / max(claims, 1.0),
        "joint_E_interval_holds": float(np.mean([float(row["E_interval_holds"]) for row in rows])),
    }


def main() -> None:
    """Print the figures; --json writes them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, metavar="FILE")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="where evidence is kept for the next run")
    parser.add_argument("--replicates", type=int, default=3, metavar="N", help="recordings a place, default: 3")
    parser.add_argument("--libraries", type=int, default=len(HIDDEN), metavar="N", help=f"default: {len(HIDDEN)}")
    parser.add_argument("--linear", action="store_true", help="draw recordings in a linear model instead")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        source = Source(arguments.keep or Path(folder), arguments.replicates, arguments.linear)
        found = figures(source, arguments.libraries)
    for name, value in found.items():
        if isinstance(value, float):
            print(f"{name}: {value:.4g}")
    if arguments.json is not None:
        arguments.json.write_text(json.dumps({"figures": found}, indent=1) + "\n")


if __name__ == "__main__":
    main()
