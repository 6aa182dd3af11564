"""How hot the gears are, said in one way: words, degrees, kelvins."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.case.case import GearCase, load_case, load_example
from thermogear.case.thermal_state import COMPUTED, HOT, UNDEFORMED, ThermalState

OWN = """[gears]
module = "3 mm"
face_width = "30 mm"
[gears.pinion]
teeth = 20
[gears.wheel]
teeth = 40
[operating]
speed = "3000 rpm"
torque = "80 N m"
"""


@pytest.fixture(scope="module")
def rig() -> GearCase:
    case = load_example("rig")
    assert isinstance(case, GearCase)
    return case


@pytest.mark.parametrize(
    ("text", "state"),
    [
        ("hot", HOT),
        ("undeformed", UNDEFORMED),
        ("computed", COMPUTED),
        ("100", ThermalState.at(373.15)),
        (" 100 degC", ThermalState.at(373.15)),
        ("100 °C", ThermalState.at(373.15)),
        ("373.15 K", ThermalState.at(373.15)),
    ],
)
def test_what_a_command_line_says(text: str, state: ThermalState) -> None:
    assert ThermalState.parse(text) == state


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "cold",
            r"state: got 'cold'; allowed undeformed .*\"cold\" is now called \"undefor",
        ),
        ("warm", r"state: got 'warm'; allowed undeformed \| hot \| computed \| degrees Celsius"),
        ("-300", r"state: got .*"),
        ("nan", r"state: got nan.*"),
        ("100 mm", r"state: got '100 mm'; allowed undeformed"),
    ],
)
def test_what_it_cannot_say(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        ThermalState.parse(text)
    assert "\n" not in str(caught.value)


def test_what_python_says() -> None:
    assert ThermalState.of("hot") is HOT
    assert ThermalState.of("undeformed") is UNDEFORMED
    assert ThermalState.of(None) is UNDEFORMED
    assert ThermalState.of(400.0) == ThermalState.at(400.0)
    assert [one.stored for one in (HOT, UNDEFORMED, ThermalState.at(400.0))] == [
        "hot", "undeformed", 400.0,
    ]  # fmt: skip
    with pytest.raises(InputError, match="state: got 'tepid'"):
        ThermalState.of("tepid")


def test_states_of_a_case_are_what_they_say(rig: GearCase) -> None:
    model = rig.models[0]
    cold, hot, warm = (
        state.operating(rig, model) for state in (UNDEFORMED, HOT, ThermalState.at(350.0))
    )
    reference = rig.stated.temperatures.reference
    assert {float(np.ravel(t)[0]) for t in cold.temperatures.bodies.values()} == {reference}
    assert cold.oil_temperature == hot.oil_temperature
    assert hot is rig.stated
    assert np.all(np.asarray(warm.temperatures.pinion_addendum) == 350.0)
    computed = COMPUTED.operating(rig, model)
    assert np.array_equal(
        computed.temperatures.bodies["housing"],
        rig.balance(model).operating.temperatures.bodies["housing"],
    )


def test_a_held_state_stays_at_another_speed(rig: GearCase) -> None:
    model = rig.models[0]
    here = COMPUTED.operating(rig, model).point(0)
    held = ThermalState("computed", held=here)
    assert COMPUTED.hangs_on_the_load(rig)
    assert not held.hangs_on_the_load(rig)
    moved = held.operating(rig, model)
    assert np.array_equal(moved.speed, rig.stated.speed)
    assert moved.temperatures is here.temperatures


@pytest.mark.filterwarnings("ignore::thermogear.base.errors.ValidityWarning")
@pytest.mark.parametrize("state", [HOT, UNDEFORMED])
def test_bare_quantities_are_the_cycle_s_own(state: ThermalState) -> None:
    """Of computed temperatures, the second point's beyond every steady state."""
    small = ["grid.mesh_positions=48", "grid.path_positions=11", "grid.harmonics=12"]
    heavy = 'operating.torque=["80 N m", "2000 N m"]'
    case = load_case(OWN, [*small, heavy])
    assert isinstance(case, GearCase)
    model = case.models[0]
    cycle = state.cycle(case, model)
    want = ("transmission_error", "film_parameter", "jam_temperature", "mean_stiffness")
    bare = state.quantities(case, model, want)
    for name in (*want, "status", "pinion_speed", "pinion_torque"):
        assert np.array_equal(bare[name], cycle[name].values, equal_nan=name != "status"), name
