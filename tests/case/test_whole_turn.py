"""What a case says of a whole turn: eccentricity, pitch errors, teeth that differ, marks."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TypeVar

import numpy as np
import pytest

import own_chart
from own_chart import END, START, chart, diameter
from said import numbers
from thermogear.base.errors import InputError, ValidityWarning
from thermogear.base.period import Period
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.derived import facts
from thermogear.gears.candidates import mesh_points
from thermogear.gears.deviations import PitchError
from thermogear.gears.graded_flanks import WavyProfile
from thermogear.gears.population import ToothProfile, drawn_pair, measured
from thermogear.gears.turn import Eccentricity, ToothShapes

Z1, Z2 = 20, 40
COSINE = math.cos(math.radians(20.0))
PERFECT = ["transmission_error.harmonics=[]"]


def case(*changes: str) -> GearCase:
    return gear_case(load_case(own_chart.CASE, [*PERFECT, *changes]))


def graded(*changes: str) -> GearCase:
    return gear_case(load_case(own_chart.CASE, changes))


def um(values: list[float]) -> str:
    return str([f"{value!r} um" for value in values])


Kind = TypeVar("Kind")


def alone(found: GearCase, kind: type[Kind]) -> Kind:
    (one,) = (one for one in found.deviations if isinstance(one, kind))
    return one


def gap(found: GearCase, flank: str = "drive", periods: int = 4 * Z2) -> np.ndarray:
    at = mesh_points(found.pair, 0.25 * np.arange(4 * periods), flank).contacts
    return np.asarray(sum(one.gap(at) for one in found.deviations))


# --- fields -------------------------------------------------------------------------------


def test_a_run_out_is_twice_an_eccentricity() -> None:
    amount = case('gears.pinion.eccentricity={amount="12 um", angle="90 deg"}')
    run_out = case('gears.pinion.eccentricity={run_out="24 um", angle="90 deg"}')
    one = alone(amount, Eccentricity)
    assert one.gear == "pinion"
    assert one.angle == pytest.approx(0.5 * math.pi, rel=1e-14)
    assert one.amount == pytest.approx(12e-6, rel=1e-14)
    assert alone(run_out, Eccentricity).amount == pytest.approx(12e-6, rel=1e-14)
    assert amount.period == Period(Z1, (Z1, Z2))


def test_an_arc_is_converted_by_the_cosine_of_the_pressure_angle() -> None:
    errors = um([float(n % 7) - 3.0 for n in range(Z2)])
    line = alone(case(f"gears.wheel.pitch_errors={errors}"), PitchError)
    arc = alone(
        case(f"gears.wheel.pitch_errors={errors}", "gears.pitch_errors_along=arc"), PitchError
    )
    np.testing.assert_allclose(arc.errors, COSINE * np.array(line.errors), rtol=1e-14, atol=0.0)


@pytest.mark.parametrize("gear", ["pinion", "wheel"])
def test_single_pitches_are_differences_of_the_index(gear: str) -> None:
    """A pitch is too long where the tooth lies too far back: its drive flank, where it is ahead
    as on the pinion, has too little, on the wheel, where it looks back, too much."""
    teeth = {"pinion": Z1, "wheel": Z2}[gear]
    pitches = np.random.default_rng(3).normal(size=teeth)
    pitches -= pitches.mean()
    index = np.cumsum(pitches) * {"pinion": -1.0, "wheel": 1.0}[gear]
    kind = 'gears.pitch_errors_are="single pitch"'
    got = alone(case(f"gears.{gear}.pitch_errors={um(pitches.tolist())}", kind), PitchError)
    same = alone(case(f"gears.{gear}.pitch_errors={um(index.tolist())}"), PitchError)
    assert got.gear == gear
    np.testing.assert_allclose(
        np.array(got.errors), np.array(same.errors) - np.mean(same.errors), atol=1e-18
    )
    assert np.mean(got.errors) == pytest.approx(0.0, abs=1e-20)


def test_every_tooth_and_single_teeth_have_their_profiles() -> None:
    slopes = [0.5 * n for n in range(Z1)]
    found = case(
        f'gears.pinion.tooth_profiles=[{{slope={um(slopes)}, form="2 um", flank="drive"}}]',
        'gears.pinion.teeth_differ=[{tooth=3, index="8 um", slope="-4 um", waves=3.5, form="1 um", '
        'phase="90 deg", flank="back"}]',
    )
    every, single = (one for one in found.deviations if isinstance(one, ToothShapes))
    assert (every.shapes[0].flank, single.shapes[0].flank) == ("drive", "back")
    for n, shape in enumerate(every.shapes):
        assert isinstance(shape, WavyProfile)
        assert (shape.slope, shape.form) == pytest.approx((1e-6 * slopes[n], 2e-6), rel=1e-14)
    third = single.shapes[2]
    assert isinstance(third, WavyProfile)
    assert (third.slope, third.form) == pytest.approx((-4e-6, 1e-6), rel=1e-14)
    assert third.waves == 3.5
    assert third.phase == pytest.approx(0.5 * math.pi, rel=1e-14)
    assert single.shapes[:2] == single.shapes[3:5]
    assert single.shapes[0] == WavyProfile("pinion", slope=0.0, flank="back")
    errors = np.zeros(Z1)
    errors[2] = 8e-6
    np.testing.assert_allclose(alone(found, PitchError).errors, errors, rtol=1e-14)


REFUSED = {
    'gears.pinion.eccentricity={amount="1 um", run_out="2 um"}':
        "gears.pinion.eccentricity: got both amount and run_out; allowed exactly one of the two; "
        "leave one out",
    "gears.pinion.eccentricity={}":
        "gears.pinion.eccentricity: got neither amount and run_out; allowed exactly one of the "
        "two; write amount = ...",
    'gears.wheel.eccentricity={run_out="3 mm"}':
        "gears.wheel.eccentricity.run_out: got '3 mm'; allowed 0..2000 um; write for instance "
        '"20 um"',
    'gears.wheel.tooth_profiles=[{slope=["1 um", "2 um"]}]':
        "gears.wheel.tooth_profiles[0].slope: got 2 values; allowed one for each of the 40 teeth, "
        "or one; list them tooth by tooth",
    "gears.pinion.teeth_differ=[{tooth=21, slope='1 um'}]":
        "gears.pinion.teeth_differ: got tooth 21; allowed 1..20",
    "gears.pinion.teeth_differ=[{tooth=21, index='1 um'}]":
        "gears.pinion.teeth_differ: got tooth 21; allowed 1..20",
    "gears.pinion.teeth_differ=[{tooth=2, slope='1 um'}, {tooth=2, form='1 um'}]":
        "gears.pinion.teeth_differ[0]: got tooth 2 twice; allowed each tooth of a side once; put "
        "what differs into one entry",
    "gears.pinion.pitch_errors_along='arc'":
        "gears.pinion.pitch_errors_along: got an unknown key; [gears.pinion] does not have it; did "
        "you mean 'pitch_errors'?",
    "gears.pitch_errors_along='chord'":
        "gears.pitch_errors_along: got 'chord'; allowed line of action | arc; write for "
        'instance "line of action"',
    "gears.pinion.teeth_differ=[{tooth=2, slope=['1 um', '2 um']}]":
        "gears.pinion.teeth_differ.slope: got 2 values; allowed one; list them tooth by tooth",
    "gears.pinion.tooth_profiles=[{flank='drive'}]":
        "gears.pinion.tooth_profiles[0].form: got nothing; allowed slope or form; for none write "
        'form = "0 um"',
    "gears.pinion.tooth_profiles=[{slope='1 um', waves=3}]":
        "gears.pinion.tooth_profiles[0].form: got nothing; allowed form beside phase or waves; for "
        'none write form = "0 um"',
    "gears.pinion.teeth_differ=[{tooth=2, index='1 um', flank='back'}]":
        "gears.pinion.teeth_differ[0].flank: got 'back'; allowed beside slope or form; an index "
        "moves the whole tooth; leave it out",
    "gears.marks=[21, 1]": "gears.marks[0]: got 21; allowed 1..20",
    "gears.marks=[1]":
        "gears.marks: got a list of 1; allowed 2 entries; write for instance [1, 1]",
}  # fmt: skip


@pytest.mark.parametrize("change", REFUSED)
def test_what_does_not_fit_is_one_line(change: str) -> None:
    with pytest.raises(InputError) as caught:
        case(change)
    assert str(caught.value) == REFUSED[change]


def test_pitches_that_do_not_close_are_no_pitches() -> None:
    errors = um([1.0] * Z1)
    with pytest.raises(InputError) as caught:
        case(f"gears.pinion.pitch_errors={errors}", 'gears.pitch_errors_are="single pitch"')
    assert str(caught.value) == (
        "gears.pinion.pitch_errors: got single pitch deviations that add up to 20 um; allowed "
        "-10..10 um; after a whole turn the pitches close; are they positions of the teeth? then "
        'gears.pitch_errors_are = "index"'
    )


def test_teeth_that_take_the_whole_backlash_are_refused() -> None:
    """A tooth early by x takes x of it, an eccentricity e of one gear 2 e sin(alpha_w)."""
    whole = 2e6 * case().cold_backlash.half
    tooth = 'gears.wheel.teeth_differ=[{{tooth=3, index="{:.6f} um"}}]'
    run_out = "gears.pinion.eccentricity.run_out={:.6f} um"
    sine = math.sin(math.radians(20.0))
    for field, change, most in (
        ("gears.wheel.teeth_differ", tooth, whole),
        ("gears.pinion.eccentricity", run_out, whole / sine),
    ):
        meshing = case(change.format(0.999 * most))
        assert meshing.period.mesh_periods > 1
        narrow = meshing.with_values({"cold_half_backlash": 1e-6}, told=False)
        assert narrow.deviations == meshing.deviations  # a jam is what a sweep looks for
        with pytest.raises(InputError) as caught:
            case(change.format(1.01 * most))
        assert str(caught.value) == (
            f"{field}: got teeth that take {1.01 * whole:.4g} um of the backlash; allowed < "
            f"{whole:.4g} um, the whole of it along the line of action; the cold pair would jam; "
            "correct the unit, or open [backlash]"
        )


def test_what_changes_nothing_is_said() -> None:
    errors = f"gears.pinion.pitch_errors={um([1.0, -1.0] * (Z1 // 2))}"
    chosen = {
        "gears.marks=[3, 5]": "gears.marks: 3, 5 has no effect: the teeth of each gear are alike",
        "gears.period=mesh": "gears.period: mesh has no effect: the teeth of each gear are alike",
        "gears.pitch_errors_along=arc":
            "gears.pitch_errors_along: arc has no effect: no pitch_errors are given",
        "gears.part=nominal": "gears.part: nominal has no effect: no flank deviates but by reliefs",
    }  # fmt: skip
    for change, line in chosen.items():
        with pytest.warns(ValidityWarning) as caught:
            case(change)
        assert [str(one.message) for one in caught] == [f"{line}; leave it out"]
        case(errors, change)  # where a warning would be an error
    own = [f"gears.{gear}.tooth_profiles=[{{slope='1 um'}}]" for gear in ("pinion", "wheel")]
    for change in ("accuracy=5", "seed=2", "teeth=drawn"):
        with pytest.warns(ValidityWarning, match=rf"^flanks\.{change.replace('=', ': ')} has no "):
            graded(*own, f"flanks.{change}")
    for change in ("drawing=3", "drawing=0"):
        with pytest.warns(ValidityWarning, match=r"^flanks\.drawing: \d has no effect: it is one"):
            graded(f"flanks.{change}")
        graded("flanks.teeth=drawn", f"flanks.{change}")


# --- marks and assemblies -----------------------------------------------------------------

BOTH = [
    f"gears.pinion.pitch_errors={um([round(3 * math.sin(2.3 * n * n), 3) for n in range(Z1)])}",
    f"gears.wheel.pitch_errors={um([round(3 * math.cos(1.7 * n * n), 3) for n in range(Z2)])}",
    'gears.pinion.eccentricity={amount="5 um", angle="30 deg"}',
    'gears.wheel.eccentricity={amount="7 um", angle="-60 deg"}',
    "gears.wheel.teeth_differ=[{tooth=7, slope='4 um'}]",
]


@pytest.mark.parametrize("flank", ["drive", "back"])
def test_marks_start_the_same_gears_at_other_teeth(flank: str) -> None:
    """Marks (1 + k, 1 + k) begin k mesh periods later; marks of one assembly do so too."""
    plain, later = case(*BOTH), case(*BOTH, "gears.marks=[4, 24]")
    start = (23 + 40 * np.arange(20)) % Z1  # the mesh period where tooth 4 meets tooth 24
    shift = int(23 + 40 * np.argmax(start == 3))
    expected = np.roll(gap(plain, flank), -4 * shift, axis=0)
    np.testing.assert_allclose(gap(later, flank), expected, atol=1e-17)
    assert (later.tooth_number("pinion", 0), later.tooth_number("wheel", 17)) == (4, 1)


def test_a_case_without_marks_says_of_how_many_assemblies_it_is_one() -> None:
    plain = case(*BOTH)
    (said,) = (one for one in plain.assumptions if one.field == "gears.marks")
    assert said.value == "1, 1"
    assert numbers(said.default) == [1, 1, 0, 20]
    fields = {one.field for one in case(*BOTH, "gears.marks=[1, 1]").assumptions}
    assert "gears.marks" not in fields
    assert "gears.marks" not in {one.field for one in case(*BOTH[:1]).assumptions}
    coprime = case(*BOTH[2:], "gears.wheel.teeth=41")
    assert "gears.marks" not in {one.field for one in coprime.assumptions}


def test_assemblies_differ_and_are_all() -> None:
    found = case(*BOTH).assemblies()
    assert len(found) == math.gcd(Z1, Z2)
    assert found[0].file.gears.marks is None
    assert [one.file.gears.marks for one in found[1:]] == [(1, k) for k in range(2, 21)]
    fields = [{one.field for one in each.assumptions} for each in found]
    assert ["gears.marks" in each for each in fields] == [True] + [False] * 19
    sizes = {round(1e9 * float(np.ptp(gap(one)[:, 1])), 6) for one in found[:6]}
    assert len(sizes) == 6
    assert case(*BOTH[:1]).assemblies() == (case(*BOTH[:1]).assemblies()[0],)
    assert len(case(*BOTH[2:], "gears.wheel.teeth=41").assemblies()) == 1


# --- period and mean tooth ----------------------------------------------------------------


def period_facts(found: GearCase) -> list[object]:
    return [one.value for one in facts(found) if one.group.startswith("period of all")]


def test_teeth_alike_have_one_mesh_period_and_say_nothing_of_a_turn() -> None:
    found = graded()
    assert found.period == Period(1, (Z1, Z2))
    assert found.mean_tooth() is found
    assert period_facts(found) == []
    assert period_facts(case(*BOTH, "gears.period=mesh")) == [40]


def test_the_mean_tooth_stays_in_what_is_read_anew() -> None:
    found = case(*BOTH).mean_tooth()
    assert found.period == Period(1, (Z1, Z2))
    assert found.overrides[-1] == ("gears.period", "mesh")
    again = found.with_values({"operating.torque": 70.0})
    assert again.period.mesh_periods == 1
    index = {one.gear: one.errors for one in again.deviations if isinstance(one, PitchError)}
    for gear, errors in index.items():
        whole = next(
            one for one in case(*BOTH).deviations
            if isinstance(one, PitchError) and one.gear == gear
        )  # fmt: skip
        np.testing.assert_allclose(errors, np.mean(whole.errors), rtol=1e-12)


def test_check_tells_period_orders_and_what_a_machine_would_measure() -> None:
    found = case(*BOTH)
    period, *orders, until, assemblies = period_facts(found)
    assert (period, until, assemblies) == (40, 2, 20)
    assert orders == list(Period.of((Z1, Z2), pinion=True, wheel=True).orders.values())
    bore = [one for one in facts(found) if one.group == "wheel about its bore"]
    figures = measured(found.pair, "wheel", found.deviations)
    assert [one.name.split()[0] for one in bore] == ["drive", "back"]
    assert f"f_p {1e6 * figures.single_pitch:.2f}, F_p {1e6 * figures.cumulative_pitch:.2f}" in str(
        bore[0].value
    )


# --- drawn and measured teeth -------------------------------------------------------------


def test_drawn_teeth_are_whole_gears_of_the_class() -> None:
    found = graded("flanks.teeth=drawn", "flanks.seed=5", "flanks.drawing=3")
    assert found.deviations == drawn_pair(found.pair, 6, seed=5, place=3)
    assert found.period == Period(40, (Z1, Z2))
    assert found.accuracy == 6
    bore = [str(one.value) for one in facts(found) if one.group.endswith("about its bore")]
    assert len(bore) == 4
    assert any(value.endswith("class 6") for value in bore)
    shifted = graded("flanks.teeth=drawn", "flanks.seed=5", "flanks.drawing=3", "gears.marks=[1,5]")
    assert shifted.deviations[:4] == found.deviations[:4]
    index = np.roll(alone_of(found, "wheel").errors, -4)
    np.testing.assert_array_equal(alone_of(shifted, "wheel").errors, index)


def alone_of(found: GearCase, gear: str) -> PitchError:
    return next(one for one in found.deviations if isinstance(one, PitchError) and one.gear == gear)


def test_gears_beyond_the_tables_are_not_drawn() -> None:
    with pytest.raises(InputError) as caught:
        graded("flanks.teeth=drawn", "gears.module=0.3 mm", "operating.torque=0.1 N m")
    assert str(caught.value) == (
        "flanks: got module 0.3 mm; allowed 0.5..70 mm; the range of ISO 1328-1:2013; give "
        "[transmission_error] harmonics, or measured profiles, instead"
    )


def test_a_gear_that_is_given_is_not_drawn() -> None:
    with pytest.raises(InputError) as caught:
        graded("flanks.teeth=drawn", BOTH[0])
    assert str(caught.value) == (
        'gears.pinion.pitch_errors: got given beside flanks.teeth = "drawn"; a drawn gear has its '
        "own; leave one out, or give tooth_profiles, which are not drawn then"
    )
    given = graded("flanks.teeth=drawn", BOTH[0], "gears.pinion.tooth_profiles=[{slope='1 um'}]")
    drawn = [one for one in given.deviations if isinstance(one, ToothShapes)]
    assert {one.gear for one in drawn if isinstance(one.shapes[0], ToothProfile)} == {"wheel"}


def test_a_chart_of_every_tooth_acts_tooth_by_tooth(tmp_path: Path) -> None:
    rho = np.linspace(START, END, 121)
    share = (rho - START) / (END - START)
    slopes = np.random.default_rng(2).normal(0.0, 3.0, Z1)
    traces = {f"tooth {n + 1} drive [um]": slope * (share - 0.5) for n, slope in enumerate(slopes)}
    text = chart(traces, diameter(rho))
    mean = own_chart.case(tmp_path, text)
    assert mean.period.mesh_periods == 1
    found = own_chart.case(tmp_path, text, more='teeth = "measured"\n')
    (shapes,) = (one for one in found.deviations if isinstance(one, ToothShapes))
    assert (shapes.gear, shapes.shapes[0].flank) == ("pinion", "drive")
    ends = np.array([found.pair.path.a, found.pair.path.e])
    rise = [-float(np.diff(one.taken_off(found.pair, ends))[0]) for one in shapes.shapes]
    np.testing.assert_allclose(rise, 1e-6 * slopes, atol=2e-9)
    few = chart(dict(list(traces.items())[:19]), diameter(rho))
    with pytest.raises(InputError) as caught:
        own_chart.case(tmp_path, few, more='teeth = "measured"\n')
    assert str(caught.value).endswith(
        "flanks.pinion: got traces of 19 teeth, drive flank; allowed all 20 teeth with "
        'flanks.teeth = "measured"; write teeth = "alike" to take the mean of these'
    )


def test_an_eccentricity_is_given_in_one_place() -> None:
    shafts = (
        "[[shafts]]\ngear = 'pinion'\nlength = '100 mm'\ndiameter = '30 mm'\nbearings = '6206'\n"
        "eccentricity = '5 um'\n[[shafts]]\ngear = 'wheel'\nlength = '100 mm'\n"
        "diameter = '30 mm'\nbearings = '6206'\n"
    )
    with pytest.raises(InputError) as caught:
        load_case(own_chart.CASE + shafts, ['gears.pinion.eccentricity={amount="5 um"}'])
    assert "got one beside [gears.pinion.eccentricity]" in str(caught.value)
    load_case(own_chart.CASE + shafts, ['gears.wheel.eccentricity={amount="5 um"}'])
