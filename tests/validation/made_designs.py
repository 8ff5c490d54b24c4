"""Designs of trials like a made recording: an arm, a motion and a sight that are known."""

from tentacle.io.waveform_file import waveform_table
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Chirp
from validation.trials.design import Design, designs
from validation.trials.likeness import Likeness
from validation.trials.sight import Measurement

MODEL = Model(
    Specimen(Cone(0.011, 0.003), 0.14, 1080.0), WATER,
    parameters={"elasticity": {"E": Estimate.exact(2e5, "Pa")}, "damping": {"eta": Estimate.exact(2e3, "Pa s")},
                "drag": {"C_perp": Estimate.exact(1.1)}},
)  # fmt: skip
LIKE = Likeness(MODEL, waveform_table(Chirp(0.3, 0.2, 2.0, 12.0)), 12.0, 60.0, Measurement("midline", 1e-4, 1e-4))


def of_kind(effect: str, **changed: object) -> Design:
    """A trial that hides one effect."""
    (design,) = designs(1, 4, (effect,), ("magnet",), LIKE, ["single"])
    return Design.of({**design.table(), **changed})
