"""Diagnosis of records drawn by a generator that shares no code with the package.

Seeds were fixed before anything was compared.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from thermogear.base.errors import InputError
from thermogear.base.limits import VIBRATION_ZONES, zone_of
from thermogear.front.diagnose_command import MACHINES
from thermogear.measured.diagnosis import InAngle, in_angle
from thermogear.measured.impacts import BearingRates
from thermogear.measured.record import Channel, Record
from thermogear.results.result import Result
from thermogear.study.diagnosis import diagnose, healthy_limit, trend_of
from thermogear.views.pages.diagnosis import summary

sys.path.insert(0, str(Path(__file__).parents[1] / "measured"))
from faulty_gears import Gears

PAIR = Gears(teeth=(11, 13))
SPEED = 2 * np.pi * PAIR.speed


def read(
    seed: int, *, tacho: bool = True, extra: float = 0.0, gears: Gears = PAIR, **fault: float
) -> InAngle:
    """A record in the angle of the pair's pinion; ``extra``: bursts of an outer race."""
    x, turns = gears.record(seed, **fault)  # type: ignore[arg-type]
    if extra:
        drawn = np.random.default_rng(seed + 1)
        slip = 0.003 * np.cumsum(drawn.normal(size=turns.size)) / np.sqrt(turns.size)
        place = ((turns * 3.572 + slip) % 1.0) / (3.572 * PAIR.speed)
        x = x + extra * np.exp(-place * 900.0) * drawn.normal(size=x.size)
    channels = [Channel("a", x, "m/s^2")]
    channels += [Channel("tacho", PAIR.tacho(turns), "V")] if tacho else []
    record = Record(tuple(channels), f"r{seed}", rate=PAIR.rate, tacho="tacho" if tacho else None)
    return in_angle(record, teeth=11, speed=SPEED, pulses_per_turn=1.0 if tacho else None)


@cache
def healthy(seed: int) -> InAngle:
    return read(seed)


def source(make: Callable[[], InAngle], name: str = "new") -> tuple[str, Callable[[], InAngle]]:
    return name, make


BASELINE = [source(partial(healthy, seed), f"h{seed}") for seed in (301, 302, 303, 304)]


def judged(make: Callable[[], InAngle], baseline: int = 4) -> Result:
    return diagnose([source(make)], BASELINE[:baseline], teeth=PAIR.teeth)


def verdict(result: Result) -> tuple[str, str]:
    row = result.table("figures")["verdicts"][-1]
    return row["verdict"], row["shaft"]


@pytest.mark.parametrize(("shaft", "tooth"), [(0, 7), (1, 4)])
def test_the_shaft_and_the_tooth_are_found(shaft: int, tooth: int) -> None:
    found = judged(partial(read, 311 + shaft, shaft=shaft, tooth=tooth, dip=0.4, lag=0.02))
    name = ("pinion", "wheel")[shaft]
    assert verdict(found) == ("changed", name)
    place = next(row for row in found.table("figures")["places"] if row["shaft"] == name)
    assert place["named"]
    # tooth 1 is at the first pulse: there the pinion has turned once, the wheel by eleven teeth
    assert place["tooth"] == (tooth - 11 * shaft) % PAIR.teeth[shaft] + 1
    assert all(change < 0 for change in place["amplitude"] if change)


def test_few_false_alarms() -> None:
    """Whole records; `trials/diagnosis.py` counts sixty such sets, and finds faults."""
    verdicts = [
        verdict(diagnose(
            [source(partial(read, 400 + 4 * k))],
            [source(partial(read, 401 + 4 * k + j), f"h{j}") for j in range(3)],
            teeth=PAIR.teeth,
        ))[0]
        for k in range(2)
    ]  # fmt: skip
    alarms = verdicts.count("changed")
    assert stats.binomtest(alarms, len(verdicts), 0.05, alternative="greater").pvalue > 0.01


@pytest.mark.parametrize("records", [2, 3, 6])
def test_the_limit_keeps_the_false_alarms_of_a_family(records: int) -> None:
    drawn, family, sets = np.random.default_rng(320 + records), 10, 300
    alarms = 0
    for _ in range(sets):
        spread = drawn.uniform(0.02, 0.5, size=family)
        level = spread[:, None] * drawn.normal(size=(family, records + 1))
        blocks = level[..., None] + 0.1 * drawn.normal(size=(family, records + 1, 5))
        rows = np.exp(blocks)
        limits = [healthy_limit(list(row[:-1]), family=family).limit for row in rows]
        alarms += bool(np.any(np.median(rows[:, -1], axis=-1) > limits))
    assert stats.binomtest(alarms, sets, 0.05, alternative="greater").pvalue > 0.01, alarms


def test_one_record_of_the_baseline_decides_nothing_and_none_judges_nothing() -> None:
    broken = partial(read, 330, shaft=0, tooth=3, dip=0.6)
    assert verdict(judged(broken, baseline=1)) == ("one baseline record", "")
    found = judged(broken, baseline=0)
    assert verdict(found) == ("no baseline", "")
    assert np.isfinite(found.groups["indicators"]["indicator_value"]).all()


def test_the_limit_is_the_prediction_limit_of_a_textbook() -> None:
    medians = np.exp([0.1, 0.3, 0.2, 0.4])
    limit = healthy_limit([np.array([m]) for m in medians], family=2, alarm=0.05).limit
    logs = np.log(medians)
    t = stats.t.ppf(0.975, 3)
    assert limit == pytest.approx(np.exp(logs.mean() + t * logs.std(ddof=1) * np.sqrt(1.25)))


def test_a_bearing_is_heard_by_its_rate_and_gears_alone_are_not() -> None:
    hung = [("pinion", BearingRates.of("6205", elements=9, ratio=7.938 / 38.5))]
    heard = [
        diagnose([source(partial(read, 340, extra=extra))], teeth=PAIR.teeth, bearings=hung)
        for extra in (1.5, 0.0)
    ]
    lines = [found.table("figures")["bearings"] for found in heard]
    assert lines[0][0]["part"] == "outer race"
    assert lines[0][0]["order"] == pytest.approx(3.572, rel=0.01)
    assert lines[1] == []


@pytest.mark.parametrize(
    ("gears", "verdict_of", "words"),
    [
        (Gears(teeth=(12, 13)), "other gears", "order 12 .* order 11"),
        (Gears(teeth=(19, 48), speed=30.0), "other gears", "order 19 .* order 11"),
        (Gears(teeth=(11, 13), speed=30.0), "another speed", "1800 rpm, the baseline at 1500 rpm"),
    ],
)
def test_a_record_of_another_machine_is_not_judged(
    gears: Gears, verdict_of: str, words: str
) -> None:
    found = judged(partial(read, 360, gears=gears))
    assert verdict(found) == (verdict_of, "")
    assert re.match(f"new: Undecided: [^.]*{words}", summary(found.table("figures")))


def test_a_wheel_of_other_teeth_behind_the_same_pinion_is_no_sound_record() -> None:
    """An average at the turn of a wheel that is not there lacks what the baseline's had."""
    for seed in (362, 363):
        found = judged(partial(read, seed, gears=Gears(teeth=(11, 30))))
        row = found.table("figures")["verdicts"][-1]
        print(row)
        assert row["below"] >= row["beyond"]
        assert verdict(found) == ("undecided", "")


def test_other_teeth_without_a_tacho_are_refused_in_one_line() -> None:
    with pytest.raises(InputError, match=r"^--speed: got no mesh line of 11 teeth at it"):
        read(361, tacho=False, gears=Gears(teeth=(15, 40)))


def test_a_trend_over_records() -> None:
    slope, chance = trend_of([2.0, 2.2, 2.4, 2.6, 2.8])
    assert slope == pytest.approx(0.2 / 2.4)
    assert chance == pytest.approx(2 / 120)


def test_without_a_tacho_the_mesh_line_tells_the_angle() -> None:
    found = read(350, tacho=False)
    assert not found.marked
    assert found.speed == pytest.approx(SPEED, rel=2e-3)


def test_what_is_missing_is_said_in_one_line() -> None:
    x = np.random.default_rng(351).normal(size=20_000)
    noise = Record((Channel("a", x, "g"),), "noise", rate=8192.0)
    with pytest.raises(InputError, match=r"^--speed: got none; .*--speed"):
        in_angle(noise, teeth=19)
    with pytest.raises(InputError, match=r"^teeth: got 0; "):
        in_angle(noise, teeth=0)


def test_zones_of_a_class() -> None:
    assert set(MACHINES) == set(VIBRATION_ZONES)
    assert [zone_of(v, "large rigid") for v in (1e-3, 3e-3, 5e-3, 8e-3)] == list("ABCD")
