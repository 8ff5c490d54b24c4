"""A recording's evidence says what a diagnosis' own score says, and recordings together say more than each alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from discovery.library.evidence import (
    PER_RECORDING,
    SHARES,
    base_hypothesis,
    evidence_of,
    read_evidence,
    write_evidence,
)
from discovery.library.joint import combine
from discovery.library.joint_data import joint_data
from discovery.library.pooled import directions, estimates_of, pool_of
from inference.posterior import FORCE_SHARES
from inference.score import responses, score
from inference.whitened_fit import whitened_fit
from tentacle.errors import InputError
from tests.made_recordings import TRUTH, record

SECONDS, U = 3.0, 0.004
WITH_IT = (4, 5, 6, 7)
COUNT = 12


@pytest.fixture(scope="module")
def bases():
    """Twelve recordings of one arm, 4 % softer at the end; a current in four in a row."""
    found = []
    for k in range(COUNT):
        hidden = {("elasticity", "E"): TRUTH["elasticity", "E"] * (1.0 - 0.04 * k / (COUNT - 1))}
        hidden |= {("current", "U_x"): U} if k in WITH_IT else {}
        start = found[0].fitted if found else None
        found.append(base_hypothesis(record(hidden, seconds=SECONDS, seed=k), 2, start))
    return found


@pytest.fixture(scope="module")
def library(bases):
    return [evidence_of(base) for base in bases]


def test_the_evidence_says_what_the_score_of_a_diagnosis_says(bases, library):
    base, evidence = bases[4], library[4]
    for share in (0, 2):
        filters = tuple(force.filter(FORCE_SHARES[SHARES[share]]) for force in base.forces)
        known = [one for one in responses(base.problem, base.fitted) if one.effect.name not in PER_RECORDING]
        gains = {
            (c.effect.name, c.shapes): c.gain
            for c in score(whitened_fit(base.problem, base.fitted, filters), known)
            if len(c.effect.strengths) == 1
        }
        root, free = evidence.roots[share], len(evidence.free)
        basis, _ = np.linalg.qr(root[:, :free])
        rest = root[:, -1] - basis @ (basis.T @ root[:, -1])
        for place, (effect, _, shapes) in enumerate(evidence.columns):
            if (effect, shapes) not in gains:
                continue
            column = root[:, free + place] - basis @ (basis.T @ root[:, free + place])
            gain = 0.5 * (column @ rest) ** 2 / (column @ column)
            assert gain == pytest.approx(gains[effect, shapes], rel=1e-4, abs=1e-6)


def test_evidence_is_read_as_it_was_written(library, tmp_path):
    file = tmp_path / "one.npz"
    write_evidence(library[0], file, code="abc")
    again, stated = read_evidence(file)
    assert stated == {"code": "abc"}
    assert (again.free, again.columns, again.data) == (library[0].free, library[0].columns, library[0].data)
    np.testing.assert_allclose(again.roots, library[0].roots, rtol=1e-6, atol=1e-6 * np.abs(library[0].roots).max())
    file.write_bytes(file.read_bytes()[:200])
    with pytest.raises(InputError, match="is no evidence"):
        read_evidence(file)


def test_the_arm_s_change_and_the_current_s_recordings_are_found_together(library):
    days = np.arange(float(COUNT))
    answer = combine(library, days)
    assert answer.effects[0].names[0] == "current"
    np.testing.assert_array_equal(np.flatnonzero(answer.effects[0].claimed), WITH_IT)
    value, low, high = answer.effects[0].strengths["U_x"]
    # Twice the interval of 95 %: one noise in ten thousand lies outside.
    assert abs(value - U) < high - low
    assert answer.changed == (("elasticity", "E"),)
    change, low, high = np.array(answer.trends["elasticity", "E"].change) / answer.trends["elasticity", "E"].start
    assert abs(change + 0.04) < high - low
    assert answer.false_claims <= 0.05


def test_without_the_current_nothing_is_found(library):
    kept = [k for k in range(COUNT) if k not in WITH_IT]
    answer = combine([library[k] for k in kept], np.array(kept, dtype=float))
    assert answer.effects == ()
    assert answer.mass_of_none > 0.05
    assert joint_data(answer, [str(k) for k in kept])["effects"] == []


def test_a_recording_in_which_an_effect_cannot_act_says_nothing_of_it(library):
    dry = replace(library[0], columns=library[0].columns[:1], roots=library[0].roots[:, :, [0, 1, 2, 3, -1]])
    pool = pool_of([dry, *library[1:]], np.arange(float(COUNT)))
    sought = [one for one in directions(library) if one.effect == "current"]
    for one in estimates_of(pool, sought):
        assert not np.isfinite(one.deviations[0])
        assert np.isfinite(one.deviations[1:]).all()
