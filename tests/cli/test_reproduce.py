import pytest

from tentacle.cli import main
from tentacle.cli._reproduce_fig9 import cell
from tentacle.cli._reproduce_table1 import LENGTHS, PAPER, specimen_result
from tentacle.cli.reproduce import results


def test_results_are_found_by_listing():
    assert {"fig9", "table1"} <= set(results())


def test_a_cell_of_figure_9_swims_forward_alike_in_both_models():
    found = cell({"length": 0.14, "amplitude": 0.7, "frequency": 2.1})
    assert found["reference"] > 0.03
    assert found["affine"] == pytest.approx(found["reference"], rel=0.1)


def test_the_papers_table_is_whole():
    assert all(len(rows) == len(LENGTHS) for rows in PAPER.values())


def test_one_arm_of_table_1_from_video():
    task = {"length": 0.15, "silicone": "Dragon Skin 20", "seconds": 3.0, "look": "clean", "seed": 0}
    found = specimen_result(task)
    assert found["accepted"] > 0.95
    assert found["midline_mm"] < 0.5
    assert found["q1_rad2"] < 0.01


def test_too_short_a_video_is_refused(tmp_path, capsys):
    assert main(["reproduce", "table1", "--out", str(tmp_path / "t"), "--seconds", "1"]) == 2
    assert "3 or more" in capsys.readouterr().err
