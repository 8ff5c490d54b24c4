"""Which law of the material a baseline lacks, where the declared model does not explain it.

    left(law) = sqrt(min |r(law)|^2 / min |r(none)|^2),     r: residuals of the baseline's recordings

Each law is declared in turn and fitted with the base parameters by least squares, from all of its starts.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from affine_model.effects import absent_effects, catalogue
from discovery.side_by_side import side_by_side
from inference.base_fit import Setting, rough_base_fit


def baseline_advice(setting: Setting) -> str | None:
    """A sentence on the law that leaves least of the baseline's error; None if there is no baseline or no such law."""
    alone = tuple(replace(e, varies=(), complete=False) for e in setting.experiments if e.complete)
    own = setting.declaration.specimen.laws
    laws = [law.name for law in absent_effects() if law.family == "elastic" and law.name not in own]
    if not alone or not laws:
        return None
    setting = replace(setting, experiments=alone)
    sets = [own, *((*own, law) for law in laws)]
    declared, *others = side_by_side([partial(_left, setting, one) for one in sets])
    least, best = min(others, default=declared)
    if declared[1] != own or least >= declared[0]:
        return None
    share = 100.0 * float(np.sqrt(least / declared[0]))
    names = ", ".join(f'"{name}"' for name in best)
    return (
        f"Of the laws of a material, {best[-1]} leaves least of the error of the baseline's recordings, {share:.0f} %. "
        f"If it acts in the arm itself, declare laws = [{names}] under [specimen] of all its recordings."
    )


def _left(setting: Setting, laws: tuple[str, ...]) -> tuple[float, tuple[str, ...]]:
    """Half the sum of squares [nats] that the declared model with these laws leaves, with two coordinates; the laws."""
    declaration = setting.declaration
    relaxes = any(catalogue()[law].relaxation_time is not None for law in laws)
    experiments = tuple(replace(e, declared=e.declared | set(laws), remembers=relaxes) for e in setting.experiments)
    with_laws = replace(declaration, specimen=replace(declaration.specimen, laws=laws))
    return rough_base_fit(replace(setting, declaration=with_laws, experiments=experiments), 2)[1].misfit, laws
