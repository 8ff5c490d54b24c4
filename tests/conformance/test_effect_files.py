"""The effect files of examples/effects are held to the conformance tests of the catalogue, by the tests themselves."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
FILES = sorted((ROOT / "examples" / "effects").glob("*.toml"))
ROOMS = ("tests/affine_model/test_effects.py", "tests/conformance/test_pairs_of_effects.py",
         "tests/affine_model/test_kernel.py::test_kernel_equals_assembly")  # fmt: skip


def test_effect_files_pass_the_conformance_tests():
    names = [file.stem for file in FILES]
    # One compiled kernel holds all of them; that it does what the assembly does is tried on the force at the tip.
    chosen = f"({' or '.join(names)}) and not same_call and not (kernel_equals and not magnet)"
    words = [sys.executable, "-m", "pytest", *ROOMS, "-q", "-p", "no:cacheprovider", "-k", chosen, "--effects", *FILES]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-4000:]
    assert int(done.stdout.rsplit(" passed", 1)[0].split()[-1]) >= 10 * len(names)
