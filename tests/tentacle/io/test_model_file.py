"""model.toml gives the model back exactly, and names what is wrong."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tentacle.errors import InputError
from tentacle.io.model_file import read_model, write_model
from tentacle.model import Estimate, Model
from tentacle.posterior import Posterior
from tentacle.specimen import WATER, Cone, Gravity, Rectangle, Specimen

MODEL = Model(
    specimen=Specimen(Cone(0.0125, 0.001), 0.14, 1070.0, 0.0, "affine"),
    fluid=WATER,
    gravity=Gravity(1 / 3, 9.8),
    order=3,
    parameters={
        "elasticity": {"k0": Estimate(1 / 7, 0.1, 0.2, "N m/rad"), "k1": Estimate(-0.1, -0.2, 0.0, "N m/rad")},
        "drag": {"C_perp": Estimate.exact(1.1)},
        "third_curvature": {},
        "current": {"u": Estimate(0.02, float("-inf"), float("inf"), "m/s")},
    },
    posterior=Posterior(("elasticity.k0", "elasticity.k1"), (1 / 39, 0.04), ((1.0, -1 / 3), (-1 / 3, 1.0))),
)


def test_a_model_file_gives_the_model_back_exactly(tmp_path: Path) -> None:
    beam = Specimen(Rectangle(0.03, 0.02), 0.1, 1070.0, 0.052, clamp_length=1 / 300)
    for model in (MODEL, Model(beam)):
        write_model(model, tmp_path / "model.toml")
        assert read_model(tmp_path / "model.toml") == model
    assert [file.name for file in tmp_path.iterdir()] == ["model.toml"]


def test_only_a_plain_file_is_replaced(tmp_path: Path) -> None:
    """A device must stay: root can rename a file onto /dev/null, and the machine has none afterwards."""
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to("/dev/full")
    for name in ("pipe", "link", ""):
        with pytest.raises(InputError, match=r"no plain file|no file name"):
            write_model(MODEL, tmp_path / name if name else Path())
    assert (tmp_path / "pipe").is_fifo()
    assert (tmp_path / "link").is_char_device()
    assert {path.name for path in tmp_path.iterdir()} == {"pipe", "link"}


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("order = 3", "order = 0", "model.toml:1: order: 0 is not usable; expected a whole number >= 1"),
        ("order = 3", "ordr = 3", "ordr: unknown key (did you mean order?)"),
        ("value = 1.1", "valu = 1.1", "effects.drag.C_perp.value: missing (there is valu"),
        ("value = 1.1", "value = nan", "effects.drag.C_perp.value: nan is out of range"),
        ("low = 0.1", "low = 0.19", "effects.elasticity.k0.value: 0.14285714285714285 is not between low and high"),
        ('"elasticity.k0",', '"elasticity.k9",', "posterior.parameters: names a parameter that the model lacks"),
        ("0.04,", "-0.04,", "posterior.correlation: a deviation is not positive"),
        ("0.04,", "", "posterior.deviation: "),
        ("-0.3333333333333333,", "-0.4,", "posterior.correlation: correlation is not symmetric"),
        ("-0.3333333333333333,", "[],", "posterior.correlation: "),
        ("length_m = 0.14", "length_m = -1", "specimen.length_m: -1 is out of range"),
    ],
)
def test_bad_model_files_are_refused_in_one_line(old: str, new: str, said: str, tmp_path: Path) -> None:
    write_model(MODEL, tmp_path / "model.toml")
    text = (tmp_path / "model.toml").read_text()
    assert old in text
    (tmp_path / "model.toml").write_text(text.replace(old, new, 1))
    with pytest.raises(InputError) as caught:
        read_model(tmp_path / "model.toml")
    assert said in str(caught.value)
