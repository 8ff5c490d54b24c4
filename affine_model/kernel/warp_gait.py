"""The parts of a kernel that swims: eq. 20 in place of a table of base motions, and six numbers in place of a course.

    theta(t) = sum over waves w and multiples m of alpha_w C_m fade_m(omega_w) sin(m omega_w t + phi_w)

A step takes one sine and cosine a wave, and makes its harmonics by the addition theorem.
"""

from __future__ import annotations

from affine_model.kernel.generate import Parts
from tentacle.gait import COEFFICIENT, MULTIPLE, TERM

WAVES = 3
GAIT_SIZES = {
    "with_sine": (len(TERM),), "with_cosine": (len(TERM),), "omega": (WAVES,), "peak": (3,), "settled": (),
    "hardest": (),
}  # fmt: skip


def _harmonics(wave: int) -> list[tuple[int, int]]:
    """(number, multiple of the wave's frequency) of its harmonics."""
    return [(h, int(MULTIPLE[h])) for h in range(len(TERM)) if TERM[h] == wave]


def _gait_command() -> str:
    """Eq. 20 at t: theta and its first two derivatives into `command`, its harmonics by the addition theorem."""
    text = ["for b in range(BLOCK):", *(f"    command[{k}, b] = 0.0" for k in range(3))]
    for wave in range(WAVES):
        text.append(f"    sine_1, cosine_1 = sincos(omega[{wave}, b] * t[b])")
        multiples = [m for _, m in _harmonics(wave)]
        stride = 1 if 2 in multiples else 2
        if stride == 2 and len(multiples) > 1:
            text.append("    turn_sine = 2.0 * sine_1 * cosine_1")
            text.append("    turn_cosine = cosine_1 * cosine_1 - sine_1 * sine_1")
        turn = ("sine_1", "cosine_1") if stride == 1 else ("turn_sine", "turn_cosine")
        for m in multiples[1:]:
            before = m - stride
            text.append(f"    sine_{m} = sine_{before} * {turn[1]} + cosine_{before} * {turn[0]}")
            text.append(f"    cosine_{m} = cosine_{before} * {turn[1]} - sine_{before} * {turn[0]}")
        rates, bends = [], []
        for h, m in _harmonics(wave):
            text += [
                f"    ahead = with_sine[{h}, b] * sine_{m} + with_cosine[{h}, b] * cosine_{m}",
                f"    aside = with_sine[{h}, b] * cosine_{m} - with_cosine[{h}, b] * sine_{m}",
                "    command[0, b] += ahead",
                f"    rate_{h} = aside",
                f"    bend_{h} = ahead",
            ]
            rates.append(f"{float(m)} * rate_{h}")
            bends.append(f"{float(m * m)} * bend_{h}")
        text.append(f"    command[1, b] += omega[{wave}, b] * ({' + '.join(rates)})")
        text.append(f"    command[2, b] -= omega[{wave}, b] * omega[{wave}, b] * ({' + '.join(bends)})")
    return "\n".join(f"        {line}" for line in text)


def _gait_start() -> str:
    """Amplitudes of the harmonics, faded towards the bandwidth; then a pass that scales them to the servo's limits."""
    text = ["    for b in range(BLOCK):"]
    for wave in range(WAVES):
        text.append(f"        omega[{wave}, b] = gait[first + b, {WAVES + wave}]")
        text.append(f"        wave_sine, wave_cosine = sincos(gait[first + b, {2 * WAVES + wave}])")
        for h, multiple in _harmonics(wave):
            text.append(f"        strength = gait[first + b, {wave}] * {float(COEFFICIENT[h])!r}")
            if multiple > 1:
                share = f"min({float(multiple)} * abs(omega[{wave}, b]) / (6.283185307179586 * bandwidth), 1.0)"
                text.append(f"        fade = math.cos(1.5707963267948966 * {share})")
                text.append("        strength = strength * fade * fade")
            text.append(f"        with_sine[{h}, b] = strength * wave_cosine")
            text.append(f"        with_cosine[{h}, b] = strength * wave_sine")
    text += ["    for step in range(steps):", "        for b in range(BLOCK):"]
    text += [
        "            t[b] = t0[lane[b]] + (float(step) + 0.5) * h",
        _gait_command(),
        "        for b in range(BLOCK):",
    ]
    text += [f"            peak[{k}, b] = max(peak[{k}, b], abs(command[{k}, b]))" for k in range(3)]
    text += ["    for b in range(BLOCK):", "        scale = 1.0"]
    text += [f"        scale = min(scale, limits[{k}] / max(peak[{k}, b], 1e-300))" for k in range(3)]
    for h in range(len(TERM)):
        text += [f"        {name}[{h}, b] = {name}[{h}, b] * scale" for name in ("with_sine", "with_cosine")]
    text += ["        outcome[5, first + b] = scale"]
    return "\n".join(text)


_SWIM_KEPT = """\
        for b in range(BLOCK):
            if (step + 1) % 2 == 0:
                if step >= average_from:
                    hardest[b] = max(hardest[b], abs(0.5 * window[3, b]))
                window[3, b] = 0.0
            if step + 1 == average_from:
                settled[b] = u[n + 1, b]
"""
_SWIM_SUMMARY = """\
    kept = max(steps - average_from, 1)
    for b in range(BLOCK):
        outcome[0, first + b] = -sums[1, b] / float(kept)
        outcome[1, first + b] = (settled[b] - u[n + 1, b]) / (float(kept) * h)
        outcome[2, first + b] = sums[2, b] / float(kept)
        outcome[3, first + b] = hardest[b]
        outcome[4, first + b] = diverged[b]
"""


def gait_parts() -> Parts:
    """The parts, for affine_model.kernel.generate.filled_template."""
    return Parts(_gait_command(), _SWIM_KEPT, _SWIM_SUMMARY, _gait_start())
