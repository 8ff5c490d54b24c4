"""A model with more curvature coordinates begins in the same pose, with the same motion."""

import numpy as np
import pytest

from inference.experiment import predict
from inference.more_coordinates import with_coordinates


def test_a_model_with_more_coordinates_begins_in_the_same_pose_with_the_same_motion(plain):
    problem, fitted = plain.problem, plain.fitted
    before = problem.arm.order
    more, nuisances = with_coordinates(problem, fitted.nuisances, before + 2)
    assert [own.size for own in nuisances] == more.sizes()
    begins = []
    for model, own in ((problem, fitted.nuisances), (more, nuisances)):
        run = predict(model.arm, model.experiments[0], fitted.parameters[:, None], own[0][:, None], model.step).batch
        begins.append([states[0, :, 0] @ model.arm.from_monomial.T for states in (run.q, run.q_rate)])
    for few, many in zip(*begins, strict=True):
        # Legendre coordinates are orthogonal: the lower ones stay, and the higher ones begin at 0.
        assert many == pytest.approx(np.concatenate([few, [0.0, 0.0]]), abs=1e-9)
