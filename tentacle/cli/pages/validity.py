"""The validity maps of `tentacle compare` as sections of its report."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tentacle.model import Model
    from validation.validity_map import Validity
    from viz.report import ReportSection


def validity_sections(model: Model, maps: list[Validity]) -> list[ReportSection]:
    """One map for each arm, and the errors of all arms over drag / stiffness."""
    from validation.validity_advice import sentence
    from validation.validity_map import AMPLITUDES, LEVELS, MAP_ORDERS, RATIOS
    from viz.figures.flexibility import flexibility_figure
    from viz.figures.validity_map import validity_figure
    from viz.report import Picture, ReportSection, ReportTable

    sections = []
    for found in maps:
        errors: dict[str, Any] = {f"shape, order {o}": found.shape[i] for i, o in enumerate(MAP_ORDERS)}
        if model.fluid.density > 0.0:
            errors |= {f"mean thrust, order {o}": found.thrust[i] for i, o in enumerate(MAP_ORDERS)}
        mode = ", ".join(f"{100 * e:.2g} % at order {o}" for e, o in zip(found.frequency, MAP_ORDERS, strict=True))
        reach = [
            (str(o), f"{100 * level:.0f} %", *(f"{found.reach(o, level, a):g}" for a in range(len(AMPLITUDES))))
            for o in MAP_ORDERS
            for level in LEVELS
        ]
        limits = ReportTable(
            "largest frequency / first mode up to which the shape stays within the error, by amplitude",
            ("order", "error", *(f"{a:g} rad" for a in AMPLITUDES)),
            reach,
            numeric=tuple(range(2, 2 + len(AMPLITUDES))),
        )
        words = (
            sentence(found),
            f"First mode in the fluid: {found.first:.3g} Hz; the reduced model's is off by {mode}.",
            "Shape: rms distance of the midlines over the tip's rms motion. Thrust: of the mean over 2 periods;"
            " blank where the mean is under 1 % of the load's rms.",
        )
        picture = Picture(validity_figure(RATIOS, AMPLITUDES, errors, LEVELS), "Lines: 1, 5 and 10 %.")
        sections.append(ReportSection(f"Validity, {found.label}", words, (limits,), (picture,)))
    if maps and model.fluid.density > 0.0:
        over = {f"shape, order {o}": {m.label: m.shape[i] for m in maps} for i, o in enumerate(MAP_ORDERS)}
        figure = flexibility_figure(RATIOS, {m.label: m.flexibility for m in maps}, over, LEVELS)
        words = (
            "Drag over stiffness: rho w (2 pi f theta L)^2 L^3 / (2 E I0), one point a motion. It decides little by"
            " itself: at one value the error runs over decades, ordered by the frequency (colour). At a given frequency"
            " over first mode E drops out: what stays is amplitude, taper, L/r0 and the material's loss.",
        )
        sections.append(ReportSection("Over flexibility", words, (), (Picture(figure, "Dashed: 1, 5 and 10 %."),)))
    return sections
