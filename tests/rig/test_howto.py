"""What the how-to shows is what the program takes; its commands are run in tests/docs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from rig.setup_file import read_setup
from tentacle.io.waveform_file import read_waveform

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "howto" / "rig.md").read_text()
COMMANDS = [
    line
    for block in re.findall(r"```bash\n(.*?)```", PAGE, re.DOTALL)
    for line in block.splitlines()
    if "tentacle " in line
]


def test_every_command_of_the_rig_is_shown() -> None:
    shown = {tuple(command.split()[1:3]) for command in COMMANDS}
    for verb in ("ports", "emulate", "check", "calibrate", "record", "import", "optimise", "campaign"):
        assert ("rig", verb) in shown


def test_the_files_that_are_shown_are_read(tmp_path: Path) -> None:
    setup, wave = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    (tmp_path / "rig.toml").write_text(setup)
    (tmp_path / "wave.toml").write_text(wave)
    assert read_setup(tmp_path / "rig.toml").limits.max_speed == 8.0
    assert read_waveform(tmp_path / "wave.toml")(0.25)[0] == pytest.approx(0.5)


def test_the_wiring_is_the_sketchs() -> None:
    sketch = (ROOT / "rig" / "firmware" / "due" / "tentacle_rig" / "tentacle_rig.ino").read_text()
    pins = dict(re.findall(r"(k\w+Pin) = (\w+)", sketch))
    rows = {row.split("|")[1].strip(): row for row in PAGE.splitlines() if row.startswith("| ")}
    assert f"D{pins['kServoPin']};" in rows["servo signal"]
    assert f"D{pins['kDataPin']}, D{pins['kClockPin']}" in rows["HX711 DOUT, PD_SCK"]
    assert f"D{pins['kLedPin']}," in rows["sync LED with 330 ohm"]
    assert f"{pins['kAnglePin']}," in rows["servo position (optional)"]
    assert f"{pins['kCurrentPin']};" in rows["servo current (optional)"]
