"""The device of a series of blind trials: it reaches each diagnosis, and only a CUDA device belongs to a task."""

from types import SimpleNamespace

import pytest

from tentacle.errors import InputError
from tests.validation.made_designs import of_kind
from validation.trials import series


@pytest.mark.parametrize("device", [None, "cuda:1"])
def test_a_task_names_its_device_and_the_diagnosis_has_it(device, monkeypatch):
    """Tasks of the CPU stay as they are, so that stored results stay theirs."""
    tasks, deciding = [], []

    def run(_, some, **__):
        tasks.extend(some)
        return [series.trial(task) for task in some]

    def diagnosed(*_, **given):
        deciding.append(given["deciding"])
        raise InputError("enough")

    monkeypatch.setattr(series, "made", lambda _: (SimpleNamespace(), {}))
    monkeypatch.setattr(series, "diagnose", diagnosed)
    design = of_kind("current")
    outcomes, refused = series.run_series([design], SimpleNamespace(run=run), device=device)
    assert tasks == [design.table() if device is None else {**design.table(), "device": device}]
    assert [one.device for one in deciding] == [device]
    assert (outcomes, len(refused)) == ([], 1)
