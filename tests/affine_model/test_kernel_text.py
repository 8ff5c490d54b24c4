"""The kernel's text: unrolled loops and placed arrays compute what the loops and arrays as written would."""

import numpy as np
import pytest
import sympy

from affine_model.advance import Drive, Pace, Rail, Servo, advance, at_rest
from affine_model.arm import Arm, neutral_parameters, parameter_index, parameter_rows
from affine_model.free_body import Hull
from affine_model.kernel.arguments import ARGUMENTS, packed
from affine_model.kernel.generate import kernel_parts
from affine_model.kernel.machine_code import Loaded, object_code
from affine_model.kernel.trace import lines
from affine_model.kernel.unroll import unrolled_source
from affine_model.simulate import Timing, simulate
from tentacle.specimen import WATER, Cone, Gravity, Specimen
from tentacle.waveform import Sine

TEXT = """
def work_out(a, work):
    for b in range(4):
        for i in unrolled(n):
            for j in unrolled(i + 1):
                m[i, j, b] = a[i, j] * b
        whole[b] = total(m[i, 0, b] for i in unrolled(n))
"""


def test_unrolled_and_placed():
    source = unrolled_source(TEXT, {"n": 3}, {"m": (3, 3), "whole": ()})
    assert "unrolled" not in source
    assert "total" not in source
    place: dict = {}
    exec(compile(source, "kernel", "exec"), place)
    a, work = np.arange(9.0).reshape(3, 3), np.zeros((10, 4))
    place["work_out"](a, work)
    expected = np.tril(a)[:, :, None] * np.arange(4)
    assert np.array_equal(work[:9].reshape(3, 3, 4), expected)  # rows in the order of the shapes
    assert np.array_equal(work[9], expected[:, 0].sum(axis=0))


def test_what_all_lanes_share_is_read_once():
    source = unrolled_source(TEXT, {"n": 1}, {"m": (1, 1), "whole": ()})
    before, inside = source.split("for b in")
    assert "a[0, 0]" in before
    assert "a[0, 0]" not in inside


def test_a_wrong_number_of_indices_is_refused():
    with pytest.raises(SyntaxError, match="m has 2 indices"):
        unrolled_source("m[1, b] = 0.0", {}, {"m": (2, 2)})


@pytest.mark.parametrize(
    "drive", [Drive(Servo(1.0, 0.02, 2.0, 0.5), Rail(0.1, 0.5, 0.01)), Drive(hull=Hull(0.3, 3e-4, 0.1, 0.05, 3.0, 1.0))]
)
def test_machine_code_computes_what_the_text_says(drive):
    """The text run as Python, and compiled, on numbers at which every effect and the drive act."""
    arm = Arm(Specimen(Cone(0.0125, 0.003), 0.14, 1070.0, tip_mass=0.001), WATER, Gravity(0.2), order=2, nodes=4)
    parameters = np.repeat(neutral_parameters()[:, None], 5, axis=1)
    for row in parameter_rows():
        parameters[row.index] = row.parameter.nominal * np.linspace(0.9, 1.1, 5)
    base = Sine(0.5, 1.3, 0.4)((np.arange(4) + 0.5) / 500)[:, :, None]
    pace = Pace(1 / 500, 2, complete=True)

    def in_python(nodes, order, _, *arguments, free):
        place: dict = {}
        exec(compile(kernel_parts(nodes, order, free=free).text(), "kernel", "exec"), place)
        with np.errstate(all="ignore"):  # empty lanes
            place["advance"](0, *arguments)

    start = np.zeros(5), at_rest(arm, 5, drive)
    compiled = advance(arm, drive, parameters, base, start, pace)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("affine_model.advance.advance_blocks", in_python)
        spoken = advance(arm, drive, parameters, base, start, pace)
    for name in ("u", "u_rate", "force", "past", "store", "summary"):
        expected, found = getattr(spoken, name), getattr(compiled, name)
        assert np.all(np.isfinite(expected))
        assert np.max(np.abs(expected)) > 0.0
        np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-12 * np.max(np.abs(expected)), err_msg=name)


def test_few_arms_move_as_in_a_batch():
    """The kernel of few lanes and that of a block are one text: 1e-12 of each other."""
    arm = Arm(Specimen(Cone(0.0125, 0.003), 0.14, 1070.0), WATER, order=3)
    parameters = np.repeat(neutral_parameters()[:, None], 20, axis=1)
    for effect, name, value in (("elasticity", "E", 2e5), ("damping", "eta", 500.0), ("drag", "C_perp", 1.1)):
        parameters[parameter_index(effect, name)] = value * np.linspace(0.8, 1.2, 20)
    base = Sine(0.5, 1.3)((np.arange(200) + 0.5) / 250)[:, :, None]
    many = simulate(arm, parameters, base, Timing(1 / 250)).q
    for first in (0, 17):
        few = simulate(arm, np.ascontiguousarray(parameters[:, first : first + 3]), base, Timing(1 / 250)).q
        np.testing.assert_allclose(few, many[:, :, first : first + 3], rtol=0.0, atol=1e-12 * np.max(np.abs(many)))


LANES = """
def sincos(angle):
    return angle, angle

def advance(block, parameters, summary):
    for b in range(2000):
        summary[0, b] = math.exp(parameters[0, b])
        summary[1, b] = math.tanh(parameters[1, b])
"""


def test_exponentials_of_a_vector_are_exact_to_rounding_over_their_whole_range():
    """Against numpy: exp to 1e-15 of itself up to the ends of the doubles, tanh to 3e-16 of one."""
    given = np.stack([np.linspace(-708.0, 708.0, 2000), np.linspace(-25.0, 25.0, 2000) ** 3 / 625.0])
    found = _computed(given)
    np.testing.assert_allclose(found[0], np.exp(given[0]), rtol=1e-15)
    np.testing.assert_allclose(found[1], np.tanh(given[1]), rtol=0.0, atol=3e-16)


def test_exponentials_of_what_is_out_of_range_stay_at_its_ends_and_divergence_shows():
    given = np.zeros((2, 2000))
    given[0, :3], given[1, :3] = (-1e9, 1e9, np.nan), (-1e9, 1e9, np.nan)
    found = _computed(given)
    assert 0.0 <= found[0, 0] < 1e-300
    assert found[0, 1] > 1e300
    assert tuple(found[1, :2]) == (-1.0, 1.0)
    assert np.all(np.isnan(found[:, 2]))


def _computed(given):
    """The two rows that LANES makes of two rows (2, 2000)."""
    found = np.zeros_like(given)
    code, (words, held) = Loaded(object_code(LANES, 2000)), packed(["parameters", "summary"], (given, found))
    code.run(0, words.ctypes.data)
    del held  # it lived until here
    return found


def test_the_sines_and_cosines_of_one_angle_come_from_one_call():
    t = sympy.Symbol("t", real=True)
    text = lines([("force", "+=", sympy.sin(2 * t) + sympy.cos(2 * t)), ("slope", "-=", 2 * sympy.cos(2 * t))], "")
    assert sum("sincos" in line for line in text) == 1
    place = {"t": [0.7], "b": 0, "force": 1.0, "slope": 0.0, "sincos": lambda x: (np.sin(x), np.cos(x))}
    exec("\n".join(text), place)
    assert place["force"] == pytest.approx(1.0 + np.sin(1.4) + np.cos(1.4), rel=1e-15)
    assert place["slope"] == pytest.approx(-2.0 * np.cos(1.4), rel=1e-15)


def test_what_is_no_part_of_the_text_is_refused():
    head = f"def advance(block, {', '.join(name for name in ARGUMENTS if name != 'block')}):\n"
    for line, said in (("    x = math.gamma(h)\n", "math.gamma"), ("    while h:\n        pass\n", "no part")):
        with pytest.raises(SyntaxError, match=said):
            object_code(head + line, 4)


def test_an_array_in_another_order_is_refused():
    with pytest.raises(ValueError, match=r"summary.*C order"):
        packed(["summary"], (np.zeros((3, 4)).T,))
