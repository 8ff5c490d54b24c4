"""The emulator's arm as a process of its own, at the end of a pipe."""

import os

from rig.arm_plant import _REQUEST, main
from tentacle.io.model_file import write_model
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Specimen


def test_a_board_that_ends_before_it_is_answered_ends_the_arm_quietly(tmp_path, monkeypatch):
    """Ctrl-C ends the board, maybe between its question and the answer."""
    parameters = {
        "elasticity": {"E": Estimate.exact(2e5, "Pa")},
        "damping": {"eta": Estimate.exact(1e3, "Pa s")},
        "drag": {"C_perp": Estimate.exact(1.1)},
    }
    write_model(Model(Specimen(Cone(0.0125, 0.006), 0.14, 1070.0), WATER, parameters=parameters), tmp_path / "m.toml")
    monkeypatch.setattr("rig.arm_plant.signal.signal", lambda *_: None)  # this process keeps its Ctrl-C
    questions, board = os.pipe()
    nobody, answers = os.pipe()
    os.write(board, _REQUEST.pack(0.01, 0.0, 1.0))
    os.close(nobody)
    try:
        assert main([str(questions), str(answers), str(tmp_path / "m.toml")]) == 0
    finally:
        for end in (questions, board, answers):
            os.close(end)
