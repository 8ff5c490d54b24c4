"""Laplace's evidence is a number where the data close every direction of the unknowns, and none elsewhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from inference.prior import laplace_evidence


def test_an_unknown_that_nothing_determines_has_no_evidence(plain):
    assert np.isfinite(laplace_evidence(plain.problem, plain.fitted, 1.0))
    jacobian = plain.fitted.jacobian.copy()
    jacobian[:, -1] = 0.0  # the last initial rate, which no frame and no prior shows
    assert laplace_evidence(plain.problem, replace(plain.fitted, jacobian=jacobian), 1.0) == -np.inf
