"""The load-sharing kernel against enumeration of all contact sets, and its energy."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize

from thermogear.gears import sharing_kernel
from thermogear.gears.contact import hertz_half_width
from thermogear.gears.sharing_kernel import _approach, _half_width, _share_one, _solve_spd
from thermogear.gears.stiffness import weber_approach

LINEAR = np.zeros(6)
"""A contact law of nothing: the springs stand in the compliance alone."""
CURVED = np.array([0.05, 0.08, 0.43, 0.2, 0.02, 0.1])
RUN = pytest.mark.parametrize("run", [_share_one, _share_one.py_func], ids=["compiled", "python"])


def places(count: int = 4) -> np.ndarray:
    """Of deep flanks and one without depth; far from a tip, near one, on a sharp and a round edge.

    Columns: h_1, h_2, rho*, r*, theta, d, lever.
    """
    out = np.ones((count, 7))
    out[:, 0] = np.sqrt(np.geomspace(1e-3, 100.0, count))
    out[:, 1] = np.sqrt(np.linspace(0.0, 5.0, count))
    kinds = [[0.0, 0.0, np.inf, 1.0], [0.0, 0.0, 0.3, 1.0], [0.0, 2.0, 0.0, 0.98]]
    out[:, 3:] = np.resize([*kinds, [0.1, 0.5, 0.0, 0.99]], (count, 4))
    return out


def random_mesh(seed: int, count: int = 4) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(count, count))
    compliance = root @ root.T / count + np.eye(count)
    return compliance, rng.uniform(0.0, 2.0, count), rng.uniform(0.1, 1.0, count)


def by_enumeration(
    load: float, gap: np.ndarray, matrix: np.ndarray
) -> tuple[np.ndarray, float, float]:
    """The one set of pairs whose forces push and whose other gaps stay open."""
    count = gap.size
    for size in range(1, count + 1):
        for loaded in itertools.combinations(range(count), size):
            index = list(loaded)
            soft = np.linalg.inv(matrix[np.ix_(index, index)])
            delta = (load + soft.sum(axis=0) @ gap[index]) / soft.sum()
            force = np.zeros(count)
            force[index] = soft @ (delta - gap[index])
            if force[index].min() > 0.0 and np.all(matrix @ force + gap >= delta - 1e-12):
                return force, delta, float(soft.sum())
    raise AssertionError("no contact set fits")


@RUN
def test_linear_contact_is_the_only_contact_set_that_fits(run) -> None:  # type: ignore[no-untyped-def]
    for seed in range(40):
        compliance, gap, linear = random_mesh(seed)
        for load in (0.05, 1.0, 30.0):
            force = np.zeros(4)
            springs = compliance + np.diag(linear)
            delta, stiffness, settled = run(load, gap, springs, 1.0, places(), LINEAR, force)
            exact, at, slope = by_enumeration(load, gap, springs)
            assert settled
            assert force == pytest.approx(exact, rel=1e-9, abs=1e-11 * load)
            assert delta == pytest.approx(at, rel=1e-10)
            assert stiffness == pytest.approx(slope, rel=1e-9)


def test_the_contact_of_the_kernel_is_the_written_law() -> None:
    """Weber and Banaschek's approach of both gears beside K F^0.9 and a constant compliance."""
    nu, depth, softest = (0.3, 0.2), (4e-3, 1e-5), 3e-12
    # a = sqrt(4 F rho*/(pi b E*)) with 4 rho*/(pi b E*) = softest m^2/N
    law = np.array([0.0, 0.0, 0.3 / 0.7, 0.2 / 0.8, 0.02, 0.1])
    for i in range(2):
        law[i] = 2.0 * (1.0 - nu[i] ** 2) / (np.pi * 206e9 * 0.02)
    for force in (1e-3, 1.0, 4e3, 1e7):
        exact = 0.02 * force**0.9 + 0.1 * force
        for i in range(2):
            exact += float(
                weber_approach(
                    force,
                    depth=depth[i],
                    half_width=np.sqrt(softest * force),
                    modulus=206e9,
                    poisson=nu[i],
                    face_width=0.02,
                )
            )
        near = np.array([[*depth, 1.0, 0.0, 0.0, np.inf, 1.0]])
        assert _approach(force, softest, near, 0, law)[0] == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("kind", range(4), ids=["flank", "near a tip", "sharp edge", "round edge"])
def test_the_slope_of_a_contact_is_that_of_its_approach(kind: int) -> None:
    """Everywhere rising too: a contact widens in proportion to its force at most."""
    for force in np.geomspace(1e-6, 1e6, 25):
        h = 1e-5 * force
        got, slope = _approach(force, 1.0, places(), kind, CURVED)
        ends = [_approach(f, 1.0, places(), kind, CURVED)[0] for f in (force - h, force + h)]
        assert slope == pytest.approx((ends[1] - ends[0]) / (2.0 * h), rel=1e-7)
        assert slope > 0.0
        # work along the mate's normal: what the pinion does by its lever
        plain, straight = places(), places()[kind, 6]
        plain[kind, 6] = 1.0
        over = _approach(force / straight, 1.0, plain, kind, CURVED)
        assert (got, slope) == pytest.approx((over[0] / straight, over[1] / straight**2), rel=1e-13)


def test_half_widths_join_where_the_laws_meet() -> None:
    """a far from a tip; 0.3 a at a sharp tip, on either side; l on a steep edge; a_e on top."""
    wide, radius = 4.0 * 200e3 / (np.pi * 113e9), 8e-3
    a = float(hertz_half_width(200e3, radius, 113e9))

    def half(edge: float, angle: float, distance: float) -> float:
        return float(_half_width(wide, radius, edge, angle, distance)[0])

    assert half(0.0, 0.0, np.inf) == pytest.approx(a, rel=1e-12)
    assert half(0.0, 0.0, a * (1.0 - 1e-12)) == pytest.approx(a, rel=1e-11)
    assert half(0.0, 0.0, 0.5 * a) == pytest.approx(a * (1.0 - 0.7 * 0.25), rel=1e-12)
    assert half(0.0, 0.0, 0.0) == pytest.approx(0.3 * a, rel=1e-12)
    assert half(0.0, 1e-12, 0.0) == pytest.approx(0.3 * a, rel=1e-8)
    # a punch whose pressure falls from its edge as sqrt((l - x)/x) carries pi E* theta l/4
    assert half(0.0, 50.0, 0.0) == pytest.approx(0.5 * 0.65 * wide / 50.0, rel=1e-3)
    at = 1e-4
    assert half(at, 0.02, 0.0) - half(0.0, 0.02, 0.0) == pytest.approx(
        float(hertz_half_width(200e3, at, 113e9)), rel=1e-12
    )
    assert half(1e-20, 0.02, 0.0) == pytest.approx(half(0.0, 0.02, 0.0), rel=1e-6)


def test_nonlinear_contact_has_the_least_energy() -> None:
    """Energy with the integral of the contact's approach, minimised by another method."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    for seed in range(3):
        compliance, gap, _ = random_mesh(seed)

        def energy(f: np.ndarray, c=compliance, g=gap) -> float:
            work = 0.0
            for j, top in enumerate(np.maximum(f, 1e-12)):
                # the fifth power of the node: the approach has a root at no force
                at = top * (0.5 * (1.0 + nodes)) ** 5
                rate = 2.5 * top * (0.5 * (1.0 + nodes)) ** 4 * weights
                work += sum(
                    _approach(p, 1.0, places(), j, CURVED)[0] * w
                    for p, w in zip(at, rate, strict=True)
                )
            return float(0.5 * f @ c @ f + g @ f + work)

        force = np.zeros(4)
        _, _, settled = _share_one(3.0, gap, compliance, 1.0, places(), CURVED, force)
        assert settled
        found = minimize(
            energy,
            np.full(4, 0.75),
            method="SLSQP",
            bounds=[(0.0, None)] * 4,
            constraints={"type": "eq", "fun": lambda f: f.sum() - 3.0},
            options={"ftol": 1e-15, "maxiter": 500},
        )
        assert energy(force) <= found.fun + 1e-9
        assert force == pytest.approx(found.x, abs=2e-4)


def test_pairs_that_cannot_touch_are_left_out() -> None:
    compliance, gap, _ = random_mesh(3)
    gap[1] = np.inf
    force = np.zeros(4)
    _, _, settled = _share_one(50.0, gap, compliance, 1.0, places(), LINEAR, force)
    assert settled
    assert force[1] == 0.0


NAN = np.nan


@RUN
@pytest.mark.parametrize("place", [0, 3], ids=["nearest pair", "another pair"])
@pytest.mark.parametrize(
    "what", ["load", "gap", "compliance", "negative compliance", "place", "law"]
)
def test_nothing_settles_that_is_not_a_number(run, place: int, what: str) -> None:  # type: ignore[no-untyped-def]
    compliance, _, _ = random_mesh(5)
    gap, near, law = np.array([0.0, 0.1, 0.2, 0.3]), places(), CURVED.copy()
    load = 2.0
    match what:
        case "load":
            load = NAN
        case "gap":
            gap[place] = NAN
        case "compliance":
            compliance[place, place] = NAN
        case "negative compliance":
            compliance[place, place] = -5.0
        case "place":
            near[place, 2] = NAN
        case "law":
            law[place] = NAN
    force = np.zeros(4)
    delta, stiffness, settled = run(load, gap, compliance, 1.0, near, law, force)
    assert not settled
    assert np.isnan([delta, stiffness, *force]).all()


@pytest.mark.parametrize("run", [_solve_spd, _solve_spd.py_func], ids=["compiled", "python"])
def test_small_solver(run) -> None:  # type: ignore[no-untyped-def]
    compliance, gap, linear = random_mesh(7)
    right = np.stack([gap, linear], axis=1)
    exact = np.linalg.solve(compliance[:3, :3], right[:3])
    run(compliance.copy(), 3, right)
    assert right[:3] == pytest.approx(exact, rel=1e-12)


def test_forces_to_begin_with_change_the_steps_and_not_the_answer(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The energy is convex: one answer from every start, and from itself in one step."""
    asked: list[float] = []

    def counted(force: float, *rest: Any) -> tuple[float, float]:
        asked.append(force)
        return _approach.py_func(force, *rest)

    monkeypatch.setattr(sharing_kernel, "_approach", counted)
    for seed in range(6):
        compliance, gap, _ = random_mesh(seed)
        begun = np.zeros(4)
        delta, _, _ = _share_one(2.0, gap, compliance, 1.0, places(), CURVED, begun)
        for start in (begun.copy(), np.full(4, 0.5), np.array([0.0, 9.0, 0.0, np.nan])):
            force = start.copy()
            asked.clear()
            same, _, settled = _share_one.py_func(
                2.0, gap, compliance, 1.0, places(), CURVED, force
            )
            assert settled
            assert force == pytest.approx(begun, rel=1e-10, abs=1e-12)
            assert same == pytest.approx(delta, rel=1e-12)
            if np.array_equal(start, begun):
                assert len(asked) == np.count_nonzero(begun)
