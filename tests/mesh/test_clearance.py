"""Clearance and jam: the mesh force, every deviation, and what the picture shows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from conftest import Compared
from thermogear import Gear, GearPair, MeshModel, Operating, Temperatures, mesh_cycle
from thermogear.base.materials import MATERIALS, ZERO_CELSIUS, lubricant
from thermogear.base.vocabulary import STATUS
from thermogear.gears.centrifugal import centrifugal_displacement
from thermogear.gears.deviations import (
    BasePitchDifference,
    Deviation,
    FlankTable,
    PathTable,
    PitchError,
    PressureAngleError,
    Relief,
)
from thermogear.gears.loaded import loaded_contact, solve_mesh
from thermogear.mesh.clearance import Clearance
from thermogear.mesh.excite import excitation
from thermogear.mesh.thermal import HotPair, ThermalDeviation

# the textbook's foundation, shown beside the loaded contact, has its range
pytestmark = pytest.mark.filterwarnings("ignore:foundation of the gear with 19 teeth")

T0 = ZERO_CELSIUS + 20.0
SMALL = GearPair(
    Gear(19, 3e-3, pressure_angle=np.radians(25.0), profile_shift=0.3),
    Gear(47, 3e-3, pressure_angle=np.radians(25.0), profile_shift=0.1),
)


def table(gear: str, flank: str = "both") -> FlankTable:
    body = SMALL.pinion if gear == "pinion" else SMALL.wheel
    radius = np.linspace(body.form_radius, body.tip_radius, 6)
    return FlankTable(
        gear, radius=radius, added=1e-6 * np.array([12, -4, 9, 3, -8, -20.0]), flank=flank
    )


DEVIATIONS: dict[str, list[Deviation]] = {
    "none": [],
    "tip relief": [
        Relief("pinion", amount=25e-6, length=3e-3),
        Relief("wheel", amount=18e-6, length=2.5e-3, end="tip", shape="parabolic"),
    ],
    "root relief of one side": [
        Relief("wheel", amount=30e-6, length=4e-3, end="root", flank="back")
    ],
    "long relief that leaves no involute": [
        Relief("pinion", amount=40e-6, length=8e-3, end="root")
    ],
    "pressure angle": [PressureAngleError("pinion", 4e-3), PressureAngleError("wheel", -2e-3)],
    "profile": [table("pinion"), table("wheel", "drive")],
    "added material": [PathTable(s=[0.0, 0.1], added=[6e-6, 6e-6])],
    "base pitch": [BasePitchDifference(3e-4)],
    "one pitch error": [PitchError("pinion", (4e-6,) * 19)],
}


def warm(pinion: float, wheel: float, housing: float) -> Temperatures:
    """Addenda and housing [C], bores 15 K below."""
    one, two = ZERO_CELSIUS + pinion, ZERO_CELSIUS + wheel
    return Temperatures(
        reference=T0,
        pinion_addendum=one,
        pinion_bore=one - 15.0,
        wheel_addendum=two,
        wheel_bore=two - 15.0,
        housing=ZERO_CELSIUS + housing,
    )


def point(
    hot_rig: Operating, temperatures: Temperatures, half_backlash: float = 60e-6
) -> Operating:
    return replace(
        hot_rig,
        speed=np.array([200.0]),
        torque=np.array([40.0]),
        oil_temperature=330.0,
        temperatures=temperatures,
        half_backlash=half_backlash,
    )


@pytest.mark.parametrize("kind", DEVIATIONS)
def test_the_loaded_contact_leaves_the_clearance_of_the_one_spring(
    hot_rig: Operating, kind: str
) -> None:
    devices = DEVIATIONS[kind]
    operating = point(hot_rig, warm(110.0, 80.0, 60.0))
    cycle = mesh_cycle(SMALL, operating, deviations=devices, mesh_positions=24)
    hot = HotPair(SMALL, operating, MeshModel.consistent())
    found = excitation(cycle, SMALL, damping_ratio=0.05)[0]
    assert found is not None
    phase, b = cycle["mesh_phase"].values, operating.half_backlash
    one_spring = 2.0 * cycle["half_backlash_curve"].values[0]
    assert one_spring.mean() == pytest.approx(2.0 * found.half_backlash, rel=1e-12)
    # where the force of each flank begins: a load of 1e-9 N deflects nothing
    flanks = [*devices, ThermalDeviation(hot)]
    touch = sum(
        solve_mesh(
            SMALL, 1e-9, phase[[0, 17]], deviations=flanks, flank=flank, mean_load=0.0
        ).elastic
        for flank in ("drive", "back")
    )
    assert (touch + 2 * b - one_spring[[0, 17]])[0] / b == pytest.approx(np.zeros(2), abs=1e-9)


@pytest.mark.parametrize("kind", DEVIATIONS)
def test_at_its_jam_temperature_a_pair_has_no_clearance_left(
    hot_rig: Operating, kind: str, compared: Compared
) -> None:
    """Both readings: gears over a housing as it is, and everything in proportion.

    At a speed that takes backlash too, which no temperature changes.
    """
    devices = DEVIATIONS[kind]
    state = warm(120.0, 95.0, 50.0)
    fast = replace(point(hot_rig, state), speed=np.array([3000.0]), pulled=1.0)
    before = mesh_cycle(SMALL, fast, deviations=devices, mesh_positions=24)
    parts = [float(before[f"half_backlash_by_{n}"][0]) for n in ("deviations", "speed", "heat")]
    assert parts[1] < -1e-6
    assert 60e-6 + sum(parts) == pytest.approx(float(before["least_half_backlash"][0]), abs=1e-18)
    rise = float(before["jam_temperature"][0] - state.pinion_addendum)
    factor = float(before["proportional_jam_temperature"][0] - T0) / 100.0
    bodies = ("pinion_addendum", "pinion_bore", "wheel_addendum", "wheel_bore")
    alone = replace(state, **{name: float(getattr(state, name)) + rise for name in bodies})
    together = replace(
        state,
        **{name: T0 + factor * (getattr(state, name) - T0) for name in (*bodies, "housing")},
    )
    for jammed in (alone, together):
        at_jam = replace(fast, temperatures=jammed)
        there = mesh_cycle(SMALL, at_jam, deviations=devices, mesh_positions=24)
        least = float(there["half_backlash_curve"].min())
        compared("least half backlash at the jam", "0", least / 60e-6, 1e-9)
    assert factor > 1.0
    assert rise > 0.0


def test_centrifugal_growth_takes_backlash_along_the_line_of_action() -> None:
    """j = sum 2 u (sin a - psi cos a) of both flanks; none as drawn, none in the thesis."""
    pair = GearPair(Gear(40, 4e-3), Gear(80, 4e-3))
    cold = Operating(
        speed=[2618.0], torque=[100.0], lubricant=lubricant("M100"), oil_temperature=T0,
        temperatures=Temperatures.uniform(T0, reference=T0), half_backlash=100e-6,
    )  # fmt: skip
    model = MeshModel.consistent().override(bore="shaft", stiffness="textbook-30-degree",
                                            sharing="equal")  # fmt: skip
    alpha, lost = np.radians(20.0), 0.0
    for gear, speed in ((pair.pinion, 2618.0), (pair.wheel, 1309.0)):
        u = centrifugal_displacement(gear, gear.pitch_radius, speed, "shaft")
        lost += float(u) * (np.sin(alpha) - 0.5 * np.pi / gear.teeth * np.cos(alpha))
    # 23 and 47 um outward, 48 of 200 um of backlash in both discs alike without their teeth's width
    assert 2e6 * lost == pytest.approx(46.4, abs=0.3)
    found = mesh_cycle(pair, cold, model, mesh_positions=24)
    curve = found["half_backlash_curve"].values[0]
    assert np.abs(100e-6 - lost - curve).max() < 0.05 * lost
    assert float(found["half_backlash_by_heat"][0]) == 0.0
    assert float(found["pinion_deformation"].max()) > 0.0
    for still in (
        mesh_cycle(pair, cold.as_drawn(), model, mesh_positions=24),
        mesh_cycle(pair, cold, MeshModel.thesis(), mesh_positions=24),
    ):
        assert float(still["half_backlash_by_speed"][0]) == 0.0
        assert np.all(still["half_backlash_curve"].values == 100e-6)


@pytest.mark.parametrize(
    "model", [MeshModel.consistent(), MeshModel.thesis()], ids=lambda m: m.name
)
def test_material_added_to_both_flanks_takes_up_the_backlash(
    hot_rig: Operating, model: MeshModel
) -> None:
    cold = point(hot_rig, Temperatures.uniform(T0, reference=T0), 100e-6)
    for added, left, status in ((60e-6, 40e-6, "ok"), (101e-6, -1e-6, "jammed")):
        devices = [PathTable(s=[0.0, 0.1], added=[added, added])]
        cycle = mesh_cycle(SMALL, cold, model, deviations=devices)
        np.testing.assert_allclose(cycle["half_backlash_curve"], left, rtol=0, atol=1e-18)
        assert STATUS[int(cycle["status"][0])] == status
        assert float(cycle["cold_half_backlash"][0]) == 100e-6
        assert float(np.abs(cycle["kinematic_error"]).max()) < 1e-18
    one_side = [PathTable(s=[0.0, 0.1], added=[20e-6, 20e-6], flank="drive")]
    cycle = mesh_cycle(SMALL, cold, model, deviations=one_side)
    np.testing.assert_allclose(cycle["half_backlash_curve"], 90e-6, rtol=1e-12)
    np.testing.assert_allclose(cycle["kinematic_error"], -10e-6, rtol=1e-12)


def test_the_tightest_pair_decides_not_a_mean(rig: GearPair, hot_rig: Operating) -> None:
    """In double contact the flanks of unequal gears differ by strain times base pitch."""
    for difference in (30.0, 60.0):
        hotter, colder = T0 + 80.0, T0 + 80.0 - difference
        state = Temperatures(
            reference=T0,
            pinion_addendum=hotter,
            pinion_bore=hotter,
            wheel_addendum=colder,
            wheel_bore=colder,
            housing=T0 + 40.0,
        )
        hot = HotPair(rig, replace(hot_rig, temperatures=state), MeshModel.consistent())
        phase = np.array([0.3])
        entering, leading = rig.path.a + np.array([0.3, 1.3]) * rig.base_pitch
        drive = hot.added_material(np.array([entering, leading]))[0]
        strain = rig.pinion.material.thermal_expansion * difference
        assert drive[1] - drive[0] == pytest.approx(strain * rig.base_pitch, rel=1e-9)
        found = Clearance(hot, phase)
        taken = hot.operating.half_backlash - found.half_backlash - found.error
        assert float(taken[0, 0]) == pytest.approx(drive[1], rel=0, abs=1e-16)


@pytest.mark.parametrize("flank", ["growth", "thesis"])
def test_one_pair_alone_takes_its_own_added_material_off_the_drive_side(
    rig: GearPair, hot_rig: Operating, flank: str
) -> None:
    """(b - b') - e = (S + S^c)/2 + (S - S^c)/2 = S; the thesis knows no error of heat."""
    hot = HotPair(rig, hot_rig, MeshModel.consistent().override(flank=flank))
    phase = np.linspace(rig.contact_ratio - 1.0 + 0.02, 1.0 - 0.02, 9)  # one pair in contact
    s = rig.path.a + phase * rig.base_pitch
    found = Clearance(hot, phase)
    if flank == "thesis":
        assert not np.any(found.error)
        return
    taken = hot_rig.half_backlash - found.half_backlash - found.error
    np.testing.assert_allclose(taken, hot.added_material(s), rtol=0, atol=1e-17)
    assert np.any(found.error)


def test_what_heat_never_closes_has_no_jam_temperature(rig: GearPair, hot_rig: Operating) -> None:
    cold = mesh_cycle(rig, replace(hot_rig, temperatures=hot_rig.temperatures.cold()))
    uniform = mesh_cycle(
        rig, replace(hot_rig, temperatures=Temperatures.uniform(T0 + 100.0, reference=T0))
    )
    for cycle in (cold, uniform):
        assert np.all(np.isnan(cycle["proportional_jam_temperature"].values))
        assert np.all(np.isfinite(cycle["jam_temperature"].values))


def proportion(state: Temperatures, factor: float) -> Temperatures:
    """Every excess over the reference times ``factor``."""
    return replace(
        state, **{name: T0 + factor * (body - T0) for name, body in state.bodies.items()}
    )


@pytest.mark.parametrize(
    ("state", "expansion", "side"),
    [
        (warm(120.0, 95.0, 60.0), 12e-6, 1.0),
        (warm(120.0, 110.0, 100.0), 23e-6, -1.0),
        (warm(-10.0, 0.0, -25.0), 12e-6, -1.0),
        (warm(-10.0, 0.0, 15.0), 12e-6, 1.0),
    ],
    ids=["housing of steel", "of aluminium", "colder than the drawing", "colder gears alone"],
)
def test_in_proportion_a_pair_jams_on_the_side_where_its_gap_closes(
    hot_rig: Operating, state: Temperatures, expansion: float, side: float
) -> None:
    """A housing that shrinks more than the gears takes the backlash up in the cold."""
    housing = replace(MATERIALS["steel"], thermal_expansion=expansion)
    operating = replace(point(hot_rig, state, 12e-6), housing=housing)
    cycle = mesh_cycle(SMALL, operating, mesh_positions=24)
    jam = float(cycle["proportional_jam_temperature"][0])
    assert np.sign(jam - T0) == side
    factor = (jam - T0) / (float(state.pinion_addendum) - T0)
    there = replace(operating, temperatures=proportion(state, factor))
    least = mesh_cycle(SMALL, there, mesh_positions=24)["least_half_backlash"]
    assert float(least[0]) / 12e-6 == pytest.approx(0.0, abs=1e-9)


def test_a_pair_that_jams_without_heat_has_no_temperature_of_it(hot_rig: Operating) -> None:
    tight = [PathTable(s=[0.0, 0.1], added=[61e-6, 61e-6])]
    for state in (warm(120.0, 95.0, 50.0), Temperatures.uniform(T0, reference=T0)):
        cycle = mesh_cycle(SMALL, point(hot_rig, state), deviations=tight, mesh_positions=24)
        assert STATUS[int(cycle["status"][0])] == "jammed"
        assert float(cycle["least_half_backlash"][0]) < 0.0
        assert np.isnan(cycle["jam_temperature"].values).all()
        assert np.isnan(cycle["proportional_jam_temperature"].values).all()


def test_heavy_added_material_leaves_a_contact_that_settles(hot_rig: Operating) -> None:
    """A constant shift moves the origin alone, however light the load is."""
    pair = GearPair(
        Gear(60, 20e-3, face_width=0.2, bore_radius=0.3),
        Gear(150, 20e-3, face_width=0.2, bore_radius=0.8),
    )
    phase = np.arange(24) / 24
    for line_load in (1e2, 1e3):
        force = line_load * pair.face_width
        bare = loaded_contact(pair, force, phase)
        shifted = loaded_contact(
            pair, force, phase, deviations=[PathTable(s=[0.0, 1.0], added=[-1e-3, -1e-3])]
        )
        assert not shifted["status"].any()
        stiffness = bare["tangent_stiffness"].values
        np.testing.assert_allclose(shifted["tangent_stiffness"], stiffness, rtol=1e-6)
        moved = shifted["transmission_error"].values - bare["transmission_error"].values
        np.testing.assert_allclose(moved, 1e-3, rtol=1e-9)
