"""Effect files: read and written alike; what is wrong with one is said in a line."""

from pathlib import Path

import pytest

from affine_model.effects import catalogue
from tentacle.errors import InputError
from tentacle.io.effect_file import effect_text, effects_of, read_effects
from tentacle.law.in_use import laws_in_use

EXAMPLES = sorted((Path(__file__).parents[3] / "examples" / "effects").glob("*.toml"))
MAGNET = next(file for file in EXAMPLES if file.stem == "magnet").read_text()


@pytest.mark.parametrize("file", EXAMPLES, ids=lambda file: file.stem)
def test_a_law_is_written_as_it_is_read(file, tmp_path):
    (law,) = read_effects([file])
    copy = tmp_path / "copy.toml"
    copy.write_text(effect_text(law))
    assert read_effects([copy]) == (law,)


@pytest.mark.parametrize(
    ("old", "new", "field"),
    [
        ("F * reference^2 * (place_x", "F * (place_x", "law.force_x"),  # another dimension
        ("F * reference^2 * (place_x", "F * reference^2 * (place_z", "law.force_x"),
        ("F * reference^2 * (place_x - x) / d^3", "reference / reference", "law.force_x"),
        ("F * reference^2 * (place_x - x) / d^3", "F * 1e-9^(-x / reference)^0.5", "law.force_x"),
        ("F * reference^2 * (place_x - x) / d^3", "F * 0 ^ (0 - 1)", "law"),  # plain numbers, and no array of them
        ("F * reference^2 * (place_x - x) / d^3", "F / 0", "law"),
        ("F * reference^2 * (place_x - x) / d^3", "F * 10 ^ 10 ^ 10", "law"),
        ('unit = "N"', 'unit = "mN"', "parameters.F.unit"),
        ("bounds = [-0.5, 0.5]", "bounds = [0.5, -0.5]", "parameters.F.bounds"),
        ("place_x]", "stiffness]", "law.force_x"),
        ('acts = "tip"', 'acts = "hand"', "law.acts"),
        ('name = "magnet"', 'name = "a b"', "name"),
        ("[define]", "[defines]", "defines"),
        ("scan = [0.06", "scan = [6.0", "parameters.place_x.scan"),
    ],
)
def test_what_is_wrong_with_a_file_is_named(old, new, field, tmp_path):
    assert old in MAGNET
    file = tmp_path / "own.toml"
    file.write_text(MAGNET.replace(old, new))
    with pytest.raises(InputError) as caught:
        read_effects([file])
    assert caught.value.file == file
    assert str(caught.value.field).startswith(field.split(".")[0])


def test_a_law_is_in_use_within_its_context_only(tmp_path):
    before = set(catalogue())
    with effects_of(EXAMPLES):
        assert set(catalogue()) - before == {law.name for law in laws_in_use()} == {file.stem for file in EXAMPLES}
        with pytest.raises(InputError), effects_of(EXAMPLES[:1]):
            pass
    assert set(catalogue()) == before
    taken = tmp_path / "wall.toml"
    taken.write_text(MAGNET.replace('name = "magnet"', 'name = "wall"'))
    with pytest.raises(InputError, match=r"wall\.toml:\d+: name: the catalogue has an effect 'wall'"):
        read_effects([taken], catalogue())
    with effects_of([taken]), pytest.raises(InputError, match="of that name"):
        catalogue()
    assert set(catalogue()) == before
