"""The generated Warp kernels against the compiled kernel, on the CPU and on a CUDA device if there is one.

The laws are the same. Uniform values are multiplied in another order: 1e-9 leaves room for that over all steps.
"""

from dataclasses import replace

import numpy as np
import pytest
import torch

from affine_model.advance import Drive, Pace, Rail, Servo, advance, arm_arrays, at_rest
from affine_model.arm import Arm, parameter_index
from affine_model.device import chosen_device, cuda_device
from affine_model.effects import catalogue
from affine_model.kernel.warp_source import Variant, warp_text
from affine_model.swim import assumed_model, paper_cone, search_box, trial_of
from affine_model.swim.evaluate import evaluate
from tentacle.errors import InputError
from tentacle.law.in_use import using
from tentacle.law.written_law import WrittenLaw, WrittenParameter
from tentacle.specimen import WATER, Cone, Gravity, Specimen
from tentacle.waveform import Sine

wp = pytest.importorskip("warp", reason="needs NVIDIA Warp")
gpu = pytest.importorskip("affine_model.gpu")

ARM = Arm(Specimen(Cone(0.0125, 0.003), 0.14, 1070.0, tip_mass=0.001), WATER, Gravity(0.2), order=2, nodes=6)
GIVING = replace(ARM, specimen=replace(ARM.specimen, clamp_length=0.01, shear_compliance=1.0))
H, STEPS, COUNT = 1 / 500, 40, 3


DEVICES = ["cpu", *(["cuda"] if torch.cuda.is_available() else [])]


@pytest.fixture(autouse=True)
def quick_compile(monkeypatch):
    monkeypatch.setattr(wp.config, "optimization_level", 0)


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("arm", [ARM, GIVING], ids=["rigid clamp", "clamp that gives"])
def test_every_effect_steps_as_in_the_compiled_kernel(parameters, arm, device):
    """All effects at once, a servo and a rail: one kernel holds every law."""
    everything = parameters(elasticity__E=2e5, damping__eta=2e3, drag__C_perp=1.1)
    for effect in catalogue().values():
        for parameter in effect.strengths if effect.family != "base" else ():
            everything[parameter_index(effect.name, parameter.name)] = 0.1 * parameter.nominal
    p = np.repeat(everything[:, None], COUNT, axis=1)
    p[parameter_index("elasticity", "E")] *= np.linspace(0.8, 1.2, COUNT)
    base = Sine(0.3, 1.0, 0.4)((np.arange(STEPS) + 0.5) * H)[:, :, None]
    drive, pace = Drive(Servo(0.8, 0.02, 1.0, 0.5), Rail(0.25, 0.35, 0.01)), Pace(H, 2, 10, 1, 0, True)
    state = at_rest(arm, COUNT)
    state.u[0] = 0.1
    truth = advance(arm, drive, p, base, (np.zeros(COUNT), state), pace)
    start = np.zeros(COUNT), state.u, state.u_rate, state.past, state.store
    own, table, *moving = (torch.from_numpy(x).to(device) for x in (p, base, *start))
    found = gpu.advance_on_device(arm, drive, own, table, tuple(moving), pace)
    names = ("u", "u_rate", "force", "past", "store", "summary")
    assert np.all(truth.summary[4] < 0.0)
    for name, tensor in zip(names, found, strict=True):
        expected = getattr(truth, name)
        np.testing.assert_allclose(tensor.cpu().numpy(), expected, rtol=1e-9, atol=1e-9 * np.max(np.abs(expected)))


@pytest.mark.parametrize("device", DEVICES)
def test_gaits_made_in_the_kernel_swim_as_those_of_a_table(device):
    trial = replace(trial_of(assumed_model(paper_cone(0.21), "dragon-skin-10")), settle=0.2, window=0.4)
    drive, limits = Drive(rail=Rail(0.25, 0.35)), trial.limits.bounds
    genes = search_box(trial.limits).alpha(np.random.default_rng(0).random((9, 20))).T.copy()
    timing = Pace(trial.step, 2, trial.settled), trial.steps
    expected = evaluate(trial.arm, drive, genes, trial.parameters, limits, timing)[:, :, 0]
    given = torch.from_numpy(trial.parameters[:, 0].copy()), torch.from_numpy(genes).to(device)
    servo = torch.from_numpy(limits.kinematic), limits.bandwidth
    found = gpu.swim_on_device(trial.arm, drive, *given, servo, timing).cpu().numpy()
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * np.max(np.abs(expected), axis=1).min())
    assert expected[5].min() < 0.9  # some were scaled to the servo's limits


def law(force):
    """A law in use beside the catalogue."""
    strength = WrittenParameter("k", "1/m", 1.0, (0.0, 10.0), "stiffness over the weight of water")
    return WrittenLaw("spring", "Spring", "made", "line", {"force_x": force}, (strength,), {}, {})


def test_a_kernel_has_the_laws_in_use():
    """Not those of a law of the same name that was in use before."""
    texts = []
    for force in ("-k * fluid_density * gravity * area * x", "-2 * k * fluid_density * gravity * area * x"):
        with using([law(force)]):
            effects = tuple(catalogue())
            active = tuple(name == "spring" for name in effects)
            texts.append(warp_text(Variant(3, 1, active, False, False), False, ()))
    assert texts[0] != texts[1]


def test_one_kernel_serves_every_clamp():
    """A fit may move the clamp's length, and would compile for each."""
    softer = replace(GIVING, specimen=replace(GIVING.specimen, clamp_length=0.02))
    given = [{**arm_arrays(arm, Drive()), "h": H} for arm in (GIVING, softer)]
    variant = Variant(GIVING.node_count, GIVING.order, (False,) * len(catalogue()), False, False, gives=True)
    one, other = (gpu._prepared(variant, False, numbers) for numbers in given)
    assert one.kernel is other.kernel
    assert one.table != other.table


def test_a_device_is_named_or_refused_in_one_line(monkeypatch):
    assert chosen_device("cpu") == "cpu"
    assert cuda_device("auto") is cuda_device("cpu") is None
    with pytest.raises(InputError, match="not known"):
        chosen_device("tpu")
    if not torch.cuda.is_available():
        assert chosen_device("auto") == "cpu"
        with pytest.raises(InputError, match="0 CUDA devices"):
            cuda_device("cuda")
        with pytest.raises(InputError, match="0 CUDA devices"):
            chosen_device("cuda:1")
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    assert chosen_device("auto") is None  # the compiled kernel on numpy arrays
    with pytest.raises(InputError, match="PyTorch and NVIDIA Warp missing"):
        chosen_device("cuda")
