"""One conformance test over every effect of the catalogue; a new effect's file is held to it at once."""

import importlib
import pkgutil
from types import SimpleNamespace

import numpy as np
import pytest
import sympy
import torch

import affine_model.effects as folder
from affine_model.arm import Arm, active_effects, parameter_index, parameter_rows
from affine_model.base_signal import DRIVE_TRAIN
from affine_model.dynamics import Instant, advanced_memory, balance, parameters_of
from affine_model.effect import QUANTITIES, Effect
from affine_model.effects import absent_effects, catalogue
from affine_model.kernel.trace import symbols_for, traced
from affine_model.simulate import Start, Timing, simulate
from tentacle.specimen import WATER, Cone, Gravity, Specimen
from tentacle.waveform import Sine

CONTRACT = {  # These names are known outside
    "added_mass", "skin_drag", "linear_drag", "current", "sloshing", "wall", "buoyancy", "gravity_tilt", "tip_mass",
    "cubic_stiffness", "intrinsic_curvature", "viscoelasticity", "dry_friction", "soft_spot", "stiffness_drift",
    "third_curvature", "servo_lag", "backlash", "time_offset", "camera_roll", "camera_scale",
}  # fmt: skip
LAWS = (
    "stiffness", "stiffness_share", "natural_curvature", "bending_moment", "force", "couple", "drag_coefficient",
    "line_inertia", "carried_water", "normal_inertia", "rotary_inertia", "weight",
    "water_velocity", "hung_mass", "payload_shift", "tip_force", "gravity_tilt", "relaxation_time", "yield_curvature",
)  # fmt: skip
EFFECTS = list(catalogue().values())
BASE_EFFECTS = tuple(effect for effect in catalogue().values() if effect.family == "base")
ARM = Arm(Specimen(Cone(0.0125, 0.003), 0.14, 1070.0, tip_mass=0.001), WATER, Gravity(0.2), order=3, nodes=8)
BASE = {"elasticity__E": 2e5, "damping__eta": 1.5e3, "drag__C_perp": 1.1}

each_effect = pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.name)


def laws_of(effect: Effect) -> list[str]:
    return [kind for kind in LAWS if getattr(effect, kind) is not None]


def nominal(effect: Effect) -> dict[str, float]:
    return {f"{effect.name}__{parameter.name}": parameter.nominal for parameter in effect.parameters}


def random_state(seed):
    rng = np.random.default_rng(seed)
    u = rng.normal(size=5) * [0.8, 0.5, 0.3, 0.5, 0.02]
    return u, rng.normal(size=5) * [4.0, 3.0, 2.0, 3.0, 0.1], rng.normal(size=(1, ARM.nodes)) * 0.3


def test_the_catalogue_holds_the_names_of_the_contract():
    names = {effect.name for effect in absent_effects()}
    assert names >= CONTRACT
    assert {effect.name for effect in BASE_EFFECTS} == {"inertia", "elasticity", "damping", "weight", "drag"}


def test_one_file_is_one_effect_of_the_same_name():
    for info in pkgutil.iter_modules(folder.__path__):
        module = importlib.import_module(f"affine_model.effects.{info.name}")
        found = [name for name, value in vars(module).items() if isinstance(value, Effect)]
        assert found == [info.name.upper()]
        assert getattr(module, info.name.upper()).name == info.name
        assert module.__doc__


def test_every_servo_effect_has_its_place_in_the_drive_train():
    assert {effect.name for effect in catalogue().values() if effect.base} == {effect.name for effect in DRIVE_TRAIN}


@each_effect
def test_a_law_that_levels_off_says_so(effect):
    levelling = any(part.has(sympy.tanh) for kind in laws_of(effect) for part in traced(effect, kind))
    assert effect.levels_off == (levelling or effect.yield_curvature is not None)


@each_effect
def test_effect_says_what_it_is(effect):
    assert effect.title
    assert effect.source
    assert effect.name.isidentifier()
    outside = effect.base or effect.sight or effect.extra_order
    assert bool(laws_of(effect)) != bool(outside), "an effect acts in the equations of motion or outside them"
    assert effect.family == "base" or effect.extra_order or effect.strengths, "nothing could switch it off"
    for parameter in effect.parameters:
        low, high = parameter.bounds
        assert parameter.unit
        assert parameter.words
        assert low <= parameter.neutral <= high
        assert low < parameter.nominal <= high
        assert all(low <= value <= high for value in parameter.scan)
        assert parameter.nominal != 0.0


@each_effect
def test_laws_are_formulas_of_known_quantities(effect):
    allowed = set(QUANTITIES) | {str(value) for value in vars(symbols_for(effect)[1]).values()}
    for kind in laws_of(effect):
        for expression in traced(effect, kind):
            assert {str(symbol) for symbol in expression.free_symbols} <= allowed
            assert all(value.is_finite is not False for value in expression.atoms(sympy.Number))
            if kind in ("line_inertia", "carried_water", "normal_inertia", "rotary_inertia", "hung_mass", "stiffness"):
                # inertia and stiffness may not depend on rates: M must be a Hessian, and U a potential
                assert not {"c_rate", "phi_rate", "u_n", "u_t", "speed"} & {str(s) for s in expression.free_symbols}


@each_effect
def test_law_gradients_of_formula_and_autodiff_agree(effect):
    """The symbolic derivative (which the kernel uses) against torch's through the same law."""
    rng = np.random.default_rng(7)
    x_symbols, p_symbols = symbols_for(effect)
    values = {name: float(rng.uniform(0.2, 0.9)) for name in QUANTITIES}
    x = SimpleNamespace(
        **{name: torch.tensor(value, dtype=torch.float64, requires_grad=True) for name, value in values.items()}
    )
    p = SimpleNamespace(
        **{q.name: torch.tensor(0.7 * q.nominal, dtype=torch.float64, requires_grad=True) for q in effect.parameters}
    )
    leaves = [*vars(x).items(), *vars(p).items()]
    symbols = {**vars(x_symbols), **vars(p_symbols)}
    numbers = {symbols[name]: value.item() for name, value in leaves}
    for kind in laws_of(effect):
        law = getattr(effect, kind)(x, p)
        outputs = law if isinstance(law, tuple) else (law,)
        for output, expression in zip(outputs, traced(effect, kind), strict=True):
            # abs: positive(z) of a negative z is a difference of numbers of order 1
            assert float(torch.as_tensor(output).detach()) == pytest.approx(
                float(expression.subs(numbers)), rel=1e-12, abs=1e-15
            )
            if not isinstance(output, torch.Tensor) or not output.requires_grad:
                assert not expression.free_symbols
                continue
            tensors = [value for _, value in leaves]
            gradients = torch.autograd.grad(output, tensors, allow_unused=True, retain_graph=True)
            for (name, _), gradient in zip(leaves, gradients, strict=True):
                truth = float(sympy.diff(expression, symbols[name]).subs(numbers))
                found = 0.0 if gradient is None else float(gradient)
                # abs: 1 - tanh^2 loses digits when it is small
                assert found == pytest.approx(truth, rel=1e-11, abs=1e-13), f"d {kind} / d {name}"


@each_effect
def test_neutral_effect_changes_nothing(effect, parameters):
    p = parameters(**BASE)
    for parameter in effect.shapes:  # shapes mean nothing while the strengths are zero
        p[parameter_index(effect.name, parameter.name)] = parameter.nominal
    base = BASE_EFFECTS
    for seed in range(3):
        u, v, memory = random_state(seed)
        without = balance(ARM, base, p, u, v, Instant(0.3, memory))
        acting = base if effect in base else (*base, effect)
        present = balance(ARM, acting, p, u, v, Instant(0.3, memory))
        # Not one bit: every law is a multiple of its strengths, and a sum with zero is exact.
        assert np.array_equal(without.force, present.force)
        assert np.array_equal(without.mass_matrix, present.mass_matrix)
        assert np.array_equal(without.fluid_force, present.fluid_force)


@pytest.mark.parametrize("effect", [e for e in absent_effects() if laws_of(e)], ids=lambda effect: effect.name)
def test_nominal_effect_changes_something(effect, parameters):
    p = parameters(**BASE, **nominal(effect))
    assert effect in active_effects(p)
    u, v, memory = random_state(0)
    a = balance(ARM, BASE_EFFECTS, p, u, v, Instant(0.3, memory))
    b = balance(ARM, active_effects(p), p, u, v, Instant(0.3, memory))
    assert not np.array_equal(a.force, b.force) or not np.array_equal(a.mass_matrix, b.mass_matrix)


@pytest.mark.parametrize("effect", [e for e in EFFECTS if e.dissipative and laws_of(e)], ids=lambda effect: effect.name)
def test_dissipative_effect_takes_energy(effect, parameters):
    """Power of the effect's force plus the rate of what it stores is never positive, in still water, at any state."""
    stiff = {"elasticity__E": 2e5, "drag__C_perp": 1.0}  # an effect may scale one of these
    with_it = parameters(**{**stiff, **nominal(effect)})
    without = parameters(**{name: value for name, value in stiff.items() if name not in nominal(effect)})
    for seed in range(40):
        u, v, memory = random_state(seed)
        c_rate = ARM.curvature_basis @ v[: ARM.order]
        if effect.yield_curvature is not None:
            memory = advanced_memory(ARM, (effect,), with_it, memory, 0.0 * c_rate, 0.0)  # never beyond the yield
        force = balance(ARM, active_effects(with_it), with_it, u, v, Instant(0.3, memory)).force
        power = v @ (force - balance(ARM, active_effects(without), without, u, v, Instant(0.3)).force)
        if effect.remembers:  # stored: half the moment times the memory, both linear in it
            h = 1e-6
            memory_rate = (advanced_memory(ARM, (effect,), with_it, memory, c_rate, h) - memory)[0] / h
            k = 2e5 * ARM.node_quantities["second_moment"] / ARM.specimen.length
            seen = SimpleNamespace(stiffness=k, memory=memory[0], c_rate=0.0 * c_rate)  # what slides stores nothing
            assert effect.bending_moment is not None
            power += ARM.rule.weights @ (effect.bending_moment(seen, parameters_of(effect, with_it)) * memory_rate)
        assert power < 0.0


@each_effect
def test_the_same_call_gives_the_same_bits(effect, parameters):
    p = parameters(**BASE, **({} if effect.family == "base" else nominal(effect)))
    t = (np.arange(60) + 0.5) / 250
    runs = [
        simulate(
            ARM,
            np.repeat(p[:, None], 3, axis=1),
            Sine(0.5, 1.3)(t)[:, :, None],
            Timing(1 / 250),
            start=Start(q=np.full((3, 3), 0.2)),
        )
        for _ in range(2)
    ]
    assert np.all(np.isnan(runs[0].diverged))
    for name in ("q", "q_rate", "fluid_force", "load", "torque", "mean_thrust"):
        assert np.array_equal(getattr(runs[0], name), getattr(runs[1], name))
    assert np.array_equal(runs[0].q[..., 0], runs[0].q[..., 2])  # nor does the place in the batch matter


def test_parameter_rows_are_one_each_and_in_order():
    rows = parameter_rows()
    assert [row.index for row in rows] == list(range(len(rows)))
    assert len({(row.effect, row.parameter.name) for row in rows}) == len(rows)
    with pytest.raises(KeyError, match=r"drag\.C_parallel"):
        parameter_index("drag", "C_parallel")
