"""Dials: turned they are text in the case file, and the case then has what they say."""

from __future__ import annotations

import math

import numpy as np
import pytest

from own_pair import OWN_PAIR
from thermogear.base.errors import InputError
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.dials import Changes, balanced, dials, turned
from thermogear.gears.tooth_damage import way_across

pytestmark = pytest.mark.filterwarnings("ignore::thermogear.base.errors.ValidityWarning")
HARMONICS = (
    'transmission_error.harmonics=[{ order = 2, amplitude = "1.5 um", phase = "40 deg" }, '
    '{ order = 1, amplitude = "6 um", phase = "-0.3 rad" }, { order = 5, amplitude = "0.25 um" }]'
)
PAIRS: dict[str, tuple[str, tuple[str, ...]]] = {
    "rig": ("rig", ()),
    "rig, computed": (
        "rig",
        (
            "temperatures.pinion_addendum=", "temperatures.wheel_addendum=",
            "temperatures.pinion_bore_below_addendum=", "temperatures.wheel_bore_below_addendum=",
            "temperatures.housing_below_addendum=", "oil.temperature_below_addendum=",
        ),
    ),
    "own": (OWN_PAIR, ()),
    "own, shifted, several harmonics": (
        OWN_PAIR, ("gears.pinion.profile_shift=0.42", "gears.wheel.profile_shift=-0.1", HARMONICS),
    ),
    "own, no error, circumferential half backlash": (
        OWN_PAIR,
        ("transmission_error=", "backlash.direction=circumferential", "backlash.extent=half"),
    ),
    "own, backlash decided": (
        OWN_PAIR, ("backlash=", "gears.pinion.profile_shift=0.25", "gears.wheel.profile_shift=0.0"),
    ),
    "plastic on steel, computed": ("pom-steel", ()),
    "with shafts": ("motor-train", ()),
}  # fmt: skip


def case_of(name: str, changes: Changes = ()) -> GearCase:
    """A pair with more changes, as the command line would read it."""
    source, own = PAIRS[name]
    last = dict(one.split("=", 1) for one in own) | dict(changes)
    return gear_case(load_case(source, [f"{path}={text}" for path, text in last.items()]))


@pytest.mark.parametrize("name", PAIRS)
def test_a_turned_dial_says_what_it_was_turned_to(name: str) -> None:
    """Each at drawn places of its range; no other dial moves by it."""
    case, rng = case_of(name), np.random.default_rng(len(name))
    before = {one.name: one for one in dials(case)}
    for dial in before.values():
        if dial.held or (case.computed and dial.name in ("torque", "damping", "part")):
            continue  # each would take a heat balance of its own
        for value in rng.uniform(max(dial.low, 0.01), dial.high, 1 if case.computed else 2):
            value = round(value) if dial.name == "part" else value
            text = turned(case, {dial.name: float(value)})
            if name == "rig" and dial.name == "gears" and value < 60.0:
                # so near the drawing's temperature nothing can keep its proportion to the gears
                with pytest.raises(InputError, match="in proportion to it would be at"):
                    case_of(name, text)
                continue
            changed = case_of(name, text)
            found = {one.name: one for one in dials(changed)}
            assert found[dial.name].value == pytest.approx(value, rel=2e-9, abs=1e-9), dial.name
            assert before.keys() == found.keys()
            for other in before.keys() - {dial.name, "gears", "housing"}:
                assert found[other].value == pytest.approx(before[other].value, rel=1e-9), other
            for other in {"gears", "housing"} - {dial.name}:
                moved = not math.isclose(found[other].value, before[other].value, rel_tol=1e-9)
                assert moved <= case.computed or (dial.name, other) == ("gears", "housing")


@pytest.mark.parametrize("name", PAIRS)
def test_dials_hold_their_value_in_their_range(name: str) -> None:
    for one in dials(case_of(name)):
        assert one.low <= one.value <= one.high or one.held, one.name
        assert one.low < one.high
        whole = one.name == "part"  # a whole number
        assert one.step == 1.0 if whole else 0.0 < one.step <= (one.high - one.low) / 100.0
        steps = (one.high - one.low) / one.step
        assert steps == pytest.approx(round(steps), rel=1e-5)
        assert one.fields
        assert set(one.row) == set(one.__dataclass_fields__)


def test_gears_at_a_temperature_keep_their_distances() -> None:
    """The rig's bores, housing and oil stand below its gears; 17 degrees more for all of them."""
    case = case_of("rig")
    hot = case_of("rig", turned(case, {"gears": 157.0}))
    one, other = (c.operating_of(c.models[0]).temperatures for c in (case, hot))
    for body in ("pinion_addendum", "wheel_addendum", "pinion_bore", "wheel_bore", "housing"):
        rise = np.ravel(getattr(other, body)) - np.ravel(getattr(one, body))
        assert rise == pytest.approx(17.0, abs=1e-9), body


@pytest.mark.parametrize("name", [name for name in PAIRS if "computed" in name])
def test_heat_off_keeps_the_temperatures_and_on_gives_them_back(name: str) -> None:
    """Within the rounding of the file's text, a hundredth of a kelvin; on again: to the bit."""
    case = case_of(name)
    assert case.computed
    assert balanced(case, True) == ()
    off = balanced(case, False)
    held = case_of(name, off)
    assert not held.computed
    again = gear_case(
        load_case(
            case.text,
            {p: t for p, t in {**dict(held.overrides), **dict(balanced(held, True))}.items()
             if t or p in dict(case.overrides)},
        )
    )  # fmt: skip
    assert again.computed
    bodies = ("pinion_addendum", "wheel_addendum", "pinion_bore", "wheel_bore", "housing")
    computed, kept, back = (
        np.array([np.ravel(getattr(c.operating_of(c.models[0]).temperatures, b))[0]
                  for b in bodies])
        for c in (case, held, again)
    )  # fmt: skip
    assert np.abs(kept - computed).max() <= 0.0151
    assert back.tolist() == computed.tolist()
    oil = [float(np.ravel(c.operating_of(c.models[0]).oil_temperature)[0]) for c in (case, held)]
    assert abs(oil[0] - oil[1]) <= 0.0151


@pytest.mark.parametrize("name", PAIRS)
def test_heat_on_leaves_the_given_temperatures_out(name: str) -> None:
    case = case_of(name)
    if case.computed:
        return
    on = case_of(name, balanced(case, True))
    assert on.computed
    held = {one.name: one.held for one in dials(on)}
    assert held["gears"]
    with pytest.raises(InputError, match="heat balance computes it"):
        turned(on, {"gears": 100.0})


CRACKED = '{kind = "crack", gear = "wheel", tooth = 5, depth = "2 mm", angle = "60 deg"}'
WORN = '{kind = "wear", gear = "pinion", depth = "5 um"}'


def test_a_dial_of_a_crack_turns_the_first_one_and_leaves_the_rest() -> None:
    """100 % of the way across is 2 x_root/sin(angle): the depth said is the share times that."""
    case = case_of("own", (("faults", f"[{WORN}, {CRACKED}]"),))
    before = {dial.name: dial.value for dial in dials(case)}
    root = way_across(case.pair.wheel, 0.5 * math.pi)
    assert before["crack"] == pytest.approx(2e-3 * math.sin(math.pi / 3.0) / root, rel=1e-9)
    again = case_of("own", turned(case, {"crack": 0.4}))
    assert again.file.faults[0] == case.file.faults[0]
    assert (again.file.faults[1].share, again.file.faults[1].tooth) == (0.4, 5)
    sound = case_of("own")
    assert {dial.name: dial.value for dial in dials(sound)}["crack"] == 0.0
    cracked = case_of("own", turned(sound, {"crack": 0.3}))
    assert (cracked.file.faults[0].gear, cracked.file.faults[0].place) == ("pinion", 0)
    assert cracked.period.mesh_periods == sound.pair.pinion.teeth


REFUSED = {
    "speed": (-1.0, 0.0, 1e9, math.nan, math.inf, -math.inf, 1e308),
    "torque": (-5.0, 1e300, math.nan),
    "gears": (-300.0, 1e6, math.nan),
    "housing": (-1e6, 1e9, math.nan),
    "backlash": (-1.0, 1e3, math.nan),
    "damping": (-0.1, 17.0, math.nan),
    "crack": (-0.1, 0.7, math.nan),
}


@pytest.mark.parametrize("name", ["rig", "own, shifted, several harmonics"])
def test_a_value_that_cannot_be_is_one_line(name: str) -> None:
    case = case_of(name)
    for dial in dials(case):
        for value in REFUSED[dial.name]:
            with pytest.raises(InputError) as caught:
                case_of(name, turned(case, {dial.name: value}))
            # one line for each field that it puts
            lines = str(caught.value).split("\n")
            assert len(lines) <= len(dial.fields)
            for words in lines:
                assert "; " in words
                assert words.startswith(dial.fields[0].rpartition(".")[0]), words
    with pytest.raises(InputError, match="did you mean 'torque'"):
        turned(case, {"torqe": 3.0})
