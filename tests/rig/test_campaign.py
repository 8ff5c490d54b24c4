"""Campaigns: checked before anything moves, resumed where they stopped."""

from __future__ import annotations

from pathlib import Path

import pytest

from rig.campaign import read_campaign, run_campaign
from rig.connection import connected
from rig.emulator import Emulator
from rig.run_file import read_run
from rig.safety import SafetyLimits
from rig.settle import SettleRule
from rig.setup_file import LoadCellCalibration, RigSetup
from tentacle.errors import InputError
from tentacle.io.declaration_file import RecordingFile
from tentacle.io.folder_lock import owned_folder
from tentacle.recording import Declaration
from tentacle.specimen import WATER, Cone, Specimen

EXAMPLE = Path(__file__).parents[2] / "examples" / "campaign.toml"
SHORT = """
name = "short"
[[run]]
name = "a"
duration_s = 1.0
waveform = {kind = "sine", amplitude_rad = 0.3, frequency_hz = 1.0}
repeat = 2
"""


def setup_at(port: str, limits: SafetyLimits) -> RigSetup:
    declared = RecordingFile(Declaration(Specimen(Cone(0.0125, 0.001), 0.14, 1070.0), WATER))
    return RigSetup(port, limits, SettleRule(2e-3, 30, 10.0), LoadCellCalibration(52000.0, 180000.0), declared)


def test_the_example_is_within_usual_limits(limits: SafetyLimits) -> None:
    campaign = read_campaign(EXAMPLE, setup_at("loop://", limits))
    assert [run.name for run in campaign.runs] == ["chirp", "sine-low", "sine-low-2", "sine-high"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("amplitude_rad = 0.3", "amplitude_rad = 0.9"), "beyond the limits"),
        (('name = "a"', 'name = "../a"'), "no file name"),
        (("duration_s = 1.0", "duration_s = 0"), "duration_s"),
        (('kind = "sine"', 'kind = "square"'), "kind"),
        (("repeat = 2", "repeats = 2"), "unknown key"),
    ],
)
def test_a_bad_run_is_named_before_anything_moves(
    change: tuple[str, str], message: str, limits: SafetyLimits, tmp_path: Path
) -> None:
    file = tmp_path / "campaign.toml"
    file.write_text(SHORT.replace(*change))
    with pytest.raises(InputError, match=message):
        read_campaign(file, setup_at("loop://", limits))


def test_a_campaign_goes_on_where_it_stopped(emulator: Emulator, limits: SafetyLimits, tmp_path: Path) -> None:
    setup = setup_at(emulator.url, limits)
    (tmp_path / "campaign.toml").write_text(SHORT)
    campaign = read_campaign(tmp_path / "campaign.toml", setup)
    folder = tmp_path / "out"
    with connected(setup) as board:
        first = next(iter(run_campaign(setup, board, None, campaign, folder)))
        content = bytearray(first.path.read_bytes())
        middle = len(content) // 2
        content[middle : middle + 4096] = bytes(4096)  # one bit can fall into padding, where it changes no sample
        first.path.write_bytes(content)
        rest = list(run_campaign(setup, board, None, campaign, folder))
        again = list(run_campaign(setup, board, None, campaign, folder))
    assert first.path.name == "a.rrd"
    assert [result.path.name for result in rest] == ["a.rrd", "a-2.rrd"]
    assert "kept as a.unfinished-1.rrd" in rest[0].words
    assert (folder / "a.unfinished-1.rrd").read_bytes() == content
    with owned_folder(folder, ""), pytest.raises(InputError, match="out: is in use by another process"):
        next(run_campaign(setup, board, None, campaign, folder))
    assert again == []
    assert read_run(folder / "a-2.rrd").outcome == "complete"
