"""Motions handed on to their neighbours, held against the folds of continued orbits."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from thermogear.analysis.bifurcations import FLIP, FOLD
from thermogear.analysis.continuation import continuation
from thermogear.analysis.orbits import periodic_orbit
from thermogear.analysis.settle import PERIODIC
from thermogear.analysis.side_by_side import Motions, motions_along
from thermogear.dynamics.models import TorsionalModel

STEP = 0.025
FREQUENCY = 0.4 * (1.0 + STEP) ** np.arange(40)
SEED = 1117
STARTS = ((1.1, 0.0), (1.4, 0.0), (-1.0, 0.0))


def variants(count: int) -> list[TorsionalModel]:
    """Lightly damped pairs whose flanks part near resonance; drawn before anything was run."""
    draw = np.random.default_rng(SEED)
    return [
        TorsionalModel(
            damping_ratio=draw.uniform(0.03, 0.06),
            frequency=0.7,
            stiffness_amplitude=draw.uniform(0.05, 0.15),
            mean_force=0.1,
            force_amplitude=draw.uniform(0.02, 0.06),
        )
        for _ in range(count)
    ]


def along(model: TorsionalModel, **kwargs: int) -> Motions:
    return motions_along(model.replace(frequency=FREQUENCY).lanes(), STARTS, **kwargs)


def ends(found: Motions) -> list[tuple[int, int]]:
    """(lane inside, lane outside) of every end of a range in which two motions or more live."""
    several = found.count(FREQUENCY.size) > 1
    return [
        (lane, lane + 1) if several[lane] else (lane + 1, lane)
        for lane in np.flatnonzero(several[1:] != several[:-1])
    ]


def nearest_loss(model: TorsionalModel, found: Motions, inside: int, outside: int) -> float:
    """Steps from the last lane with two motions to where one of them is lost."""
    way = outside - inside
    goal = float(FREQUENCY[inside] * (1.0 + STEP) ** (6 * way))
    steps = []
    for row in np.flatnonzero((found.lane == inside) & (found.label == PERIODIC)):
        at = model.replace(frequency=float(FREQUENCY[inside]))
        orbit = periodic_orbit(at, int(found.period[row]), tuple(found.state[row]))
        branch = continuation(orbit, "frequency", goal)
        lost = [one.value for one in branch.bifurcations if one.kind in (FOLD, FLIP)]
        steps += [abs(float(np.log(v / FREQUENCY[inside]) / np.log1p(STEP))) for v in lost[:1]]
    return min(steps)


def test_ranges_of_two_motions_end_at_the_folds(
    compared: Callable[..., None], capsys: pytest.CaptureFixture[str]
) -> None:
    distances = []
    for model in variants(6):
        found = along(model)
        distances += [nearest_loss(model, found, *end) for end in ends(found)]
    assert len(distances) >= 6
    with capsys.disabled():
        print(f"\nside by side: {len(distances)} ends, worst {max(distances):.3f} steps")
    compared(
        "ends of the ranges with two motions, in steps of 2.5 % of speed",
        "folds of continued orbits of six random pairs",
        distances,
        1.0,
    )


def test_one_motion_where_the_flanks_stay_together() -> None:
    """Without error and with hardly any change of stiffness the equation is linear."""
    model = TorsionalModel(
        damping_ratio=0.1,
        frequency=0.7,
        stiffness_amplitude=0.01,
        mean_force=0.5,
        force_amplitude=0.0,
    )
    found = along(model)
    assert np.all(found.count(FREQUENCY.size) == 1)
    assert np.all(found.label == PERIODIC)
    assert np.all(found.period == 1)


def test_what_is_found_does_not_hang_on_the_order_of_the_lanes() -> None:
    model = variants(1)[0]
    there = along(model)
    back = motions_along(model.replace(frequency=FREQUENCY[::-1]).lanes(), STARTS)
    count = there.count(FREQUENCY.size)
    assert np.array_equal(count, back.count(FREQUENCY.size)[::-1])


def test_one_pass_finds_what_the_starts_lead_to_and_no_more() -> None:
    model = variants(1)[0]
    assert np.all(along(model, passes=1).count(40) <= along(model).count(40))
