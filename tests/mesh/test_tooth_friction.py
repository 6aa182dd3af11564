"""Friction of the teeth as two functions of the phase: against every pair's own, and the losses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from conftest import Compared
from thermogear import (
    Gear,
    GearPair,
    InputError,
    MeshModel,
    Operating,
    Relief,
    Temperatures,
    excitation,
    mesh_cycle,
)
from thermogear.base.excitation import Excitations, FrictionSplit
from thermogear.base.materials import lubricant
from thermogear.base.pieces import Pieces
from thermogear.gears.contact import sliding_velocity
from thermogear.heat.friction import ConstantDry
from thermogear.mesh.elastic import elastic_pair
from thermogear.mesh.excite import excitations
from thermogear.mesh.friction_path import FrictionPath
from thermogear.mesh.mesh_heat import mesh_heat
from thermogear.mesh.thermal import HotPair
from thermogear.mesh.tooth_friction import friction_split, rubbing
from thermogear.shafts.mesh_lines import MeshFrame

BUNDLES = [MeshModel.consistent(), MeshModel.thesis()]
BY_RULE = [
    MeshModel.thesis(),
    MeshModel.thesis().override(friction="dry", sharing="equal"),
    MeshModel.consistent().override(sharing="stiffness"),
]


def cold(at: Operating) -> Operating:
    return replace(at, temperatures=at.temperatures.cold())


def pitch_phase(pair: GearPair) -> float:
    """The phase at which a pair passes the pitch point."""
    return float(np.mod((pair.path.c - pair.path.a) / pair.base_pitch, 1.0))


def drawn(random: np.random.Generator) -> tuple[GearPair, Operating]:
    """A random pair with two operating points, warm or hot."""
    module, angle = float(random.uniform(1e-3, 6e-3)), float(np.radians(random.uniform(18, 25)))
    teeth = int(random.integers(20, 40)), int(random.integers(40, 90))
    pinion, wheel = (
        Gear(
            z,
            module,
            pressure_angle=angle,
            face_width=8.0 * module,
            bore_radius=0.15 * z * module,
        )
        for z in teeth
    )
    hot = 293.15 + random.uniform(10.0, 90.0)
    at = Operating(
        speed=random.uniform(30.0, 600.0, 2),
        torque=random.uniform(2e5, 2e6, 2) * 8.0 * module**2 * pinion.pitch_radius,
        lubricant=lubricant("M100"),
        oil_temperature=hot,
        temperatures=replace(
            Temperatures.uniform(hot, reference=293.15), pinion_addendum=hot + 15.0
        ),
        half_backlash=0.03 * module,
    )
    return GearPair(pinion, wheel), at


def frame_of(pair: GearPair, random: np.random.Generator) -> MeshFrame:
    return MeshFrame(
        base_radii=(pair.pinion.base_radius, pair.wheel.base_radius),
        teeth=(pair.pinion.teeth, pair.wheel.teeth),
        pressure_angle=pair.operating_pressure_angle,
        centre_line=float(random.uniform(-np.pi, np.pi)),
        sense=int(random.choice([-1, 1])),
    )


@pytest.mark.parametrize("model", BY_RULE, ids=["thesis", "dry", "stiffness"])
def test_power_on_the_train_is_what_every_pair_of_flanks_loses(
    model: MeshModel, compared: Compared
) -> None:
    random, away = np.random.default_rng(61), []
    for _ in range(6):
        pair, at = drawn(random)
        frame = frame_of(pair, random)
        columns = np.stack(frame.friction_columns)
        for place, one in enumerate(friction_split(pair, at, model, accuracy=1e-6)):
            assert one is not None
            omega = float(at.speed[place])
            turning = frame.sense * omega * np.array([0, 0, 1.0, 0, 0, frame.ratio])
            elastic = elastic_pair(HotPair(pair, at.point(place), model))
            force = float(elastic.force[0])
            for phase in random.uniform(0.0, 1.0, 20):
                s = pair.path.a + (phase + np.arange(2)) * pair.base_pitch
                s = s[s < pair.path.e]
                path = FrictionPath(elastic, s)
                slides = np.abs(sliding_velocity(pair, omega, s))
                lost = force * np.sum(path.friction * path.share * slides)
                chi = np.array([one.at_pitch(phase), one.per_metre(phase)])
                power = force * chi @ columns @ turning
                assert power <= 0.0
                steepest = force * omega * pair.base_pitch
                away.append((power + lost) / steepest)
    compared("power of the teeth's friction, pair by pair", "sum of mu F |v|", away, 2e-6)


def test_friction_of_random_loaded_pairs_takes_power_and_gives_none() -> None:
    """Tip corners that carry beyond the path included: power -F_d chi_1 (omega_1 + omega_2)."""
    random = np.random.default_rng(62)
    phase = np.linspace(0.0, 1.0, 400, endpoint=False)
    for _ in range(3):
        pair, at = drawn(random)
        for place, one in enumerate(friction_split(pair, at.point(0), MeshModel.consistent())):
            assert one is not None
            turned = one.per_metre(phase)
            assert np.all(turned >= -1e-4 * turned.max())
            elastic = elastic_pair(HotPair(pair, at.point(place), MeshModel.consistent()))
            slope = float(at.speed[0]) * (1.0 + pair.pinion.teeth / pair.wheel.teeth)
            loss = float(elastic.force[0]) * one.per_metre.mean * slope
            assert loss == pytest.approx(float(mesh_heat(elastic, 1000).power[0]), rel=1e-4)


@pytest.mark.parametrize("model", BUNDLES, ids=lambda m: m.name)
@pytest.mark.parametrize("hot", [False, True], ids=["cold", "hot"])
def test_its_mean_is_the_frictional_power_of_the_cycle(
    rig: GearPair, hot_rig: Operating, model: MeshModel, hot: bool
) -> None:
    at = hot_rig if hot else cold(hot_rig)
    slope = at.speed * (1.0 + rig.pinion.teeth / rig.wheel.teeth)
    for place, one in enumerate(friction_split(rig, at, model)):
        assert one is not None
        elastic = elastic_pair(HotPair(rig, at.point(place), model))
        loss = float(elastic.force[0]) * one.per_metre.mean * slope[place]
        assert loss == pytest.approx(float(mesh_heat(elastic, 400).power[0]), rel=1e-4)
        stored = mesh_cycle(rig, at.point(place), model, want=["frictional_power"])
        assert loss == pytest.approx(float(stored["frictional_power"][0]), rel=2e-3)


@pytest.mark.parametrize("model", BUNDLES, ids=lambda m: m.name)
def test_pieces_meet_the_cycle_at_every_phase(
    rig: GearPair, hot_rig: Operating, model: MeshModel
) -> None:
    phase = np.random.default_rng(3).uniform(0.0, 1.0, 700)
    for relieved in ((), (Relief("pinion", amount=15e-6, length=4e-3),)):
        for at in (hot_rig.point(1), cold(hot_rig).point(1)):
            (one,) = friction_split(rig, at, model, deviations=relieved)
            found = rubbing(elastic_pair(HotPair(rig, at, model), relieved), phase)
            assert one is not None
            assert found is not None
            for own, known in zip((one.at_pitch, one.per_metre), found.values, strict=True):
                assert np.abs(own(phase) - known).max() <= 2e-4 * np.abs(known).max()


@pytest.mark.parametrize("model", BUNDLES, ids=lambda m: m.name)
def test_it_jumps_where_a_pair_passes_the_pitch_point(
    rig: GearPair, hot_rig: Operating, model: MeshModel
) -> None:
    at, phase = hot_rig.point(0), pitch_phase(rig)
    (one,) = friction_split(rig, at, model)
    assert one is not None
    assert phase in one.at_pitch.starts
    beside = FrictionPath(
        elastic_pair(HotPair(rig, at, model)), rig.path.c + np.array([-1e-9, 1e-9])
    )
    step = float((beside.share * beside.friction).sum())
    chi = one.at_pitch(phase + np.array([-1e-10, 1e-10]))
    assert np.diff(chi) == pytest.approx([step], rel=2e-3)
    # away from the pitch point the pair's arm is zero there, so that the torque does not jump
    turned = one.per_metre(phase + np.array([-1e-10, 1e-10]))
    assert np.ptp(turned) < 2e-4 * np.abs(one.per_metre(np.linspace(0.0, 1.0, 50))).max()


def test_dry_equal_shares_have_their_closed_form(rig: GearPair, hot_rig: Operating) -> None:
    model = MeshModel.thesis().override(friction="dry", sharing="equal")
    (one,) = friction_split(rig, hot_rig.point(0), model)
    assert one is not None
    pitch, mu = pitch_phase(rig), model.dry_coefficient
    leaving = rig.contact_ratio - 1.0
    assert one.at_pitch.starts == pytest.approx((0.0, *sorted((pitch, leaving))))
    ends = (rig.path.a - rig.path.c, rig.path.e - rig.path.c)
    assert one.at_pitch(0.5 * leaving) == pytest.approx(0.0, abs=1e-15)
    assert one.at_pitch(np.array([0.5 * (leaving + pitch), 0.5 * (1.0 + pitch)])) == pytest.approx(
        [-mu, mu], rel=1e-14
    )
    assert float(one.per_metre(0.0)) == pytest.approx(
        0.5 * mu * (abs(ends[0]) + ends[0] + rig.base_pitch), rel=1e-13
    )


def test_it_goes_with_the_coefficient_down_to_nothing(rig: GearPair, hot_rig: Operating) -> None:
    every = [
        friction_split(
            rig,
            hot_rig.point(0),
            BUNDLES[0].override(friction=ConstantDry.name, dry_coefficient=mu),
        )[0]
        for mu in (0.1, 1e-12)
    ]
    assert every[0] is not None
    assert every[1] is not None
    phase = np.linspace(0.0, 1.0, 301)
    for name in ("at_pitch", "per_metre"):
        some, none = (getattr(one, name)(phase) for one in every)
        assert np.abs(none).max() <= 1e-11 * np.abs(some).max() * 1.01
        np.testing.assert_allclose(none * 1e11, some, atol=1e-9 * np.abs(some).max())


def test_excitations_carry_it_where_it_is_asked_for(rig: GearPair, hot_rig: Operating) -> None:
    cycle = mesh_cycle(rig, hot_rig, BUNDLES[1])
    plain = excitations(cycle, rig, damping_ratio=0.05)
    assert plain.friction is None
    assert plain.one(0).friction is None
    split = friction_split(rig, hot_rig, BUNDLES[1])
    found = excitations(cycle, rig, damping_ratio=0.05, friction=split)
    for name in ("stiffness", "error", "half_backlash", "mean_force"):
        assert np.array_equal(getattr(found, name), getattr(plain, name))
    assert found.take([2, 0]).friction == (split[2], split[0])
    both = Excitations.joined([plain, found])
    assert both.friction == (None, None, None, *split)
    singles = excitation(cycle, rig, damping_ratio=0.05, friction=split)
    assert [one.friction for one in singles if one is not None] == list(split)
    assert Excitations.of([one for one in singles if one is not None]).friction == split
    with pytest.raises(InputError):
        excitations(cycle, rig, damping_ratio=0.05, friction=split[:2])


def test_what_cannot_be_split_is_refused(rig: GearPair, hot_rig: Operating) -> None:
    with pytest.raises(InputError):
        friction_split(rig, replace(hot_rig, speed=np.zeros(1)))
    with pytest.raises(InputError):
        friction_split(rig, hot_rig, accuracy=0.0)
    one, two = (Pieces.constant(starts=[0.0, s], values=[0.1, 0.2]) for s in (0.3, 0.4))
    with pytest.raises(InputError):
        FrictionSplit(at_pitch=one, per_metre=two)
