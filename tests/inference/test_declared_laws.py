"""[specimen] laws: effects that act in an arm of their own are fitted like E and eta, in the baseline too."""

from dataclasses import replace

import numpy as np
import pytest

from affine_model.arm import parameter_index
from affine_model.declared_laws import law_starts
from affine_model.effects import catalogue
from inference.base_fit import Setting, fit_base
from inference.identify import identify
from inference.one_arm import same_arm
from inference.prepare import prepare
from inference.score import responses
from tentacle.cli import main
from tentacle.errors import InputError
from tentacle.io.declaration_file import declaration_tables, parse_recording_file
from tentacle.io.model_file import read_model, write_model
from tentacle.io.write_folder import write_folder
from tentacle.recording import Declaration, Recording
from tentacle.specimen import AIR, WATER, Fluid
from tests.made_recordings import SPECIMEN, Run, record_declared

FRICTION = {("dry_friction", "c_f"): 0.1, ("dry_friction", "slip"): 0.03}
C_F = parameter_index("dry_friction", "c_f")


def with_friction(*laws: str, **run) -> Recording:
    """A recording of an arm in which friction acts, declared with these laws."""
    return record_declared(Declaration(replace(SPECIMEN, laws=laws), WATER), FRICTION, Run(**run))


def test_a_declared_law_is_fitted_with_the_base_and_told_with_its_interval():
    found = identify([with_friction("dry_friction")], order=2)
    known = found.model.parameters["dry_friction"]
    for (_, name), truth in FRICTION.items():
        # Four deviations: a true interval misses once in 16 000. Or 3 %, by which the step of the fit moves friction.
        away = max(4.0 * (known[name].high - known[name].low) / (2.0 * 1.96), 0.03 * truth)
        assert known[name].value == pytest.approx(truth, abs=away)
    assert found.model.parameters["elasticity"]["E"].value == pytest.approx(2e5, rel=0.01)
    assert found.errors.midline_mm < 1.05 * 1e-1 * np.sqrt(2.0)  # the noise alone
    assert any("declared law dry_friction" in sentence for sentence in found.words)


def test_without_it_the_error_is_many_times_the_noise():
    assert identify([with_friction()], order=2).errors.midline_mm > 4.0 * 1e-1 * np.sqrt(2.0)


def test_it_acts_in_a_baseline_and_is_not_sought():
    p = prepare(with_friction("dry_friction", seconds=3.0), hold_out=False)
    baseline = replace(p.experiment, complete=True)
    setting = Setting(p.recording.declaration, (baseline,), 2)
    start = setting.start()
    assert start[C_F] == catalogue()["dry_friction"].strengths[0].nominal
    assert baseline.acting(start[:, None])[C_F, 0] == start[C_F]
    assert replace(baseline, declared=frozenset()).acting(start[:, None])[C_F, 0] == 0.0
    sought = {one.effect.name for one in responses(*fit_base(setting, 2))}
    assert "dry_friction" not in sought
    assert "cubic_stiffness" in sought


def test_declared_added_mass_acts_in_a_baseline():
    fluid = Fluid(998.0, "section")
    recording = record_declared(Declaration(SPECIMEN, fluid), {}, Run(seconds=1.0))
    baseline = replace(prepare(recording, hold_out=False).experiment, complete=True)
    start = Setting(recording.declaration, (baseline,), 2).start()
    C_a = parameter_index("added_mass", "C_a")
    assert baseline.acting(start[:, None])[C_a, 0] == start[C_a] == 1.0


def test_the_memory_of_a_declared_maxwell_branch_is_among_the_unknowns():
    recording = record_declared(Declaration(replace(SPECIMEN, laws=("viscoelasticity",)), WATER), {}, Run(seconds=1.0))
    experiment = prepare(recording, hold_out=False).experiment
    assert [name for name in experiment.nuisance_names(2) if name.startswith("memory")] == ["memory1(0)", "memory2(0)"]
    assert identify([recording], order=2).model.parameters["viscoelasticity"]["g"].low == 0.0  # there is none


def test_a_law_of_the_fluid_is_not_fitted_in_air():
    specimen = replace(SPECIMEN, laws=("skin_drag", "dry_friction"))
    assert [law.name for law in Setting(Declaration(specimen, AIR), (), 2).laws] == ["dry_friction"]
    assert [law.name for law in Setting(Declaration(specimen, WATER), (), 2).laws] == ["skin_drag", "dry_friction"]


@pytest.mark.parametrize("name", ["dry_friction", "cubic_stiffness", "viscoelasticity", "tip_mass"])
def test_starts_keep_to_the_bounds_of_a_law(name):
    law = catalogue()[name]
    low, high = np.array([parameter.bounds for parameter in law.parameters]).T
    starts = np.array(law_starts(law))
    assert np.all((low <= starts) & (starts <= high))
    assert len(np.unique(starts, axis=0)) == len(starts)


def test_laws_are_written_and_read_back(tmp_path):
    declaration = Declaration(replace(SPECIMEN, laws=("dry_friction", "cubic_stiffness")), WATER)
    assert parse_recording_file(declaration_tables(declaration)).declaration == declaration
    assert "laws" not in declaration_tables(Declaration(SPECIMEN, WATER))["specimen"]
    model = identify([with_friction("dry_friction", seconds=3.0)], order=2).model
    write_model(model, tmp_path / "model.toml")
    assert read_model(tmp_path / "model.toml") == model


@pytest.mark.parametrize(
    ("laws", "told"),
    [
        (["dry_frictoin"], "did you mean dry_friction?"),
        (["camera_roll"], "laws that act in an arm"),
        (["dry_friction", "dry_friction"], "a name twice"),
        ("dry_friction", "no list of names"),
        ([3], "no list of names"),
    ],
)
def test_a_law_that_no_arm_has_is_told_in_one_line(laws, told, tmp_path, capsys):
    folder = tmp_path / "arm"
    write_folder(with_friction(seconds=1.0), folder)
    file = folder / "recording.toml"
    shown = str(laws).replace("'", '"') if isinstance(laws, list) else f'"{laws}"'
    file.write_text(file.read_text().replace("[specimen]", f"[specimen]\nlaws = {shown}"))
    assert main(["diagnose", str(folder), "--out", str(tmp_path / "answer")]) == 2
    line = capsys.readouterr().err
    assert line.count("\n") == 1
    assert told in line
    assert "recording.toml" in line
    assert not (tmp_path / "answer").exists()


def test_recordings_of_one_arm_declare_the_same_laws():
    with pytest.raises(InputError, match=r"specimen\.laws"):
        same_arm([with_friction(seconds=1.0), replace(with_friction("dry_friction", seconds=1.0), name="other")])
