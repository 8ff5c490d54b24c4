"""What one recording says of its arm's parameters and of every absent effect: a Gaussian about its own base fit.

    -2 log p(recording | x) = |root (x - centre, 1)|^2 + const.,        x = (base parameters, strengths of effects)

root is the triangular factor of [J S r], from which the recording's own unknowns (initial state, clamp, ...) are
projected out. J: derivatives of the whitened residuals by the base parameters; S: by each effect's strengths, all
absent; r: the residual of the base fit. All are whitened as in a diagnosis (inference.latent_force), at several shares
of unknown forces. Effects add to first order: this is the score test (inference.score) before anything is decided, so
that recordings can be put together later without being simulated again.
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

import numpy as np

from affine_model.curvature import Array
from affine_model.effect import Effect
from affine_model.effects import absent_effects
from discovery.decide import form_coarsening
from inference.base_fit import Setting, fitted_order, most_coordinates, needed_order, rough_base_fit
from inference.fit import Fit
from inference.latent_force import Filter
from inference.motion import motion_shown
from inference.posterior import FORCE_SHARES, Hypothesis, declared_model
from inference.prepare import prepare
from inference.score import Response, responses
from inference.sufficient_step import sufficient_step
from inference.trajectory import ParameterName, Problem
from inference.whitened_fit import tangent_basis, whitened, whitened_rows
from tentacle.errors import InputError
from tentacle.io.written_file import written_file
from tentacle.recording import Recording

# Of FORCE_SHARES; chosen, for time and room: all of them cost a recording 1 to 1.6 s (15 %) and 90 kB more.
SHARES = tuple(range(0, len(FORCE_SHARES), 3))
PER_RECORDING = ("sloshing",)  # effects whose strengths depend on when a recording began: they are not one number

Column = tuple[str, str, tuple[float, ...]]  # an effect, one of its strengths, the values of its shapes


@dataclass(frozen=True)
class RecordingEvidence:
    """One recording's evidence.

    free: base parameters; centre (P,): their values at the recording's own fit. columns: strengths of effects, C of
    them; nominal (C,): their typical sizes. scale (P + C,): one unit of each column of roots. roots (A, P + C + 1,
    P + C + 1), the last column the residual; log_evidence (A,) [nats] of the base fit at each of SHARES. coarsening: T
    of the decision (discovery.decide), without effects: the factor by which this recording's evidence is coarsened.
    data: how many numbers were measured. noise_root: as roots, with white noise alone.
    """

    free: tuple[ParameterName, ...]
    centre: Array
    columns: tuple[Column, ...]
    scale: Array
    roots: Array
    log_evidence: Array
    coarsening: float
    data: int
    noise_root: Array


def order_of(recording: Recording) -> int:
    """How many curvature coordinates this recording shows. InputError (CannotTellError) where it is unusable."""
    prepared = prepare(recording, hold_out=False)
    return needed_order(Setting(recording.declaration, (prepared.experiment,), 2))


def base_hypothesis(recording: Recording, order: int, start: Fit | None = None) -> Hypothesis:
    """The declared model with that many coordinates, fitted to all frames of one recording.

    The number is the arm's, not the recording's: models of different order err differently, and the difference between
    two recordings would look like an effect in one of them. start: a fit of this arm from which this fit begins.
    InputError (CannotTellError) where the recording is unusable or shows too little.
    """
    prepared = prepare(recording, hold_out=False)
    setting = Setting(recording.declaration, (prepared.experiment,), order)
    problem, fitted = rough_base_fit(setting, 2, warm=start)
    if order > 2:
        setting = replace(setting, experiments=problem.experiments)
        problem, fitted = rough_base_fit(setting, fitted_order(order, most_coordinates(problem)), warm=fitted)
    fine = replace(problem, step=sufficient_step(problem, fitted), parameters=fitted.parameters)
    return declared_model(fine, fitted.nuisances)


def evidence_of(base: Hypothesis) -> RecordingEvidence:
    """The evidence of a base hypothesis of one recording."""
    problem, fitted = base.problem, base.fitted
    effects = tuple(effect for effect in absent_effects() if effect.name not in PER_RECORDING)
    known = [one for one in responses(problem, fitted, effects) if one.shapes in _scanned(one.effect)]
    columns = tuple((one.effect.name, s.name, one.shapes) for one in known for s in one.effect.strengths)
    nominal = [s.nominal for one in known for s in one.effect.strengths]
    count = len(problem.free)
    scale = np.concatenate([problem.scales()[:count], nominal])
    roots = [
        _root(problem, fitted, known, tuple(force.filter(FORCE_SHARES[place]) for force in base.forces), scale)
        for place in SHARES
    ]
    motion = motion_shown(problem, fitted, base.forces, FORCE_SHARES[0])
    return RecordingEvidence(
        free=problem.free,
        centre=fitted.values,
        columns=columns,
        scale=scale,
        roots=np.array(roots),
        log_evidence=base.log_evidence[list(SHARES)],
        coarsening=form_coarsening(motion.nats),
        data=int(
            sum(np.sum(rows[e.used] != 0.0) for e, rows in zip(problem.experiments, fitted.residuals, strict=True))
        ),
        noise_root=_root(problem, fitted, known, (), scale),
    )


def _scanned(effect: Effect) -> set[tuple[float, ...]]:
    """The choices of shapes that are the same in every recording."""
    return set(product(*(shape.scan for shape in effect.shapes)))


def _root(problem: Problem, fitted: Fit, known: Sequence[Response], filters: tuple[Filter, ...], scale: Array) -> Array:
    """The triangular factor (P + C + 1) of the whitened columns, without what the recording's own unknowns absorb."""
    rows = whitened_rows(problem, fitted, filters)
    slopes = [np.concatenate(own, axis=2) for own in zip(*(one.slopes for one in known), strict=True)]
    effects = whitened(problem, slopes, filters)
    effects = np.concatenate([effects, np.zeros((rows.shape[0] - effects.shape[0], effects.shape[1]))])
    count = len(problem.free)
    basis = tangent_basis(rows[:, 1 + count :])
    together = np.concatenate([rows[:, 1 : 1 + count] * scale[:count], effects * scale[count:], rows[:, :1]], axis=1)
    return np.asarray(np.linalg.qr(together - basis @ (basis.T @ together), mode="r"), dtype=np.float64)


def write_evidence(evidence: RecordingEvidence, file: Path, **stated: str) -> None:
    """The evidence as an .npz, whole or not at all; stated: texts that are kept beside it (the code's version)."""
    file.parent.mkdir(parents=True, exist_ok=True)
    words = {"free": evidence.free, "columns": evidence.columns, "coarsening": evidence.coarsening, **stated}
    with written_file(file) as partial, partial.open("wb") as stream:
        np.savez(
            stream, words=np.array(json.dumps(words)), data=evidence.data, centre=evidence.centre,
            scale=evidence.scale, log_evidence=evidence.log_evidence, roots=evidence.roots.astype(np.float32),
            noise_root=evidence.noise_root.astype(np.float32),
        )  # fmt: skip


def read_evidence(file: Path) -> tuple[RecordingEvidence, dict[str, str]]:
    """The evidence, and the texts kept beside it. InputError where the file is none of this program, or damaged."""
    try:
        with file.open("rb") as stream, np.load(stream, allow_pickle=False) as held:
            words = json.loads(str(held["words"]))
            arrays = {name: held[name] for name in ("centre", "scale", "log_evidence", "roots", "noise_root")}
            data = int(held["data"])
        free = tuple((str(effect), str(name)) for effect, name in words.pop("free"))
        columns = tuple((str(e), str(n), tuple(map(float, shapes))) for e, n, shapes in words.pop("columns"))
        coarsening = float(words.pop("coarsening"))
    except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile) as error:
        raise InputError(f"is no evidence: {error}", file=file, expected="a file of tentacle library joint") from None
    as_float = {name: np.asarray(values, dtype=np.float64) for name, values in arrays.items()}
    return RecordingEvidence(free=free, columns=columns, coarsening=coarsening, data=data, **as_float), words
