"""The grammar of laws that are proposed: where a force acts, its direction, and a product of powers or one function.

Every candidate is a written law (tentacle.law) with one or two strengths, in which it is linear, and shapes (a power, a
place, a frequency, a threshold, a time), of which a coarse set of values is tried before they are refined.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tentacle.law.expression import names_in, parse
from tentacle.law.written_law import Acts, WrittenLaw, WrittenParameter

SPEED_REFERENCE = 0.1  # m/s, rad/s and arm lengths: the references of powers
RATE_REFERENCE = 3.0
SOURCE = "proposed by the search over the grammar of laws"
POWERS = (0.5, 1.0, 1.5, 2.0, 3.0)
REACHES = (0.15, 0.3)  # arm lengths
LEAST_REACH = 0.1  # arm lengths: 8 Gauss nodes integrate a bell of this extent to 12 % at worst
STRENGTH_UNIT = {"line": "N/m", "tip": "N", "moment": "1"}
NOMINAL = {"line": 0.02, "tip": 0.002, "moment": 0.1}
STRONGEST = {"line": 1e3, "tip": 1e4, "moment": 1e3}  # nominal strengths: about ten times the arm's own weight
ONE_WAY = ("drag_", "skin_", "one_way", "tip_drag", "patch_", "tether", "stop_", "late", "bending_loss")  # a >= 0: a
# negative strength of these would drive, push, or pull where their words say that they brake, pull, or hold
SLENDER = 20.0  # length over width, about: strengths of forces per width are as much larger


@dataclass(frozen=True)
class Form:
    """A family of laws of one form: the written law with its first shape values, and a description."""

    law: WrittenLaw
    words: str

    @property
    def shapes(self) -> tuple[WrittenParameter, ...]:
        """The parameters that are not strengths."""
        return tuple(p for p in self.law.parameters if p.scan)

    @property
    def strengths(self) -> tuple[WrittenParameter, ...]:
        """The parameters in which it is linear."""
        return tuple(p for p in self.law.parameters if not p.scan)


@dataclass(frozen=True)
class Scale:
    """What the candidates' shapes depend on: length [m], whether water is around, duration [s]."""

    length: float
    wet: bool
    duration: float


def power(scan: tuple[float, ...] = POWERS) -> WrittenParameter:
    """A power."""
    return WrittenParameter("power", "1", 2.0, (0.05, 6.0), "power of the law", scan)


def _place(scale: Scale, count: int, name: str) -> list[WrittenParameter]:
    """A point in the plane, from a grid around the arm."""
    L = scale.length
    along_n = tuple(float(v) for v in L * np.linspace(-0.8, 0.8, count))
    along = tuple(float(v) for v in L * np.linspace(0.1, 1.5, count))
    limits = (-3.0 * L, 3.0 * L)
    return [
        WrittenParameter(f"{name}_x", "m", 0.4 * L, limits, "along n at theta = 0", along_n),
        WrittenParameter(f"{name}_y", "m", 0.9 * L, limits, "along the straight arm at theta = 0", along),
    ]


def _reach(length: float) -> WrittenParameter:
    """The extent of a place, on an arm of that length [m]."""
    bounds = (LEAST_REACH * length, 5.0 * length)
    return WrittenParameter("reach", "m", 0.3 * length, bounds, "its extent", tuple(r * length for r in REACHES))


def _frequency(scale: Scale) -> WrittenParameter:
    step = 0.5 / scale.duration
    scan = tuple(float(v) for v in np.arange(max(0.2, 2.0 * step), 5.0, step))
    return WrittenParameter("frequency", "Hz", 1.0, (0.05, 20.0), "frequency", scan)


def _form(
    name: str, words: str, acts: Acts, components: dict[str, str], shapes: list[WrittenParameter],
    defined: dict[str, str] | None = None,
) -> Form:  # fmt: skip
    """A form with the strengths a, and b where it is named; a shape called tau is the time of its memory."""
    components = {part: text.replace(" * 1 * ", " * ") for part, text in components.items()}  # a weight of 1
    unit, nominal = STRENGTH_UNIT[acts], NOMINAL[acts]
    used = set().union(*(names_in(parse(part)) for part in components.values()))
    most = (
        STRONGEST[acts] * nominal * (SLENDER if any("width / length" in part for part in components.values()) else 1.0)
    )
    limits = (0.0 if name.startswith(ONE_WAY) else -most, most)
    own = [WrittenParameter(s, unit, nominal, limits, "strength") for s in ("a", "b") if s in used]
    relaxation = "tau" if any(shape.name == "tau" for shape in shapes) else None
    text = " ".join([*components.values(), *(defined or {}).values()])
    constants = {
        n: v for n, v in {"u_0": (SPEED_REFERENCE, "m/s"), "w_0": (RATE_REFERENCE, "rad/s")}.items() if n in text
    }
    law = WrittenLaw(name, words, SOURCE, acts, components, (*own, *shapes), defined or {}, constants, relaxation)
    law.check()
    return Form(law, words)


def _odd(quantity: str, reference: str) -> str:
    """sign(q) |q / q0|^power, without a corner."""
    return f"(abs({quantity}) / {reference})^(power - 1) * {quantity} / {reference}"


def forms(scale: Scale) -> tuple[Form, ...]:
    """All forms for an arm of that scale."""
    return (*_of_velocity(scale), *_of_place(scale), *_of_time(scale), *_of_curvature())


def _of_velocity(scale: Scale) -> list[Form]:
    found = []
    for where, weight in (("width", "width / length"), ("length", "1")):
        found += [
            _form(f"drag_{where}", f"a normal force against the motion, with a power of its speed, per {where}",
                  "line", {"force_n": f"-a * {weight} * {_odd('u_n', 'u_0')}"}, [power()]),
            _form(f"skin_{where}", f"a tangential force against the motion, with a power of its speed, per {where}",
                  "line", {"force_t": f"-a * {weight} * {_odd('u_t', 'u_0')}"}, [power()]),
        ]  # fmt: skip
    for side, sign in (("right", ""), ("left", "-")):
        found.append(
            _form(f"one_way_{side}", f"a normal force against motion to the {side} only, with a power of the speed",
                  "line", {"force_n": f"-a * width / length * {sign or '1 * '}(positive({sign}u_n) / u_0)^power"},
                  [power((1.0, 1.5, 2.0))])
        )  # fmt: skip
    found.append(
        _form("tip_drag", "a force at the tip against its normal motion, with a power of the speed", "tip",
              {"force_n": f"-a * {_odd('u_n', 'u_0')}"}, [power()])
    )  # fmt: skip
    where = "exp(-((x - at_x)^2 + (y - at_y)^2) / reach^2)"
    for exponent, words in ((1, "linear"), (2, "quadratic")):
        speed = "u_n / u_0" if exponent == 1 else "abs(u_n) * u_n / u_0^2"
        found.append(
            _form(f"patch_{words}", f"a {words} drag that is larger near a point", "line",
                  {"force_n": f"-a * width / length * {speed} * {where}"},
                  [*_place(scale, 7, "at"), _reach(scale.length)])
        )  # fmt: skip
    return found


def _of_place(scale: Scale) -> list[Form]:
    L = scale.length
    distance = "sqrt((x - at_x)^2 + (y - at_y)^2 + 1e-4 * length^2)"
    radial = {"force_x": "(at_x - x) / d", "force_y": "(at_y - y) / d"}
    magnet = {name: f"a * (0.3 * length / d)^power * {way}" for name, way in radial.items()}
    tether = {name: f"a * positive(d - slack) / length * {way}" for name, way in radial.items()}
    slack = WrittenParameter("slack", "m", 0.5 * L, (0.0, 3.0 * L), "where it begins to pull",
                             tuple(share * L for share in (0.001, 0.2, 0.4, 0.6, 0.8)))  # fmt: skip
    edge = WrittenParameter("edge", "m", 0.2 * L, (-2.0 * L, 2.0 * L), "where it begins",
                            tuple(float(v) * L for v in np.linspace(-0.6, 0.6, 13)))  # fmt: skip
    jet = "exp(-((x - at_x)^2 + (y - at_y)^2) / reach^2)"
    found = [
        _form("attraction", "a force at the tip towards a point, with a power of the distance", "tip", magnet,
              [*_place(scale, 9, "at"), power((1.0, 2.0, 3.0, 4.0))], {"d": distance}),
        _form("tether", "a thread from a point to the tip, slack up to a length", "tip", tether,
              [*_place(scale, 7, "at"), slack], {"d": distance}),
        _form("tip_spring", "a force at the tip towards x = 0, with a power of its displacement", "tip",
              {"force_x": f"-a * {_odd('x', '(0.3 * length)')}"}, [power()]),
        _form("tip_push", "a steady force at the tip", "tip", {"force_x": "a", "force_y": "b"}, []),
        _form("jet", "a steady jet around a point in space", "line",
              {"force_x": f"a * {jet}", "force_y": f"b * {jet}"}, [*_place(scale, 7, "at"), _reach(scale.length)]),
        _form("line_spring", "a force towards x = 0 all along the arm, with a power of the displacement", "line",
              {"force_x": f"-a * {_odd('x', '(0.3 * length)')}"}, [power()]),
    ]  # fmt: skip
    for side, sign in (("right", ""), ("left", "-")):
        found.append(
            _form(f"stop_{side}", f"a stop at the tip on the {side}, a power of the way beyond its edge", "tip",
                  {"force_x": f"-a * {sign or '1 * '}(positive({sign}(x - edge)) / (0.1 * length))^power"},
                  [edge, power((1.0, 1.5, 2.0))])
        )  # fmt: skip
    return found


def _of_time(scale: Scale) -> list[Form]:
    beat = "(a * cos(6.283185307 * frequency * t) + b * sin(6.283185307 * frequency * t))"
    found = []
    if scale.wet:
        found.append(
            _form("vortex", "a normal force at one frequency, with a power of the speed", "line",
                  {"force_n": f"{beat} * width / length * (speed / u_0)^power"},
                  [_frequency(scale), power((2.0, 1.0))])
        )  # fmt: skip
    found += [
        _form("beat_x", "a force across, at one frequency, all along the arm", "line", {"force_x": beat},
              [_frequency(scale)]),
        _form("tip_beat_x", "a force across at the tip, at one frequency", "tip", {"force_x": beat},
              [_frequency(scale)]),
    ]  # fmt: skip
    return found


def _of_curvature() -> list[Form]:
    tau = WrittenParameter("tau", "s", 0.3, (0.01, 60.0), "relaxation time", (0.05, 0.15, 0.5, 1.5, 5.0))
    found = []
    for where, weight in (("all along", "1"), ("towards the tip", "s"), ("towards the clamp", "(1 - s)")):
        name = {"1": "", "s": "_tip", "(1 - s)": "_clamp"}[weight]
        found += [
            _form(f"bending{name}", f"a stiffening moment with a power of the curvature, {where}", "moment",
                  {"moment": f"a * stiffness * {weight} * abs(c)^(power - 1) * c"}, [power((0.5, 2.0, 3.0, 4.0))]),
            _form(f"late{name}", f"a delayed spring, {where}", "moment",
                  {"moment": f"a * stiffness * {weight} * memory"}, [tau]),
            _form(f"bending_loss{name}", f"a moment against the rate of curvature, with a power of it, {where}",
                  "moment", {"moment": f"a * stiffness * {weight} * {_odd('c_rate', 'w_0')}"}, [power()]),
            _form(f"one_sided{name}", f"more stiffness to one side only, {where}", "moment",
                  {"moment": f"a * stiffness * {weight} * positive(c)"}, []),
        ]  # fmt: skip
    return found
