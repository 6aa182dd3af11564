"""Fits: known factors are found again, with the uncertainty that linear theory gives."""

from __future__ import annotations

import re

import numpy as np
import pytest

from said import numbers
from thermogear.analysis.fit import fit
from thermogear.base.errors import InputError
from thermogear.measured.published import RPM, LineTable, SpeedLine
from thermogear.study.case_runs import overrides_of
from thermogear.study.compare import fit_case, tree_lines

RATIOS = np.array([0.2, 0.5, 0.9, 1.0, 1.1, 1.6])


def resonance(factors: np.ndarray) -> np.ndarray:
    """Amplitude of a damped oscillator, factors on damping 0.05 and forcing 2."""
    zeta = 0.05 * factors[0]
    return 2.0 * factors[1] / np.hypot(1 - RATIOS**2, 2 * zeta * RATIOS)


def test_known_factors_are_found_again() -> None:
    truth = np.array([1.7, 0.6])
    found = fit(
        resonance,
        ["damping", "force"],
        measured=resonance(truth),
        uncertainty=0.01 * resonance(truth),
    )
    assert found.factors == pytest.approx(tuple(truth), rel=1e-5)
    assert found.notices == ()


def test_the_uncertainty_is_that_of_many_noisy_fits() -> None:
    truth = np.array([1.3, 0.8])
    clean = resonance(truth)
    rng = np.random.default_rng(1)
    fits = [
        fit(
            resonance,
            ["damping", "force"],
            measured=clean * (1 + 0.02 * rng.standard_normal(6)),
            uncertainty=0.02 * clean,
        )
        for _ in range(150)
    ]
    spread = np.std(np.log([f.factors for f in fits]), axis=0)
    np.testing.assert_allclose(spread, np.mean([f.uncertainties for f in fits], axis=0), rtol=0.2)


def test_what_the_data_cannot_tell_is_said() -> None:
    def product(factors: np.ndarray) -> np.ndarray:
        return np.array([1.0, 2.0, 3.0]) * factors[0] * factors[1]

    alike = fit(
        product, ["a", "b"], measured=np.array([2.0, 4.0, 6.0]), uncertainty=np.full(3, 0.1)
    )
    said = [(level, set(text.split())) for level, text in alike.notices]
    assert any(level == "important" and words >= {"a", "from"} for level, words in said)

    def deaf(factors: np.ndarray) -> np.ndarray:
        return np.array([1.0, 2.0]) * factors[0]

    unseen = fit(deaf, ["a", "b"], measured=np.array([1.1, 2.2]), uncertainty=np.full(2, 0.01))
    assert any(re.search(r"\bb\b", text) for _, text in unseen.notices)
    few = fit(
        lambda f: np.array([f[0] * f[1] ** 2]),
        ["a", "b"],
        measured=np.array([2.0]),
        uncertainty=np.array([0.1]),
    )
    assert ("important", [2.0, 1.0]) in [(level, numbers(text)) for level, text in few.notices]


def test_refusals() -> None:
    with pytest.raises(
        InputError, match=r"^uncertainty: got \[0\.0\]; allowed > 0, finite, one for each"
    ):
        fit(resonance, ["a"], measured=np.ones(1), uncertainty=np.zeros(1))
    with pytest.raises(InputError, match=r"^parameters: got none; allowed one or more fields$"):
        fit(resonance, [], measured=np.ones(1), uncertainty=np.ones(1))


def test_overrides_scale_values_with_their_units() -> None:
    text = "[dynamics]\ndamping_ratio = 0.1\n[transmission_error]\nharmonics = [{ order = 1, "
    text += 'amplitude = "4 um" }]\n'
    assert overrides_of(text, {}, "dynamics.damping_ratio", 1.5) == {
        "dynamics.damping_ratio": str(0.1 * 1.5)
    }
    assert overrides_of(text, {}, "zeta", 1.5) == {"dynamics.damping_ratio": str(0.1 * 1.5)}
    assert overrides_of(text, {}, "transmission_error.amplitude", 2.0) == {
        "transmission_error.harmonics": '[{ order = 1, amplitude = "8.0 um" }]'
    }


@pytest.mark.slow
def test_a_cases_transmission_error_is_found_again_from_its_own_lines() -> None:
    from thermogear.case.case import load_example
    from thermogear.study.run import run

    quick = {
        "model.bundle": '"consistent"',
        "operating.speed": '["1000 rpm", "2000 rpm"]',
        "simulation.steps_per_period": "128",
        "simulation.discard": "100",
        "simulation.most_discarded": "400",
        "simulation.periods": "32",
        "grid.mesh_positions": "96",
        "draw.pictures": '["motion"]',
    }
    grown = {
        **quick,
        "transmission_error.harmonics": '[{ order = 1, amplitude = "6 um", phase = "0 deg" }]',
    }
    lines = tree_lines(run(load_example("rig", grown)))["consistent hot"].lines
    table = LineTable(
        "made",
        tuple(
            SpeedLine(speed=x.speed, frequency=x.frequency, displacement=x.displacement)
            for x in lines
        ),
    )
    found = fit_case(load_example("rig", quick), table, ["transmission_error.amplitude"])
    assert found.factors[0] == pytest.approx(1.2, rel=1e-3)
    assert lines[0].speed == pytest.approx(1000 * RPM)
