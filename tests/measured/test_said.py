"""What a measurement says: given beside found, figures with units, greatest of many."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pytest
from scipy import stats

from said import numbers
from thermogear.base.errors import InputError
from thermogear.base.units import RPM
from thermogear.measured.contradictions import of_line, of_pulses, of_speed
from thermogear.measured.dataset import result_of
from thermogear.measured.figures import figures
from thermogear.measured.gearing import Gearing
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import Measurement, measure
from thermogear.measured.shaft import given_shaft
from thermogear.results.files import json_text
from thermogear.signals.slices import greatest, order_slices
from thermogear.views.page import Gallery, Shown
from thermogear.views.picture import Curve, Points
from thermogear.views.write import page_of

pytestmark = pytest.mark.usefixtures("looked_once")

TEETH, PULSES, RATE, SECONDS = 20, 2, 2000.0, 5.0
FIRST, LAST = 600.0, 1320.0  # rpm


def run_up() -> Record:
    """A gear of 20 teeth on the tacho's shaft, 600 to 1320 rpm, and its speed at 300 rpm/V."""
    t = np.arange(int(RATE * SECONDS)) / RATE
    rpm = FIRST + (LAST - FIRST) * t / SECONDS
    turns = (FIRST * t + (LAST - FIRST) * t**2 / 2.0 / SECONDS) / 60.0
    x = np.cos(2 * np.pi * TEETH * turns) + 0.4 * np.cos(4 * np.pi * TEETH * turns + 1)
    x = (1.0 + 0.1 * np.cos(2 * np.pi * turns)) * x
    x += 0.05 * np.random.default_rng(11).standard_normal(t.size)
    pulses = 5.0 * (PULSES * turns % 1.0 < 0.3)
    channels = Channel("acc", x, "g"), Channel("tacho", pulses, "V"), Channel("n", rpm / 300, "V")
    return Record(channels, "run", RATE, "made", tacho="tacho")


def steady(rate: float = 2560.0) -> Record:
    """A gear of 25 teeth at 1200 rpm."""
    turns = 20.0 * np.arange(10_000) / 2560.0
    swing = 1.0 + 0.2 * np.cos(2 * np.pi * turns)
    x = swing * (np.cos(50 * np.pi * turns) + 0.5 * np.cos(100 * np.pi * turns + 1))
    x += 0.2 * np.cos(2 * np.pi * turns) + 0.05 * np.random.default_rng(12).standard_normal(x.size)
    return Record((Channel("acc", x, "m/s^2"),), "steady", rate, "made")


@pytest.fixture(scope="module")
def run() -> Measurement:
    return measure(
        run_up(), teeth=TEETH, pulses_per_turn=3.0, speed=5000.0 * RPM, harmonics=2, sidebands=1
    )


def important(found: Measurement) -> dict[str, Mapping[str, Any]]:
    """Data of the important notices by their codes."""
    return {one.code: one.data for one in found.notices if one.level == "important"}


# --- given and found -----------------------------------------------------------------------------


def test_pulses_and_speed_that_contradict_a_run_are_told_with_what_fits(run: Measurement) -> None:
    # three and 20 teeth given, the mesh line at order 30: two would fit, or a mate of 30 teeth
    told = important(run)
    pulses = told["pulses_contradict_teeth"]
    assert (pulses["given"], pulses["teeth"]) == (3.0, 20)
    assert (pulses["fitting"], pulses["mate"]) == (2, 30)
    assert pulses["order"] == pytest.approx(30.0, rel=1e-4)
    assert run.slices is not None
    ends = run.slices.speed.min() / RPM, run.slices.speed.max() / RPM
    speed = told["speed_contradicted"]
    given_and_found = np.array([speed["given"], speed["lowest"], speed["highest"]]) / RPM
    assert given_and_found == pytest.approx([5000.0, *ends], rel=1e-3)


def test_a_tacho_in_volts_is_a_speed() -> None:
    named = run_up().supplied(tacho="n")
    found = measure(named.with_speed("n", 300.0), teeth=15, harmonics=1, sidebands=0)
    assert found.slices is not None
    assert "n" not in found.channels
    # no sidebands confirm the fifteen given: the turns are those of the speed channel's shaft
    true = FIRST + (LAST - FIRST) * found.slices.time / SECONDS
    assert found.teeth is None
    assert found.slices.speed / RPM == pytest.approx(true, rel=0.01)


def test_a_speed_in_volts_without_its_scale_asks_for_it() -> None:
    record = run_up().supplied(tacho="n")
    shaft = given_shaft(record, samples=record.samples, start=0, pulses_per_turn=None)
    assert shaft is not None
    (told,) = shaft.told
    assert shaft.turns.size == 0
    assert (told.code, told.data["channel"], told.data["unit"]) == ("tacho_not_used", "n", "V")


def test_a_wrong_speed_is_told_before_the_rate() -> None:
    told = important(measure(steady(), teeth=25, speed=3100.0 * RPM, harmonics=1, sidebands=0))
    speed = told["speed_contradicts_rate"]
    both = speed["given"] / RPM, speed["found"] / RPM
    assert both == pytest.approx((3100.0, 1200.0), rel=1e-4)


def test_a_speed_twice_too_fast_with_the_right_teeth_is_told() -> None:
    """Twice the mesh line stands there as well, and is read."""
    found = measure(steady(), teeth=25, speed=2400.0 * RPM, harmonics=1, sidebands=0)
    # times the speed given would fit
    assert important(found)["mesh_line_contradicted"]["ratio"] == pytest.approx(0.5, rel=1e-4)
    right = measure(steady(), teeth=25, speed=1200.0 * RPM, harmonics=1, sidebands=0)
    assert important(right) == {}


def test_what_agrees_or_is_open_is_no_contradiction() -> None:
    assert of_pulses(2.0, mesh=20.0, teeth=20) == []
    assert of_pulses(2.0, mesh=20.0, teeth=None) == []
    assert of_pulses(None, mesh=30.0, teeth=20) == []
    assert of_speed(1000.0, lowest=1090.0, highest=2000.0) == []
    assert of_line(Gearing(mesh_frequency=0.2, harmonics=(9.0,))) == []
    (unlike,) = of_pulses(1.0, mesh=7.3, teeth=20)
    assert (unlike.data["teeth"], unlike.data["order"]) == (20, 7.3)
    assert unlike.data["fitting"] is unlike.data["mate"] is None


def pair(random: np.random.Generator, teeth: tuple[int, int], rpm: float) -> Record:
    """Two gears in mesh, the first at ``rpm``; each turn of each swells the mesh line."""
    rate, turns = 8192.0, rpm / 60.0 * np.arange(20_000) / 8192.0
    swell = np.ones(turns.size)
    for z in teeth:
        phase = random.uniform(0.0, 2.0 * np.pi)
        size = random.uniform(0.04, 0.1)
        swell += size * np.cos(2 * np.pi * turns * teeth[0] / z + phase)
    x = 0.05 * random.standard_normal(turns.size)
    for rank, size in ((1, 1.0), (2, 0.5), (3, 0.3)):
        phase = random.uniform(0.0, 2.0 * np.pi)
        x += size * swell * np.cos(2 * np.pi * rank * teeth[0] * turns + phase)
    return Record((Channel("a", x, "g"),), "pair", rate, "made")


def pairs(random: np.random.Generator, count: int) -> Iterator[tuple[tuple[int, int], float]]:
    """Teeth whose speeds cannot be taken for each other, none a divisor, and the first's rpm."""
    while count:
        teeth = int(random.integers(17, 41)), int(random.integers(25, 95))
        if teeth[1] >= 1.2 * teeth[0] and teeth[1] % teeth[0]:
            count -= 1
            yield teeth, float(random.uniform(1000.0, 1500.0))


def test_teeth_of_one_gear_with_the_speed_of_the_other_are_told_and_right_ones_are_not() -> None:
    """Both statements that are right are silent; both that are crossed are told, with no speed."""
    random = np.random.default_rng(20261126)
    for teeth, rpm in pairs(random, 3):
        record = pair(random, teeth, rpm)
        speeds = rpm, rpm * teeth[0] / teeth[1]
        for own in (0, 1):
            for whose in (0, 1):
                nominal = speeds[whose] * float(random.uniform(0.97, 1.03))
                found = measure(
                    record, teeth=teeth[own], speed=nominal * RPM, harmonics=1, sidebands=0
                )
                told = [n.code for n in found.notices if n.level in ("important", "warning")]
                case = f"{teeth}, {rpm}: --teeth {teeth[own]} --speed {nominal}: {told}"
                if own == whose:
                    assert told == [], case
                    assert found.lines[0].shaft_speed / RPM == pytest.approx(speeds[own], rel=1e-3)
                    continue
                assert told, case
                assert np.isnan(found.lines[0].shaft_speed), case


def with_tacho() -> Record:
    """A mesh line of 20 teeth at 900 rpm without sidebands, one pulse a turn."""
    t = np.arange(20_000) / 5000.0
    turns = 15.0 * t
    values = np.cos(40 * np.pi * turns) + 0.4 * np.cos(80 * np.pi * turns)
    values += 0.05 * np.random.default_rng(11).standard_normal(t.size)
    pulses = 5.0 * (turns % 1.0 < 0.1)
    made = Record((Channel("a", values, "g"), Channel("p", pulses, "V")), "made", 5000.0, "made")
    return made.supplied(tacho="p")


def test_pulses_and_speed_that_contradict_each_other_are_told() -> None:
    told = measure(with_tacho(), pulses_per_turn=2.0, speed=900.0 * RPM, harmonics=1, sidebands=0)
    # two given make 450 of 900 rpm: one would fit
    data = important(told)["pulses_contradict_speed"]
    assert (data["given"], data["fitting"]) == (2.0, 1)
    speeds = data["speed_found"] / RPM, data["speed_given"] / RPM
    assert speeds == pytest.approx((450.0, 900.0), rel=1e-4)
    right = measure(with_tacho(), pulses_per_turn=1.0, speed=900.0 * RPM, harmonics=1, sidebands=0)
    assert "pulses_contradict_speed" not in important(right)


def test_a_stated_speed_tells_the_pulses_and_given_teeth_are_not_found_ones() -> None:
    for speed, pulses in ((900.0, 1), (450.0, 2)):
        found = measure(with_tacho(), speed=speed * RPM, harmonics=1, sidebands=0)
        (told,) = (one.data for one in found.notices if one.code == "pulses_by_speed")
        assert told["pulses"] == pulses
    unused = important(measure(steady(), pulses_per_turn=2.0))
    assert unused["pulses_without_tacho"] == {"given": 2.0}
    contradicted = important(measure(with_tacho(), teeth=25, pulses_per_turn=1.0))
    data = contradicted["pulses_contradict_teeth"]
    assert (data["given"], data["teeth"]) == (1.0, 25)
    assert data["order"] == pytest.approx(20.0, rel=1e-4)


# --- no weights -----------------------------------------------------------------------------------


def test_the_terminal_tells_what_was_given_and_that_teeth_are_undecided(run: Measurement) -> None:
    lines = page_of(result_of(run)).lines()
    (teeth,) = [line for line in lines if line.startswith("teeth: ")]
    assert numbers(teeth) == [20.0]
    assert not [line for line in lines if "weight" in line]
    (mean,) = [line for line in lines if "shaft speed" in line]
    # three pulses said where there are two: the teeth given tell the speed of their shaft
    assert numbers(mean) == pytest.approx([960.0, 600.0, 1320.0], rel=0.09)
    bare = figures(measure(steady(), harmonics=1, sidebands=0))
    assert (bare["teeth"], bare["teeth_confirmed"]) == (None, False)


# --- the spectrum of the page ---------------------------------------------------------------------


def spectrum(found: Measurement) -> Shown:
    """The picture of the spectrum on the record's page."""
    (section,) = [one for one in page_of(result_of(found)).sections if one.name == "spectrum"]
    (gallery,) = [one for one in section.blocks if isinstance(one, Gallery)]
    return gallery.pictures[0]


@pytest.mark.parametrize("seed", [41, 42])
def test_a_run_has_no_order_in_its_spectrum_over_time(seed: int) -> None:
    """In hertz to half the rate, and nothing marked: no line of a run has one frequency."""
    random = np.random.default_rng(seed)
    t = np.arange(int(RATE * SECONDS)) / RATE
    ends = random.uniform(300.0, 700.0), random.uniform(900.0, 1400.0)
    turns = (ends[0] * t + (ends[1] - ends[0]) * t**2 / 2.0 / SECONDS) / 60.0
    x = np.cos(2 * np.pi * TEETH * turns) + 0.05 * random.standard_normal(t.size)
    pulses = 5.0 * (turns % 1.0 < 0.3)
    channels = Channel("acc", x, "g"), Channel("tacho", pulses, "V")
    record = Record(channels, "run", RATE, "made", tacho="tacho")
    found = measure(record, pulses_per_turn=1.0, teeth=TEETH, harmonics=1, sidebands=0)
    shown = spectrum(found)
    panel = shown.picture.panels[0][0]
    assert "[Hz]" in panel.x.words
    assert [one for one in panel.marks if isinstance(one, Points)] == []
    (curve,) = [one for one in panel.marks if isinstance(one, Curve)]
    assert np.max(curve.x) == pytest.approx(RATE / 2, rel=0.01)
    assert found.slices is not None
    speed = found.slices.speed / RPM
    told = numbers(str(shown.caption))[:2]
    assert told == pytest.approx([speed.min(), speed.max()], rel=1e-4)


# --- figures -------------------------------------------------------------------------------------


def leaves(value: Any, name: str = "") -> Iterator[tuple[str, float]]:
    """Every number with the name it has."""
    if isinstance(value, dict):
        for key, one in value.items():
            yield from leaves(one, key) if key not in ("units", "settings", "notices") else ()
    elif isinstance(value, list):
        for one in value:
            yield from leaves(one, name)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield name, value


def test_every_number_of_the_json_has_a_unit_and_half_widths_are_absolute(
    run: Measurement,
) -> None:
    told = json.loads(json_text(page_of(result_of(run)).figures))
    units = told["units"]
    assert {name for name, _ in leaves(told)} <= {*units, "schema"}
    assert units["reading"] == units["reading_half_width"] == "g"
    assert not [name for name, _ in leaves(told) if name in ("half_width", "uncertainty")]
    for line in told["lines"]:
        share = line["relative_half_width"]
        for name in ("reading", "acceleration", "displacement"):
            assert line[f"{name}_half_width"] == pytest.approx(share * line[name])
    slices = told["slices"]
    (first, *_) = [one for one in slices["orders"] if one["name"] == "mesh x 1"]
    assert run.slices is not None
    assert np.array(first["reading"], float) == pytest.approx(run.slices.reading[0, 0], nan_ok=True)
    half = np.array(first["reading_half_width"], float)
    assert half == pytest.approx(run.slices.half_width[0, 0], nan_ok=True)
    assert len(slices["speed"]) == len(slices["time"]) == len(first["frequency"])
    moved = np.array(first["acceleration"], float)
    ratio = np.array(first["acceleration_half_width"], float) / moved
    assert ratio == pytest.approx(half / np.array(first["reading"], float), nan_ok=True)


# --- the greatest of many ------------------------------------------------------------------------


def test_the_greatest_of_many_steps_is_held_where_one_steps_interval_is_not() -> None:
    """A steady order in strong noise: of some 80 readings the highest is high by noise."""
    random = np.random.default_rng(20)
    theta = np.arange(90 * 32) / 32.0
    held = one_step = 0
    for _ in range(60):
        x = np.cos(2 * np.pi * 5 * theta + random.uniform(0, 6))
        x += 0.6 * random.standard_normal(theta.size)
        found = order_slices(x, samples_per_turn=32, first=0.0, orders=[5.0])
        top = greatest(found.amplitude[0], half_width=found.half_width[0])
        assert top is not None
        held += top.low <= 1.0 <= top.high
        one_step += abs(top.amplitude - 1.0) <= found.half_width[0, top.step]
    assert held >= stats.binom.ppf(1e-4, 60, 0.95)
    assert one_step < stats.binom.ppf(1e-4, 60, 0.95)


def test_the_greatest_of_one_step_is_that_step() -> None:
    found = greatest([np.nan, 2.0, np.nan], half_width=[0.1, 0.25, 0.1])
    assert found is not None
    assert (found.step, found.steps) == (1, 1)
    assert (found.low, found.high) == pytest.approx((1.75, 2.25))
    assert greatest([np.nan], half_width=[np.nan]) is None


def test_orders_and_harmonics_of_a_run_that_it_cannot_hold() -> None:
    top = RATE / 2.56 / (FIRST / 60.0)
    with pytest.raises(InputError, match=r"^orders: got .* slowest speed; .* as --orders \d") as it:
        measure(run_up(), pulses_per_turn=PULSES, harmonics=1, orders=(1.2 * top,))
    assert numbers(str(it.value).replace("..", " .. "))[2] == pytest.approx(top, rel=0.05)
    found = measure(run_up(), pulses_per_turn=PULSES, harmonics=64, sidebands=0)
    read = [line.name for line in found.lines if line.kind == "shaft"]
    (told,) = [n.data for n in found.notices if n.code == "harmonics_above_rate"]
    assert (told["read"], told["asked"]) == (len(read), 64)


def test_orders_of_a_run_whose_shaft_is_not_known_are_refused() -> None:
    t = np.arange(int(RATE * SECONDS)) / RATE
    cycles = TEETH * (FIRST * t + (LAST - FIRST) * t**2 / 2.0 / SECONDS) / 60.0
    x = np.cos(2 * np.pi * cycles) + 0.05 * np.random.default_rng(1).standard_normal(t.size)
    record = Record((Channel("acc", x, "g"),), "run", RATE, "made")
    assert measure(record).slices is not None
    with pytest.raises(InputError, match=r"^orders: got 2; no shaft's speed is known; --speed"):
        measure(record, orders=(2.0,))
    found = measure(record, teeth=TEETH, speed=960.0 * RPM, orders=(2.0,))
    assert "order 2" in [line.name for line in found.lines]
