"""What a law is called by its sign and place, and the kinds of laws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from discovery.laws.inside import AT_PLACE
from discovery.laws.search import FittedLaw
from tentacle.law.written_law import WrittenLaw

CONTRARY = {
    "towards": "away from",
    "stiffening": "softening",
    "more stiffness": "less stiffness",
}  # where the strength a is negative
LAW_KINDS = {
    "the speed": ("drag_", "skin_", "one_way", "tip_drag"), "the speed near a place": ("patch_",),
    "the place of the tip": ("attraction", "tether", "tip_spring", "stop_"),
    "the place of one section": ("inside_attraction", "inside_tether", "inside_spring", "inside_stop_"),
    "the speed of one section": ("inside_drag",),
    "the place of every section": ("jet", "line_spring"), "time": ("vortex", "beat_x", "tip_beat", "inside_beat"),
    "a steady force": ("tip_push", "inside_push"),
    "the curvature": ("bending", "one_sided"), "the past curvature": ("late",),
}  # fmt: skip


def title_of(law: WrittenLaw, values: Mapping[str, float]) -> str:
    """The law's title with these values: the way of its force by the sign of a, and the section where it acts."""
    title = law.title
    if values.get("a", 0.0) < 0.0:
        for said, contrary in CONTRARY.items():
            title = title.replace(said, contrary)
    return title.replace(AT_PLACE, f"s = {values['at_s']:.2f}") if "at_s" in values else title


def by_kind(found: Sequence[FittedLaw]) -> dict[str, list[FittedLaw]]:
    """The laws of each kind that was found, the one that leaves least first."""
    ordered = sorted(found, key=lambda one: one.unexplained)
    kinds = {
        kind: [one for one in ordered if one.form.law.name.startswith(starts)] for kind, starts in LAW_KINDS.items()
    }
    return {kind: laws for kind, laws in kinds.items() if laws}
