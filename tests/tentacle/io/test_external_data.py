"""Others' data: found, checked, and the silicone beam as recordings whose geometry is that of a 100 mm beam."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tentacle.cli import main
from tentacle.io.convert_data import convert_data
from tentacle.io.external_data import DATA_SETS, check_data_set, data_folder, file_digest
from tentacle.io.import_folder import read_folder
from tentacle.io.silicone_beam import BEAM_FILES, read_beam, release_time
from tests.tentacle.io.test_import_folder import assert_equal_recordings

BEAMS = data_folder() / "silicone_beam"
needs_beams = pytest.mark.skipif(
    not BEAMS.is_dir(), reason=f"no silicone beam data in {BEAMS}: `tentacle data` says where to get them"
)


def test_a_set_is_absent_incomplete_changed_or_present(tmp_path: Path) -> None:
    bench = next(data_set for data_set in DATA_SETS if data_set.name == "thrust_bench")
    assert check_data_set(bench, tmp_path) == ("absent", [])
    folder = tmp_path / "thrust_bench"
    folder.mkdir()
    assert check_data_set(bench, tmp_path)[0] == "incomplete"
    for name in bench.files:
        (folder / name).write_text("t_s\n")
    assert check_data_set(bench, tmp_path) == ("changed", list(bench.files))
    assert file_digest(folder / "robo-3.csv") != bench.files["robo-3.csv"]


def test_the_list_names_source_commit_and_licence(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["data"]) == 0
    text = capsys.readouterr().out
    for data_set in DATA_SETS:
        assert data_set.url in text
        assert data_set.commit in text
        assert data_set.licence in text


@pytest.mark.parametrize("data_set", DATA_SETS, ids=lambda data_set: data_set.name)
def test_the_sets_here_are_those_that_the_tests_were_written_for(data_set: object) -> None:
    assert data_set in DATA_SETS
    state, paths = check_data_set(data_set, data_folder())  # pyright: ignore[reportArgumentType]
    if state == "absent":
        pytest.skip(f"not in {data_folder()}: `tentacle data` says where to get it")
    assert (state, paths) == ("present", [])


def test_the_release_of_a_free_fall_is_found() -> None:
    t = np.arange(0, 1, 0.01)
    for release in (0.403, 0.5, 0.617):
        drop = 0.5 * 9.80665 * np.maximum(t - release, 0) ** 2
        assert release_time(t, drop) == pytest.approx(release, abs=1e-9)  # exact but for rounding


@needs_beams
@pytest.mark.parametrize("name", BEAM_FILES)
def test_a_beam_lies_straight_until_it_is_released_and_then_falls(name: str) -> None:
    recording = read_beam(BEAMS / f"{name}.csv")
    markers, release = recording.markers, recording.declaration.release_t
    assert markers is not None
    assert release is not None
    assert 0.4 < release < 0.75  # the source: at about 0.4 to 0.7 s
    straight = np.stack([markers.d, 0.1 * markers.s], axis=-1)
    held = markers.xy[markers.t < 0.3]
    assert np.abs(held - straight).max() < 0.3e-3  # marker noise, 0.1 mm at Tip-3 along the beam
    assert np.abs(markers.xy[markers.t < release - 0.02] - straight)[..., 0].max() < 0.3e-3  # the hand's tremor
    assert markers.s.max() == pytest.approx(1.0, abs=1e-12)  # the foremost marker
    assert np.ptp(markers.d) == pytest.approx(0.03, abs=0.0015)  # on a face 30 mm high
    # Gravity pulls along -n: at rest at the end the tip hangs below the straight pose by millimetres.
    assert recording.declaration.gravity.angle == pytest.approx(-np.pi / 2)
    drop = -(markers.xy[-100:] - straight)[..., 0].mean()
    assert 5e-3 < drop < (8e-3 if "gravity" in name else 20e-3)


@needs_beams
def test_converted_beams_are_import_folders(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["data", "convert", "silicone_beam", str(tmp_path / "beams")]) == 0
    for name in BEAM_FILES:
        assert_equal_recordings(read_folder(tmp_path / "beams" / name), read_beam(BEAMS / f"{name}.csv"))
    assert main(["data", "convert", "silicone_beam", str(tmp_path / "beams")]) == 2
    assert "is there already" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["trunk_payload", "pressure_arm"])
def test_other_arms_are_converted_to_import_folders(name: str, tmp_path: Path) -> None:
    if not (data_folder() / name).is_dir():
        pytest.skip(f"no {name} in {data_folder()}: `tentacle data` says where to get it")
    folders = convert_data(name, data_folder(), tmp_path)
    assert len(folders) == {"trunk_payload": 44, "pressure_arm": 2}[name]  # 13 + 8 + 21 decays, 2 driven; 2 runs
    for folder in folders:
        recording = read_folder(folder)
        markers = recording.markers
        assert markers is not None
        still = markers.xy[:50] if name == "pressure_arm" else markers.xy[-145:]
        if "controlled" not in folder.name:  # the tendons' arm is never at rest
            np.testing.assert_allclose(still.mean(axis=0)[:, 0], markers.d, atol=1e-6)  # written to the micrometre
            along = recording.declaration.specimen.length * markers.s
            assert np.abs(still.mean(axis=0)[:, 1] - along).max() < 1.5e-2  # what still swings hangs less deep
        assert recording.declaration.uncertain[0].field == "specimen.density_kg_m3"
        if "decay" in folder.name:
            assert recording.declaration.release_t is None
            assert recording.declaration.specimen.laws == ("dry_friction",)
            # The middle disc begins its swing: it moves at once, with a tenth of its way to rest behind it.
            way = np.linalg.norm(markers.xy[:, 1] - still[:, 1].mean(axis=0), axis=1)
            assert way[10] < way[0] - 0.03 * way[0]
            assert way[:3].max() > 0.8 * way.max()
