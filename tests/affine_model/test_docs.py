"""The documentation of the effects runs as it stands; that its catalogue is current is held in tests/docs."""

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "howto" / "own_effect.md"


def test_add_your_own_effect_runs_as_written(tmp_path):
    text = PAGE.read_text()
    law, session = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    (printed,) = re.findall(r"It prints\n\n```text\n(.*?)```", text, re.DOTALL)
    (tmp_path / "my_effects").mkdir()
    (tmp_path / "my_effects" / "fillet.py").write_text(law)
    (tmp_path / "session.py").write_text(session)
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "TENTACLE_CACHE": str(tmp_path)}
    command = [sys.executable, "session.py"]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == printed
