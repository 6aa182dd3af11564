"""Faults of the case file: what they are to the teeth, what is refused, what leaves them out."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.family import family
from thermogear.case.points import excitations
from thermogear.case.thermal_state import UNDEFORMED
from thermogear.gears.candidates import mesh_points
from thermogear.gears.tooth_damage import Crack, MissingTooth
from thermogear.study.declared import fault_notices

TEXT = """
[gears]
module = "3 mm"
face_width = "20 mm"
[gears.pinion]
teeth = 23
[gears.wheel]
teeth = 47
[operating]
speed = "2500 rpm"
torque = "120 N m"
[transmission_error]
harmonics = []
"""
EVERY = {
    "crack": 'gear = "pinion"\ntooth = 3\ndepth = "2 mm"',
    "crack of a share": 'gear = "wheel"\nshare = 0.3\nangle = "60 deg"\nwidth_share = 0.5',
    "chip": 'gear = "wheel"\ntooth = 47\nheight = "2 mm"',
    "missing": 'gear = "pinion"\ntooth = 2',
    "spall": 'gear = "pinion"\ntooth = 4\nlength = "2 mm"\ndepth = "0.1 mm"',
    "spall of a share": 'gear = "pinion"\nlength = "2 mm"\ndepth = "0.1 mm"\nwidth_share = 0.4',
    "wear": 'gear = "pinion"\ncoefficient = "1e-17 m^2/N"\nrevolutions = 1e7',
    "wear of one": 'gear = "wheel"\ntooth = 5\ndepth = "20 um"',
    "pitch": 'gear = "wheel"\ntooth = 7\namount = "15 um"',
    "eccentricity": 'gear = "pinion"\namount = "15 um"\nangle = "90 deg"',
}


def faulty(*faults: str, text: str = TEXT) -> GearCase:
    return gear_case(load_case(text + "".join(f"[[faults]]\n{one}\n" for one in faults)))


def of(name: str) -> str:
    return f'kind = "{name.split()[0]}"\n{EVERY[name]}'


@pytest.mark.parametrize("name", EVERY)
def test_every_kind_acts_over_the_turn_of_its_gear(name: str) -> None:
    case = faulty(of(name))
    teeth = 23 if "pinion" in EVERY[name] else 47
    assert case.period.mesh_periods == (1 if name == "wear" else teeth)
    (words,) = case.faults()
    assert name.split()[0] in words
    assert case.sound().deviations == () == case.sound().file.faults
    mean = case.mean_tooth()
    assert mean.faults() == (case.faults() if name == "wear" else [])
    assert mean.period.mesh_periods == 1
    assert gear_case(load_case(case.text, case.overrides)).faults() == [words]


@pytest.mark.parametrize(
    ("fault", "instead"),
    [
        ("pitch", "[[gears.wheel.teeth_differ]]\ntooth = 7\nindex = '15 um'\n"),
        ("eccentricity", "[gears.pinion.eccentricity]\namount = '15 um'\nangle = '90 deg'\n"),
    ],
)
def test_a_misplaced_tooth_is_the_one_of_the_gears_table(fault: str, instead: str) -> None:
    one, other = faulty(of(fault)), gear_case(load_case(TEXT + instead))
    assert one.deviations == other.deviations
    model = one.models[0]
    first, second = (excitations(case, UNDEFORMED.cycle(case, model)) for case in (one, other))
    assert np.array_equal(first.stiffness, second.stiffness)
    assert np.array_equal(first.error, second.error)


def test_a_fault_of_no_size_is_the_sound_pair_to_the_last_digit() -> None:
    none = faulty(
        'kind = "crack"\ngear = "pinion"\ndepth = "0 mm"',
        'kind = "chip"\ngear = "wheel"\nheight = "0 mm"',
        'kind = "spall"\ngear = "wheel"\nlength = "1 mm"\ndepth = "0 mm"',
        'kind = "spall"\ngear = "wheel"\nlength = "1 mm"\ndepth = "1 mm"\nwidth_share = 0',
        'kind = "wear"\ngear = "wheel"\ncoefficient = "1e-17 m^2/N"\nrevolutions = 0',
        'kind = "pitch"\ngear = "wheel"\namount = "0 um"',
        'kind = "eccentricity"\ngear = "pinion"\namount = "0 um"',
    )
    sound = gear_case(load_case(TEXT))
    assert none.deviations == ()
    assert none.faults() == none.all_faults == [*fault_notices(none)] == []
    model = sound.models[0]
    one, two = (UNDEFORMED.cycle(case, model) for case in (none, sound))
    assert one.identical(two)
    assert gear_case(load_case("faults = []\n" + TEXT)).file.faults == ()


def test_teeth_are_counted_as_in_the_file_and_from_its_marks() -> None:
    marked = TEXT.replace("[gears]", "[gears]\nmarks = [5, 1]")
    for text, place in ((TEXT, 2), (marked, 21)):
        case = faulty(of("crack"), text=text)
        crack = next(d for d in case.deviations if isinstance(d, Crack))
        assert crack.tooth == place
        assert case.tooth_number("pinion", place) == 3
        # tooth n enters at mesh phase n
        contacts = mesh_points(case.pair, [place + 0.5]).contacts
        assert place in contacts.tooth("pinion")


def test_faults_beside_flanks_of_a_class_and_given_errors() -> None:
    text = TEXT.replace("[transmission_error]\nharmonics = []", "[flanks]\naccuracy = 6\nseed = 3")
    case, plain = faulty(of("missing"), of("pitch"), text=text), gear_case(load_case(text))
    assert case.deviations[: len(plain.deviations)] == plain.deviations
    assert {type(d) for d in case.deviations} > {MissingTooth}
    assert case.period.mesh_periods == 23 * 47
    # broken teeth are not measured; those that stand are
    assert case.turn_class != plain.turn_class
    assert faulty(of("missing"), text=text).turn_class == plain.turn_class
    nominal = gear_case(load_case(case.text, {"gears.part": "nominal"}))
    assert nominal.faults() == []


def test_notices_say_what_acts_and_what_is_left_out() -> None:
    case = faulty(of("crack"), of("wear"))
    (acting,) = fault_notices(case)
    assert acting.code == "fault_taken"
    crack, wear = case.faults()
    assert f"{crack}; {wear}" in acting.text
    told = {one.code: one.text for one in fault_notices(case.mean_tooth())}
    assert "wear" in told["fault_taken"]
    assert crack in told["fault_left_out"]
    assert [one.code for one in fault_notices(case, sound=True)] == ["fault_left_out"]
    assert not [*fault_notices(case.sound())]
    textbook = gear_case(load_case(case.text, {"model.stiffness": "textbook-30-degree"}))
    assert "do not feel shapes of flanks" in next(fault_notices(textbook)).text


def test_run_ups_take_the_turn_of_a_fault_and_the_mean_tooth_of_what_is_made() -> None:
    case = faulty(of("crack"))
    assert case.over_speeds() is case
    assert case.unless_stated("period", "mesh").period.mesh_periods == 1
    stated = gear_case(load_case(case.text, {"gears.period": "mesh"}))
    assert stated.over_speeds().faults() == []
    made = gear_case(load_case(TEXT + "[[gears.wheel.teeth_differ]]\ntooth = 7\nindex = '15 um'\n"))
    assert made.over_speeds().period.mesh_periods == 1


def test_several_depths_are_an_override() -> None:
    case = gear_case(load_case(faulty(of("crack")).text, {"faults.0.depth": "1 mm"}))
    assert case.faults() == ["crack of 1 mm at 45 deg, pinion tooth 3"]


@pytest.mark.parametrize(
    ("fault", "refused"),
    [
        ('kind = "crak"\ngear = "pinion"', r"faults\[0\]\.kind: got 'crak'; .*mean 'crack'\?"),
        ('kind = "missing"\ngear = "rack"', r"faults\[0\]\.gear: got 'rack'; allowed pinion"),
        ('kind = "missing"\ngear = "pinion"\ntooth = 24', r"tooth: got 24; allowed 1\.\.23;"),
        ('kind = "missing"\ngear = "pinion"\ntooth = 0', r"tooth: got 0; allowed 1\.\.2000"),
        ('kind = "crack"\ngear = "pinion"', r"got no size; allowed depth, or share"),
        ('kind = "crack"\ngear = "pinion"\ndepth = 2', r"a bare number has no unit"),
        (
            'kind = "crack"\ngear = "pinion"\ndepth = "4.5 mm"',
            r"depth: got 4\.5 mm; allowed <= 4\.",
        ),
        ('kind = "crack"\ngear = "pinion"\nshare = 0.6', r"share: got 0\.6; allowed 0\.\.0\.51"),
        ('kind = "crack"\ngear = "pinion"\nshare = 0.1\nangle = "20 deg"', r"allowed 45\.\.90 deg"),
        ('kind = "chip"\ngear = "pinion"', r"height: got nothing; needed with kind = \"chip\""),
        ('kind = "chip"\ngear = "pinion"\nheight = "6 mm"', r"height: got 6 mm; allowed <= 4\.44"),
        (
            'kind = "chip"\ngear = "pinion"\ndepth = "1 mm"\nheight = "1 mm"',
            r'depth: got given beside kind = "chip"; allowed height, tooth',
        ),
        (
            'kind = "spall"\ngear = "wheel"\nlength = "2 mm"\ndepth = "1 mm"\ndiameter = "200 mm"',
            r"diameter: got a radius of 100 mm; allowed 68",
        ),
        (
            'kind = "spall"\ngear = "wheel"\nlength = "2 mm"\ndepth = "1 um"\nwidth_share = 0.5',
            r"depth: got 0\.001 mm; allowed >= 0\.002\d+ mm; under the greatest torque",
        ),
        (
            'kind = "spall"\ngear = "wheel"\nlength = "2 mm"\ndepth = "1 mm"\nwidth_share = 0.95',
            r"width_share: got 0\.95; allowed 0\.\.0\.9",
        ),
        ('kind = "wear"\ngear = "wheel"\nrevolutions = 1e6', r"coefficient: got nothing; needed"),
        ('kind = "eccentricity"\ngear = "wheel"\namount = "-3 um"', r"amount: .*allowed 0\.\."),
        ('kind = "eccentricity"\ngear = "wheel"\namount = "400 um"', r"the cold pair would jam"),
        (
            'kind = "eccentricity"\ngear = "wheel"\namount = "5 mm"',
            r"of an eccentricity 0 um at least",
        ),
        (
            'kind = "pitch"\ngear = "wheel"\namount = 5',
            r'allowed -1000\.\.1000 um; .* for instance "5 um"',
        ),
    ],
)
def test_refusals_are_one_line_under_the_field(fault: str, refused: str) -> None:
    with pytest.raises(InputError, match=refused) as caught:
        faulty(fault)
    assert caught.value.field.startswith("faults[0]")
    assert "\n" not in str(caught.value)


def test_one_crack_and_one_break_of_a_tooth() -> None:
    with pytest.raises(InputError, match=r"faults\[1\]: got crack of tooth 3 of the pinion"):
        faulty(of("crack"), of("crack"))
    gone = 'kind = "missing"\ngear = "wheel"\ntooth = 47'
    with pytest.raises(InputError, match=r"faults\[1\]: got missing of tooth 47 of the wheel"):
        faulty(of("chip"), gone)
    chip = 'kind = "chip"\ngear = "pinion"\ntooth = 3\nheight = "1 mm"'
    with pytest.raises(InputError, match=r"faults\[1\]: got chip of tooth 3 .* another, crack"):
        faulty(of("crack"), chip)
    assert len(faulty(of("chip"), of("missing"), of("crack")).faults()) == 3


def test_two_faults_of_one_place_are_refused_and_those_beside_each_other_are_not() -> None:
    """Middles on the flank lie (r_1^2 - r_2^2)/(2 r_b) apart, both half lengths or more."""
    spall = of("spall")
    for other in (spall, of("spall of a share") + "\ntooth = 4"):
        with pytest.raises(InputError, match=r"faults\[1\]: got spall of tooth 4 .* side by side"):
            faulty(spall, other)
    gone = 'kind = "missing"\ngear = "pinion"\ntooth = 4'
    for pair in ((gone, spall), (spall, gone)):
        with pytest.raises(InputError, match=r"faults\[1\]: .* of tooth 4 .* nothing on a missing"):
            faulty(*pair)
    low, base = 33.5, 69.0 * np.cos(np.radians(20.0)) / 2.0
    for beyond in (0.99, 1.01):
        high = np.sqrt(low**2 + 2.0 * base * beyond * 1.0)
        two = [
            f'kind = "spall"\ngear = "pinion"\nlength = "1 mm"\ndepth = "0.1 mm"\n'
            f'diameter = "{2.0 * radius:.6f} mm"'
            for radius in (low, high)
        ]
        if beyond > 1.0:
            assert len(faulty(*two).faults()) == 2
        else:
            with pytest.raises(InputError, match="spalls side by side"):
                faulty(*two)
    assert len(faulty(gone, of("spall of a share"), of("eccentricity"), of("wear")).faults()) == 4


def test_too_many_faults_are_to_be_left_out() -> None:
    with pytest.raises(InputError, match=r"faults: got 65 entries; .* leave some out"):
        faulty(*[of("missing")] * 65)


def test_what_nothing_feels_is_no_parameter() -> None:
    """Fewer words than a map that is all one colour."""
    case = faulty(of("crack"), of("wear of one"), of("wear"))
    mean, depths = case.unless_stated("period", "mesh"), np.array([1e-3, 2e-3])
    for n in (0, 1):
        with pytest.raises(InputError, match=rf"faults\.{n}\.depth: .*here feels it") as got:
            family(mean, ["pinion_speed"]).require({f"faults.{n}.depth": depths / 10**n})
        assert "\n" not in str(got.value)
        family(case, ["pinion_speed"]).require({f"faults.{n}.depth": depths / 10 ** (2 * n)})
    family(mean, ["pinion_speed"]).require({"faults.2.revolutions": np.array([1e6, 2e6])})
    textbook = gear_case(load_case(case.text, {"model.stiffness": "textbook-30-degree"}))
    with pytest.raises(InputError, match="nothing here feels it"):
        family(textbook, ["pinion_speed"]).require({"faults.0.depth": depths})


def test_a_notice_names_what_varies_in_place_of_the_file() -> None:
    case = faulty(of("crack"))
    (notice,) = fault_notices(case, varied=["pinion_speed", "faults.0.depth"])
    assert notice.data["varied"] == ["faults.0.depth"]
    assert "faults.0.depth" in notice.text
    (plain,) = fault_notices(case, varied=["pinion_speed"])
    assert plain.text == next(fault_notices(case)).text
    # only answers and runs have that stress
    assert "root" not in plain.text


def test_some_tooth_must_touch() -> None:
    gone = [f'kind = "missing"\ngear = "pinion"\ntooth = {n}' for n in (4, 5, 6)]
    assert len(faulty(*gone[:2]).faults()) == 2
    with pytest.raises(InputError, match="faults: got so many broken teeth side by side"):
        faulty(*gone)
