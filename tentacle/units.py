"""Units that people type and read, beside the SI units of the code."""

from __future__ import annotations


def from_mm(length: float) -> float:
    """[mm] to [m]."""
    return 1e-3 * length


def in_mn(force: float) -> float:
    """[N] to [mN]."""
    return 1e3 * force
