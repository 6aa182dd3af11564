"""The gear pair's heat balance: closed forms of its paths, published body temperatures."""

import math

import numpy as np
import pytest

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.base.materials import ZERO_CELSIUS, lubricant
from thermogear.gears.contact import reduced_radius, sum_velocity
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair
from thermogear.heat.convection import disc_nusselt
from thermogear.heat.gearbox import (
    Losses,
    Surroundings,
    body_conductances,
    face_conductance,
    oil_prandtl,
    thermal_network,
)
from thermogear.heat.laws import iso_13989_2, schlenk
from thermogear.heat.losses import gear_loss_factor, mesh_loss
from thermogear.heat.lubrication import density, dynamic_viscosity, kinematic_viscosity
from thermogear.heat.scuffing import body_temperature_15144
from thermogear.heat.transient import Stretch, follow

OIL = lubricant("M100")
PINION = Gear(teeth=25, module=5e-3, bore_radius=0.025, face_width=0.025)
WHEEL = Gear(teeth=75, module=5e-3, bore_radius=0.080, face_width=0.025)


def test_conduction_through_the_ring_is_the_radial_fields() -> None:
    """Body to bore and root to body in series: ln(r_f/r_x)/(2 pi k b)."""
    outer, inner = body_conductances(PINION)
    pitch_thickness = math.pi * 5e-3 / 2.0
    teeth = (PINION.pitch_radius - PINION.root_radius) / (46.0 * 0.025 * pitch_thickness * 25)
    ring = 1.0 / outer - teeth + 1.0 / inner
    expected = math.log(PINION.root_radius / 0.025) / (2.0 * math.pi * 46.0 * 0.025)
    assert ring == pytest.approx(expected, rel=1e-12)


def test_face_conductance_is_area_times_the_similarity_coefficient() -> None:
    """Laminar: h is uniform over the face."""
    warm, omega = ZERO_CELSIUS + 60.0, 100.0
    nu, pr = float(kinematic_viscosity(OIL, warm)), float(oil_prandtl(OIL, warm))
    film = float(disc_nusselt(pr)) * OIL.thermal_conductivity * math.sqrt(omega / nu)
    area = math.pi * (0.056**2 - 0.025**2)
    computed = face_conductance(
        omega, inner_radius=0.025, outer_radius=0.056, lubricant=OIL, oil_temperature=warm
    )
    assert computed == pytest.approx(film * area, rel=1e-10)
    assert (
        face_conductance(
            0.0, inner_radius=0.025, outer_radius=0.056, lubricant=OIL, oil_temperature=warm
        )
        == 0.0
    )


def test_paths_of_the_network_by_hand() -> None:
    """Shaft and bearing in series on both sides; wetted flanks and faces; housing by area."""
    around = Surroundings(wetted_share=(0.2, 0.4), shaft_length=0.1, bearing_conductance=7.0)
    warm, omega = ZERO_CELSIUS + 70.0, 90.0
    network = thermal_network(PINION, WHEEL, omega, Losses(mesh=10.0), OIL, warm, around)
    found = {(x.first, x.second): float(np.asarray(x.conductance)) for x in network.links}
    along = 46.0 * math.pi * 0.025**2 / 0.1
    mount = 2.0 * along * 7.0 / (along + 7.0)
    assert found["pinion_shaft", "housing"] == pytest.approx(mount, rel=1e-12)
    assert found["oil", "housing"] == pytest.approx(200.0 * 0.6)
    assert found["housing", "ambient"] == pytest.approx(15.0 * 0.6)
    nu, pr = float(kinematic_viscosity(OIL, warm)), float(oil_prandtl(OIL, warm))
    film = float(disc_nusselt(pr)) * OIL.thermal_conductivity * math.sqrt(omega / 3.0 / nu)
    flanks = 2.0 * 75 * 0.025 * (WHEEL.tip_radius - WHEEL.root_radius)
    assert found["wheel_tooth", "oil"] == pytest.approx(0.4 * film * flanks, rel=1e-10)
    faces = 2.0 * float(
        face_conductance(
            omega / 3.0,
            inner_radius=0.080,
            outer_radius=WHEEL.root_radius,
            lubricant=OIL,
            oil_temperature=warm,
        )
    )
    assert found["wheel_body", "oil"] == pytest.approx(0.4 * faces, rel=1e-12)
    rings = (PINION.root_radius**2 - 0.025**2) * math.pi * 0.025
    assert network.capacities["pinion_body"] == pytest.approx(7850.0 * 470.0 * rings)
    assert network.capacities["oil"] == pytest.approx(3.0 * OIL.specific_heat)


def test_equal_temperature_without_heat() -> None:
    around = Surroundings(ambient=300.0)
    state = thermal_network(PINION, WHEEL, 100.0, Losses(mesh=0.0), OIL, 330.0, around).steady()
    for value in state.temperatures.values():
        assert value == pytest.approx(300.0, abs=1e-9)


def test_hotter_with_load_pinion_hotter_than_wheel_and_heat_flows_outwards() -> None:
    mesh = np.array([50.0, 200.0, 800.0])
    state = thermal_network(
        PINION, WHEEL, 150.0, Losses(mesh=mesh, partition_1=0.5, churning=20.0), OIL, 350.0
    ).steady()
    tooth = state["pinion_tooth"]
    assert np.all(np.diff(tooth) > 0.0)
    assert np.all(tooth > state["wheel_tooth"])
    assert np.all(tooth > state["pinion_body"])
    assert np.all(state["pinion_body"] > state["pinion_shaft"])
    assert np.all(state["oil"] > state["housing"])
    assert state.heat_out["ambient"] == pytest.approx(mesh + 20.0, rel=1e-10)
    assert np.max(state.residual) < 1e-9


def test_warm_up_ends_steady() -> None:
    network = thermal_network(PINION, WHEEL, 150.0, Losses(mesh=200.0, partition_1=0.5), OIL, 350.0)
    stretch = Stretch(end=np.inf, network=lambda state: network)
    curve = follow([stretch], dict.fromkeys(network.free, 293.15)).temperatures["pinion_tooth"]
    assert np.all(np.diff(curve) > 0.0)
    assert curve[-1] == pytest.approx(float(network.steady()["pinion_tooth"]), abs=0.02)


def test_supplied_oil_carries_its_heat_away() -> None:
    """Steady: rho c Q (T_oil - T_supply) leaves with the oil, the rest through the housing."""
    around = Surroundings(oil_flow=1e-4, supply_temperature=330.0)
    state = thermal_network(PINION, WHEEL, 150.0, Losses(mesh=3000.0), OIL, 350.0, around).steady()
    carried = float(density(OIL, 330.0)) * OIL.specific_heat * 1e-4 * (state["oil"] - 330.0)
    assert state.heat_out["supply"] == pytest.approx(float(carried), rel=1e-10)
    assert state.heat_out["supply"] + state.heat_out["ambient"] == pytest.approx(3000.0, rel=1e-10)
    with pytest.raises(InputError, match=r"^surroundings.oil_flow: got -1.0"):
        Surroundings(oil_flow=-1.0)


def fzg_test() -> tuple[GearPair, np.ndarray, float]:
    """Test A20/8.3/90: load stages 5, 7, 9, 10, 11 at 2170 1/min."""
    pinion = Gear(
        16, 4.5e-3, profile_shift=0.8532, face_width=0.02, bore_radius=0.015, tip_radius=0.044385
    )
    wheel = Gear(
        24,
        4.5e-3,
        profile_shift=-0.5,
        face_width=0.02,
        bore_radius=0.015,
        tip_radius=0.05625,
        allow_undercut=True,
    )
    torques = np.array([94.1, 183.4, 302.0, 372.6, 450.1])
    return GearPair(pinion, wheel, centre_distance=0.0915003), torques, 2170.0 * np.pi / 30.0


def test_body_temperature_of_the_fzg_test_against_regression_and_standard(
    compared: Compared,
) -> None:
    """Measured: 80 + 0.23 T1 C with the oil at about 80 + 0.09 T1 C.

    The network's pinion body, nothing fitted, lies within 6 K of the measured line, the
    estimate of ISO/TR 15144-1 1 to 17 K below it. The hottest node, the pinion's teeth, is up
    to 28 K above the line, which is a mean of both gears.
    """
    pair, torque, omega = fzg_test()
    oil = ZERO_CELSIUS + 80.0 + 0.09 * torque
    path, pitch = pair.path, pair.base_pitch
    radius = float(reduced_radius(pair, path.c))
    speed = float(sum_velocity(pair, omega, path.c))
    eta = dynamic_viscosity(OIL, ZERO_CELSIUS + 90.0)
    w = torque / pair.pinion.base_radius / 0.02
    mu = schlenk(w, speed, radius, eta, 0.35e-6, factor=1.0)
    factor = gear_loss_factor(
        teeth_1=16, ratio=1.5, approach=(path.c - path.a) / pitch, recess=(path.e - path.c) / pitch
    )
    loss = mesh_loss(torque * omega, mu, factor)
    state = thermal_network(
        pair.pinion,
        pair.wheel,
        omega,
        Losses(mesh=loss, partition_1=0.5),
        OIL,
        oil,
        measured={"oil": oil},
    ).steady()
    measured = 80.0 + 0.23 * torque
    body = state["pinion_body"] - ZERO_CELSIUS
    compared(
        "body temperature by the network, nothing fitted",
        "measured line of the FZG test, 80 + 0.23 T1 °C",
        body - measured,
        6.0,
        "K",
    )
    tooth = state["pinion_tooth"] - ZERO_CELSIUS
    assert np.all((tooth - measured > 0.0) & (tooth - measured < 28.0))
    mu_iso = iso_13989_2(w, speed, radius, eta, 0.35e-6)
    lost = mesh_loss(torque * omega, mu_iso, factor)
    estimate = (
        body_temperature_15144(oil, lost, centre_distance=0.0915, face_width=0.02, lubrication=1.0)
        - ZERO_CELSIUS
    )
    assert np.max(np.abs(estimate - measured)) < 17.0


def test_measured_oil_holds_its_node() -> None:
    network = thermal_network(
        PINION, WHEEL, 150.0, Losses(mesh=200.0), OIL, 350.0, measured={"oil": 350.0}
    )
    state = network.steady()
    assert state["oil"] == 350.0
    assert state.heat_out["oil"] + state.heat_out["ambient"] == pytest.approx(200.0, rel=1e-9)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Losses(mesh=-1.0), "losses.mesh: got -1.0 W; allowed >= 0"),
        (lambda: Losses(mesh=1.0, partition_1=1.5), "losses.partition_1: got 1.5; allowed 0 .. 1"),
        (lambda: Surroundings(ambient=-1.0), "surroundings.ambient: got -1 K (-274.15 degC)"),
        (lambda: Surroundings(wetted_share=(0.5, 1.5)), "surroundings.wetted_share: got (0.5, 1."),
    ],
)
def test_impossible_input_is_refused(call, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError) as caught:
        call()
    assert str(caught.value).startswith(message)
