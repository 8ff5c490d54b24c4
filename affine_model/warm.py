"""The kernels that the usual orders need, compiled before they are needed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from affine_model.arm import arm_of
from affine_model.kernel.load import BLOCK, FEW, is_compiled, load_kernel
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Specimen

USUAL_ORDERS = (2, 5)  # coordinates: the paper's model, and the most that a diagnosis fits


def not_compiled(orders: Sequence[int] = USUAL_ORDERS) -> list[int]:
    """The orders whose kernel this computer has not compiled yet."""
    return [order for order in orders if not is_compiled(arm_of(_model(order)).nodes, order)]


def compile_orders(orders: Sequence[int] = USUAL_ORDERS) -> None:
    """Compile the kernels of these orders, where they are not there."""
    for order in orders:
        for lanes in (BLOCK, FEW):
            load_kernel(arm_of(_model(order)).nodes, order, lanes)


def _model(order: int) -> Model:
    arm = Specimen(Cone(0.01, 0.005), 0.1, 1070.0)
    return replace(Model(arm, WATER).with_effect("elasticity", E=Estimate.exact(2e5, "Pa")), order=order)
