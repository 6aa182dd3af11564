"""Heat of the contact in the time mean: load off the path, heat from flank to flank, nodes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from thermogear import GearPair, MeshModel, Operating, mesh_cycle
from thermogear.base.materials import lubricant
from thermogear.heat.contact_state import FILMS
from thermogear.heat.expansion import RadialField, base_circle_growth
from thermogear.heat.gearbox import (
    body_conductances,
    body_places,
    body_radius,
    face_conductance,
    tooth_radius,
)
from thermogear.heat.losses import gear_loss_factor
from thermogear.heat.network import Link, ThermalNetwork
from thermogear.heat.temperature import flank_exchange
from thermogear.mesh.balance import FAR, Gearbox, heat_balance
from thermogear.mesh.elastic import elastic_pair
from thermogear.mesh.friction_path import FrictionPath
from thermogear.mesh.mesh_heat import MeshHeat, mesh_heat
from thermogear.mesh.thermal import HotPair

OIL = lubricant("M100")
DRY = MeshModel.consistent().override(friction="dry")


def means(rig: GearPair, at: Operating, model: MeshModel, phases: int = 48) -> MeshHeat:
    return mesh_heat(elastic_pair(HotPair(rig, at, model)), phases)


def loaded(at: Operating, torque: float) -> Operating:
    return replace(at, torque=np.full(at.speed.shape, torque))


def test_equal_shares_lose_what_ohlendorfs_factor_says(rig: GearPair, hot_rig: Operating) -> None:
    """The integral over both pairs in contact is the closed form, to rounding."""
    found = means(rig, hot_rig, DRY.override(sharing="equal"))
    path, pitch = rig.path, rig.base_pitch
    factor = gear_loss_factor(
        teeth_1=25, ratio=3.0, approach=(path.c - path.a) / pitch, recess=(path.e - path.c) / pitch
    )
    expected = DRY.dry_coefficient * hot_rig.speed * hot_rig.torque * factor
    np.testing.assert_allclose(found.power, expected, rtol=1e-12)
    assert found.beyond.tolist() == [0.0, 0.0, 0.0]


def test_a_friction_law_is_given_the_films_that_it_asks_for(
    rig: GearPair, hot_rig: Operating
) -> None:
    """No other film is computed; what is told of the whole state is the same to the last bit."""
    for name, films in (("lambda-blend", {"central_film_parameter"}), ("xu-kahraman", set())):
        model = MeshModel.consistent().override(friction=name)
        path = FrictionPath(
            elastic_pair(HotPair(rig, hot_rig, model)),
            np.linspace(rig.path.a, rig.path.e, 9),
        )
        friction = path.friction
        assert {one for one in FILMS if one in vars(path)} == films
        np.testing.assert_array_equal(friction, model.law(path.state))


def test_a_share_that_is_known_already_gives_the_very_heat_and_near_by_nearly_so(
    rig: GearPair, hot_rig: Operating
) -> None:
    for sharing in ("loaded", "equal"):
        model = DRY.override(sharing=sharing)
        found = means(rig, hot_rig, model)
        again = mesh_heat(elastic_pair(HotPair(rig, hot_rig, model)), share=found.share)
        for one, other in zip(found, again, strict=True):
            np.testing.assert_array_equal(one, other)
    warm = replace(hot_rig, temperatures=replace(hot_rig.temperatures, pinion_addendum=375.0))
    near = elastic_pair(HotPair(rig, warm, DRY))
    kept = mesh_heat(near, share=means(rig, hot_rig, DRY).share)
    # the balance goes by a kept share no nearer to its end than this part of its way
    np.testing.assert_allclose(kept.power, mesh_heat(near).power, rtol=FAR)


def test_load_off_the_path_rubs_as_well(rig: GearPair, hot_rig: Operating) -> None:
    """Along one pair's way, tip corners before A and behind E included, the same power."""
    at = loaded(hot_rig, 300.0)
    elastic = elastic_pair(HotPair(rig, at, DRY))
    reach = 0.5 * rig.base_pitch
    scale = rig.face_width / rig.base_pitch

    def along(first: float, last: float) -> np.ndarray:
        s = np.linspace(first, last, 1501)
        path = FrictionPath(elastic, s)
        return np.trapezoid(path.heat, s, axis=-1) * scale

    whole = along(rig.path.a - reach, rig.path.e + reach)
    inside = along(rig.path.a, rig.path.e)
    found = mesh_heat(elastic)
    np.testing.assert_allclose(found.power, whole, rtol=2e-3)
    np.testing.assert_allclose(found.beyond, 1.0 - inside / whole, atol=3e-3)
    # what a path from A to E alone would leave out
    assert np.all((found.beyond > 0.05) & (found.beyond < 0.16))
    # more load bends the teeth further, and nothing of it is lost: all shares sum to one
    assert np.all(mesh_heat(elastic_pair(HotPair(rig, loaded(at, 20.0), DRY))).beyond < 0.03)


@pytest.mark.parametrize("torque", [100.0, 500.0])
def test_few_phases_are_enough(rig: GearPair, hot_rig: Operating, torque: float) -> None:
    at = loaded(hot_rig, torque)
    coarse, fine = (means(rig, at, MeshModel.consistent(), n) for n in (48, 400))
    np.testing.assert_allclose(coarse.power, fine.power, rtol=2e-3)
    np.testing.assert_allclose(coarse.conductance, fine.conductance, rtol=5e-3)


def test_flanks_exchange_what_two_half_spaces_in_touch_do(
    rig: GearPair, hot_rig: Operating
) -> None:
    """Equal speeds: the flux (T1 - T2) B/2/sqrt(pi t) of Carslaw and Jaeger for 2 B/v."""
    steel = rig.pinion.material.thermal_contact_coefficient
    speed, half = 3.0, 2e-4
    lasting = 2.0 * half / speed
    per_area = steel / np.sqrt(np.pi) * np.sqrt(lasting)  # B/2 int dt/sqrt(pi t)
    found = flank_exchange(
        half, speed_1=speed, speed_2=speed, contact_coefficient_1=steel, contact_coefficient_2=steel
    )
    assert found == pytest.approx(per_area * speed, rel=1e-12)
    # whichever flank is called the first
    one, other = (
        flank_exchange(half, speed_1=a, speed_2=b, contact_coefficient_1=c, contact_coefficient_2=d)
        for a, b, c, d in ((2.0, 5.0, steel, 1e3), (5.0, 2.0, 1e3, steel))
    )
    assert one == other
    # the rig's contact: 5 to 14 W/K, more with load and with speed
    weak, strong = (
        means(rig, loaded(hot_rig, t), MeshModel.consistent()).conductance for t in (20.0, 500.0)
    )
    assert np.all((weak > 2.0) & (strong < 20.0) & (strong > weak))
    assert np.all(np.diff(weak) > 0.0)


def test_heat_flows_from_the_hotter_flank_and_no_heat_is_lost(rig: GearPair) -> None:
    """A pinion held 60 K hotter warms the wheel through the contact."""
    box = Gearbox(measured={"oil": 353.15, "pinion_tooth": 413.15})
    found = heat_balance(rig, 200.0, 100.0, OIL, 125e-6, DRY, gearbox=box)
    t = found.steady
    crossing = found.losses.contact * (t["pinion_tooth"] - t["wheel_tooth"])
    assert crossing[0] > 200.0
    network = found.network
    bare = ThermalNetwork(
        tuple(x for x in network.links if (x.first, x.second) != ("pinion_tooth", "wheel_tooth")),
        network.sources,
        network.fixed,
    ).steady()
    assert t["wheel_tooth"][0] > bare["wheel_tooth"][0] + 5.0
    # all that enters leaves through the given nodes, to rounding
    lost = sum(
        getattr(found.losses, name)[0] for name in ("mesh", "churning", "bearing_1", "bearing_2")
    )
    out = sum(float(values[0]) for values in t.heat_out.values())
    assert out == pytest.approx(float(lost), rel=1e-10)


def test_the_field_passes_through_the_nodes_and_carries_their_heat(rig: GearPair) -> None:
    found = heat_balance(rig, np.array([100.0, 300.0]), 200.0, OIL, 125e-6)
    hot = HotPair(rig, found.operating, MeshModel.consistent())
    cycle = mesh_cycle(rig, found.operating, path_positions=21, mesh_positions=16)
    for name, gear in (("pinion", rig.pinion), ("wheel", rig.wheel)):
        field, t = (
            hot.field(gear),
            {k: found.steady[f"{name}_{k}"] for k in ("tooth", "body", "shaft")},
        )
        for radius, node in (
            (gear.bore_radius, "shaft"),
            (body_radius(gear), "body"),
            (tooth_radius(gear), "tooth"),
            (gear.tip_radius, "tooth"),
        ):
            np.testing.assert_allclose(field.temperature(radius)[:, 0], t[node], rtol=1e-8)
        outer, inner = body_conductances(gear)
        flow = inner * (t["body"] - t["shaft"])
        np.testing.assert_allclose(cycle[f"{name}_shaft_heat"].values, flow, rtol=1e-6)
        # what enters the ring at the root circle is what leaves the teeth
        ring = 2.0 * np.pi * gear.material.thermal_conductivity * gear.face_width
        root = field.temperature(gear.root_radius)[:, 0]
        entering = ring * (root - t["body"]) / np.log(gear.root_radius / body_radius(gear))
        np.testing.assert_allclose(entering, outer * (t["tooth"] - t["body"]), rtol=1e-6)


def test_growth_through_the_nodes_against_finite_volumes(rig: GearPair) -> None:
    """A ring that loses heat from its faces, 1200 rings: the one logarithm is far off."""
    omega, oil, bath, bore = 70.0, 353.15, 350.0, 351.0
    gear, heat, share = rig.wheel, 600.0, 0.3
    outer, inner = body_conductances(gear)
    faces = (
        share
        * 2.0
        * float(
            face_conductance(
                omega,
                inner_radius=gear.bore_radius,
                outer_radius=gear.root_radius,
                lubricant=OIL,
                oil_temperature=oil,
            )
        )
    )
    lumped = ThermalNetwork(
        (Link("tooth", "body", outer), Link("body", "shaft", inner), Link("body", "oil", faces)),
        {"tooth": heat},
        {"shaft": bore, "oil": bath},
    ).steady()
    # finite volumes: teeth of constant section, then rings; laminar, h is uniform over the face
    k, b, count = gear.material.thermal_conductivity, gear.face_width, 1200
    edges = np.linspace(gear.bore_radius, gear.root_radius, count + 1)
    middle = 0.5 * (edges[1:] + edges[:-1])
    area = np.pi * np.diff(edges**2)
    loss = faces * area / area.sum()
    between = 2.0 * np.pi * k * b / np.log(middle[1:] / middle[:-1])
    first = 2.0 * np.pi * k * b / np.log(middle[0] / edges[0])
    matrix = np.diag(loss) - np.diag(between, 1) - np.diag(between, -1)
    matrix[range(count), range(count)] += np.r_[first, between] + np.r_[between, 0.0]
    right = loss * bath
    right[0] += first * bore
    right[-1] += heat
    exact = np.linalg.solve(matrix, right)
    root = exact[-1] + heat * np.log(edges[-1] / middle[-1]) / (2.0 * np.pi * k * b)
    at = tooth_radius(gear)
    thick = 2.0 * at * float(gear.half_thickness_angle(at))
    tooth = root + heat * (at - gear.root_radius) / (k * b * thick * gear.teeth)

    def growth(bore_t: float, tip_t: float, between: tuple[tuple[float, float], ...]) -> float:
        field = RadialField(
            bore_radius=gear.bore_radius,
            tip_radius=gear.tip_radius,
            bore_temperature=bore_t,
            addendum_temperature=tip_t,
            reference=293.15,
            between=between,
        )
        return float(base_circle_growth(gear, field))

    every = tuple((float(r), float(t)) for r, t in zip(middle[::10], exact[::10], strict=True))
    reference = growth(bore, float(tooth), (*every, (gear.root_radius, float(root)), (at, tooth)))
    seen = (float(np.interp(body_radius(gear), middle, exact)), float(tooth))
    for (body, top), limit in ((seen, 0.03), ((lumped["body"], lumped["tooth"]), 0.06)):
        through = growth(bore, float(top), body_places(gear, body=body, tooth=top))  # type: ignore[arg-type]
        single = growth(bore, float(top), ())
        # with the nodes' true temperatures, and with those of the network
        assert abs(through / reference - 1.0) < limit
        assert abs(through - reference) < 0.35 * abs(single - reference)
