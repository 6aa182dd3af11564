"""Paths of the journals of a drive train in motion: against the laws of their bearings."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from conftest import Compared
from thermogear.analysis.any_motion import settle
from thermogear.base.excitation import Periodic
from thermogear.case.case import GearCase, load_case
from thermogear.case.thermal_state import UNDEFORMED
from thermogear.dynamics.geared import LocalBearing
from thermogear.dynamics.geared_map import GearedMap
from thermogear.dynamics.ladder import COUNTS, Run
from thermogear.shafts.bearings.laws import ElementLaw, LinearLaw, RingLaw
from thermogear.study.shafts.motion import train_motion
from thermogear.study.shafts.moving import MovingTrain, moving
from thermogear.study.shafts.record import SAMPLES, lines, recorded, shown, torus_orders
from thermogear.study.shafts.state import settled

Floats = NDArray[np.float64]
PAIR = """
[gears]
module = "2.5 mm"
face_width = "24 mm"
[gears.pinion]
teeth = 27
[gears.wheel]
teeth = 44
[oil]
name = "ISO VG 100"
temperature = "60 degC"
[temperatures]
pinion_addendum = "90 degC"
pinion_bore = "80 degC"
wheel_addendum = "85 degC"
wheel_bore = "75 degC"
housing = "55 degC"
[operating]
speed = "2300 rpm"
torque = "55 N m"
[train]
elements = 4
gravity = false  # spread along the shafts, which a reduced train bears to some 1e-5
"""
SHAFTS = "".join(
    f"""
[[shafts]]
gear = "{gear}"
length = "130 mm"
gear_position = "50 mm"
diameter = "30 mm"
"""
    for gear in ("pinion", "wheel")
)


def bearing(shaft: str, position: float, law: str) -> str:
    return f'\n[[bearings]]\nshaft = "{shaft}"\nposition = "{position} mm"\n{law}\n'


SPRING = 'stiffness = ["150 N/um", "90 N/um"]\ncross_stiffness = "20 N/um"'
RING = 'ring = { load = "2 kN", deflection = "12 um", exponent = 1.3, play = "30 um" }'
IDLE = 'ring = { load = "2 kN", deflection = "12 um", play = "900 um" }'
BALLS = 'type = "6206"'


@cache
def case(*laws: str, third: str = "") -> GearCase:
    places = [("pinion", 10.0), ("pinion", 120.0), ("wheel", 10.0), ("wheel", 120.0)]
    text = PAIR + SHAFTS
    text += "".join(bearing(*at, law) for at, law in zip(places, laws, strict=True))
    if third:
        text += bearing("wheel", 95.0, third)
    found = load_case(text)
    assert isinstance(found, GearCase)
    return found


@cache
def train(*laws: str, third: str = "") -> MovingTrain:
    own = case(*laws, third=third)
    ((state,),) = settled(own, [0], states=[UNDEFORMED])
    return moving(own, state)


def test_the_mean_of_a_settled_path_is_the_place_at_rest(compared: Compared) -> None:
    """Two linear bearings a shaft: means follow from the balance of forces, whatever shakes."""
    own = train(SPRING, SPRING, SPRING, SPRING)
    found = recorded(own, settle(GearedMap(model=own.model), own.start).state, 2)
    rest = own.state.rest.bearing_displacement
    path = found.journal_path
    swing = np.ptp(path, axis=0).max()
    assert swing > 1e-7
    away = np.abs(path.mean(axis=0) - rest).max()
    compared("mean place of a journal", "statics", away / np.abs(rest).max(), 1e-8)
    assert (found.bearing_contact == 1.0).all()
    assert (found.bearing_losses == 0).all()


def test_a_train_that_nothing_shakes_stays_where_it_rests(compared: Compared) -> None:
    own = train(BALLS, RING, SPRING, SPRING)
    still = replace(
        own.model,
        mesh_stiffness=Periodic(own.model.mesh_stiffness.mean),
        error=Periodic(0.0),
    )
    found = recorded(replace(own, model=still), own.start, 3)
    rest = own.state.rest.bearing_displacement
    away = np.abs(found.journal_path - rest).max() / np.abs(rest).max()
    compared("place of a journal, nothing shakes", "statics", away, 1e-8)
    assert (found.bearing_contact == 1.0).all()


def test_force_follows_the_path_by_each_law_at_every_sample() -> None:
    """The force on a ring is -law(u): K u of a spring, k (|u| - c)^n along u in a clearance."""
    own = train(BALLS, RING, SPRING, SPRING, third=IDLE)
    found = recorded(own, own.start, 3)
    path, force = found.journal_path, found.bearing_force
    laws = [place.bearing.law for place in own.state.assembly.bearings]
    size = np.abs(force).max()
    seen = set()
    for number, law in enumerate(laws):
        u, f = path[:, number], force[:, number]
        r = np.linalg.norm(u, axis=1)
        if isinstance(law, LinearLaw):
            back = np.linalg.solve(np.array(law.stiffness_matrix), f.T).T
            assert np.allclose(u, back, atol=1e-12 * r.max())
        elif isinstance(law, RingLaw):
            deep = np.maximum(r - law.clearance, 0.0)
            told = (law.coefficient * deep**law.exponent / r)[:, None] * u
            assert np.allclose(f, told, atol=1e-9 * size)
            free = bool((r <= law.clearance).all())
            assert found.bearing_contact[number] == (0.0 if free else 1.0)
            seen.add(free)
        else:
            assert np.allclose(f, -law.force(u), atol=1e-9 * size)
    # one ring carries all the time, one with a wide play never
    assert seen == {True, False}
    # an elastic shaft in bearings of one law is pushed along its load
    assert (np.einsum("sbi,sbi->sb", path, force) >= 0.0).all()


@pytest.mark.parametrize("reach", [0.5, 2.0, 5.0])
def test_share_and_losses_of_a_swing_across_the_clearance(reach: float, compared: Compared) -> None:
    """u = a sin along x: |u| > c for 1 - 2 asin(c/a)/pi of the time, lost twice a swing."""
    own = train(BALLS, RING, SPRING, SPRING)
    place = own.state.assembly.bearings[1]
    law = place.bearing.law
    assert isinstance(law, RingLaw)
    across = own.reduction.vector(place.directions)
    unit = across @ np.linalg.inv(across.T @ across)
    phase = np.arange(4 * SAMPLES + 1) / SAMPLES
    u = reach * law.clearance * np.sin(2.0 * np.pi * (phase + 0.003))
    states = np.zeros((phase.size, own.model.dimension))
    states[:, : own.model.size] = np.outer(u, unit[:, 0])
    run = Run(
        sections=states[SAMPLES::SAMPLES], jacobian=np.empty(0), directions=np.empty(0),
        samples=states[:-1], sample_phase=phase[:-1], times=np.empty(0),
        counts=dict.fromkeys(COUNTS, 0), shares=np.zeros(3),
    )  # fmt: skip
    found = shown(own, run, 0.0)
    assert np.allclose(found.journal_path[:, 1, 0], u[:-1])
    share = 1.0 - 2.0 / np.pi * np.arcsin(1.0 / reach) if reach > 1.0 else 0.0
    away = found.bearing_contact[1] - share
    compared("share of contact of a swinging journal", "closed form", away, 1.0 / SAMPLES)
    assert found.bearing_losses[1] == (8 if reach > 1.0 else 0)


def test_a_journal_touches_where_its_bearing_pushes() -> None:
    rng = np.random.default_rng(4)
    u = rng.uniform(-2e-5, 2e-5, (400, 2))
    for law in (
        RingLaw(coefficient=1e8, exponent=1.5, clearance=1e-5),
        ElementLaw(elements=7, coefficient=8e9, clearance=8e-6),
        ElementLaw(elements=7, coefficient=8e9, clearance=-2e-6),
    ):
        pushed = np.linalg.norm(law.force(u), axis=1) > 0.0
        bearing = LocalBearing(
            directions=np.eye(2), coefficient=law.coefficient, clearance=law.clearance,
            elements=getattr(law, "elements", 0),
        )  # fmt: skip
        assert np.array_equal(bearing.depth(u, phase=np.zeros(400)) > 0.0, pushed)


def test_lines_of_two_base_frequencies_are_kept() -> None:
    nu = 0.381966
    orders = torus_orders(nu)
    for one in (1.0, nu, 1.0 - nu, 2.0 + 2.0 * nu, 12.0):
        assert np.abs(orders - one).min() < 1e-8
    assert 0.5 not in orders
    # two curves in turn: every order is met by half ones, too
    assert np.abs(torus_orders(nu, curves=2) - (0.5 + nu)).min() < 1e-8
    phase = np.arange(64 * SAMPLES) / SAMPLES
    found = lines(3.0 * np.cos(2.0 * np.pi * (1.0 + nu) * phase), orders=orders)
    assert abs(orders[found.argmax()] - 1.0 - nu) < 1e-8
    assert found.max() == pytest.approx(3.0, rel=1e-3)


def test_what_a_run_stores_of_its_journals() -> None:
    data, notices = train_motion(case(BALLS, RING, SPRING, SPRING))
    path = data["journal_path"]
    assert path.dims == ("state", "operating", "bearing", "axis", "sample")
    assert path.attrs["units"] == "m"
    clear = data["radial_internal_clearance"].values[:, 0]
    assert clear[1, 0] < clear[0, 0]  # a warm inner ring takes clearance
    assert np.allclose(clear[:, 1], 30e-6)
    assert np.isnan(clear[:, 2:]).all()
    amount = np.linalg.norm(data["mean_bearing_load"].values, axis=-1)
    assert np.allclose(amount, data["mean_bearing_force"].values)
    assert (data["bearing_contact_share"].values == 1.0).all()
    assert np.isnan(data["second_frequency"].values).all()
    # cages elsewhere: the drawn place first, and what all three give
    for name in ("mesh", "bearing"):
        forces = data[f"cage_{name}_force"].transpose(..., "cage")
        own = data[f"greatest_{name}_force"].values
        assert np.array_equal(forces.isel(cage=0).values, own)
        assert (np.ptp(forces.values, axis=-1) > 0.0).all()
        assert np.allclose(forces.values, own[..., None], rtol=0.02)
    assert set(data["cage_label"].values.ravel()) == {"period-1"}
    told = {one.code: one.data for one in notices}
    assert "train_cages" in told
    assert "train_cages_matter" not in told


def test_cages_a_whole_pitch_on_are_the_same() -> None:
    own = train(BALLS, RING, SPRING, SPRING)
    whole, half = own.model.with_cages_on(1.0), own.model.with_cages_on(0.5)
    state, same, apart = (
        GearedMap(model=model).carry(own.start, 4)[-1] for model in (own.model, whole, half)
    )
    away = GearedMap(model=own.model).distance
    assert away(state, same) < 1e-9
    assert away(state, apart) > 1e-5
