"""[fluid] added_mass: none, the section's, or fitted; it comes with the declaration into every model and every fit."""

import numpy as np
import pytest

from affine_model.arm import parameter_index, parameter_vector
from inference.base_fit import Setting
from mujoco_ref.simulate import plain_parameters
from tentacle.errors import InputError
from tentacle.io.declaration_file import declaration_tables, parse_recording_file
from tentacle.model import Model
from tentacle.recording import Declaration
from tentacle.specimen import Cone, Fluid, Rectangle, Specimen

CONE = Specimen(Cone(0.0125, 0.003), 0.14, 1070.0)
C_A = parameter_index("added_mass", "C_a")


@pytest.mark.parametrize(
    ("declared", "held", "freed"), [("none", 0.0, False), ("section", 1.0, False), ("fit", 1.0, True)]
)
def test_what_is_declared_is_in_both_models_and_in_the_fit(declared, held, freed):
    fluid = Fluid(998.0, declared)
    model = Model(CONE, fluid)
    assert parameter_vector(model)[C_A] == held
    assert plain_parameters(model).get("added_mass", {}).get("C_a", 0.0) == held
    setting = Setting(Declaration(CONE, fluid), (), 2)
    assert setting.start()[C_A] == held
    assert (("added_mass", "C_a") in setting.base_free()) == freed


def test_a_declaration_is_written_and_read_back():
    declaration = Declaration(CONE, Fluid(998.0, "section"))
    assert parse_recording_file(declaration_tables(declaration)).declaration == declaration
    with pytest.raises(InputError, match="added_mass"):
        parse_recording_file(
            {**declaration_tables(declaration), "fluid": {"density_kg_m3": 998.0, "added_mass": "yes"}}
        )


def test_air_carries_nothing_and_a_square_more_than_a_circle():
    assert parameter_vector(Model(CONE, Fluid(0.0, "section")))[C_A] == 0.0
    square = Specimen(Rectangle(0.02, 0.02), 0.2, 1070.0)
    # DNV-RP-C205: a square's 1.51 pi rho a^2, and a flat plate's 1.
    assert parameter_vector(Model(square, Fluid(998.0, "section")))[C_A] == pytest.approx(1.51)
    assert Rectangle(0.02, 1e-9).added_mass == pytest.approx(1.0, abs=1e-6)
    assert np.all(np.diff([Rectangle(0.02, h).added_mass for h in (0.001, 0.01, 0.05, 0.2)]) > 0.0)
