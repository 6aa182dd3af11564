"""The trial of drive trains, one of two hundred: `make trial NAME=trains` runs it whole."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scripts import script

from conftest import AtLength, Compared
from said import numbers
from thermogear.dynamics.geared_map import GearedMap
from thermogear.dynamics.return_map import return_map

TRIAL = script("trials/trains")


@pytest.mark.slow
def test_labels_of_random_trains_asked_otherwise(at_length: AtLength, compared: Compared) -> None:
    count = at_length(1, 40, "random drive trains labelled in four ways")
    records = [TRIAL.labelled(number) for number in range(1, 1 + count)]
    undecided = [way for one in records for way in TRIAL.WAYS if one[way]["name"] == "undecided"]
    # of many trains one in twenty may be undecided; one alone may not
    assert len(undecided) <= 0.05 * len(TRIAL.WAYS) * (count - 1)
    wrong = [
        (one["number"], way, words)
        for one in records
        for way, words in (TRIAL.explained(one) if TRIAL.changed(one) else {}).items()
        if way != "reduction" and not words.startswith(TRIAL.ONE_OPEN)
    ]
    compared("labels of drive trains", "longer transient, finer steps", len(wrong), 0.0)
    some = TRIAL.chosen(records, -(-count // 2))
    complaints = [words for one in some if (words := TRIAL.checked(one))]
    assert complaints == []
    compared("labels of drive trains", "long independent integration", len(complaints), 0.0)
    page = TRIAL.page(records, {}, {one["number"]: "" for one in some}, TRIAL.COUNT)
    assert f"Only {count} of 200" in page


def test_the_other_integration_is_the_same_motion(compared: Compared) -> None:
    """By another rule, of a train that loses contact; on it the engine takes finer steps."""
    train = TRIAL.drawn(1).train(TRIAL.MODES)
    fine = GearedMap(model=train.model, how=TRIAL.FINER)
    start = fine.carry(train.start, 500)[-1]
    own = fine.carry(start, 3)
    other = TRIAL.Independent(train.model, 1e-12).carry(start, 3)
    run = fine.engine.run(start, 3)
    assert run.counts["losses"] > 0
    away = fine.distance(own, other)
    compared("motion of a random train", "DOP853, units of the map", away, 1e-7)
    # a label that is not true is complained of
    record = {
        "number": 1,
        "cycle": 1,
        "label": {
            "name": "period-2", "period": 2, "orbit": True, "multiplier": 0.99,
            "state": fine.carry(start, 1000)[-1].tolist(),
        },
    }  # fmt: skip
    assert "already" in TRIAL.checked(record)
    record["label"] = {**record["label"], "name": "chaotic", "lyapunov": 1e3}
    assert TRIAL.checked(record)


def test_what_was_done_is_kept(tmp_path: Path) -> None:
    path = tmp_path / "kept.jsonl"
    done = TRIAL.kept(path)
    made = dict(TRIAL.each("checked", [3, 5], done["checked"], path, lambda n: f"made {n}"))
    assert made == {3: "made 3", 5: "made 5"}
    with path.open("a") as out:
        out.write(json.dumps({"what": "checked"})[:9])

    def refuse(number: int) -> str:
        raise AssertionError(number)

    again = TRIAL.kept(path)
    assert dict(TRIAL.each("checked", [3, 5], again["checked"], path, refuse)) == made


def test_a_state_in_other_coordinates() -> None:
    one = TRIAL.drawn(1)
    few, many = one.train(TRIAL.MODES), one.train(TRIAL.MODES + TRIAL.MORE_MODES)
    back = TRIAL.across(TRIAL.across(few.start, few, many), many, few)
    section = return_map(few.model)
    assert np.max(section.distance(back, few.start)) < 1e-3


def test_labels_that_rounding_changes_are_complained_of() -> None:
    def label(name: str, followed: int = 0) -> dict[str, object]:
        return {"name": name, "followed": followed}

    alike = [label("chaotic", 32_000), label("undecided"), label("chaotic", 33_000)]
    apart = [label("chaotic", 32_000), label("period-12")]
    short = [label("chaotic", 4646), label("chaotic", 32_000)]
    made = {3: alike, 4: apart, 5: short, 6: [label("period-1")]}
    apart_words, short_words = TRIAL.differing_labels(made)
    assert numbers(apart_words)[0] == 4.0
    assert numbers(short_words) == [5.0, 4646.0]
    words = "\n".join(TRIAL.page_of_rounding(made))
    assert numbers(words)[:2] == [3.0, 40.0]
    (told,) = [line for line in words.splitlines() if line.startswith("**")]
    assert numbers(told) == [2.0, 3.0, 1.0]
    assert TRIAL.page_of_rounding({}) == []
