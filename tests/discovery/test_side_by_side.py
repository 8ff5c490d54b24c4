"""Tasks in processes of their own give what they give here, and leave nothing behind."""

import multiprocessing
import os
import signal
import sys
import threading
import time
from dataclasses import dataclass
from functools import partial

import numpy as np
import pytest

from affine_model.cores import usable_cores
from discovery.shared_pickle import reachable, received, sent
from discovery.side_by_side import side_by_side
from inference.prepare import prepare

forked = pytest.mark.skipif(sys.platform != "linux", reason="processes are forked on Linux")


@pytest.fixture
def alone(monkeypatch):
    """Two cores, and no thread beside this one: the tests' own runner has one that waits for orders."""
    others: list[threading.Thread] = []
    monkeypatch.setattr("discovery.side_by_side.usable_cores", lambda: 2)
    monkeypatch.setattr(threading, "enumerate", lambda: [threading.current_thread(), *others])
    return others


@dataclass(frozen=True)
class Held:
    """An array, and one made from it."""

    given: object
    made: np.ndarray
    law: object = None


def doubled(held: Held, factor: float) -> Held:
    return Held(held.given, factor * held.given, held.law)


def test_what_the_parent_has_is_not_copied():
    held = Held(np.arange(1e5), np.zeros(1), lambda x: 2.0 * x)
    shared = reachable([partial(doubled, held, 2.0)])
    text = sent(doubled(held, 2.0), shared)
    found = received(text, shared)
    assert found.given is held.given
    assert found.law is held.law  # a function that no pickle could carry
    np.testing.assert_array_equal(found.made, 2.0 * held.given)
    assert len(text) < 1.1 * held.given.nbytes  # one of the two arrays


def test_results_are_those_of_one_process_in_their_order():
    held = Held(np.linspace(0.0, 1.0, 1000), np.zeros(1))
    tasks = [partial(doubled, held, factor) for factor in (1.0, 2.0, 3.0, 4.0, 5.0)]
    for task, result in zip(tasks, side_by_side(tasks), strict=True):
        np.testing.assert_array_equal(result.made, task().made)
        assert result.given is held.given


def test_a_run_that_left_all_bounds_is_left_out_and_an_error_is_told():
    def astray():
        raise np.linalg.LinAlgError

    def wrong():
        raise ValueError("a message")

    assert side_by_side([lambda: 1, astray, lambda: 3]) == [1, 3]
    with pytest.raises(ValueError, match="a message"):
        side_by_side([lambda: 1, wrong])


@forked
@pytest.mark.usefixtures("alone")
def test_a_forked_process_computes_on_one_core():
    assert side_by_side([usable_cores, usable_cores]) == [1, 1]


@forked
@pytest.mark.usefixtures("alone")
def test_a_process_that_the_system_ends_costs_no_result():
    here = os.getpid()

    def ended():
        if os.getpid() != here:
            os.kill(os.getpid(), signal.SIGKILL)
        return 7

    assert side_by_side([ended, lambda: 8]) == [7, 8]


@forked
@pytest.mark.usefixtures("alone")
def test_an_interrupt_leaves_no_process():
    def interrupt(*_):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 1.0)
    begin = time.monotonic()
    try:
        with pytest.raises(KeyboardInterrupt):
            side_by_side([partial(time.sleep, 60.0)] * 3)
    finally:
        signal.signal(signal.SIGALRM, before)
    assert time.monotonic() - begin < 30.0
    assert not multiprocessing.active_children()


@forked
def test_nothing_is_forked_beside_another_thread(alone):
    """It may hold a lock that a task needs."""
    assert os.getpid() not in side_by_side([os.getpid, os.getpid])
    alone.append(threading.Thread())
    assert side_by_side([os.getpid, os.getpid]) == [os.getpid()] * 2


def in_which_process(_):
    return os.getpid()


@forked
@pytest.mark.usefixtures("alone")
def test_nothing_is_forked_for_a_cuda_device(recorded):
    """A forked process cannot use it."""
    recording = recorded(seconds=1.0)
    for device in (None, "cuda"):
        held = Held(prepare(recording, hold_out=False, device=device).experiment, np.zeros(1))
        processes = side_by_side([partial(in_which_process, held)] * 2)
        assert (processes == [os.getpid()] * 2) == (device is not None)
