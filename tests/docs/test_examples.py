"""Every example runs, leaves the picture that the gallery shows, and is a notebook too."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCRIPTS = sorted((ROOT / "examples").glob("*.py"))


def hook():
    """The gallery's module; it stands beside the documentation, in no package."""
    pytest.importorskip("mkdocs", reason="mkdocs is not installed: pip install tentacle-twin[docs]")
    spec = importlib.util.spec_from_file_location("gallery_of_examples", ROOT / "docs" / "hooks" / "examples.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_an_example_runs_and_leaves_its_picture(script, tmp_path):
    shell = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-W", "error::DeprecationWarning:__main__", str(script)]
    done = subprocess.run(command, cwd=tmp_path, env=shell, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip()
    import cv2

    made, shown = (cv2.imread(str(p)) for p in (tmp_path / f"{script.stem}.png", gallery(f"{script.stem}.webp")))
    assert made is not None
    assert shown is not None, "python docs/make_pictures.py makes the gallery's pictures"
    # the gallery's is made smaller; tight borders differ by a few pixels with the fonts at hand
    assert made.shape[1] / made.shape[0] == pytest.approx(shown.shape[1] / shown.shape[0], rel=0.05)
    assert gallery(f"{script.stem}.txt").read_text().count("\n") == done.stdout.count("\n")


def gallery(name: str) -> Path:
    return ROOT / "docs" / "pictures" / "examples" / name


def test_a_notebook_has_the_scripts_code_and_nothing_more():
    gallery_hook = hook()
    assert len(SCRIPTS) >= 4
    for script in SCRIPTS:
        text = script.read_text(encoding="utf-8")
        made = json.loads(json.dumps(gallery_hook.notebook(text)))
        code = ["".join(cell["source"]) for cell in made["cells"] if cell["cell_type"] == "code"]
        assert code[0] == "%matplotlib inline"
        kept = [line for line in text.splitlines() if line and not line.startswith("#")]
        assert [line for cell in code[1:] for line in cell.splitlines() if line and not line.startswith("#")] == kept
        assert len({cell["id"] for cell in made["cells"]}) == len(made["cells"])
        assert made["cells"][1]["cell_type"] == "markdown"
        assert made["cells"][1]["source"][0].startswith("# ")


def test_text_before_the_first_cell_is_refused():
    with pytest.raises(ValueError, match="begins with a cell"):
        hook().cells("import os\n# %%\n")
