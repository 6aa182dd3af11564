"""The thesis's experiment on sampled drive trains: the stored rows are what the code computes."""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scripts import script

from conftest import Compared
from thermogear.case.case import gear_case, load_case
from thermogear.thesis.base_sets import interval
from thermogear.thesis.experiment import stored

SAMPLES = sys.modules["rig_samples"] = script("trials/rig_samples")
ANSWER = script("trials/rig_answer")
ASSUMED, PRINTED, SEEN, SEED = SAMPLES.ASSUMED, SAMPLES.PRINTED, SAMPLES.SEEN, SAMPLES.SEED
EITHER, NEAR = ANSWER.EITHER, ANSWER.NEAR
answer, factor, results = ANSWER.answer, ANSWER.factor, ANSWER.results


@pytest.fixture(scope="module")
def rows() -> list[Any]:
    return list(SAMPLES.stored())


def test_at_least_200_are_stored_as_drawn_from_the_seed(rows: list[Any]) -> None:
    assert len(rows) == SAMPLES.SAMPLES_STORED >= 200
    assert [dict(one.values) for one in rows] == SAMPLES.drawn(len(rows), seed=SEED)
    for one in ASSUMED:
        values = [row.values[one.name] for row in rows]
        assert one.low <= min(values) <= max(values) <= one.high
        if not one.choices:
            strips = np.sort([_share(one.low, one.high, one.logarithmic, v) for v in values])
            assert np.abs(strips * len(rows) - np.arange(len(rows)) - 0.5).max() < 0.6, (
                one.name
            )  # rounded


def _share(low: float, high: float, logarithmic: bool, value: float) -> float:
    if logarithmic:
        return float(np.log(value / low) / np.log(high / low))
    return (value - low) / (high - low)


# the first; the nearest of all, a resonance of a cap; a motion that does not close depends on the
# last bit and is none of them
@pytest.mark.parametrize("number", [0, 4, 7])
def test_a_stored_row_is_what_the_code_computes(number: int, rows: list[Any]) -> None:
    told, found = rows[number], SAMPLES.shown(rows[number].values)
    assert found.labels == told.labels
    assert found.channels == told.channels
    for place in SEEN:
        assert found.amplitudes[place] == pytest.approx(told.amplitudes[place], rel=1e-3)
        assert found.most[place] == pytest.approx(told.most[place], rel=1e-3)


def test_few_coordinates_are_enough(rows: list[Any], compared: Compared) -> None:
    found = SAMPLES.shown(rows[1].values, held=2 * SAMPLES.HELD_MODES)
    pairs = [(found.most[place], rows[1].most[place]) for place in SEEN]
    compared(
        "displacements of a sampled drive train of the thesis's rig, relative",
        "twice as many modes of its shafts",
        [np.divide(a, b) - 1.0 for a, b in pairs],
        0.05,
    )


def test_a_sampled_case_holds_what_was_drawn(rows: list[Any]) -> None:
    values = rows[7].values
    case = gear_case(load_case(SAMPLES.case_text(values)))
    train = case.train
    assert train is not None
    assert case.stated.torque[0] == pytest.approx(values["torque"])
    assert train.casing is not None
    assert train.casing.mass == values["housing_mass"]
    critical = 2.0 * np.sqrt(train.casing.mass * train.casing.stiffness[0])
    assert train.casing.damping / critical == pytest.approx(values["mount_damping"])
    for one in train.bearings:
        assert one.seat is not None
        assert one.seat.stiffness[0] == pytest.approx(1e6 * values["seat_stiffness"])
        loss = one.seat.damping / one.seat.stiffness[0]
        assert loss == pytest.approx(1e-6 * values["seat_loss"])
        assert one.play == pytest.approx(1e-6 * values["play"])
    left, right = sorted(one.position for one in train.bearings if one.shaft == "wheel")
    assert right - left == pytest.approx(1e-3 * values["span"])
    place = (train.shafts[1].gear_position - left) / (right - left)
    assert place == pytest.approx(values["place"])


def test_the_rule_counts_one_channel_near_at_all_speeds_and_growing(rows: list[Any]) -> None:
    near = tuple(1.3 * v for v in PRINTED)
    hit = replace(rows[0], amplitudes={**rows[0].amplitudes, "cap": near})
    assert factor(hit, EITHER) == pytest.approx(1.3)
    far = replace(hit, amplitudes={**hit.amplitudes, "cap": (near[0], near[1], 1.6 * PRINTED[2])})
    assert factor(far, "cap") == pytest.approx(1.6)
    falling = (1.4 * PRINTED[0], 0.7 * PRINTED[1], PRINTED[2])
    fallen = replace(hit, amplitudes={**hit.amplitudes, "cap": falling})
    lost = SAMPLES.without(rows[0].values, "jammed", dict.fromkeys(SEEN, (np.nan,) * 3))
    data = results([hit, far, fallen, lost, *rows[:20]])
    one = data.sel(seen=EITHER, limit=NEAR)
    assert int(one["hits"]) == 1
    assert (data.attrs["lost"], data.attrs["trains"]) == (1, 24)
    open_ = [one for one in rows[:20] if "undecided" in one.labels]
    assert data.attrs["open"] == len(open_) > 0
    assert data.attrs["open_nearest"] == min(factor(one, EITHER) for one in open_)
    assert (float(one["share_low"]), float(one["share_high"])) == interval(1, count=24, lost=1)


def _told(hits: int, lost: int = 0) -> str:
    low, high = interval(hits, count=256, lost=lost)
    return answer(low=low, high=high)


def test_intervals_and_the_answer_they_give() -> None:
    # (1 - p)^n = 0.025 at the upper end where there is no hit
    assert interval(0, count=256)[1] == pytest.approx(1.0 - 0.025 ** (1.0 / 256.0), rel=1e-9)
    assert interval(256, count=256)[0] == pytest.approx(0.025 ** (1.0 / 256.0), rel=1e-9)
    assert (
        interval(5, count=40)[0]
        < 5 / 40
        < interval(5, count=40)[1]
        < interval(5, count=40, lost=3)[1]
    )
    told = [_told(n) for n in (0, 5, 40, 150, 256)]
    assert told == ["no", "no", "undecided", "yes", "yes"]
    assert _told(0, lost=40) == "undecided"


def test_ranks_find_what_decides(rows: list[Any]) -> None:
    made = [
        replace(
            one,
            most={**one.most, "cap": (1e-6, 1e-6, 1e-9 * one.values["torque"] ** 3)},
        )
        for one in rows
    ]
    data = results(made)
    names = [one.name for one in ASSUMED]
    rank = data["rank"].values[list(ANSWER.TARGETS).index("cap")]
    assert rank[names.index("torque")] == pytest.approx(1.0)
    others = np.delete(rank, names.index("torque"))
    assert np.abs(others).max() < 4.0 / np.sqrt(len(rows))


def test_the_stored_trains_answer_with_share_and_spread(rows: list[Any]) -> None:
    data = results(rows)
    xr.testing.assert_allclose(stored(), data, rtol=1e-9)
    assert stored().attrs == data.attrs
    one = data.sel(seen=EITHER, limit=NEAR)
    assert data.attrs["answer"] == answer(
        low=float(one["share_low"]), high=float(one["share_high"])
    )
    word = {"no": "No,", "yes": "Yes,", "undecided": "Undecided:"}[data.attrs["answer"]]
    assert data.attrs["sentence"].startswith(word)
    assert f"{int(one['hits'])} of {len(rows)}" in data.attrs["sentence"]
    strongest = np.abs(data["rank"].values).argmax(axis=1)
    for words in data["input_words"].values[strongest]:
        assert words in data.attrs["deciding"]
