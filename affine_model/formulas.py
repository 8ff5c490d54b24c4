"""The catalogue in words and formulas, printed from the laws that the program computes (docs/catalogue.md)."""

from __future__ import annotations

import sympy

from affine_model.effect import QUANTITIES, Effect
from affine_model.effects import catalogue
from affine_model.kernel.trace import symbols_for, traced

LAW_NAMES = {
    "stiffness": "stiffness k [N m/rad]",
    "stiffness_share": "relative change of the stiffness",
    "natural_curvature": "curvature of the unloaded arm [rad]",
    "bending_moment": "bending moment [N m]",
    "force": "force (normal, tangential) [N/m]",
    "couple": "couple [N]",
    "drag_coefficient": "drag coefficient",
    "line_inertia": "inertia [kg/m]",
    "carried_water": "water carried every way [kg/m]",
    "normal_inertia": "inertia along the normal [kg/m]",
    "rotary_inertia": "rotary inertia [kg m]",
    "weight": "weight, as mass [kg/m]",
    "water_velocity": "velocity of the water (x, y) [m/s]",
    "hung_mass": "body at the tip: mass [kg], reach [m], drop [m], density [kg/m^3]",
    "payload_shift": "shift of the payload (along the tangent, along the normal) [m]",
    "tip_force": "force at the tip (normal, tangential) [N]",
    "gravity_tilt": "tilt of gravity [rad]",
    "relaxation_time": "relaxation time [s]",
    "yield_curvature": "curvature [rad] at which it slips",
}


def formulas(effect: Effect) -> list[tuple[str, str]]:
    """(what, formula) for every law of the effect, parameters under their own names."""
    _, p = symbols_for(effect)
    names = {symbol: sympy.Symbol(name, real=True) for name, symbol in vars(p).items()}
    return [
        (words, ", ".join(str(expression.subs(names).evalf(5)) for expression in traced(effect, kind)))
        for kind, words in LAW_NAMES.items()
        if getattr(effect, kind) is not None
    ]


def _section(effect: Effect) -> list[str]:
    text = [f"## {effect.name}", "", f"{effect.title} ({effect.family}). Source: {effect.source}.", ""]
    text += [f"- {words}: `{formula}`" for words, formula in formulas(effect)]
    outside = {
        "base angle, u before and theta behind the effect": effect.base and effect.base.__doc__,
        "measurement": effect.sight and effect.sight.__doc__,
    }
    text += [f"- {words}: `{value}`" for words, value in outside.items() if value is not None]
    text += [f"- curvature coordinates added: {effect.extra_order}"] * (effect.extra_order > 0)
    if effect.parameters:
        text += ["", "| parameter | unit | nominal | bounds | meaning |", "|---|---|---|---|---|"]
    for q in effect.parameters:
        low, high = q.bounds
        words = q.words.replace("|", r"\|")
        text.append(f"| {q.name} | {q.unit} | {q.nominal:g} | {low:g} .. {high:g} | {words} |")
    return [*text, ""]


def catalogue_page() -> str:
    """The page docs/catalogue.md."""
    text = [
        "# The catalogue of effects",
        "",
        "Printed by `python -m affine_model.formulas > docs/catalogue.md` from the laws themselves.",
        "",
        "| quantity | meaning |",
        "|---|---|",
    ]
    text += [f"| {name} | {words} |" for name, words in QUANTITIES.items()]
    text.append("")
    for effect in catalogue().values():
        text += _section(effect)
    return "\n".join(text).rstrip() + "\n"


if __name__ == "__main__":
    print(catalogue_page(), end="")
