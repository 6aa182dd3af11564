"""ISO 1328-1: published figures of both editions, grades, rounding, ranges."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.gears.accuracy import (
    EDITIONS,
    flank_tolerances,
    round_tolerance,
)


def micrometres(values: tuple[float, ...]) -> np.ndarray:
    return 1e6 * np.array(values)


@pytest.mark.parametrize(
    ("teeth", "module", "grade", "exact", "printed"),
    [
        (16, 4.5, 5, (6.87, 19.96, 5.87, 7.47, 9.51), (7, 20, 6, 7.5, 9.5)),
        (50, 3.0, 6, (8.98, 29.9, 7.57, 9.40, 12.07), (9, 30, 7.5, 9.5, 12)),
        (30, 2.0, 8, (16.6, 50.3, 13.7, 17.25, 22.1), (17, 50, 14, 17, 22)),
    ],
)
def test_edition_2013(
    teeth: int, module: float, grade: int, exact: tuple[float, ...], printed: tuple[float, ...]
) -> None:
    found = flank_tolerances(teeth, module * 1e-3, grade=grade)
    # the third row is given to one decimal
    within = 0.006 if grade < 8 else 0.051
    assert micrometres(found)[[0, 2, 3, 4]] == pytest.approx(
        np.array(exact)[[0, 2, 3, 4]], abs=within
    )
    assert micrometres(found)[1] == pytest.approx(exact[1], abs=0.051)
    assert micrometres(found.rounded()) == pytest.approx(printed, abs=1e-9)


@pytest.mark.parametrize(
    ("teeth", "module", "grade", "given"),
    [(16, 4.5, 5, (6.4, 19.5, 6.0, 7.4, 9.5)), (50, 3.0, 6, (9.1, 35.2, 8.0, 9.75, 12.6))],
)
def test_edition_1995(teeth: int, module: float, grade: int, given: tuple[float, ...]) -> None:
    found = flank_tolerances(teeth, module * 1e-3, grade=grade, edition="1995")
    assert micrometres(found) == pytest.approx(given, abs=0.051)


@pytest.mark.parametrize("edition", EDITIONS)
def test_two_grades_double_a_tolerance_and_every_size_widens_it(edition: str) -> None:
    rng = np.random.default_rng(1328)
    for _ in range(200):
        teeth, module = int(rng.integers(10, 300)), float(rng.uniform(0.6e-3, 12e-3))
        grade = int(rng.integers(1, 9))

        def of(z: int, m: float, a: int) -> np.ndarray:
            return np.array(flank_tolerances(z, m, grade=a, edition=edition))

        here = of(teeth, module, grade)
        assert of(teeth, module, grade + 2) == pytest.approx(2.0 * here, rel=1e-12)
        assert np.all(of(teeth, module, grade + 1) > here)
        assert np.all(of(teeth + 10, module, grade) >= here)
        assert np.all(of(teeth, 1.1 * module, grade) >= here)
        # the total lies between its greater part and the sum of both
        slope, form, total = here[2:]
        assert max(slope, form) < total < slope + form


def test_steps_of_1995_hold_their_upper_edge() -> None:
    """d 50 mm still belongs to 20..50, as the tables print it; just above it does not."""
    inside, edge, above = (
        flank_tolerances(25, m, grade=5, edition="1995").cumulative_pitch
        for m in (1.9e-3, 2e-3, 2.0001e-3)
    )
    assert inside == edge
    assert above > edge


def test_rounding() -> None:
    given = np.array([0.04, 0.05, 4.94, 4.96, 5.24, 5.25, 9.74, 9.76, 10.4, 10.5, 99.5])
    shown = np.array([0.0, 0.1, 4.9, 5.0, 5.0, 5.5, 9.5, 10.0, 10.0, 11.0, 100.0])
    assert 1e6 * round_tolerance(1e-6 * given) == pytest.approx(shown, abs=1e-9)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: flank_tolerances(20, 3e-3, grade=12),
            "accuracy.grade: got 12; allowed a whole number, 1..11; the grades of ISO 1328-1:2013",
        ),
        (
            lambda: flank_tolerances(20, 3e-3, grade=13, edition="1995"),
            "accuracy.grade: got 13; allowed a whole number, 0..12; the grades of ISO 1328-1:1995",
        ),
        (
            lambda: flank_tolerances(20, 3e-3, grade=6, edition="2018"),
            "accuracy.edition: got '2018'; allowed 2013 | 1995; did you mean '2013'?",
        ),
        (
            lambda: flank_tolerances(1001, 1e-3, grade=6),
            "accuracy.teeth: got 1001; allowed 5..1000; the range of ISO 1328-1",
        ),
        (
            lambda: flank_tolerances(20, 0.4e-3, grade=6),
            "accuracy.module: got 0.4 mm; allowed 0.5..70 mm; the range of ISO 1328-1:2013",
        ),
        (
            lambda: flank_tolerances(9, 0.5e-3, grade=6),
            "accuracy.diameter: got 4.5 mm; allowed 5..15000 mm; the range of ISO 1328-1:2013",
        ),
    ],
)
def test_nothing_is_extrapolated(call, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError) as caught:
        call()
    assert str(caught.value) == message
