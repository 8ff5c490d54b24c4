import pytest

from tentacle.cli import main
from tentacle.cli.reproduce import paper_results
from validation.paper_fig9 import fig9_cell
from validation.paper_table1 import PAPER, TABLE1_LENGTHS
from validation.table1_arm import arm_result


def test_results_are_found_by_listing():
    assert {"fig9", "table1"} <= set(paper_results())


def test_a_cell_of_figure_9_swims_forward_alike_in_both_models():
    found = fig9_cell({"length": 0.14, "amplitude": 0.7, "frequency": 2.1})
    assert found["reference"] > 0.03
    assert found["affine"] == pytest.approx(found["reference"], rel=0.1)


def test_the_papers_table_is_whole():
    assert all(len(rows) == len(TABLE1_LENGTHS) for rows in PAPER.values())


@pytest.mark.long
def test_one_arm_of_table_1_from_video():
    task = {"length": 0.15, "silicone": "Dragon Skin 20", "seconds": 3.0, "look": "clean", "seed": 0}
    found = arm_result(task | {"chirp_seconds": 5.0})
    assert found["accepted"] > 0.95
    assert found["midline_mm"] < 0.5
    assert found["q2_rad2"] < 0.25 * found["motion_q2_rad2"]
    # A model without added mass finds the share 1080/2078 of the stiffness, that of the inertia it knows.
    assert found["E_pa"] / 5.0e5 == pytest.approx(1080 / 2078, rel=0.15)
    # The paper's route: an affine k cannot follow a cone's, and turns negative at the tip.
    assert found["paper_k0"] > 0.0 > found["paper_k0"] + found["paper_k1"]


def test_too_short_a_video_is_refused(tmp_path, capsys):
    assert main(["reproduce", "table1", "--out", str(tmp_path / "t"), "--seconds", "1"]) == 2
    assert "3 or more" in capsys.readouterr().err
