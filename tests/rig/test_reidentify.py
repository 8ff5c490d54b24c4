"""Re-identification: which recordings are diagnosed, and which model proposes."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from rig import reidentify
from rig.gait_space import GaitSpace, TrialPlan
from rig.model_gaits import predicted_propulsion
from rig.reidentify import proposer, unlike
from rig.safety import SafetyLimits
from tentacle.errors import InputError
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Specimen

ARM = Specimen(Cone(0.0125, 0.0015), 0.14, 1070.0)
PLAN = TrialPlan(3, 1)


def model(stiffness: float) -> Model:
    values = {"elasticity": {"E": stiffness}, "damping": {"eta": 200.0}, "drag": {"C_perp": 1.2}}
    named = {e: {n: Estimate.exact(v) for n, v in parameters.items()} for e, parameters in values.items()}
    return Model(ARM, WATER, parameters=named)


@pytest.fixture
def space(limits: SafetyLimits) -> GaitSpace:
    return GaitSpace(limits, (0.5, 2.5), harmonics=0)


def test_recordings_that_differ_most_are_diagnosed(space: GaitSpace) -> None:
    efforts, frequencies = (0.9, 0.91, 0.2, 0.92, 0.9), (2.0, 2.0, 2.0, 0.5, 2.01)
    points = [{"frequency_hz": f, "effort": e} for f, e in zip(frequencies, efforts, strict=True)]
    assert unlike(points, space, 3) == [2, 3, 4]  # the latest, and the two that lie far from it
    assert unlike(points[:2], space, 3) == [0, 1]


@pytest.mark.parametrize("true", [1.3e5, 0.6e5])
def test_the_model_that_the_load_cell_bears_out_proposes(
    true: float, space: GaitSpace, monkeypatch: pytest.MonkeyPatch
) -> None:
    believed, augmented = model(1.3e5), model(0.6e5)
    points = space.sample(4, seed=1)
    measured = dict(enumerate(predicted_propulsion(model(true), space, points, PLAN)))
    said = SimpleNamespace(augmented_model=augmented, base_model=Model(ARM, WATER), headline="a tip mass")
    runs = [SimpleNamespace(number=k, start={"waveform": point}) for k, point in enumerate(points)]
    heard: list[str] = []
    monkeypatch.setattr(reidentify, "read_run", lambda path: runs[int(path.name)])
    monkeypatch.setattr(reidentify, "tracked", lambda run: run)
    monkeypatch.setattr(reidentify, "diagnose", lambda _recordings, **_: said)
    monkeypatch.setattr(reidentify, "propulsion", lambda run, _begin, _end: measured[run.number])
    monkeypatch.setattr(reidentify, "best_gaits", lambda chosen, *_: [chosen])
    propose = proposer(space, PLAN, believed=believed, told=heard.append)
    assert propose([Path(str(k)) for k in range(4)]) == [believed if true == 1.3e5 else augmented]
    assert heard == ["a tip mass"]


def test_recordings_that_show_no_arm_propose_nothing(space: GaitSpace, monkeypatch: pytest.MonkeyPatch) -> None:
    """The search goes on, and it is said why nothing is proposed."""
    runs = [SimpleNamespace(path=Path(str(k)), start={"waveform": p}) for k, p in enumerate(space.sample(2, seed=1))]

    def nothing_seen(run: SimpleNamespace) -> None:
        raise InputError("has no video", file=run.path)

    heard: list[str] = []
    monkeypatch.setattr(reidentify, "read_run", lambda path: runs[int(path.name)])
    monkeypatch.setattr(reidentify, "tracked", nothing_seen)
    assert proposer(space, PLAN, told=heard.append)([Path("0"), Path("1")]) == []
    assert len(heard) == 1
    assert "has no video" in heard[0]


def test_recordings_that_cannot_be_read_are_left_out_and_named(space: GaitSpace, tmp_path: Path) -> None:
    heard: list[str] = []
    (tmp_path / "torn.rrd").write_bytes(bytes(100))
    assert proposer(space, PLAN, told=heard.append)([tmp_path / "gone.rrd", tmp_path / "torn.rrd"]) == []
    assert [name in words for name, words in zip(("gone.rrd", "torn.rrd"), heard, strict=True)] == [True, True]
