"""Shafts and bearings in a case file: what it builds, what it refuses, what it tells."""

from __future__ import annotations

import math

import numpy as np
import pytest

from own_trains import FOUR, OWN, PAIR, PINION, TRAIN, WHEEL, bare, bearing, random_train
from thermogear import InputError
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.derived import facts
from thermogear.case.shaft_plan import TrainPlan
from thermogear.shafts.bearings.laws import ElementLaw, LinearLaw, RingLaw

MOTOR = '\n[motor]\ninertia = "0.02 kg m^2"\ncoupling_stiffness = "2000 N m/rad"\n'
DISC = '\n[[discs]]\nshaft = "wheel"\nposition = "20 mm"\n'


def planned(text: str) -> TrainPlan:
    train = gear_case(load_case(text)).train
    assert train is not None
    return train


def test_ten_lines_draw_two_shafts_and_four_bearings() -> None:
    plan = planned(TRAIN)
    assert len((PINION + WHEEL).split("\n\n")[0].splitlines()) <= 10
    assert [one.shaft for one in plan.bearings] == ["pinion"] * 2 + ["wheel"] * 2
    assert [one.position for one in plan.bearings] == pytest.approx([0.0075, 0.1125, 0.008, 0.112])
    assert [one.gear_position for one in plan.shafts] == [0.06, 0.06]
    case = gear_case(load_case(TRAIN))
    train = plan.drive_train(pair=case.pair)
    assert train.frame.teeth == (20, 40)
    assert train.gravity == pytest.approx(9.80665)
    assert all(isinstance(one.law, ElementLaw) for one in train.bearings)
    # the middle of 5..20 um of play is 6.25 um radial; k5 takes some of it
    assert 0.0 < train.bearings[0].law.clearance < 6.25e-6  # type: ignore[attr-defined]


def test_without_shafts_there_is_no_train() -> None:
    case = gear_case(load_case(PAIR))
    assert case.train is None
    assert not [one for one in case.assumptions if one.field.startswith(("shafts", "train"))]


def test_a_default_is_told_once_with_its_reason() -> None:
    fields = [one.field for one in gear_case(load_case(TRAIN)).assumptions]
    for name in ("bearings.play", "bearings.damping", "shafts.gear_position", "train.centre_line"):
        assert fields.count(name) == 1


def test_bearings_of_every_kind() -> None:
    laws = (
        'stiffness = ["200 N/um", "100 N/um"]\ncross_stiffness = "10 N/um"',
        'ring = { load = "1000 N", deflection = "10 um", exponent = 1.5, play = "16 um" }',
        'type = "NU206E"\nplay = "20 um"\nshaft_interference = "0 um"\ndamping = "900 N s/m"',
        'inside = { bore = "25 mm", outside_diameter = "52 mm", width = "15 mm", elements = 9, '
        'element_diameter = "7.938 mm", pitch_diameter = "38.5 mm" }\nname = "own"',
    )
    text = PAIR + bare("pinion") + bare("wheel")
    for number, law in enumerate(laws):
        text += bearing(("pinion", "wheel")[number // 2], f"{10 + 100 * (number % 2)} mm", law)
    case = gear_case(load_case(text))
    assert case.train is not None
    (unusual,) = case.train.misfits()
    assert unusual.data["about"] == case.train.bearings[2].name
    built = case.train.drive_train(pair=case.pair).bearings
    linear, ring, roller, own = (one.law for one in built)
    assert isinstance(linear, LinearLaw)
    assert linear.stiffness_matrix == ((2e8, 1e7), (1e7, 1e8))
    assert isinstance(ring, RingLaw)
    assert ring.clearance == pytest.approx(8e-6)
    assert -ring.force([18e-6, 0.0])[0] == pytest.approx(1000.0)
    assert isinstance(roller, ElementLaw)
    assert roller.clearance == pytest.approx(10e-6)
    assert built[2].damping == 900.0
    assert isinstance(own, ElementLaw)
    assert own.elements == 9
    assert [one.name for one in built] == ["pinion 1", "pinion 2", "wheel 1", "own"]


def test_what_hangs_on_the_shafts() -> None:
    text = TRAIN.replace('bearings = "6205"', 'bearings = "6205"\nunbalance = "20 g mm"')
    text += 'eccentricity = "10 um"\neccentricity_angle = "90 deg"\n' + MOTOR
    text += DISC + 'outer_diameter = "80 mm"\nwidth = "10 mm"\n'
    text += '[housing]\nmass = "40 kg"\nmount_stiffness = "50 N/um"\n'
    text += '[train]\nsense = "clockwise"\ncentre_line = "90 deg"\ngravity = false\n'
    case = gear_case(load_case(text))
    assert case.train is not None
    built = case.train.drive_train(pair=case.pair)
    assert built.unbalances[0].moment == pytest.approx(20e-6)
    assert built.run_outs[0].shaft == "wheel"
    assert built.run_outs[0].angle == pytest.approx(math.pi / 2)
    assert built.motor is not None
    assert built.motor.position == 0.0
    assert built.discs[0].mass == pytest.approx(7830.0 * math.pi * 0.04**2 * 0.01, rel=0.02)
    assert built.casing is not None
    assert built.casing.stiffness == (5e7, 5e7)
    assert built.frame.sense == -1
    assert built.gravity == 0.0


def test_gear_body_is_the_ring_between_shaft_and_pitch_circle() -> None:
    case = gear_case(load_case(TRAIN))
    assert case.train is not None
    gear, body = case.pair.pinion, case.train.gears[0]
    area = math.pi * (gear.pitch_radius**2 - 0.0125**2)
    assert body.mass == pytest.approx(gear.material.density * area * 0.03)
    given = TRAIN + '[inertia]\nmodel = "given"\npinion = "0.003 kg m^2"\nwheel = "0.01 kg m^2"\n'
    assert planned(given).gears[0].polar_inertia == 0.003


def test_a_preload_is_allowed_and_told() -> None:
    text = PAIR + bare("pinion") + WHEEL
    law = 'type = "6205"\nplay = "-4 um"\nshaft_interference = "0 um"'
    text += bearing("pinion", "10 mm", law) + bearing("pinion", "110 mm")
    case = gear_case(load_case(text))
    plan = planned(text)
    (preload,) = plan.misfits()
    told = {one.name: one.value for one in facts(case) if one.group == "shafts and bearings"}
    # what is given as the play comes out under the name of ISO 5753-1, whole
    words = "6205 at 10 mm, radial internal clearance -4 um mounted and cold"
    assert told[plan.bearing_names[0]] == words
    assert told["unusual"] == preload.text
    assert preload.code == "bearing_preloaded_as_delivered"
    cold = plan.half_plays(np.full((4, 4), 293.15), reference=293.15)
    assert cold[0] == pytest.approx(-2e-6)


def _wheel(more: str) -> str:
    return PAIR + PINION + f'\n[[shafts]]\ngear = "wheel"\n{more}\n'


OVERLAP = (
    'sections = [{ length = "60 mm", diameter = "30 mm" }, { length = "60 mm", '
    'diameter = "200 mm" }]\ngear_position = "20 mm"\nbearings = "6206"'
)
BAD = {
    "gear off its shaft": (
        TRAIN.replace('bearings = "6205"', 'bearings = "6205"\ngear_position = "130 mm"'),
        "shafts[0].gear_position: got 130 mm; allowed 0..120 mm",
    ),
    "bearing off": (OWN + bearing("wheel", "150 mm"), "bearings[4].position: got 150 mm"),
    "bearing of no shaft": (OWN + bearing("idler", "5 mm"), "bearings[4].shaft: got 'idler'"),
    "disc off": (
        (TRAIN + DISC + 'outer_diameter = "80 mm"\nwidth = "10 mm"\n').replace(
            '"20 mm"', '"121 mm"'
        ),
        "discs[0].position: got 121 mm",
    ),
    "disc of no shaft": (
        (TRAIN + DISC + 'outer_diameter = "80 mm"\nwidth = "10 mm"\n').replace(
            'shaft = "wheel"', 'shaft = "x"'
        ),
        "discs[0].shaft: got 'x'",
    ),
    "motor off": (TRAIN + MOTOR + 'position = "500 mm"\n', "motor.position: got 500 mm"),
    "load off": (
        TRAIN + MOTOR.replace("motor", "load") + 'position = "500 mm"\n',
        "load.position: got 500 mm",
    ),
    "one bearing": (
        PAIR + PINION + bare("wheel") + bearing("wheel", "60 mm"),
        "bearings: got 1 bearing on the wheel's shaft; allowed two or more; the shaft could tilt",
    ),
    "none on the wheel": (PAIR + PINION + bare("wheel"), "got no bearings on the wheel's shaft"),
    "one shaft": (PAIR + PINION, "shafts: got no shaft of the wheel"),
    "a shaft twice": (TRAIN + PINION, "shafts: got 2 shafts of the pinion"),
    "no bearings": (PAIR + bare("pinion") + bare("wheel"), "bearings: got nothing"),
    "bearings alone": (PAIR + FOUR, "bearings: got one without shafts"),
    "train alone": (PAIR + '[train]\nsense = "clockwise"\n', "train: got one without shafts"),
    "motor alone": (PAIR + MOTOR, "motor: got one without shafts"),
    "thicker than the root": (
        TRAIN.replace('"25 mm"', '"58 mm"'),
        "shafts[0].diameter: got 58 mm under the gear; allowed <= 52.5 mm, the root circle",
    ),
    "through the other shaft": (
        _wheel(OVERLAP),
        "shafts[1]: got 200 mm thick beside the shaft of the pinion; allowed < 155 mm there",
    ),
    "through the other gear": (
        _wheel(OVERLAP.replace('"20 mm"', '"59 mm"').replace("200 mm", "130 mm")),
        "shafts[1]: got 130 mm thick beside the tip circle of the pinion",
    ),
    "hollow through": (
        TRAIN + 'inner_diameter = "30 mm"\n',
        "shafts[1].inner_diameter: got 30 mm; allowed < 30 mm",
    ),
    "hollow section": (
        _wheel('sections = [{ length = "1 mm", diameter = "9 mm", inner_diameter = "10 mm" }]'),
        "shafts[1].sections[0].inner_diameter: got 10 mm; allowed < 9 mm",
    ),
    "ring with preload": (
        OWN
        + bearing("wheel", "9 mm", 'ring = { load = "9 N", deflection = "1 um", play = "-3 um" }'),
        "bearings[4].ring.play: got '-3 um'; allowed 0..5000 um",
    ),
    "no unit": (TRAIN.replace('"25 mm"', "25"), "shafts[0].diameter: got 25; allowed 0.1..20000"),
    "another unit": (TRAIN.replace('"25 mm"', '"25 N"'), "'N' is no unit of length"),
    "unbalance as a mass": (TRAIN + 'unbalance = "20 g"\n', "'g' is no unit of unbalance"),
    "stiffness without unit": (
        OWN + bearing("wheel", "9 mm", 'stiffness = "200"'),
        "bearings[4].stiffness: got '200'",
    ),
    "below zero": (TRAIN.replace('"25 mm"', '"-25 mm"'), "shafts[0].diameter: got '-25 mm'"),
    "not a number": (TRAIN.replace('"25 mm"', '"nan mm"'), "shafts[0].diameter: got 'nan mm'"),
    "endless sections": (
        _wheel("sections = [" + '{ length = "1 mm", diameter = "30 mm" },' * 10000 + "]"),
        "shafts[1].sections: got 10000 entries; allowed 1..200",
    ),
    "endless bearings": (
        OWN + bearing("pinion", "20 mm") * 5000,
        "bearings: got 5004 entries; allowed 1..20",
    ),
    "endless discs": (TRAIN + DISC * 5000, "discs: got 5000 entries; allowed 1..50"),
    "two at one place": (
        OWN + bearing("pinion", "10 mm"),
        "bearings[4].position: got 10 mm; allowed another place",
    ),
    "one name twice": (
        OWN + bearing("wheel", "30 mm", 'type = "6205"\nname = "pinion 1"'),
        "name: got 'pinion 1'; allowed each name once",
    ),
    "unknown type": (TRAIN.replace('"6205"', '"6299"'), "shafts[0].bearings: got '6299'"),
    "two kinds": (
        OWN + bearing("pinion", "50 mm", 'type = "6205"\nstiffness = "200 N/um"'),
        "bearings[4]: got type and stiffness",
    ),
    "no kind": (OWN + bearing("pinion", "50 mm", ""), "bearings[4]: got neither type nor"),
    "play and class": (
        OWN + bearing("pinion", "50 mm", 'type = "6205"\nplay = "3 um"\nclearance_class = "C3"'),
        "bearings[4]: got both play and clearance_class",
    ),
    "unknown class": (
        OWN + bearing("pinion", "50 mm", 'type = "6205"\nclearance_class = "C9"'),
        "bearings[4].clearance_class: got 'C9'; allowed C2 | CN | C3 | C4",
    ),
    "class of a stiffness": (
        OWN + bearing("pinion", "50 mm", 'stiffness = "200 N/um"\nclearance_class = "C3"'),
        "bearings[4].clearance_class: got a clearance beside stiffness",
    ),
    "elements that do not fit": (
        OWN
        + bearing(
            "pinion",
            "50 mm",
            'inside = { bore = "25 mm", outside_diameter = "52 mm", width = "15 mm", elements = '
            '30, element_diameter = "7.9 mm", pitch_diameter = "38.5 mm" }',
        ),
        "bearings[4].inside.element_diameter: got 7.9 mm; allowed < 4.02435 mm",
    ),
    "a bearing that pushes": (
        OWN + bearing("pinion", "50 mm", 'stiffness = "10 N/um"\ncross_stiffness = "90 N/um"'),
        "bearings[4].stiffness",
    ),
    "position and end": (
        OWN + bearing("pinion", "50 mm", 'type = "6205"\nend = "left"'),
        "bearings[4].position: got one beside end",
    ),
    "three at the ends": (
        TRAIN.replace('"6205"', '["6205", "6205", "6206"]'),
        "shafts[0].bearings: got a list of 3; allowed 1..2 entries",
    ),
    "a number for a type": (TRAIN.replace('"6205"', "6205"), "shafts[0].bearings: got 6205"),
    "shorter than its bearing": (
        PAIR + PINION.replace("120 mm", "10 mm") + WHEEL,
        "shafts[0].bearings: got a bearing 15 mm wide on a shaft of 10 mm",
    ),
    "friction by skf of a roller": (
        OWN + bearing("pinion", "50 mm", 'type = "NU206E"\nfriction = "skf"'),
        "bearings[4].friction: got skf",
    ),
    "a seat without spring": (
        OWN + bearing("pinion", "50 mm", 'type = "6205"\nseat_mass = "1 kg"'),
        "bearings[4].seat_mass: got one without seat_stiffness",
    ),
    "sections and length": (
        TRAIN + 'sections = [{ length = "20 mm", diameter = "30 mm" }]\n',
        "shafts[1]: got sections beside a length or diameter",
    ),
    "no length": (_wheel('diameter = "30 mm"'), "shafts[1].length: got nothing"),
    "no gear": (TRAIN.replace('gear = "wheel"\n', ""), "shafts[1].gear: got nothing; needed"),
    "a table for a list": (PAIR + '[shafts]\ngear = "pinion"\n', "shafts: got a table"),
    "unknown key": (TRAIN + 'colour = "red"\n', "shafts[1].colour: got an unknown key"),
    "unknown material": (TRAIN + 'material = "cheese"\n', "shafts[1].material: got 'cheese'"),
    "half a disc": (TRAIN + DISC + 'mass = "2 kg"\n', "discs[0]: got a disc of no one kind"),
    "a disc of air": (
        TRAIN + DISC + 'outer_diameter = "8 mm"\nwidth = "9 mm"\ninner_diameter = "8 mm"\n',
        "discs[0].inner_diameter: got 8 mm",
    ),
    "a housing without feet": (
        TRAIN + '[housing]\nmass = "40 kg"\n',
        "housing.mount_stiffness: got nothing",
    ),
    "unknown sense": (TRAIN + '[train]\nsense = "up"\n', "train.sense: got 'up'"),
    "unknown damping": (TRAIN + '[train]\ndamping = "much"\n', "train.damping: got 'much'"),
    "motor without inertia": (
        TRAIN + MOTOR.replace('inertia = "0.02 kg m^2"\n', ""),
        "motor.inertia: got nothing; needed",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_one_line(name: str) -> None:
    text, said = BAD[name]
    with pytest.raises(InputError) as error:
        load_case(text)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_a_complaint_names_the_line_of_its_own_table() -> None:
    text = TRAIN.replace('"30 mm"\nbearings', "30\nbearings")
    with pytest.raises(InputError) as error:
        load_case(text)
    assert text.splitlines()[(error.value.line or 0) - 1] == "diameter = 30"


@pytest.mark.parametrize("seed", range(40))
def test_random_trains_load_and_build(seed: int) -> None:
    case: GearCase = gear_case(load_case(random_train(np.random.default_rng(seed))))
    assert case.train is not None
    train = case.train.drive_train(pair=case.pair)
    assert len(train.bearings) == len(case.train.bearings)
    for shaft, body in zip(train.shafts, train.gears, strict=True):
        assert 0.0 <= shaft.gear_position <= shaft.length
        assert body.mass > 0.0
        assert body.diametral_inertia > 0.5 * body.polar_inertia
    for one in train.bearings:
        held = -np.asarray(one.law.force([40e-6, 0.0]))[0]
        assert held > 0.0
        assert one.damping >= 0.0
