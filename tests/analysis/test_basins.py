"""Basins: published counts to the last start, entropies in closed form, matching."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from thermogear.analysis.attractors import (
    WIDEST_TRAP,
    Attractor,
    Field,
    _trap,
    attractors_from,
    chaotic_index,
    trapped,
)
from thermogear.analysis.basins import (
    BASIN_RULE,
    CHUNK_POINTS,
    BasinPlan,
    basin_entropy,
    basins,
    border_distances,
)
from thermogear.analysis.orbits import periodic_orbit
from thermogear.base.excitation import Periodic
from thermogear.base.vocabulary import STATUS
from thermogear.dynamics.models import DeadZoneModel, TorsionalModel

# attractor (period, point on it) -> starts of the grid that end there
TWO = {(1, 0.6479430038359856, 0.1515298562326813): 8090,
       (1, 1.1775558499577545, 0.0073759870378711): 2111}  # fmt: skip
SEVEN = {
    (1, 1.1891341213667848, -0.015769872606784224): 188,
    (2, 1.3938511831289992, -0.1595454918219694): 754,
    (6, 0.24000691048296938, 0.4938098446293777): 42,
    (3, -0.46330319138998327, -0.13185735603201762): 476,
    (2, -0.5558583520761098, 1.375219409916116): 752,
    (6, 0.8884625719648779, 0.04020210704681767): 158,
    (3, 1.2450510440239528, -0.08588016974955277): 231,
}
MODEL_TWO = TorsionalModel(
    damping_ratio=0.05, frequency=0.7, stiffness_amplitude=0.1, mean_force=0.1, force_amplitude=0.05
)
MODEL_SEVEN = TorsionalModel(
    damping_ratio=0.03,
    frequency=1.3,
    stiffness_amplitude=0.3,
    mean_force=0.1,
    force_amplitude=-0.05,
)


@pytest.mark.parametrize(
    ("model", "count", "truth"),
    [(MODEL_TWO, 101, TWO), (MODEL_SEVEN, 51, SEVEN)],
    ids=["two", "seven"],
)
def test_published_counts(model, count, truth, compared):
    axis = np.linspace(-2.0, 2.0, count)
    data = basins(model, x=axis, v=axis)
    assert data.sizes["attractor_number"] == len(truth)
    for (period, x, v), starts in truth.items():
        away = np.hypot(data.attractor_x - x, data.attractor_v - v).min("attractor_point")
        (number,) = np.flatnonzero(away.values < 1e-9)
        assert data.attractor_period.values[number] == period
        compared(
            "starts in each basin",
            "counts computed apart",
            data["count"].values[number] - starts,
            0,
            "starts",
        )
    assert data.attrs["unassigned"] == 0.0
    assert data.fraction.values.sum() == pytest.approx(1.0, abs=1e-15)


def test_threads_change_no_bit():
    axis = np.linspace(-2.0, 2.0, 31)
    assert basins(MODEL_SEVEN, x=axis, v=axis, threads=1).identical(
        basins(MODEL_SEVEN, x=axis, v=axis, threads=3)
    )


def test_mirrored_forces_mirror_the_basins():
    axis = np.linspace(-2.0, 2.0, 21)
    one = basins(MODEL_TWO, x=axis, v=axis)
    other = basins(MODEL_TWO.replace(mean_force=-0.1, force_amplitude=-0.05), x=axis, v=axis)
    assert np.array_equal(one.attractor.values, other.attractor.values[::-1, ::-1])


def test_starts_that_the_survey_misses_find_their_attractor():
    axis = np.linspace(-2.0, 2.0, 51)
    whole = basins(MODEL_SEVEN, x=axis, v=axis)
    late = basins(MODEL_SEVEN, x=axis, v=axis, survey=2)
    assert np.array_equal(np.sort(whole["count"].values), np.sort(late["count"].values))


def test_entropy_in_closed_form():
    """A border through the middle of every box gives ln 2; one colour gives 0."""
    stripes = np.tile([0, 0, 1, 1], (8, 2))
    mixed, mean, share = basin_entropy(stripes, box=4)
    assert (mixed, mean, share) == pytest.approx((np.log(2.0), np.log(2.0), 1.0))
    assert basin_entropy(np.zeros((8, 8), int), box=4) == (0.0, 0.0, 0.0)


def rattling(scale, damping=0.1):
    """The base set of table 4.2 in another unit of length: chaotic at 0.10, period 1 at 0.18."""
    force = Periodic(0.017 * scale, (-1.16 * scale,))
    return DeadZoneModel(
        damping_ratio=damping,
        frequency=1.245,
        stiffness=Periodic(1.0, (0.335,)),
        force=force,
        half_backlash=scale,
    )


@pytest.mark.parametrize("scale", [2.0**-13, 1.0, 2.0**9])
def test_a_chaotic_set_is_known_by_its_own_points_and_by_no_others(scale):
    field = Field(rattling(scale).lanes(), width=4)
    start = scale * np.array([0.0, 0.0])
    settled = field.one.visit(start[None], 300).points[0, -1]
    cloud = field.one.visit(settled[None], 2048).points[0]
    own = Attractor(period=0, points=cloud, multiplier=complex("nan"), lyapunov=0.05, trap=0.0)
    mirror = replace(own, points=-cloud)
    periodic = replace(own, period=1)
    later = field.one.visit(cloud[-1][None], 777).points[0, -1]
    for state in (settled, later):
        assert chaotic_index([own], field, state) == 0
        assert chaotic_index([periodic, mirror, own], field, state) == 2
        assert chaotic_index([periodic, mirror], field, state) == -1
        assert chaotic_index([periodic], field, state) == -1


def test_a_trap_holds_what_falls_into_it_however_slowly_the_orbit_draws():
    """In lasting contact the map is affine: the widest trap; a saddle beside it narrows it."""
    calm = TorsionalModel(
        damping_ratio=0.05,
        frequency=0.7,
        stiffness_amplitude=0.1,
        mean_force=0.5,
        force_amplitude=0.05,
    )
    slow = TorsionalModel(
        damping_ratio=0.1705,
        frequency=1.245,
        stiffness_amplitude=0.335,
        mean_force=0.017,
        force_amplitude=-1.16,
    )  # just before its flip
    folding = MODEL_TWO.replace(frequency=0.79)
    for model, start in ((calm, (1.5, 0.0)), (folding, (1.208, 0.021)), (slow, (1.08, -0.25))):
        (found,), (place,) = attractors_from(model.lanes(), np.array([start]), BASIN_RULE)
        assert place == 0
        orbit = periodic_orbit(model, found.period, found.points[0])
        size = abs(orbit.multipliers[0])
        assert abs(found.multiplier) == pytest.approx(size, rel=1e-9)
        assert found.lyapunov == pytest.approx(
            np.log(size) * model.frequency / (2.0 * np.pi * found.period), rel=1e-9
        )
        assert 0.0 < found.trap <= WIDEST_TRAP
        assert (found.trap == WIDEST_TRAP) == (model is not folding)
        field = Field(model.lanes(), width=8)
        rng = np.random.default_rng(3)
        starts = found.points[0] + found.trap * field.unit * rng.uniform(-1.0, 1.0, (40, 2))
        ends = field.of(40).visit(starts, 2000).points[:, -1]
        assert np.max(np.abs(ends - found.points[0]) / field.unit) < 0.1 * found.trap
    assert size > 0.99
    # about the unstable orbit beyond the flip no radius holds
    beyond = slow.replace(damping_ratio=0.165)
    saddle = periodic_orbit(beyond, 1, (1.08, -0.25))
    assert abs(saddle.multipliers[0]) > 1.0
    assert _trap(Field(beyond.lanes()), saddle.points, saddle.multipliers[0], 1) == 0.0
    # one lane, some lanes or all: the same maps
    for count in (1, 8, 11):
        assert field.of(count).backlash.shape == (count,)


def test_company_and_stride_change_no_trapped_start():
    rng = np.random.default_rng(5)
    starts = rng.uniform(-2.0, 2.0, (61, 2))
    lanes = MODEL_TWO.lanes()
    known, places = attractors_from(lanes, starts[:9], BASIN_RULE)
    assert len(known) == 2
    where, used, last = trapped(Field(lanes, width=61), starts, known)
    assert places.tolist() == where[:9].tolist()
    assert np.all(used % 4 == 0)
    for width in (1, 7, 60):
        other = trapped(Field(lanes, width=width), starts, known)
        for one, two in zip((where, used, last), other, strict=True):
            assert np.array_equal(one, two)
    # the last state is where that many periods lead, inside the trap and not four periods sooner
    field = Field(lanes, width=1)
    for n in (0, 17, 60):
        path = field.one.visit(starts[n][None], int(used[n])).points[0]
        assert last[n] == pytest.approx(path[-1], abs=1e-12)
        mine = known[where[n]]

        def inside(state, mine=mine):
            away = np.max(np.abs(mine.points - state) / field.unit, axis=1)
            return bool(away.min() < mine.trap)

        assert inside(path[-1])
        assert used[n] == 4 or not inside(path[-5])
    # of those that need longer nothing is known at the cap
    short, _, _ = trapped(field, starts, known, cap=40)
    assert np.array_equal(short == -1, used > 40)
    none, zero, still = trapped(field, starts, [replace(a, trap=0.0) for a in known])
    assert np.all(none == -1)
    assert not zero.any()
    assert np.array_equal(still, starts)


def test_a_start_that_leaves_for_infinity_is_no_basin():
    model = TorsionalModel(
        damping_ratio=0.001,
        frequency=2.0,
        stiffness_amplitude=0.9,
        mean_force=500.0,
        force_amplitude=0.0,
    )
    starts = np.array([[501.0, 0.1], [502.0, -3.0]])
    known = [
        Attractor(period=1, points=np.zeros((1, 2)), multiplier=0.5 + 0j, lyapunov=-0.1, trap=0.01)
    ]
    where, _, _ = trapped(Field(model.lanes(), width=1), starts, known)
    assert where.tolist() == [-2, -2]
    found, places = attractors_from(model.lanes(), starts, BASIN_RULE)
    assert found == []
    assert places.tolist() == [-2, -2]
    axis = np.array([500.0, 501.0])
    data = basins(model, x=axis, v=axis - 500.0)
    assert np.all(np.isnan(data.attractor))
    assert np.all(data.status == STATUS.index("diverged"))
    assert data.attrs["unassigned"] == 1.0
    assert data.sizes["attractor_number"] == 0


def test_what_the_survey_says_of_an_attractor_is_what_its_orbit_says():
    axis = np.linspace(-2.0, 2.0, 21)
    data = basins(MODEL_SEVEN, x=axis, v=axis)
    counts = data["count"].values
    assert counts.tolist() == sorted(counts, reverse=True)
    for n in range(data.sizes["attractor_number"]):
        period = int(data.attractor_period[n])
        points = np.stack([data.attractor_x[n], data.attractor_v[n]], axis=1)
        assert np.isfinite(points).all(axis=1).sum() == period
        orbit = periodic_orbit(MODEL_SEVEN, period, points[0])
        assert points[:period] == pytest.approx(orbit.points, abs=1e-9)
        size = abs(orbit.multipliers[0])
        assert float(data.attractor_multiplier[n]) == pytest.approx(size, rel=1e-6)
        assert float(data.attractor_lyapunov[n]) == pytest.approx(
            np.log(size) * MODEL_SEVEN.frequency / (2.0 * np.pi * period), rel=1e-6
        )
        assert counts[n] == np.count_nonzero(data.attractor == n)
        assert float(data.fraction[n]) == counts[n] / 21**2
    assert data.attrs["total_periods"] == int(data.used_periods.sum())
    mixed, every, rough = basin_entropy(data.attractor.values)
    assert data.attrs["boundary_basin_entropy"] == mixed
    assert data.attrs["basin_entropy"] == every
    assert data.attrs["boxes_with_borders"] == rough
    assert bool(data.attrs["boundary_fractal"]) == (mixed > np.log(2.0))


def test_entropy_and_border_distance_counted_start_by_start():
    rng = np.random.default_rng(11)
    where = rng.integers(-1, 3, (13, 17))
    where[:4, :4] = 1  # one box of one colour
    boxes = [where[i : i + 4, j : j + 4].ravel() for i in range(0, 12, 4) for j in range(0, 16, 4)]
    every = []
    for box in boxes:
        p = np.unique(box, return_counts=True)[1] / box.size
        every.append(float(-(p * np.log(p)).sum()))
    mixed, mean, share = basin_entropy(where, box=4)
    assert mean == pytest.approx(np.mean(every), rel=1e-12)
    assert share == pytest.approx(11 / 12)
    assert mixed == pytest.approx(np.mean([e for e in every if e > 0.0]), rel=1e-12)
    assert basin_entropy(where[:3], box=4) == basin_entropy(where[:, :3], box=4) == (0.0, 0.0, 0.0)

    x, v, unit = np.linspace(-1.0, 2.0, 13), np.linspace(3.0, -1.0, 17), np.array([0.5, 1.7])
    where = np.where(rng.random((13, 17)) < 0.1, 1, 0)
    where[6, 8] = 0
    grid = np.stack(np.meshgrid(x, v, indexing="ij"), axis=-1) / unit

    def orbit(*points):
        return SimpleNamespace(points=np.array(points))

    home, second = (x[6], v[8]), (x[2] + 0.1, v[3] - 0.1)
    known = [orbit(home), orbit(home, (9.0, 0.0)), orbit((9.0, 0.0)), orbit(home)]
    found = border_distances(x=x, v=v, where=where, known=known, unit=unit)
    least = np.linalg.norm((grid - np.array(home) / unit)[where != 0], axis=1).min()
    assert found[0] == pytest.approx(least, rel=1e-12)
    assert found[1] == 0.0  # stands on another's start
    assert np.isnan(found[2:]).all()  # outside the grid; no start of its own
    both = border_distances(x=x, v=v, where=where, known=[orbit(home, second)], unit=unit)
    near = np.linalg.norm((grid - np.array([x[2], v[3]]) / unit)[where != 0], axis=1).min()
    assert both[0] == pytest.approx(min(least, near) if where[2, 3] == 0 else 0.0, rel=1e-12)
    assert np.isnan(
        border_distances(x=x, v=v, where=np.zeros_like(where), known=[orbit(home)], unit=unit)[0]
    )
    for few in (
        {"x": x[:1], "v": v, "where": where[:1]},
        {"x": x, "v": v[:1], "where": where[:, :1]},
    ):
        assert np.isnan(border_distances(**few, known=[orbit(home)], unit=unit)).all()


@pytest.mark.parametrize(("rows", "columns"), [(7, 3), (5000, 3), (300, 100), (4, 20_000)])
def test_a_chunk_of_a_basin_holds_as_many_whole_rows_as_it_may(rows, columns):
    plan = BasinPlan(model=MODEL_TWO, x=tuple(range(rows)), v=tuple(range(columns)))
    cut = plan.cuts["x"]
    assert plan.sizes == {"x": rows, "v": columns}
    assert cut == 1 or cut * columns <= CHUNK_POINTS
    assert cut == rows or (cut + 1) * columns > CHUNK_POINTS
