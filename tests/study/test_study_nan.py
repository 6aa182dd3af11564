"""What is not a number never counts as fitted or as a relief."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.analysis.fit import fit
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.case.case import gear_case, load_case
from thermogear.gears import mesh_system
from thermogear.study.relief import relief_survey

NAN = float("nan")


def test_a_fit_wants_numbers() -> None:
    u = np.ones(2)
    with pytest.raises(InputError, match=r"^measured: got \[1\.0, nan\]; allowed finite$"):
        fit(lambda f: f[0] * u, ["damping"], measured=np.array([1.0, NAN]), uncertainty=u)
    with pytest.raises(InputError, match=r"^uncertainty: got \[1\.0, nan\]; allowed > 0, finite"):
        fit(lambda f: f[0] * u, ["damping"], measured=u, uncertainty=np.array([1.0, NAN]))


@pytest.mark.parametrize("since", [0.0, 1.0 + 1e-9])
def test_a_fit_does_not_end_where_the_simulation_has_no_numbers(since: float) -> None:
    def simulate(factors: np.ndarray) -> np.ndarray:
        return np.array([factors[0], NAN if factors[0] >= since else 2.0])

    with pytest.raises(ConvergenceError, match=r"^fit: no finite line at the factors damping = 1"):
        fit(simulate, ["damping"], measured=np.array([3.0, 2.0]), uncertainty=np.ones(2))


def test_no_relief_without_a_settled_contact(monkeypatch: pytest.MonkeyPatch) -> None:
    case = gear_case(load_case("rig"))
    known = mesh_system.as_drawn

    def broken(*given: object) -> mesh_system.Drawn:
        drawn = known(*given)  # type: ignore[arg-type]
        return drawn._replace(tooth=NAN * drawn.tooth)

    monkeypatch.setattr(mesh_system, "as_drawn", broken)
    with pytest.raises(ConvergenceError, match=r"^loaded contact: 100 of 100 positions did not"):
        relief_survey(case)
