"""measure: amplitude, order and frequency of a rig whose truth is known, checks of the rate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from record_makers import MESH_HZ, RATE, WRITERS, G, mesh_train, quantised

from conftest import Compared
from said import numbers
from thermogear.base.errors import InputError
from thermogear.measured.chain import Chain
from thermogear.measured.gearing import _line
from thermogear.measured.prominence import prominence
from thermogear.measured.readers import read_record
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import Measurement, measure
from thermogear.signals.integration import trapezoid_factor

pytestmark = pytest.mark.usefixtures("looked_once")

THESIS = ((419.7, 10.4e-6), (832.58, 19.3e-6), (1251.6, 48.5e-6))


def tone(frequency: float, amplitude: float, rate: float = 25_600.0, unit: str = "g") -> Record:
    """A pinion mesh of 25 teeth whose first line has this displacement amplitude."""
    t = np.arange(1 << 16) / rate
    rng = np.random.default_rng(4)
    shaft = frequency / 25
    turns = 2 * np.pi * shaft * t
    peak = amplitude * (2 * np.pi * frequency) ** 2
    x = peak * np.cos(25 * turns + 0.3) * (1 + 0.1 * np.cos(turns) + 0.05 * np.cos(2 * turns))
    x += 0.3 * peak * np.cos(50 * turns) * (1 + 0.1 * np.cos(turns) + 0.05 * np.cos(2 * turns))
    x += 0.2 * peak * np.cos(75 * turns) * (1 + 0.1 * np.cos(turns) + 0.05 * np.cos(2 * turns))
    x = x / G + 0.05 + 0.1 * t + 0.02 * rng.standard_normal(t.size)
    return Record((Channel("a", quantised(x, 24, 64.0 * 8), unit),), "tone", rate, "made")


def important(found: Measurement) -> dict[str, Mapping[str, Any]]:
    """Data of the important notices by their codes."""
    return {n.code: n.data for n in found.notices if n.level == "important"}


@pytest.mark.parametrize("method", ["frequency", "line"])
@pytest.mark.parametrize(("frequency", "amplitude"), THESIS)
def test_displacement_of_the_mesh_line(
    frequency: float, amplitude: float, method: str, compared: Compared
) -> None:
    found = measure(tone(frequency, amplitude), teeth=25, chain=Chain(method))
    line = found.lines[0]
    assert line.frequency == pytest.approx(frequency, rel=2e-6)
    compared(
        "displacement of the mesh line of a record",
        "the line put in",
        line.displacement / amplitude - 1.0,
        1e-3,
    )
    assert line.order == pytest.approx(25.0, abs=1e-3)
    assert line.shaft_speed == pytest.approx(2 * np.pi * frequency / 25, rel=1e-4)
    implied = amplitude * (2 * np.pi * frequency) ** 2 / G
    assert line.acceleration_g == pytest.approx(implied, rel=1e-3)


def test_the_thesis_way_loses_what_the_trapezoid_law_says() -> None:
    frequency, amplitude = THESIS[2]
    found = measure(tone(frequency, amplitude, 5120.0 * 2), chain=Chain("trapezoid"))
    law = float(trapezoid_factor(frequency, rate=5120.0 * 2))
    assert found.lines[0].displacement == pytest.approx(law * amplitude, rel=3e-3)


@pytest.mark.parametrize("name", WRITERS)
def test_the_synthetic_rig_is_read_back_blind_through_every_format(
    tmp_path: Path, name: str, compared: Compared
) -> None:
    path = tmp_path / name
    said = WRITERS[name](path, quantised(mesh_train(1 << 15, noise=0.1)))
    found = measure(read_record(path, **said), sidebands=0)  # type: ignore[arg-type]
    assert found.gearing is not None
    assert found.gearing.families
    lines = {line.name: line for line in found.lines if line.channel == found.channels[0]}
    assert lines["line x 1"].frequency == pytest.approx(MESH_HZ, rel=2e-5)
    found_g = [lines["line x 1"].acceleration_g - 1.0, lines["line x 2"].acceleration_g - 0.6]
    compared(
        "mesh lines read blind through every file format", "the record written", found_g, 0.02, "g"
    )


def test_without_rate_and_unit_there_are_orders_and_no_hertz() -> None:
    table = mesh_train(1 << 15)
    record = Record(tuple(Channel(f"a{i}", c) for i, c in enumerate(table)), "x")
    found = measure(record, teeth=32)
    for line in found.lines:
        assert np.isnan([line.frequency, line.acceleration, line.displacement]).all()
        assert np.isnan(line.shaft_speed)
    assert found.lines[0].order == pytest.approx(32.0, abs=0.01)
    assert found.lines[0].position == pytest.approx(MESH_HZ / RATE, rel=2e-5)
    assert found.settings["rate"] == "unknown"
    assert important(found) == {"rate_not_known": {}, "unit_not_known": {"unit": None}}
    assert {c.unit for c in record.channels} == {None}


@pytest.mark.parametrize("factor", [0.1, 10.0, 2.0, 5.3])
def test_a_wrong_rate_is_said_with_the_one_that_fits(factor: float) -> None:
    table = mesh_train(1 << 15, channels=1)
    record = Record((Channel("a", table[0], "g"),), "x", RATE * factor, "given")
    speed = 2 * np.pi * MESH_HZ / 32
    found = measure(record, teeth=32, speed=speed)
    told = important(found)["speed_contradicts_rate"]
    assert told["ratio"] == pytest.approx(factor, rel=1e-3)
    assert told["fitting"] == pytest.approx(RATE, rel=1e-3)


def test_nothing_is_said_of_the_right_rate() -> None:
    table = mesh_train(1 << 15, channels=1)
    right = Record((Channel("a", table[0], "g"),), "x", RATE, "given")
    assert important(measure(right, teeth=32, speed=2 * np.pi * MESH_HZ / 32)) == {}


def test_a_wrong_tooth_number_is_said() -> None:
    record = Record((Channel("a", mesh_train(1 << 15)[0], "g"),), "x", RATE, "given")
    found = measure(record, teeth=25)
    told = important(found)
    undecided = told["shaft_speed_undecided"]
    assert undecided["teeth"] == 25
    assert undecided["line"] == pytest.approx(found.lines[0].position, abs=1e-6)
    assert np.isnan(found.lines[0].shaft_speed)  # the record has a second mesh


def test_a_twin_of_the_real_rig_with_a_wrong_rate() -> None:
    table = mesh_train(60_000, 0.074385)
    record = Record(tuple(Channel(f"a{i}", c) for i, c in enumerate(table)), "x", 1280.0, "")
    found = measure(record, teeth=32, speed=2 * np.pi * 29.7)
    told = important(found)["speed_contradicts_rate"]
    assert told["fitting"] == pytest.approx(12800.0, rel=0.02)


def test_few_gaps_are_filled_and_of_many_the_longest_whole_stretch_is_used() -> None:
    x = mesh_train(1 << 15, channels=1)[0]
    whole = measure(Record((Channel("a", x.copy(), "g"),), "x", RATE, "given")).lines[0]
    x[5000:5100] = np.nan
    found = measure(Record((Channel("a", x, "g"),), "x", RATE, "given"))
    assert (found.start, found.samples) == (0, 1 << 15)
    (lost,) = (one.data for one in found.findings)
    assert (lost["first"], lost["last"], lost["samples"]) == (5000, 5099, 100)
    assert found.lines[0].reading == pytest.approx(whole.reading, rel=3e-3)
    assert found.lines[0].half_width > whole.half_width
    x[5000:8000] = np.nan
    found = measure(Record((Channel("a", x, "g"),), "x", RATE, "given"))
    assert (found.start, found.samples) == (8000, (1 << 15) - 8000)
    (cut,) = (n.data for n in found.notices if n.code == "damage_cut_away")
    assert (cut["stretch_first"], cut["stretch_last"]) == (8000, 32767)


def test_dead_channels_are_left_out_and_refused_when_asked_for() -> None:
    x = mesh_train(1 << 14, channels=1)[0]
    record = Record((Channel("a", x, "g"), Channel("b", np.zeros(x.size), "g")), "x", RATE, "given")
    found = measure(record)
    assert found.channels == ("a",)
    with pytest.raises(InputError, match=r"^channel: got 'b'; channel 'b' is zero throughout: "):
        measure(record, channels=["b"])


@pytest.mark.parametrize("scale", [1e-320, 1e-200, 1e200])
def test_numbers_of_no_sensor_are_refused_with_their_size(scale: float) -> None:
    x = mesh_train(1 << 12, channels=1)[0] * scale
    with pytest.raises(InputError, match=r"^record: got x; channel 'a': its largest"):
        measure(Record((Channel("a", x, "g"),), "x", RATE, "given"))


@pytest.mark.parametrize("side", [-1, 1])
def test_a_speed_given_next_to_a_sideband_is_nominal(side: int) -> None:
    """24 teeth at 1200 rpm; the speed given puts the mesh line on its first sideband: that was
    read, with half the amplitude and an interval of 90 %."""
    t = np.arange(20_000) / 5000.0
    x = (1 + 0.1 * np.cos(40 * np.pi * t)) * np.cos(960 * np.pi * t)
    x += 0.02 * np.random.default_rng(1).normal(size=t.size)
    record = Record((Channel("a", x, "g"),), "x", 5000.0, "given")
    found = measure(record, teeth=24, speed=(1200.0 + 50.0 * side) * np.pi / 30)
    assert found.lines[0].shaft_speed == pytest.approx(40 * np.pi, rel=1e-6)
    assert found.lines[0].reading == pytest.approx(1.0, rel=2e-3)
    (told,) = (one.data for one in found.notices if one.code == "speed_by_rate")
    assert told["given"] == pytest.approx((1200.0 + 50.0 * side) * np.pi / 30)


def test_uncertainty_grows_with_noise_and_holds_the_sensor() -> None:
    def u(noise: float, sensor: float | None = None) -> float:
        record = Record(
            (Channel("a", mesh_train(1 << 15, noise=noise, channels=1)[0], "g"),), "x", RATE, "made"
        )
        return measure(record, sensor_tolerance=sensor, sidebands=0).lines[0].uncertainty

    quiet = u(0.1)
    assert u(1.0) > quiet
    assert u(0.1, 0.05) == pytest.approx(np.hypot(quiet, 0.05), rel=1e-9)
    with pytest.raises(InputError, match=r"^sensor_tolerance: got 1\.5; allowed 0\.\.1"):
        u(0.1, 1.5)


def test_settings_say_everything_an_amplitude_needs() -> None:
    found = measure(tone(419.7, 1e-5))
    names = "rate samples bin window method band taps amplitudes"
    assert [name.split()[0] for name in found.settings] == names.split()
    assert found.settings["window"].split(",")[0] == "flattop"
    assert numbers(found.settings["window"])[0] == 3.77
    with pytest.raises(InputError, match=r"^method: got 'trapez'; did you mean 'trapezoid'\?$"):
        Chain("trapez")


@pytest.mark.parametrize("order", [1.02, 1.0, 0.4])
def test_a_line_beside_the_shaft_s_is_named_and_says_nothing_of_sidebands(order: float) -> None:
    rate, shaft, teeth = 12_800.0, 25.03, 20
    t = np.arange(1 << 15) / rate
    random = np.random.default_rng(5)
    swing = 1.0 + 0.2 * np.cos(2 * np.pi * shaft * t)
    x = swing * np.cos(2 * np.pi * teeth * shaft * t) + 0.05 * random.standard_normal(t.size)
    x += 0.4 * np.cos(4 * np.pi * teeth * shaft * t + 1.0)
    y = x + 0.5 * np.cos(2 * np.pi * order * shaft * t + 0.3)
    plain, beside = (
        {
            line.name: line
            for line in measure(
                Record((Channel("a", v, "g"),), "x", rate, "made"), teeth=teeth, orders=orders
            ).lines
        }
        for v, orders in ((x, ()), (y, (1.02,)))
    )
    asked = beside["order 1.02"]
    truth = 0.5 if order == 1.02 else 0.0
    assert abs(asked.reading - truth) < 1.5 * asked.half_width * asked.reading
    assert asked.reading - truth < 0.01
    own = beside["shaft x 1" if order == 1.0 else f"order {order:g}"]
    assert own.reading == pytest.approx(0.5, abs=0.01)
    assert own.order == pytest.approx(order, abs=1e-3)
    for name in ("mesh x 1 - 1 shaft/20", "mesh x 1 + 1 shaft/20"):
        for found in (plain, beside):
            assert found[name].reading == pytest.approx(0.1, abs=0.01)
            assert found[name].half_width < 0.1


@pytest.mark.parametrize("frequency", [1251.6])
def test_orders_that_the_record_cannot_hold_are_refused(frequency: float) -> None:
    record, rate, shaft = tone(frequency, 10e-6), 25_600.0, frequency / 25
    lowest, highest = rate / (1 << 16) / shaft, rate / 2 / shaft
    for order, edge in ((1.01 * highest, highest), (0.9 * lowest, lowest)):
        with pytest.raises(InputError, match=r"^orders: got .* as --orders \d") as refused:
            measure(record, teeth=25, orders=(1.0, order))
        got, low, high = numbers(str(refused.value).replace("..", " .. "))[:3]
        assert got == pytest.approx(order, rel=1e-5)
        assert (low, high) == pytest.approx((lowest, highest), rel=1e-3)
        inside = measure(record, teeth=25, orders=(edge * (0.99 if edge == highest else 1.01),))
        assert [line.kind for line in inside.lines].count("order") == 1


@pytest.mark.parametrize(("frequency", "rate"), [(832.58, 25_600.0), (1251.6, None)])
def test_harmonics_above_the_band_are_told(frequency: float, rate: float | None) -> None:
    record = replace(tone(frequency, 10e-6), rate=rate)
    fit = int(25_600.0 / 2.56 / frequency)
    for asked in (fit, fit + 1, 20):
        found = measure(record, harmonics=asked, sidebands=0)
        read = [line.name for line in found.lines if line.kind == "line"]
        assert read == [f"line x {k}" for k in range(1, fit + 1)]
        told = [n.data for n in found.notices if n.code == "harmonics_above_rate"]
        highest = None if rate is None else pytest.approx(rate / 2.56)
        expected = {"read": fit, "asked": asked, "highest": highest}
        assert told == ([] if asked == fit else [expected])


def test_a_line_hidden_with_all_its_harmonics_keeps_its_place() -> None:
    """No harmonic stood out of the noise: their mean had no weight."""
    raw = prominence(np.random.default_rng(3).normal(size=(1, 4096)), 1.0)
    low = int(np.argmin(raw.level[400:1200])) + 400
    flat = replace(raw, level=np.zeros_like(raw.level))
    assert _line(flat, low / raw.per_unit).mesh == pytest.approx(low / raw.per_unit, rel=0.01)
