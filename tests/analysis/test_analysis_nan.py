"""What is not a number never counts as closed, stable, settled, chaotic or reached."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from thermogear.analysis import proof as proofs
from thermogear.analysis import settle
from thermogear.analysis.attractors import (
    Field,
    attractors_from,
    chaotic_index,
    periodic_index,
    trapped,
)
from thermogear.analysis.basins import basins
from thermogear.analysis.continuation import continuation, family_of
from thermogear.analysis.curve import Curve
from thermogear.analysis.labels import label
from thermogear.analysis.lyapunov import Lyapunov, lyapunov_exponents
from thermogear.analysis.maps import parameter_map
from thermogear.analysis.orbits import Orbit, periodic_orbit, shoot
from thermogear.analysis.outcome import outcome_arrays
from thermogear.analysis.section import lanes_of
from thermogear.analysis.settle import CHAOTIC, DIVERGED, PERIODIC, Rule
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.base.vocabulary import STATUS
from thermogear.dynamics import exact
from thermogear.dynamics.exact_map import ExactMap
from thermogear.dynamics.models import TorsionalModel
from thermogear.dynamics.return_map import Visit, return_map

CALM = TorsionalModel(
    damping_ratio=0.1535,
    frequency=1.3,
    stiffness_amplitude=0.335,
    mean_force=0.017,
    force_amplitude=-1.16,
)
CHAOS = TorsionalModel(
    damping_ratio=0.1535,
    frequency=1.1,
    stiffness_amplitude=0.335,
    mean_force=0.017,
    force_amplitude=-1.16,
)
QUICK = Rule(first=64, cap=2048, chaos_periods=500)
NAN = float("nan")


@pytest.fixture(scope="module")
def orbit() -> Orbit:
    return periodic_orbit(CALM, 1, (1.08, -0.25))


class Lost(ExactMap):
    """A return map whose derivative, or whose end, is no number."""

    part = "jacobian"

    def visit(self, start: np.ndarray, periods: int = 1, *, sampled: bool = False) -> Visit:
        found = super().visit(start, periods, sampled=sampled)
        return replace(found, **{self.part: np.full_like(getattr(found, self.part), NAN)})

    def flow(self, start: np.ndarray, halves: int) -> tuple[np.ndarray, np.ndarray]:
        end, jacobian = super().flow(start, halves)
        return (end, jacobian * NAN) if self.part == "jacobian" else (end * NAN, jacobian)


@pytest.mark.parametrize("part", ["jacobian", "points"])
def test_newton_does_not_settle_where_the_map_has_no_numbers(orbit: Orbit, part: str) -> None:
    section = Lost(lanes_of(CALM))
    section.part = part
    assert shoot(return_map(lanes_of(CALM)), orbit.state, 1) is not None
    assert shoot(section, orbit.state, 1) is None


def test_a_guess_or_period_of_no_number_is_refused() -> None:
    with pytest.raises(InputError, match=r"^guess: got \[nan, 0\.0\]; allowed two finite numbers"):
        periodic_orbit(CALM, 1, (NAN, 0.0))
    for period in (NAN, np.inf, 1.5, 0):
        with pytest.raises(InputError, match=r"^period: got .*; allowed a whole number >= 1$"):
            periodic_orbit(CALM, period)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"^rule\.cap: got nan; allowed a whole number >= 8$"):
        Rule(cap=NAN)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"^rule\.close: got nan; allowed 0 < value <= 1$"):
        Rule(close=NAN)


def test_an_orbit_without_multipliers_is_not_stable(orbit: Orbit) -> None:
    assert orbit.stable
    assert not replace(orbit, jacobian=np.full((2, 2), NAN)).stable


@pytest.mark.parametrize("lost", ["derivative in the parameter", "derivative of the map", "map"])
def test_no_point_of_a_branch_without_numbers(
    orbit: Orbit, lost: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    family, start = family_of(CALM, "frequency")
    curve = Curve(family, "frequency", 1, start=start, span=0.2)
    guess = np.append(orbit.state, start) / curve.unit
    heading = np.array([0.0, 0.0, 1.0])
    assert curve.correct(guess, normal=heading) is not None
    if lost == "derivative in the parameter":
        monkeypatch.setattr(curve, "in_parameter", lambda *_: (np.full(2, NAN), np.inf))
    else:

        class Broken(Lost):
            part = "jacobian" if lost == "derivative of the map" else "points"

        monkeypatch.setattr(
            "thermogear.analysis.curve.return_map", lambda model: Broken(lanes_of(model))
        )
        curve = Curve(family, "frequency", 1, start=start, span=0.2)
    # on the curve already, and a step beside it
    for away in (0.0, 1e-3):
        assert curve.correct(guess + np.array([away, 0.0, 0.0]), normal=heading) is None
    monkeypatch.setattr(Curve, "in_parameter", lambda *_: (np.full(2, NAN), np.inf))
    with pytest.raises(ConvergenceError, match=r"^continuation in frequency: the first orbit does"):
        continuation(orbit, "frequency", 1.2)


def test_a_continuation_wants_numbers(orbit: Orbit) -> None:
    with pytest.raises(InputError, match=r"^to: got nan; allowed a finite number other than 1\.3"):
        continuation(orbit, "frequency", NAN)
    family, _ = family_of(CALM, "frequency")
    with pytest.raises(InputError, match=r"^start: got nan; allowed finite$"):
        continuation(orbit, "frequency", 1.2, family=family, start=NAN)


@pytest.mark.parametrize("lost", ["points", "jacobian", "residual", "border"])
def test_no_label_without_numbers(orbit: Orbit, lost: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert str(label(CALM, initial_state=(1.08, -0.25), cap=4000)) == "period-1"
    changes = {
        "points": {"points": np.full((1, 2), NAN)},
        "jacobian": {"jacobian": np.full((2, 2), NAN)},
    }.get(lost)
    if changes is not None:
        monkeypatch.setattr(proofs, "shoot", lambda *_: replace(orbit, **changes))
    border = NAN if lost == "border" else proofs.NEAR_BORDER
    if lost == "residual":
        monkeypatch.setattr(proofs, "shoot", lambda *_: None)
    got = label(CALM, initial_state=(1.08, -0.25), cap=4000, near_border=border)
    assert got.name == "undecided"


def test_an_exponent_of_no_number_is_not_chaos() -> None:
    batches = np.array([0.1, NAN, 0.1, 0.1])
    proof = Lyapunov(value=NAN, error=NAN, sum=-0.3, batches=batches, state=np.zeros(2))
    assert not proofs.proves_chaos(proof)
    assert np.isnan(proof.kaplan_yorke)
    assert replace(proof, value=-0.1).kaplan_yorke == 0.0
    lanes = lanes_of(CHAOS)
    broken = replace(lanes, force=lanes.force * np.array([[1.0, 1.0]]))
    with pytest.raises(InputError, match=r"^initial_state: got \[nan, 0\.0\]; allowed finite"):
        lyapunov_exponents(broken, initial_state=(NAN, 0.0))


def test_starts_that_are_no_numbers_settle_on_nothing() -> None:
    starts = np.array([[1.08, -0.25], [NAN, 0.0], [0.0, NAN]])
    many = lanes_of(CALM).take(np.zeros(3, int))
    found = settle.settle(many, starts, QUICK)
    assert found.label.tolist() == [PERIODIC, DIVERGED, DIVERGED]
    arrays = outcome_arrays(found, np.zeros(3, np.int8))
    assert arrays["status"].tolist() == [0, STATUS.index("diverged"), STATUS.index("diverged")]


def test_proofs_that_are_no_numbers_prove_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Points, derivatives and stretches are lost one after the other; no lane earns a label."""
    known = exact.advance
    start = {CALM: np.array([[1.08, -0.25]]), CHAOS: np.array([[0.0, 0.0]])}
    for model, code in ((CALM, PERIODIC), (CHAOS, CHAOTIC)):
        assert settle.settle(lanes_of(model), start[model], QUICK).label.tolist() == [code]

    def broken(maps, state, periods, **how):  # type: ignore[no-untyped-def]
        sections, stretch, samples = known(maps, state, periods, **how)
        if how.get("columns"):
            state.tangent[:] = NAN
        return sections, stretch * NAN, samples

    monkeypatch.setattr(exact, "advance", broken)
    for model in (CALM, CHAOS):
        found = settle.settle(lanes_of(model), start[model], QUICK)
        assert found.label.tolist() == [settle.UNDECIDED]
        status = outcome_arrays(found, np.zeros(1, np.int8))["status"]
        assert status.tolist() == [STATUS.index("not_converged")]


def test_no_attractor_is_reached_from_what_is_not_a_number() -> None:
    lanes = lanes_of(CALM)
    starts = np.array([[1.08, -0.25], [NAN, 0.0]])
    found, where = attractors_from(lanes, starts, QUICK)
    assert where.tolist() == [0, -2]
    reached, _, _ = trapped(Field(lanes), starts, found)
    assert reached.tolist() == [0, -2]
    unit = Field(lanes).unit
    assert periodic_index(found, np.array([NAN, 0.0]), 1, unit) == -1
    assert chaotic_index(found, Field(lanes), np.array([NAN, 0.0])) == -1


def test_axes_must_be_numbers() -> None:
    with pytest.raises(InputError, match=r"^x: got shape \(2,\); allowed finite numbers"):
        basins(CALM, x=[0.0, NAN], v=[0.0, 1.0])
    with pytest.raises(InputError, match=r"^frequency: got shape \(2,\); allowed finite numbers"):
        parameter_map(CALM, {"frequency": [1.2, NAN], "damping_ratio": [0.1, 0.2]})
