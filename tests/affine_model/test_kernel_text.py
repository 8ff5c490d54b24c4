"""The kernel's text: unrolled loops and placed arrays compute what the loops and arrays as written would."""

import numpy as np
import pytest

from affine_model.kernel.unroll import unrolled_source

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
