"""What is not a number never counts as solved: gears, pairs, deviations, the loaded contact."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
import pytest

from thermogear.base.errors import ConvergenceError, InputError
from thermogear.gears import mesh_system
from thermogear.gears.deviations import Contacts, PathTable
from thermogear.gears.geometry import Gear, Rack
from thermogear.gears.loaded import loaded_contact, solve_mesh
from thermogear.gears.pair import GearPair
from thermogear.gears.relief import optimise_tip_relief

PAIR = GearPair(Gear(25, 5e-3), Gear(75, 5e-3))
NUMBERS = [f.name for f in fields(Gear) if f.type in ("int", "float")]


@dataclass(frozen=True)
class Broken:
    """A deviation of one's own that says ``value`` at one pair of one position."""

    value: float

    def gap(self, at: Contacts) -> np.ndarray:
        gap = np.zeros(at.s.shape)
        gap[1, 2] = self.value
        return gap


@pytest.mark.parametrize("name", NUMBERS)
def test_no_number_of_a_gear_may_be_missing(name: str) -> None:
    """A size left out takes its default; one that was computed as nan is an error."""
    with pytest.raises(InputError) as caught:
        Gear(**{"teeth": 25, "module": 5e-3, name: float("nan")})  # type: ignore[arg-type]
    assert caught.value.field == name
    assert "got nan" in str(caught.value)


def test_nor_of_a_rack_or_a_pair() -> None:
    for name in ("addendum", "dedendum", "fillet_radius"):
        with pytest.raises(
            InputError, match=rf"^rack\.{name}: got nan modules; allowed 0\.\.5 modules$"
        ):
            Rack(**{name: float("nan")})
    with pytest.raises(InputError, match=r"^centre_distance: got nan m; allowed 0\.1\.\.20000 mm$"):
        GearPair(PAIR.pinion, PAIR.wheel, float("nan"))


@pytest.mark.parametrize("value", [np.nan, -np.inf])
def test_a_gap_of_no_number_is_refused(value: float) -> None:
    with pytest.raises(InputError) as caught:
        solve_mesh(PAIR, 4e3, [0.1, 0.6], deviations=[Broken(0.0), Broken(value)])
    assert str(caught.value) == (
        f"deviations[1].gap: got {value}; allowed a number of metres, or inf for a pair that "
        "never touches; Broken gives it"
    )
    open_ = solve_mesh(PAIR, 4e3, [0.1, 0.6], deviations=[Broken(np.inf)])
    assert open_.settled.all()


@pytest.fixture
def soft(monkeypatch: pytest.MonkeyPatch) -> None:
    """Teeth whose compliance is no number at the second position."""
    known = mesh_system.as_drawn

    def broken(*given: object) -> mesh_system.Drawn:
        drawn = known(*given)  # type: ignore[arg-type]
        tooth = drawn.tooth.copy()
        tooth[:, 1] = np.nan
        return drawn._replace(tooth=tooth)

    monkeypatch.setattr(mesh_system, "as_drawn", broken)


@pytest.mark.usefixtures("soft")
def test_a_position_without_compliance_has_a_status_and_no_numbers() -> None:
    got = loaded_contact(PAIR, [0.0, 4e3], [0.1, 0.6, 0.9])
    assert got.status.values.tolist() == [[0, 2, 0]] * 2
    for name in ("tangent_stiffness", "secant_stiffness", "load_share", "pair_force"):
        assert np.isnan(got[name].values[:, 1]).all(), name
        assert np.isfinite(got[name].values[:, 0]).all(), name
    assert np.isnan(got.transmission_error.values[:, 1]).all()
    assert np.isnan(got.mean_stiffness.values).all()
    assert np.isnan(got.double_contact_length.values).all()


@pytest.mark.usefixtures("soft")
def test_a_relief_is_not_optimised_on_a_mesh_that_does_not_settle() -> None:
    with pytest.raises(
        ConvergenceError, match=r"^loaded contact: 1 of 20 positions did not settle$"
    ):
        optimise_tip_relief(PAIR, 4e3, positions=20)


def test_a_table_of_the_path_without_numbers_is_refused() -> None:
    with pytest.raises(InputError, match=r"^path_table\.added: got shape \(2,\)"):
        PathTable(s=[0.0, 0.1], added=[0.0, np.nan])
    with pytest.raises(InputError, match=r"^path_table\.s: got 2 values"):
        PathTable(s=[0.0, np.nan], added=[0.0, 0.0])
