"""The loop over a block of individuals around an effect's code, behind the effect's flag."""

from __future__ import annotations

from affine_model.effect import Effect

NODE = " " * 16  # inside: for step, for iteration, for node i


def guarded(effect: Effect, number: int, body: list[str]) -> list[str]:
    """The loop over the block around a body; behind the effect's flag unless it is a base effect."""
    if not body:
        return []
    indent = NODE if effect.family == "base" else NODE + "    "
    head = [] if effect.family == "base" else [f"{NODE}if active[{number}]:"]
    return [*head, f"{indent}for b in range(BLOCK):", *(f"{indent}    {line}" for line in body)]
