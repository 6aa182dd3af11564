"""Temperatures left out of a case are computed; what is given still holds."""

from __future__ import annotations

import re

import numpy as np
import pytest
import xarray as xr

from coded import coded
from thermogear.base.errors import InputError
from thermogear.base.materials import ZERO_CELSIUS
from thermogear.base.units import RPM
from thermogear.base.vocabulary import STATUS, STILL
from thermogear.case.case import GearCase, load_case
from thermogear.case.derived import facts
from thermogear.case.examples import example_text
from thermogear.case.family import Tabulated, family
from thermogear.case.one_point import of_case
from thermogear.heat.gearbox import Surroundings
from thermogear.heat.measured_temperature import InfraredReading
from thermogear.mesh.balance import Gearbox, heat_balance
from thermogear.study.live import mesh
from thermogear.study.run import balances, carried_uncertainty, run
from thermogear.study.sweep import sweep
from thermogear.views.plots.live import told_mesh

GIVEN = r"^(pinion_addendum|wheel_addendum|\w+_below_addendum) = .*\n"
SMALL = [
    "grid.path_positions=31",
    "grid.mesh_positions=64",
    "simulation.periods=16",
    "simulation.samples=32",
    'operating.speed=["1000 rpm", "2000 rpm"]',
    'model.bundle="consistent"',
    'temperatures.row="100 degC"',
    'draw.pictures=["path","motion","temperature"]',
]


def text() -> str:
    """The rig with every temperature left out that may be."""
    return re.sub(GIVEN, "", example_text("rig"), flags=re.MULTILINE)


def left_out(*changes: str) -> GearCase:
    case = load_case(text(), [*SMALL, *changes])
    assert isinstance(case, GearCase)
    return case


@pytest.fixture(scope="module")
def tree() -> xr.DataTree:
    return run(left_out())


def test_left_out_temperatures_are_those_of_the_heat_balance(tree: xr.DataTree) -> None:
    case = left_out()
    found = heat_balance(
        case.pair,
        case.stated.speed,
        case.stated.torque,
        case.stated.lubricant,
        case.cold_backlash.half,
        case.models[0],
        gearbox=Gearbox(surroundings=Surroundings(housing_coefficient_at=None)),
    )
    balance = tree["balance"].isel(bundle=0)
    np.testing.assert_allclose(
        balance["node_temperature"].sel(node="oil").values, found.steady["oil"], atol=1e-5
    )
    assert np.all(balance["status"].values == STATUS.index("ok"))
    assert np.all(balance["residual"].values <= 1e-6)
    # every loss leaves into the ambient
    np.testing.assert_allclose(
        balance["loss"].sum("loss_kind").values, balance["heat_to_ambient"].values, rtol=1e-9
    )
    tip = tree["path"]["pinion_body_temperature"].sel(state="hot").isel(bundle=0, path_position=-1)
    np.testing.assert_allclose(
        tip.values, balance["node_temperature"].sel(node="pinion_tooth").values, atol=1e-5
    )
    assert "temperatures_computed" in coded(str(tree.attrs["notices"]))


def test_the_row_of_gear_temperatures_holds_the_teeth_alone(tree: xr.DataTree) -> None:
    warm = left_out('temperatures.follow="fixed"').operating_at(400.0)
    np.testing.assert_allclose(warm.temperatures.pinion_addendum, 400.0)
    np.testing.assert_allclose(warm.temperatures.wheel_addendum, 400.0)
    assert np.all(np.asarray(warm.temperatures.housing) < 400.0)
    assert tree["temperature"].sizes["gear_temperature"] == 1


def test_computed_temperatures_follow_the_gears_in_proportion() -> None:
    case = left_out()
    base = case.operating.temperatures.reference
    drawn = case.operating_at(base)
    assert all(np.all(body == base) for body in drawn.temperatures.bodies.values())
    assert np.all(drawn.oil_temperature == base)
    hot, warm = case.operating, case.operating_at(400.0)
    mean = 0.5 * (hot.temperatures.pinion_addendum + hot.temperatures.wheel_addendum) - base  # type: ignore[operator]
    assert np.ptp(mean) > 0.0  # each operating point has a balance of its own
    np.testing.assert_allclose(
        (warm.temperatures.housing - base) / (400.0 - base),  # type: ignore[operator]
        (hot.temperatures.housing - base) / mean,  # type: ignore[operator]
        rtol=1e-12,
    )


def test_what_is_given_outright_holds_its_node() -> None:
    case = left_out('temperatures.housing="55 degC"', 'oil.temperature="80 degC"')
    hot = case.operating
    np.testing.assert_allclose(hot.temperatures.housing, ZERO_CELSIUS + 55.0)
    np.testing.assert_allclose(hot.oil_temperature, ZERO_CELSIUS + 80.0)
    # the mesh warms the teeth above a mean of the oil and the cooler shafts and housing
    pinion, bore = (
        np.asarray(getattr(hot.temperatures, f"pinion_{n}")) for n in ("addendum", "bore")
    )
    assert np.all((pinion > bore) & (bore > ZERO_CELSIUS + 55.0))
    (held,) = (fact for fact in facts(case) if fact.name.startswith("oil is"))
    assert held.unit == "degC"


def test_a_corrected_reading_holds_its_node_and_keeps_its_uncertainty() -> None:
    reading = (
        'gearbox.readings.pinion_tooth={kind="infrared", indicated="120 degC", '
        'indicated_uncertainty="1 K", emissivity=0.9, emissivity_uncertainty=0.03, '
        'surroundings="40 degC", wavelengths=["8 um", "14 um"]}'
    )
    case = left_out(reading)
    expected = InfraredReading(
        indicated=ZERO_CELSIUS + 120.0,
        emissivity=0.9,
        surroundings=ZERO_CELSIUS + 40.0,
        band=(8e-6, 14e-6),
        u_indicated=1.0,
        u_emissivity=0.03,
    )
    (one,) = case.readings
    assert one.temperature == pytest.approx(expected.temperature(), abs=1e-9)
    assert one.uncertainty == pytest.approx(expected.uncertainty(), rel=1e-9)
    np.testing.assert_allclose(case.operating.temperatures.pinion_addendum, one.temperature)


def test_an_uncertain_reading_makes_an_uncertain_backlash() -> None:
    def found(*readings: str) -> tuple[GearCase, np.ndarray]:
        case = left_out(*readings, 'operating.speed="1000 rpm"')
        return case, carried_uncertainty(case)

    def reading(node: str, sigma: str) -> str:
        return (
            f'gearbox.readings.{node}={{kind="thermocouple", indicated="100 degC", depth="0 mm", '
            f'flux="0 kW/m^2", indicated_uncertainty="{sigma}"}}'
        )

    _, one = found(reading("housing", "1 K"))
    # a housing 1 K warmer opens the mesh by lambda a_w sin(alpha_w); the gears follow a little
    axes = 11.5e-6 * 0.25 * np.sin(np.radians(20.0))
    assert 0.0 < one[0] < axes
    _, two = found(reading("housing", "2 K"))
    np.testing.assert_allclose(two, 2.0 * one, rtol=0.02)
    _, tooth = found(reading("pinion_tooth", "1 K"))
    _, both = found(reading("housing", "1 K"), reading("pinion_tooth", "1 K"))
    assert max(one[0], tooth[0]) > 0.0
    assert both[0] > 0.0
    case, none = found(reading("housing", "0 K"))
    np.testing.assert_array_equal(none, 0.0)
    assert "half_backlash_uncertainty" in balances(case)


def test_an_embedded_thermocouple_is_carried_to_the_surface() -> None:
    reading = 'gearbox.readings.wheel_tooth={kind="thermocouple", indicated="90 degC", '
    case = left_out(reading + 'depth="2 mm", flux="46 kW/m^2"}')
    # q d/k = 46e3 * 2e-3 / 46
    assert case.readings[0].temperature == pytest.approx(ZERO_CELSIUS + 92.0, abs=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            'temperatures.pinion_addendum="100 degC"',
            "temperatures.wheel_addendum: got nothing; needed beside pinion_addendum; write "
            'wheel_addendum = "100 degC", or leave both out to have the heat balance compute them',
        ),
        (
            'temperatures.housing_below_addendum="40 K"',
            "temperatures.housing_below_addendum: got a distance from an addendum temperature that "
            "is not given; with both addenda left out the heat balance computes the temperatures; "
            "leave it out, or give both addenda",
        ),
        (
            'gearbox.measured.oi="80 degC"',
            "gearbox.measured.oi: got an unknown key; [gearbox.measured] does not have it; did you "
            "mean 'oil'?",
        ),
        (
            'gearbox.housing_coefficient="15 W/m^2"',
            "gearbox.housing_coefficient: got '15 W/m^2'; allowed 0.1..10000 W/(m^2 K); 'W/m^2' is "
            'no unit of heat transfer coefficient; write for instance "15 W/(m^2 K)"',
        ),
        (
            'gearbox.readings.oil={kind="infrared", indicated="80 degC"}',
            "gearbox.readings.oil.emissivity: got nothing; the correction of a reading of kind "
            "infrared needs it",
        ),
        (
            'gearbox.readings.oil={kind="thermocouple", indicated="80 degC", emissivity=0.9}',
            "gearbox.readings.oil.emissivity: got a value of no use to a reading of kind "
            "thermocouple; allowed depth | depth_uncertainty | flux | flux_uncertainty; leave it "
            "out",
        ),
        (
            'gearbox.readings.oil={kind="infrared", indicated="20 degC", emissivity=0.1, '
            'surroundings="90 degC"}',
            "gearbox.readings.oil: got infrared reading 293.15 K; reflections and the window alone "
            "are brighter than the reading; check emissivity, transmission and the surroundings' "
            "temperature",
        ),
    ],
)
def test_what_cannot_be_is_one_line(change: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        left_out(change)
    assert str(caught.value) == message


def test_a_node_is_held_once() -> None:
    for change in (
        'oil.temperature="70 degC"',
        'gearbox.readings.oil={kind="thermocouple", indicated="80 degC", depth="0 mm", '
        'flux="0 kW/m^2"}',
    ):
        with pytest.raises(InputError, match="one of the two"):
            left_out('gearbox.measured.oil="80 degC"', change)


def test_without_a_gearbox_its_values_are_assumptions() -> None:
    bare = re.sub(r"\[gearbox\]\n(?:\w+ = .*\n)+", "", text())
    bare = re.sub(r'^"gearbox\..*\n', "", bare, flags=re.MULTILINE)
    fields = {a.field: a for a in load_case(bare).assumptions}
    assert "default" in fields["gearbox.housing_coefficient"].reason
    given = re.sub(r"\[gearbox\]\n(?:\w+ = .*\n)+", "", example_text("rig"))
    given = re.sub(r'^"gearbox\..*\n', "", given, flags=re.MULTILINE)
    assert not any(a.field.startswith("gearbox") for a in load_case(given).assumptions)


@pytest.mark.filterwarnings("ignore::thermogear.base.errors.ValidityWarning")
def test_a_point_without_a_steady_temperature_is_a_status_without_motion() -> None:
    hopeless = run(
        left_out(
            'operating.speed=["300 rpm", "6000 rpm"]',
            'operating.torque=["20 N m", "5000 N m"]',
            'gearbox.housing_coefficient="1 W/(m^2 K)"',
            'gearbox.housing_area="0.1 m^2"',
            'draw.pictures=["path","motion"]',
        )
    )
    status = hopeless["mesh"]["status"].sel(state="hot").isel(bundle=0).values
    lost = STATUS.index("heat_not_settled")
    assert status[-1] == lost
    assert status[0] != lost
    motion = hopeless["motion"].sel(state="hot").isel(bundle=0, operating=-1)
    assert str(motion["label"].values) == STATUS[lost].replace("_", " ")
    assert int(motion["status"]) == lost
    (told,) = coded(str(hopeless.attrs["notices"]))["heat_not_settled"]
    assert told["lost"] == int((status == lost).sum())


@pytest.mark.filterwarnings("ignore::thermogear.base.errors.ValidityWarning")
def test_jammed_means_no_gap_left_and_heat_that_does_not_settle_is_a_status_of_its_own() -> None:
    """Of diagrams, maps, sweeps and run-ups; temperatures that are given need no steady state."""
    case = left_out(
        'operating.speed=["10000 rpm"]', 'operating.torque=["1000 N m"]',
        'backlash.value="0.07 mm"',
    )  # fmt: skip
    assert not case.balance(case.models[0]).settled[0]
    slow_and_fast = RPM * np.array([[100.0], [10000.0]])
    words = [
        [
            STATUS[code]
            for code in family(case, ("pinion_speed",), state=state)(slow_and_fast).status
        ]
        for state in ("hot", "computed", "undeformed", 273.15 + 134.0)
    ]
    assert words[0] == words[1] == ["ok", "heat_not_settled"]
    assert words[2] == words[3] == ["ok", "ok"]
    # a table of both has at its points their own status, between them the worse one
    table = Tabulated.of(family(case, ("pinion_speed",)), slow_and_fast[:, 0])
    there = np.append(slow_and_fast, [slow_and_fast.mean(axis=0)], axis=0)
    assert [STATUS[code] for code in table(there).status] == [*words[0], words[0][1]]

    hot = np.linspace(300.0, 700.0, 4)
    want = ("half_backlash", "proportional_jam_temperature")
    places = np.array([[speed, kelvin] for speed in slow_and_fast[:, 0] for kelvin in hot])
    over = family(case, ("pinion_speed", "gear_temperature"))
    rows, hot = over.quasi_static(places, want), places[:, 1]
    jammed = rows["status"] == STATUS.index("jammed")
    statuses = {STATUS[code] for code in rows["status"].tolist()}
    assert statuses == {"ok", "jammed", "no_oil_bath"}
    assert np.array_equal(jammed, rows["half_backlash"] <= 0.0)
    assert np.array_equal(jammed, rows["proportional_jam_temperature"] <= hot)
    with pytest.raises(InputError) as refused:
        of_case(case)
    assert str(refused.value) == (
        "operating: got heat not settled (hot); the heat balance did not settle; choose another "
        "operating point, or give temperatures"
    )
    assert of_case(case, state=273.15 + 134.0).points.status.tolist() == [0]
    swept = sweep(case, {"pinion_speed": slow_and_fast[:, 0]})
    assert coded(swept.notices)["points_heat_not_settled"] == [{"count": 1, "points": 2}]
    labels = swept.to_frame()["label"]
    assert labels.tolist() == ["periodic", "heat_not_settled"]
    assert told_mesh(mesh(case))[1].removeprefix("hot: ") == STILL["heat_not_settled"]


COLD_DAY = (
    'gearbox.ambient="-40 degC"',
    'temperatures.reference="-50 degC"',
    'temperatures.row="60 degC"',
    'operating.speed=["10 rpm", "2000 rpm"]',
    'operating.torque="150 N m"',
)


def test_a_point_beyond_a_law_costs_no_other_point() -> None:
    """Oil at -40 C in a pair that hardly turns: nan and a status; the other point bit for bit."""
    both = run(left_out(*COLD_DAY))
    # the mesh alone is asked of the other
    alone = run(left_out(*COLD_DAY, "operating.speed=2000 rpm", 'draw.pictures=["path"]'))
    lost = STATUS.index("heat_not_settled")
    mesh, path, balance = (both[name].isel(bundle=0) for name in ("mesh", "path", "balance"))
    assert mesh["status"].sel(state="hot").values.tolist() == [lost, STATUS.index("ok")]
    assert balance["status"].values.tolist() == [lost, STATUS.index("ok")]
    for name in ("mean_stiffness", "half_backlash", "frictional_power", "mesh_efficiency"):
        values = mesh[name].sel(state="hot").values
        assert np.isnan(values[0])
        assert values[1] == float(alone["mesh"][name].isel(bundle=0).sel(state="hot")[0])
    # cold, the teeth are as stiff as they are; what needs an oil is not known
    cold = mesh.sel(state="undeformed")
    assert np.all(np.isfinite(cold["mean_stiffness"].values))
    assert np.isnan(path["film_thickness"].isel(state=0, operating=0).values).all()
    assert path["regime"].sel(state="hot").isel(operating=0).values.tolist() == [-1] * 31
    node = alone["balance"]["node_temperature"].isel(bundle=0, operating=0)
    np.testing.assert_array_equal(balance["node_temperature"].isel(operating=1), node)
    motion = both["motion"].isel(bundle=0).sel(state="hot")
    assert motion["label"].values[0] == STATUS[lost].replace("_", " ")
    assert both["temperature"]["status"].isel(bundle=0).values[0].tolist()[0] == lost
    (told,) = coded(str(both.attrs["notices"]))["heat_not_settled"]
    assert {reason.partition(":")[0] for reason in told["reasons"]} == {"prandtl"}
    assert "nan" not in str(both.attrs["notices"])


def test_two_steady_states_are_said_in_words() -> None:
    case = left_out(
        'operating.speed=["1000 rpm", "4085 rpm"]',
        'operating.torque="20 N m"',
        'model.friction="benedict-kelley"',
        'model.inlet="oil"',
        'draw.pictures=["path"]',
    )
    tree = run(case)
    several = tree["balance"]["several"].isel(bundle=0).values.tolist()
    assert several == [0, 1]
    hot = tree["balance"]["hot_node_temperature"] - tree["balance"]["node_temperature"]
    assert float(hot.isel(bundle=0, operating=1).sel(node="oil")) > 5.0
    (told,) = coded(str(tree.attrs["notices"]))["second_steady_state"]
    assert (told["several"], told["points"]) == (1, 2)
    assert told["hotter"] == float(hot.isel(bundle=0, operating=1).sel(node="oil"))
