"""Shafts and bearings in the case file: what is built from it, and what is refused in one line."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scripts import script

from thermogear.base.errors import InputError
from thermogear.case.axes import parse_axis
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.new import NewCase
from thermogear.case.shaft_plan import TrainPlan
from thermogear.shafts.assembly import assemble
from thermogear.shafts.bearings.laws import ElementLaw, LinearLaw, RingLaw

PAIR = """
[gears]
module = "3 mm"
face_width = "28 mm"
[gears.pinion]
teeth = 23
[gears.wheel]
teeth = 47
[oil]
name = "ISO VG 100"
temperature = "60 degC"
[temperatures]
pinion_addendum = "80 degC"
pinion_bore = "70 degC"
wheel_addendum = "75 degC"
wheel_bore = "65 degC"
housing = "55 degC"
[operating]
speed = "1500 rpm"
torque = "80 N m"
"""
SHAFTS = """
[[shafts]]
gear = "pinion"
length = "150 mm"
diameter = "30 mm"
bearings = "6206"
[[shafts]]
gear = "wheel"
sections = [{ length = "60 mm", diameter = "40 mm" }, { length = "90 mm", diameter = "45 mm" }]
bearings = ["6208", "6208"]
"""


def read(more: str = SHAFTS, pair: str = PAIR) -> GearCase:
    return gear_case(load_case(pair + more))


def plan(more: str = SHAFTS) -> TrainPlan:
    found = read(more).train
    assert found is not None
    return found


def test_a_case_without_shafts_is_what_it_was() -> None:
    case = read("")
    assert case.train is None
    assert not [a for a in case.assumptions if a.field.split(".")[0] in ("shafts", "train")]


def test_ten_lines_make_a_train_of_two_shafts_and_four_bearings() -> None:
    found = plan()
    assert [one.shaft for one in found.bearings] == ["pinion"] * 2 + ["wheel"] * 2
    assert [one.position for one in found.bearings] == pytest.approx([0.008, 0.142, 0.009, 0.141])
    assert found.shafts[0].gear_position == pytest.approx(0.075)
    assert found.shafts[1].length == pytest.approx(0.15)
    parts = assemble(found.drive_train(pair=read().pair))
    assert parts.size == sum(5 * nodes.size for nodes in parts.nodes)
    body = found.gears[0]
    radius = 0.5 * 23 * 3e-3
    mass = 7850.0 * math.pi * (radius**2 - 0.015**2) * 0.028
    assert body.mass == pytest.approx(mass, rel=5e-3)
    assert body.polar_inertia == pytest.approx(0.5 * mass * (radius**2 + 0.015**2), rel=5e-3)


def test_every_kind_of_bearing_becomes_its_law() -> None:
    found = plan("""
[[shafts]]
gear = "pinion"
length = "150 mm"
diameter = "30 mm"
[[shafts]]
gear = "wheel"
length = "150 mm"
diameter = "40 mm"
[[bearings]]
shaft = "pinion"
position = "10 mm"
stiffness = ["200 N/um", "150 N/um"]
cross_stiffness = "10 N/um"
damping = "700 N s/m"
[[bearings]]
shaft = "pinion"
position = "140 mm"
ring = { load = "1000 N", deflection = "15 um", exponent = 1.5, play = "16 um" }
[[bearings]]
shaft = "wheel"
position = "10 mm"
type = "NU206"
play = "-10 um"
shaft_interference = "0 um"
seat_stiffness = "300 N/um"
[[bearings]]
shaft = "wheel"
position = "140 mm"
[bearings.inside]
bore = "40 mm"
outside_diameter = "80 mm"
width = "18 mm"
elements = 9
element_diameter = "12 mm"
pitch_diameter = "60 mm"
""")
    train = found.drive_train(pair=read().pair)
    laws = [one.law for one in train.bearings]
    assert laws[0] == LinearLaw(stiffness_matrix=((2e8, 1e7), (1e7, 1.5e8)))
    assert train.bearings[0].damping == 700.0
    assert isinstance(laws[1], RingLaw)
    assert laws[1].clearance == pytest.approx(8e-6)
    assert float(laws[1].force([23e-6, 0.0])[0]) == pytest.approx(-1000.0)
    assert isinstance(laws[2], ElementLaw)
    assert laws[2].clearance == pytest.approx(-5e-6, abs=1e-12)
    assert isinstance(laws[3], ElementLaw)
    seat = train.bearings[2].seat
    assert seat is not None
    assert seat.stiffness == (3e8, 3e8)
    ring = 0.25 * math.pi * (0.062**2 - 0.0555**2) * 0.016
    assert seat.mass == pytest.approx(7800.0 * ring)
    assert found.heat(read().pair, coefficient=0.0015) is not None


def test_clearances_follow_temperatures_and_fits() -> None:
    found = plan()
    cold = np.full((4, 4), 293.15)
    even = found.half_plays(cold, reference=293.15)
    hot = cold.copy()
    hot[:, 0] += 15.0
    hot[:, 1] += 8.0
    warm = found.half_plays(hot, reference=293.15)
    assert np.all(warm < even)
    uniform = found.half_plays(cold + 40.0, reference=293.15)
    # the interference keeps the ring wide, so that only the free part scales
    assert uniform == pytest.approx(even, abs=0.02e-6)


@pytest.mark.parametrize("of", ["bearings.all.play", "bearings[2].play"])
def test_the_play_of_a_bearing_is_set_and_varied(of: str) -> None:
    """Mounting and heat take the same from every play: half the play rises by half of it."""
    case = read()
    name, plays = parse_axis(case, f"{of}=0 um:50 um:6")
    assert plays == pytest.approx(1e-6 * np.arange(0.0, 60.0, 10.0))
    cold = np.full((4, 4), 293.15)
    plans = [case.with_values({name: play}).train for play in plays]
    assert all(one is not None for one in plans)
    halves = np.array([one.half_plays(cold, reference=293.15) for one in plans if one is not None])
    moved = [True] * 4 if "all" in of else [False, False, True, False]
    assert halves - halves[0] == pytest.approx(np.outer(0.5 * plays, moved), abs=1e-15)
    same = load_case(PAIR + SHAFTS, [f"{of}=50 um"])
    assert gear_case(same).train == plans[-1]


def test_the_train_of_the_rig_lies_within_what_is_assumed_of_it() -> None:
    """Gears, oil and heat are the rig's; of the train every size is within its stated range."""
    case, rig = gear_case(load_case("rig-train")), gear_case(load_case("rig"))
    own, known = case.data, rig.data
    for table, names in {"gears": ("module", "pressure_angle"), "oil": ("name",)}.items():
        assert [own[table][name] for name in names] == [known[table][name] for name in names]
    assert [case.pair.pinion.teeth, case.pair.wheel.teeth] == [25, 75]
    assert case.cold_backlash.half == pytest.approx(rig.cold_backlash.half, rel=1e-12)
    assert case.pair.face_width == pytest.approx(rig.pair.face_width, rel=1e-12)
    train = case.train
    assert train is not None
    assert train.motor is not None
    assert train.load is not None
    assert train.casing is not None
    left = [one for one in train.bearings if one.name.endswith("left")]
    right = [one for one in train.bearings if one.name.endswith("right")]
    seats = [one.seat for one in train.bearings if one.seat is not None]
    assert len(seats) == 4
    casing = train.casing
    found = {
        "torque": case.torques,
        "play": [1e6 * one.play for one in train.bearings],
        "span": [1e3 * (b.position - a.position) for a, b in zip(left, right, strict=True)],
        "bearing_damping": [one.damping for one in train.bearings],
        "seat_stiffness": [1e-6 * k for one in seats for k in one.stiffness],
        "seat_mass": [one.mass for one in seats],
        "seat_loss": [1e6 * one.damping / one.stiffness[0] for one in seats],
        "motor_inertia": [train.motor.inertia],
        "brake_inertia": [train.load.inertia],
        "coupling": [train.motor.stiffness, train.load.stiffness],
        "housing_mass": [casing.mass],
        "mount_stiffness": [1e-6 * casing.stiffness[0]],
    }
    ranges = {one.name: (one.low, one.high) for one in script("trials/rig_samples").ASSUMED}
    for name, values in found.items():
        low, high = ranges[name]
        assert all(low <= float(value or 0.0) <= high for value in values), name


def test_temperatures_of_rings_come_from_given_computed_or_bodies() -> None:
    case = read(
        SHAFTS
        + """
[[bearings]]
shaft = "pinion"
position = "40 mm"
type = "6206"
inner_temperature = "90 degC"
outer_temperature = "72 degC"
"""
    )
    found = case.train
    assert found is not None
    warm = found.bearing_temperatures(case.operating, None)
    place = found.bearing_names.index("pinion 1")
    assert warm[0, place] == pytest.approx([363.15, 354.15, 345.15, 328.15])
    assert warm[0, -1] == pytest.approx([338.15, 333.15, 328.15, 328.15])
    drawn = found.bearing_temperatures(case.operating.as_drawn(), None)
    assert drawn == pytest.approx(np.full_like(drawn, 293.15))


def test_the_heat_balance_has_the_bearings_as_nodes() -> None:
    text = PAIR[: PAIR.index('temperature = "60')] + PAIR[PAIR.index("[operating]") :]
    case = read(pair=text)
    balance = case.balance(case.models[0])
    nodes = balance.steady.temperatures
    assert {"pinion_bearing_1_inner", "wheel_bearing_2_outer"} <= set(nodes)
    assert set(balance.losses.bearings) == {
        f"{shaft}_bearing_{n}" for shaft in ("pinion", "wheel") for n in (1, 2)
    }
    assert case.train is not None
    warm = case.train.bearing_temperatures(case.operating, balance)[0]
    assert np.all(warm[:, 0] > warm[:, 2])


@pytest.mark.parametrize(
    ("old", "new", "field", "words"),
    [
        ('gear = "wheel"', 'gear = "pinion"', "shafts", "2 shafts of the pinion"),
        ('gear = "wheel"', 'gear = "weel"', "shafts[1].gear", "did you mean 'wheel'"),
        ('length = "150 mm"', "length = 150", "shafts[0].length", "unit"),
        ('length = "150 mm"', 'length = "0 mm"', "shafts[0].length", "0.1"),
        ('diameter = "30 mm"', 'diameter = "64 mm"', "shafts[0].diameter", "root circle"),
        ('bearings = "6206"', "", "bearings", "no bearings on the pinion's shaft"),
        ('bearings = "6206"', 'bearings = "6260"', "shafts[0].bearings", "6206"),
        (
            'diameter = "30 mm"',
            'diameter = "30 mm"\ninner_diameter = "30 mm"',
            "shafts[0].inner_diameter",
            "outer diameter",
        ),
        (
            'bearings = "6206"',
            'bearings = "6206"\ngear_position = "200 mm"',
            "shafts[0].gear_position",
            "0..150 mm",
        ),
        ('length = "150 mm"', "", "shafts[0].length", "sections"),
        (
            'length = "150 mm"',
            'length = "150 mm"\nsections = [{ length = "1 mm", diameter = "1 mm" }]',
            "shafts[0]",
            "leave one out",
        ),
        (
            'bearings = "6206"',
            'bearings = "6206"\nmaterial = "stell"',
            "shafts[0].material",
            "steel",
        ),
    ],
)
def test_impossible_shafts_are_one_line(old: str, new: str, field: str, words: str) -> None:
    assert old in SHAFTS
    with pytest.raises(InputError) as caught:
        read(SHAFTS.replace(old, new, 1))
    assert caught.value.field == field
    told = str(caught.value).splitlines()[0]
    assert words in told


BAD = {
    'shaft = "pinion"\nposition = "400 mm"\ntype = "6206"': "bearings[0].position",
    'shaft = "pinion"\nposition = "8 mm"\ntype = "6206"': "bearings[0].position",
    'shaft = "pinion"\nposition = "40 mm"': "bearings[0]",
    'shaft = "pinion"\nposition = "40 mm"\ntype = "6206"\nstiffness = "1 N/um"': "bearings[0]",
    'shaft = "pinion"\ntype = "6206"': "bearings[0].position",
    'shaft = "third"\nposition = "40 mm"\ntype = "6206"': "bearings[0].shaft",
    'shaft = "pinion"\nposition = "40 mm"\nstiffness = "2"': "bearings[0].stiffness",
    'shaft = "pinion"\nposition = "40 mm"\nstiffness = "-1 N/um"': "bearings[0].stiffness",
    'shaft = "pinion"\nposition = "40 mm"\nstiffness = "1 N/um"\ncross_stiffness = "5 N/um"':
        "bearings[0].stiffness",
    'shaft = "pinion"\nposition = "40 mm"\nstiffness = "1 N/um"\nplay = "1 um"':
        "bearings[0].play",
    'shaft = "pinion"\nposition = "40 mm"\n'
    'ring = { load = "1 N", deflection = "1 um", play = "-1 um" }':
        "bearings[0].ring.play",
    'shaft = "pinion"\nposition = "40 mm"\ntype = "NU206E"\nfriction = "skf"':
        "bearings[0].friction",
    'shaft = "pinion"\nposition = "40 mm"\ntype = "6206"\nseat_mass = "1 kg"':
        "bearings[0].seat_mass",
    'shaft = "pinion"\nposition = "40 mm"\ntype = "6206"\nplay = "5 um"\nclearance_class = "C3"':
        "bearings[0]",
}  # fmt: skip


@pytest.mark.parametrize("table", BAD)
def test_impossible_bearings_are_one_line(table: str) -> None:
    with pytest.raises(InputError) as caught:
        read(f"{SHAFTS}\n[[bearings]]\n{table}\n")
    assert caught.value.field == BAD[table]
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("more", "field"),
    [
        ('[[discs]]\nshaft = "pinion"\nposition = "400 mm"\nouter_diameter = "80 mm"\n'
         'width = "9 mm"',
         "discs[0].position"),
        ('[[discs]]\nshaft = "pinion"\nposition = "40 mm"\nmass = "1 kg"', "discs[0]"),
        ('[motor]\ninertia = "0.1 kg m^2"', "motor.coupling_stiffness"),
        ('[motor]\ninertia = "0.1 kg m^2"\ncoupling_stiffness = "9 N m/rad"\nposition = "1 m"',
         "motor.position"),
        ('[motor]\ninertia = "0.1 kg m^2"\ncoupling_stiffness = "9 N m/rad"\n[motor.plate]\n'
         'rated_torque = "49 N m"\nrated_speed = "2954 rpm"\npole_pairs = 2',
         "motor.plate.rated_speed"),
        ('[motor]\ninertia = "0.1 kg m^2"\ncoupling_stiffness = "9 N m/rad"\nlag = "1 s"\n'
         '[motor.plate]\nrated_torque = "49 N m"\nrated_speed = "1454 rpm"\npole_pairs = 2',
         "motor.plate"),
        ('[housing]\nmass = "40 kg"', "housing.mount_stiffness"),
        ('[train]\nsense = "left"', "train.sense"),
        ('[train]\ncentre_lime = "1 deg"', "train.centre_lime"),
    ],
)  # fmt: skip
def test_what_hangs_on_the_shafts_is_checked(more: str, field: str) -> None:
    with pytest.raises(InputError) as caught:
        read(f"{SHAFTS}\n{more}\n")
    assert caught.value.field == field


def test_bearings_without_shafts_and_endless_lists_are_refused() -> None:
    with pytest.raises(InputError, match="without shafts"):
        read('[[bearings]]\nshaft = "pinion"\nposition = "1 mm"\ntype = "6206"\n')
    many = ", ".join(['{ length = "1 mm", diameter = "30 mm" }'] * 10_000)
    endless = SHAFTS.replace('length = "150 mm"\ndiameter = "30 mm"', f"sections = [{many}]", 1)
    with pytest.raises(InputError, match="10000 entries"):
        read(endless)


def test_a_preload_is_allowed() -> None:
    found = plan(
        SHAFTS
        + '[[bearings]]\nshaft = "wheel"\nposition = "50 mm"\ntype = "6208"\nplay = "-8 um"\n'
    )
    train = found.drive_train(pair=read().pair)
    law = train.bearings[0].law
    assert isinstance(law, ElementLaw)
    assert law.clearance < -4e-6


def test_defaults_of_all_bearings_are_told_once() -> None:
    fields = [one.field for one in read().assumptions]
    assert fields.count("bearings.shaft_interference") == 1
    assert "train.damping" in fields


@pytest.mark.parametrize(
    ("teeth", "module", "torque"),
    [
        ((20, 40), "3 mm", "80 N m"),
        ((31, 44), "1.5 mm", "9 N m"),
        ((25, 75), "5 mm", "100 N m"),
        ((60, 120), "4 mm", "1800 N m"),
    ],
)
def test_new_writes_shafts_that_work(teeth: tuple[int, int], module: str, torque: str) -> None:
    made = NewCase(
        teeth=teeth, module=module, face_width="20 mm", speed="3000 rpm", torque=torque, shafts=True
    ).text()
    plain = NewCase(
        teeth=teeth, module=module, face_width="20 mm", speed="3000 rpm", torque=torque
    ).text()
    added = [line for line in made.splitlines() if line.strip()]
    assert len(added) - len([line for line in plain.splitlines() if line.strip()]) == 10
    found = gear_case(load_case(made)).train
    assert found is not None
    assert len(found.bearings) == 4
    moments = [float(torque.split()[0]) * z / teeth[0] for z in teeth for _ in range(2)]
    for one, moment in zip(found.bearings, moments, strict=True):
        assert one.rolling is not None
        stress = 16.0 * moment / (math.pi * one.rolling.bore**3)
        assert stress <= 20e6
        assert one.rolling.bore <= 0.1


def test_new_says_where_its_bearings_end() -> None:
    with pytest.raises(InputError, match="largest ready bearing"):
        NewCase(
            teeth=(40, 80), module="8 mm", face_width="80 mm", speed="900 rpm", torque="4000 N m",
            shafts=True,
        ).text()  # fmt: skip


def test_random_trains_load_and_assemble() -> None:
    rng = np.random.default_rng(61)
    for _ in range(20):
        bore = rng.choice([20, 25, 30])
        kinds = {20: ["6204", "NU204E"], 25: ["6205", "6305"], 30: ["6206", "6306", "NU206E"]}
        text = ""
        for gear in ("pinion", "wheel"):
            length = rng.uniform(90, 200)
            pieces = rng.dirichlet(np.ones(int(rng.integers(1, 5)))) * length + 1.0
            sections = ", ".join(
                f'{{ length = "{p:.4f} mm", diameter = "{bore} mm" }}' for p in pieces
            )
            text += f"""
[[shafts]]
gear = "{gear}"
sections = [{sections}]
bearings = "{rng.choice(kinds[int(bore)])}"
gear_position = "{rng.uniform(0.3, 0.7) * pieces.sum():.3f} mm"
"""
        case = read(text)
        assert case.train is not None
        parts = assemble(case.train.drive_train(pair=case.pair))
        assert np.all(np.linalg.eigvalsh(parts.mass) > 0.0)
