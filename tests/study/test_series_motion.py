"""Parts of a series and their motions, against exact orbits and a known population."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import thermogear as tg
from thermogear.analysis.orbits import periodic_orbit
from thermogear.base.errors import InputError
from thermogear.base.excitation import Excitation, Excitations, Periodic
from thermogear.case.points import points_of
from thermogear.dynamics.turns import TurnLanes, TurnTables, follow_turns
from thermogear.gears.turn import Eccentricity
from thermogear.mesh.series import SeriesMesh, series_mesh
from thermogear.mesh.thermal import HotPair
from thermogear.study import series
from thermogear.study.series import SeriesMotion, series_motion, series_parts

CASE = """
[gears]
module = "3 mm"
face_width = "30 mm"
[gears.pinion]
teeth = {z1}
[gears.wheel]
teeth = {z2}
[flanks]
accuracy = {grade}
seed = 1
[oil]
name = "ISO VG 100"
temperature = "80 degC"
[operating]
speed = "1500 rpm"
torque = "80 N m"
[temperatures]
reference = "20 degC"
pinion_addendum = "20 degC"
wheel_addendum = "20 degC"
pinion_bore = "20 degC"
wheel_bore = "20 degC"
housing = "20 degC"
"""
RATIOS = np.array([0.5, 0.95])
"""Mesh over natural frequency."""


def case_of(z1: int, z2: int, grade: int = 6) -> tg.GearCase:
    return tg.load_case(CASE.format(z1=z1, z2=z2, grade=grade))


def mesh_of(case: tg.GearCase, count: int, periods: int) -> SeriesMesh:
    hot = HotPair(case.pair, replace(case.operating, housing=case.housing), case.models[0])
    return series_mesh(hot, series_parts(case, count), periods)


def point_of(case: tg.GearCase, mesh: SeriesMesh) -> Excitations:
    """Inertias, radii, load and 24 harmonics; the rest is of no part."""
    force = 80.0 / case.pair.pinion.base_radius
    return Excitations.of(
        [
            Excitation(
                stiffness=Periodic(4e8, (0.0,) * 24), error=Periodic(0.0), half_backlash=1e-4,
                reference_half_backlash=1e-4, mean_force=force, mesh_frequency=1.0,
                inertias=(2e-3, 2e-3), base_radii=(0.03, 0.03), torques=(80.0, 80.0),
                damping_ratio=0.07,
            )
        ]
    )  # fmt: skip


def moved(mesh: SeriesMesh, case: tg.GearCase, ratios: np.ndarray, *damping: float) -> SeriesMotion:
    point = point_of(case, mesh)
    natural = np.sqrt(np.nanmean(mesh.stiffness) / point.equivalent_mass[0])
    speed = ratios * natural / case.pair.pinion.teeth
    return series_motion(mesh, point, speed, np.array(damping))


@pytest.fixture(scope="module")
def even() -> tuple[tg.GearCase, SeriesMesh]:
    case = case_of(20, 20)
    return case, mesh_of(case, 5, 20)


def test_parts_are_drawings_of_the_class_and_seed() -> None:
    case = case_of(20, 20)
    parts = series_parts(case, 3)
    assert parts[:2] == series_parts(case, 2)
    text = CASE.format(z1=20, z2=20, grade=6)
    third = 'seed = 1\nteeth = "drawn"\ndrawing = 2\n'
    assert parts[2] == tg.load_case(text.replace("seed = 1\n", third)).deviations
    coarser = series_parts(case_of(20, 20, grade=8), 3)
    for part, other in zip(parts, coarser, strict=True):
        doubled = [d.amount for d in other if isinstance(d, Eccentricity)]
        assert doubled == pytest.approx(
            [2.0 * d.amount for d in part if isinstance(d, Eccentricity)], rel=1e-12
        )


def test_a_case_without_a_class_has_no_series() -> None:
    text = CASE.format(z1=20, z2=20, grade=6)
    flanks = text[text.index("[flanks]") : text.index("[oil]")]
    case = tg.load_case(text.replace(flanks, "[transmission_error]\nharmonics = []\n"))
    with pytest.raises(InputError) as refused:
        series_parts(case, 2)
    assert refused.value.field == "flanks.accuracy"


def test_the_force_of_a_part_is_that_of_its_exact_orbit(
    even: tuple[tg.GearCase, SeriesMesh], compared
) -> None:
    case, mesh = even
    motion = moved(mesh, case, RATIOS, 0.07)
    assert motion.repeats.all()
    assert motion.contact_loss_share.max() > 0.01
    found = points_of(exact_points(case, mesh, motion.speed))
    lanes = TurnLanes(
        mean=found.flat.force[:, 0].real, damping=found.flat.damping,
        backlash=found.flat.half_backlash, period=found.flat.period,
    )  # fmt: skip
    tables = [
        TurnTables(stiffness=k, error=e / b, mesh_periods=20)
        for k, e, b in zip(found.flat.stiffness, found.error, found.length, strict=True)
    ]
    for place in range(found.status.size):
        part, speed = divmod(place, motion.speed.size)
        one = lanes_at(lanes, place)
        begun = np.array([[one.backlash[0] + one.mean[0], 0.0]])
        settled = follow_turns(tables[place], one, begun)
        orbit = periodic_orbit(found.model(place), 1, settled.state[0])
        factor = motion.dynamic_factor[0, part, speed] / orbit.dynamic_load_factor() - 1.0
        compared("dynamic factor of a part", "event-exact orbit", factor, 5e-3)
        lost = motion.contact_loss_share[0, part, speed] - (1.0 - orbit.time_share["drive"])
        compared("time out of contact of a part", "event-exact orbit", lost, 2e-3)


def lanes_at(lanes: TurnLanes, place: int) -> TurnLanes:
    return TurnLanes(**{name: values[[place]] for name, values in vars(lanes).items()})


def exact_points(case: tg.GearCase, mesh: SeriesMesh, speed: np.ndarray) -> Excitations:
    """The first three parts at each speed, with 24 harmonics of the mesh frequency."""
    (plain,) = [point_of(case, mesh).one(0)]
    assert plain is not None
    return Excitations.of(
        [
            replace(
                plain,
                stiffness=Periodic.from_samples(mesh.stiffness[part], 480),
                error=Periodic.from_samples(mesh.spring_error[part], 480),
                half_backlash=float(mesh.half_backlash[part].mean()),
                mesh_frequency=case.pair.pinion.teeth * float(rate), mesh_periods=20,
            )
            for part in range(3)
            for rate in speed
        ]
    )  # fmt: skip


def test_no_digit_of_a_motion_hangs_on_the_other_parts(
    even: tuple[tg.GearCase, SeriesMesh], monkeypatch: pytest.MonkeyPatch
) -> None:
    case, mesh = even
    monkeypatch.setattr(series, "AT_BOUNDS", 2)
    several = moved(mesh, case, RATIOS, 0.07, 0.03, 0.1)
    assert several.dynamic_factor.shape == (3, 5, 2)
    assert np.isfinite(several.dynamic_factor).sum() == 5 * 2 + 2 * 2 * 2
    curves = ("transmission_error", "spring_error", "stiffness", "half_backlash")
    few = replace(mesh, **{name: getattr(mesh, name)[:2] for name in curves})
    again = series_motion(few, point_of(case, few), several.speed, several.damping_ratio)
    for name in ("dynamic_factor", "contact_loss_share", "mesh_force_min", "repeats"):
        assert np.array_equal(getattr(again, name), getattr(several, name)[:, :2])


def test_parts_that_cannot_move_have_no_figures(even: tuple[tg.GearCase, SeriesMesh]) -> None:
    case, mesh = even
    backlash, stiffness = mesh.half_backlash.copy(), mesh.stiffness.copy()
    backlash[1, 3], stiffness[2, 7] = -1e-6, np.nan
    still = replace(mesh, half_backlash=backlash, stiffness=stiffness)
    found = moved(still, case, RATIOS, 0.07, 0.05)
    moves = np.isfinite(found.dynamic_factor).all(axis=(0, 2))
    assert moves.tolist() == [True, False, False, True, True]
    assert not found.repeats[:, ~moves].any()


def test_the_series_of_a_pair_has_the_quantiles_of_another_program() -> None:
    """64 parts of 20:40, module 3 mm, class 6, 80 N m, drawn with another seed elsewhere.

    Medians and 5 and 95 % quantiles: two such series differ by a few percent.
    """
    case = case_of(20, 40)
    mesh = mesh_of(case, 64, 40)
    error = 1e6 * mesh.transmission_error
    ratios = np.geomspace(0.1, 1.4, 45)
    factor = moved(mesh, case, ratios, 0.07).dynamic_factor[0]
    synchronous = np.ptp(error.reshape(64, 40, -1).mean(axis=1), axis=1)
    known = {
        "error of the turn": (1e6 * mesh.peak_to_peak, (24.0, 32.0, 41.0), 0.12),
        "mesh-synchronous error": (synchronous, (2.3, 4.2, 6.7), 0.25),
        "factor at .5": (factor[:, np.argmin(np.abs(ratios - 0.5))], (2.3, 3.2, 3.9), 0.12),
        "greatest factor": (factor.max(axis=1), (2.9, 3.9, 4.8), 0.12),
    }
    for name, (values, expected, within) in known.items():
        got = np.quantile(values, [0.05, 0.5, 0.95])
        assert got == pytest.approx(expected, rel=within), name
