"""A sweep over the whole catalogue by the generated Warp kernel, on Warp's CPU, against the compiled kernel.

The laws are the same. Uniform values are multiplied in another order: 1e-9 leaves room for that over all steps.
"""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from affine_model.arm import Arm, arm_of, neutral_parameters, parameter_index
from affine_model.curvature import Array
from affine_model.effects import catalogue
from affine_model.on_device import simulate_on
from inference.experiment import Experiment, Prediction, predict, whitened_residuals
from inference.prepare import prepare
from tentacle.model import Model
from tentacle.specimen import WATER
from tests.made_recordings import SPECIMEN, TRUTH, record

STEP = 1.0 / 200.0


def sweep() -> Array:
    """Parameters (R, B): the declared arm, each effect of the catalogue alone, and a last arm that runs away."""
    base = neutral_parameters()
    for name, value in TRUTH.items():
        base[parameter_index(*name)] = value
    columns = [base]
    for effect in catalogue().values():
        if effect.strengths and effect.family != "base":
            columns.append(base.copy())
            for parameter in effect.strengths:
                columns[-1][parameter_index(effect.name, parameter.name)] = 0.3 * parameter.nominal
    columns.append(base.copy())
    columns[-1][parameter_index("damping", "eta")] = -5e5
    return np.stack(columns, axis=1)


def shaken(t: Array) -> Array:
    """A base that travels 8 mm across at 1.5 Hz: x, y, rates, accelerations (6, ...)."""
    t, w = np.asarray(t, dtype=float), 2.0 * np.pi * 1.5
    none = np.zeros_like(t)
    x = 0.008 * np.sin(w * t)
    return np.stack([x, none, 0.008 * w * np.cos(w * t), none, -(w**2) * x, none])


@pytest.fixture(scope="module")
def moving() -> Experiment:
    """A recording whose base travels and which begins with memory."""
    return replace(prepare(record(seconds=1.0), hold_out=False).experiment, remembers=True, travel=shaken)


@pytest.fixture
def warped(monkeypatch):
    """predict() by Warp's kernel, compiled for this processor, without a GPU."""
    wp = pytest.importorskip("warp", reason="needs NVIDIA Warp")
    gpu = pytest.importorskip("affine_model.gpu")
    monkeypatch.setattr(wp.config, "optimization_level", 0)
    monkeypatch.setattr("affine_model.torch_simulation.advanced", gpu.advance_on_device)

    def predicted(arm: Arm, experiment: Experiment, parameters: Array, nuisances: Array) -> Prediction:
        return predict(arm, replace(experiment, device="cpu"), parameters, nuisances, STEP)

    return predicted


def test_a_sweep_of_the_catalogue_is_that_of_the_compiled_kernel(moving, warped):
    """From a moving start with memory, and from a release."""
    parameters, random = sweep(), np.random.default_rng(1)
    arm = arm_of(Model(replace(SPECIMEN, tip_mass=1e-3), WATER))  # so that a misplaced payload has a law
    for experiment in (moving, replace(moving, release=moving.t0)):
        scales = experiment.nuisance_scales(arm.order, arm.specimen.length)
        one = scales * random.uniform(-1.0, 1.0, scales.size)
        nuisances = np.repeat(one[:, None], parameters.shape[1], axis=1)
        truth = predict(arm, experiment, parameters, nuisances, STEP)
        found = warped(arm, experiment, parameters, nuisances)
        sound = np.isnan(truth.batch.diverged)
        assert sound.tolist() == [*[True] * (parameters.shape[1] - 1), False]
        np.testing.assert_array_equal(np.isnan(found.batch.diverged), sound)
        for name, lanes in vars(truth.batch).items():
            if name not in ("t", "force_t", "diverged"):
                expected = lanes[..., sound]
                size = np.max(np.abs(expected))
                np.testing.assert_allclose(
                    getattr(found.batch, name)[..., sound], expected, rtol=1e-9, atol=1e-9 * size
                )
        residuals, expected = (whitened_residuals(experiment, one)[:, :, sound] for one in (found, truth))
        np.testing.assert_allclose(residuals, expected, rtol=1e-9, atol=1e-9 * np.max(np.abs(expected)))
        moved = np.max(np.abs(expected - expected[:, :, :1]), axis=(0, 1))
        assert moved[1:].min() > 1e-3  # noise sigmas: every effect of the catalogue was there


def test_a_diagnosis_on_the_cpu_does_not_load_torch():
    lines = "from discovery.diagnose import diagnose", "from inference.identify import identify"
    words = "; ".join([*lines, "from affine_model.device import cuda_device", "assert cuda_device('auto') is None"])
    loads = f"import sys; {words}; assert cuda_device('cpu') is None; assert 'torch' not in sys.modules"
    subprocess.run([sys.executable, "-c", loads], check=True)


def test_the_compiled_kernel_is_called_as_ever(moving, monkeypatch):
    """Without a device, nothing else runs."""
    seen = []
    monkeypatch.setitem(sys.modules, "affine_model.torch_simulation", None)
    monkeypatch.setattr("inference.experiment.simulate_on", lambda *a: seen.append(a[0]) or simulate_on(*a))
    arm, parameters = arm_of(Model(SPECIMEN, WATER)), sweep()[:, :1]
    predict(arm, moving, parameters, np.zeros((len(moving.nuisance_names(arm.order)), 1)), STEP)
    assert seen == [None]
