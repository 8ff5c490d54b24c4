"""The kernel's text with marks (@NAME@) where the effects' code goes. Read it beside affine_model.dynamics.

`unrolled(m)` and `total(... for k in unrolled(m))` are written out, and the arrays of ARRAYS placed in one workspace,
by affine_model.kernel.unroll. n is the order, D the number of coordinates, NODES that of quadrature nodes, b the
individual's lane. FREE is 1 where the base floats freely: its x is then the last coordinate. It is 0 elsewhere, and no
line under unrolled(FREE) is written.
"""

from affine_model.kernel.template.motion import MOTION, TABLE
from affine_model.kernel.template.outcome import OUTCOME, SUMMARY, TRAJECTORY
from affine_model.kernel.template.solution import SOLUTION
from affine_model.kernel.template.start import ARRAYS, START

__all__ = ["ARRAYS", "SUMMARY", "TABLE", "TEMPLATE", "TRAJECTORY"]

TEMPLATE = START + MOTION + SOLUTION + OUTCOME
