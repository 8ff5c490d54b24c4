"""A law that the search proposes passes the conformance tests of effects as the file that is written."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from discovery.laws.grammar import Form, Scale, forms
from discovery.laws.inside import inner_forms
from tentacle.io.effect_file import effect_text

ROOT = Path(__file__).parents[2]
TESTS = (
    "tests/affine_model/test_effects.py",
    "tests/affine_model/test_kernel.py",
    "tests/conformance/test_pairs_of_effects.py",
)
SCALE = Scale(0.14, wet=True, duration=39.0)
FORMS = {form.law.name: form for form in (*forms(SCALE), *inner_forms(SCALE, 0.6))}


def as_proposed(form: Form):
    """The law with the middle of each shape's values, as discovery.laws.propose writes it."""

    def own(p):
        middle = p.scan[len(p.scan) // 2] if p.scan else 0.0
        return replace(p, scan=(middle,), nominal=middle or p.nominal) if p.scan else p

    return replace(form.law, name=f"law_{form.law.name}", parameters=tuple(own(p) for p in form.law.parameters))


# Not conservative; with a memory; with a corner; at one section.
@pytest.mark.long
@pytest.mark.parametrize("name", ["jet", "late_tip", "one_sided", "inside_tether"])
def test_a_proposed_file_passes_the_conformance_tests(name: str, tmp_path: Path) -> None:
    law = as_proposed(FORMS[name])
    file = tmp_path / f"{law.name}.toml"
    file.write_text(effect_text(law))
    command = [sys.executable, "-m", "pytest", "-q", *TESTS, "-k", law.name, "--effects", str(file)]
    found = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=600, check=False)
    assert found.returncode == 0, found.stdout[-2000:]
    assert " passed" in found.stdout
