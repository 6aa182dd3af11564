"""Blocks on threads: errors come out, nothing to do is nothing done; samples meet the sections."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest

from thermogear.dynamics import blocks
from thermogear.dynamics.blocks import Pace, run_blocks
from thermogear.dynamics.exact import State
from thermogear.dynamics.integrate import simulate
from thermogear.dynamics.models import TorsionalModel

MODEL = TorsionalModel(
    damping_ratio=0.05,
    frequency=[0.7, 0.9],
    stiffness_amplitude=0.2,
    mean_force=0.1,
    force_amplitude=0.15,
)


def test_an_error_in_a_block_is_raised_and_stops_the_others() -> None:
    started, stopped = threading.Event(), threading.Event()

    def fails(pace: Pace) -> None:
        started.wait(10.0)
        raise ZeroDivisionError("in a block")

    def works(pace: Pace) -> None:
        started.set()
        for _ in pace.chunks(10_000, lanes=blocks.CHUNK):
            time.sleep(1e-3)
        if pace.done < 10_000 * blocks.CHUNK:
            stopped.set()

    with pytest.raises(ZeroDivisionError, match="in a block"):
        run_blocks([fails, works], 2, threads=2)
    assert stopped.is_set()


def test_no_blocks_are_no_work() -> None:
    run_blocks([], 0)
    run_blocks([], 0, threads=4)


def test_pieces_cover_all_periods_once_and_are_counted() -> None:
    pace = Pace(0)
    pieces = list(pace.chunks(7, lanes=blocks.CHUNK // 3))
    assert pieces == [(0, 3), (3, 3), (6, 1)]
    assert pace.done == 7 * (blocks.CHUNK // 3)
    pace.stop()
    assert list(pace.chunks(7, lanes=1)) == []


@pytest.mark.parametrize("method", ["exact", "rk4", "adaptive"])
@pytest.mark.parametrize("samples", [1, 4])
def test_the_first_sample_of_every_period_is_its_section(
    method: str, samples: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where the kept periods are run in several pieces."""
    how = {"periods": 8, "samples_per_period": samples, "method": method}
    whole = simulate(MODEL, initial_state=(0.3, 0.1), **how)  # type: ignore[arg-type]
    monkeypatch.setattr(blocks, "CHUNK", 6)
    found = simulate(MODEL, initial_state=(0.3, 0.1), **how)  # type: ignore[arg-type]
    assert found.sizes["sample"] == 8 * samples
    for path, section in (("x", "section_x"), ("v", "section_v")):
        firsts = found[path].values[:, ::samples]
        assert firsts == pytest.approx(found[section].values[:, :-1], rel=1e-9, abs=1e-12)
        assert np.array_equal(found[path].values, whole[path].values)


def test_a_start_has_the_identity_as_tangent_and_nothing_counted() -> None:
    state = State.start(
        x=np.array([0.2, 1.4]), y=np.array([0.0, 0.1]), backlash=np.array([1.0, 1.0])
    )
    for lane in range(2):
        assert state.tangent[:, lane].reshape(2, 2).tolist() == [[1.0, 0.0], [0.0, 1.0]]
    assert not state.counts.any()
    state.tangent[:] = 7.0
    state.fresh_tangent()
    assert state.tangent[:, 0].tolist() == [1.0, 0.0, 0.0, 1.0]


def test_no_more_blocks_run_at_once_than_threads_asked_for() -> None:
    running, most = [0], [0]
    lock = threading.Lock()

    def block(_pace: Pace) -> None:
        with lock:
            running[0] += 1
            most[0] = max(most[0], running[0])
        time.sleep(0.02)
        with lock:
            running[0] -= 1

    run_blocks([block] * 5, 5, threads=1)
    assert most[0] == 1
    together = threading.Barrier(3)  # three at once, or it breaks
    run_blocks([lambda _pace: together.wait(30.0)] * 6, 6, threads=3)
