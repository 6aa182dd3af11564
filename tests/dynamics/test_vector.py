"""Eight lanes as one number, against numpy; lanes of full and of unfilled groups."""

import numpy as np
import pytest
from numba import njit

from thermogear.dynamics import exact
from thermogear.dynamics.kernels.vector import bits, choose, drop, load, pick, store, turn
from thermogear.dynamics.models import TorsionalModel

ONE = np.array([1.5, -2.0, 0.0, np.nan, 4.0, -0.5, np.inf, 3.0])
TWO = np.array([2.0, -2.0, 1.0, 1.0, np.nan, 0.5, 1.0, -3.0])
PLACES = np.array([7, 0, 3, 3, 1, 6, 5, 2])


@njit
def reckoned(one, two, out):
    a, b = load(one, 0), load(two, 0)
    store(out, 0, a + b)
    store(out, 8, a - b)
    store(out, 16, a * 2.0)
    store(out, 24, 1.0 / b)
    store(out, 32, abs(-a))
    store(out, 40, choose(a < b, a, 9.0))


@njit
def compared(one, two):
    a, b = load(one, 0), load(two, 0)
    whole = a == a
    return (
        bits(a < b),
        bits(a <= b),
        bits(a > b),
        bits(a >= b),
        bits(a == b),
        bits(a != b),
        bits(~(a < b)),
        bits((a < b) & whole),
        bits((a < b) | ~whole),
        bits((a < b) ^ whole),
    )


@njit
def moved(one, places, out):
    drop(out, 8, places, pick(one, 0, places, 0))


@njit
def transposed(rows, places, out):
    turn(rows, places, 0, out, 16)


def as_bits(flags):
    return int(np.sum(flags * 2 ** np.arange(8)))


def test_sums_products_and_choices_are_those_of_each_lane():
    out = np.empty(48)
    reckoned(ONE, TWO, out)
    with np.errstate(divide="ignore", invalid="ignore"):
        expected = [ONE + TWO, ONE - TWO, ONE * 2.0, 1.0 / TWO, abs(-ONE)]
        expected.append(np.where(ONE < TWO, ONE, 9.0))
    np.testing.assert_array_equal(out.reshape(6, 8), expected)


def test_comparisons_are_those_of_each_lane():
    less, whole = ONE < TWO, ONE == ONE
    expected = (
        less,
        ONE <= TWO,
        ONE > TWO,
        ONE >= TWO,
        ONE == TWO,
        ONE != TWO,
        ~less,
        less & whole,
        less | ~whole,
        less ^ whole,
    )
    assert compared(ONE, TWO) == tuple(as_bits(flags) for flags in expected)


def test_lanes_are_fetched_from_and_brought_to_their_places():
    out = np.zeros(16)
    moved(ONE, PLACES, out)
    expected = np.zeros(16)
    expected[8 + PLACES] = ONE[PLACES]
    np.testing.assert_array_equal(out, expected)


def test_rows_become_columns():
    rows = np.arange(20.0 * 10).reshape(10, 20)
    places = np.array([0, 1, 2, 3, 5, 7, 8, 9])
    out = np.empty((16, 8))
    transposed(rows, places * 20, out)
    np.testing.assert_array_equal(out, rows[places, :16].T)


@pytest.mark.parametrize("columns", [0, 1, 2])
def test_a_lane_gives_the_same_bits_in_any_company(columns):
    """From one lane to more than two groups, in any order, also taken from prepared maps."""
    rng = np.random.default_rng(11)
    lanes = TorsionalModel(
        damping_ratio=rng.uniform(0.05, 0.15, 19),
        frequency=rng.uniform(0.9, 1.2, 19),
        stiffness_amplitude=rng.uniform(0.1, 0.5, 19),
        mean_force=0.017,
        force_amplitude=-1.16,
    ).lanes()
    borders, marks = np.arange(49) / 48, np.zeros(48, np.uint8)
    marks[::12] = 1

    def run(maps, backlash):
        state = exact.State.start(x=0.3 * backlash, y=0.0 * backlash, backlash=backlash)
        found = exact.advance(maps, state, 7, columns=columns, sampled=True)
        ends = state.x, state.y, state.region, state.tangent, state.counts, state.spent
        return [np.moveaxis(np.array(part), -1, 0) for part in (*ends, found[0], found[2])]

    whole = exact.prepare_maps(lanes, borders, marks)
    together = run(whole, lanes.half_backlash)
    for keep in ([4], [18, 3], list(range(18, 7, -1)), [2] * 9):
        mine = lanes.take(np.array(keep))
        for maps in (exact.prepare_maps(mine, borders, marks), whole.take(np.array(keep))):
            for part, other in zip(run(maps, mine.half_backlash), together, strict=True):
                np.testing.assert_array_equal(part, other[keep])


def test_a_state_of_any_layout_moves_in_place():
    lanes = TorsionalModel(
        damping_ratio=0.1,
        frequency=[0.9, 1.0, 1.1],
        stiffness_amplitude=0.3,
        mean_force=0.05,
        force_amplitude=0.4,
    ).lanes()
    maps = exact.prepare_maps(lanes, np.arange(33) / 32, np.zeros(32, np.uint8))
    states = [
        exact.State.start(x=np.zeros(3), y=np.zeros(3), backlash=lanes.half_backlash)
        for _ in range(2)
    ]
    held = np.asfortranarray(states[1].tangent)
    states[1].tangent = held
    for state in states:
        exact.advance(maps, state, 5, columns=2)
    assert states[1].tangent is held
    np.testing.assert_array_equal(held, states[0].tangent)
