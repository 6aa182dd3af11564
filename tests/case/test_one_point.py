"""One point of a case is a family with one row; a branch runs along a family through it."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.case.case import GearCase, load_example
from thermogear.case.family import family
from thermogear.case.one_point import of_case, of_numbers
from thermogear.dynamics.models import from_excitation

FEW = {"grid.mesh_positions": "48", "grid.harmonics": "12", "model.bundle": "consistent"}


@pytest.fixture(scope="module")
def rig() -> GearCase:
    case = load_example("rig", FEW)
    assert isinstance(case, GearCase)
    return case


def test_a_point_is_a_row_of_the_family_of_its_case(rig: GearCase) -> None:
    point = of_case(rig, operating=2)
    whole = family(rig, ("rpm", "torque"))
    row = whole(np.array([[point.value("rpm"), point.value("torque")]]))
    for name in ("length", "rate", "stiffness", "force", "error", "mesh_frequency"):
        assert np.array_equal(getattr(row, name), getattr(point.points, name)), name
    own = from_excitation(point.excitation()).lanes()
    for name in ("period", "damping", "half_backlash", "stiffness", "force"):
        assert np.array_equal(getattr(point.points.flat, name), getattr(own, name)), name


@pytest.mark.parametrize(
    "parameter", ["rpm", "torque", "temperature", "backlash", "zeta", "w", "b"]
)
def test_every_parameter_begins_where_the_point_stands(rig: GearCase, parameter: str) -> None:
    point = of_case(rig, operating=3)
    there = point.along(parameter)(point.value(parameter)).flat
    for name in ("period", "damping", "half_backlash", "stiffness", "force"):
        here = getattr(point.points.flat, name)
        np.testing.assert_allclose(getattr(there, name), here, rtol=1e-13, atol=1e-18)


def test_a_field_of_the_file_varies_at_the_point_s_own_speed(rig: GearCase) -> None:
    point = of_case(rig, operating=3)
    width = rig.pair.pinion.face_width
    for name in ("face_width", "gears.pinion.face_width"):
        there = point.along(name)(width)
        assert there.mesh_frequency == point.points.mesh_frequency
        assert there.rate == pytest.approx(point.points.rate, rel=1e-12)
    wider = point.along("face_width")(1.2 * width)
    assert wider.stiffness > point.points.stiffness
    with pytest.raises(InputError, match="--from: got nothing; face_width stands in the file"):
        point.value("face_width")


def test_computed_heat_stays_along_speed_and_torque() -> None:
    """As hot as at the operating point: only temperature itself, and a sweep, change the heat."""
    case = load_example("rig", FEW)
    assert isinstance(case, GearCase)
    point = of_case(case, operating=1, state="computed")
    slow, mid, fast = (point.along("rpm")(f * point.value("rpm")) for f in (1.0, 2.0, 3.0))
    assert slow.half_backlash == point.points.half_backlash
    # only what the speed itself pulls the gears outward by, with its square
    assert (slow.half_backlash - fast.half_backlash) == pytest.approx(
        8.0 / 3.0 * (slow.half_backlash - mid.half_backlash), rel=1e-6
    )
    assert fast.stiffness == pytest.approx(slow.stiffness, rel=1e-3)
    swept = family(case, ("rpm",), state="computed")
    rows = swept(np.array([[point.value("rpm")], [3.0 * point.value("rpm")]]))
    assert rows.half_backlash[0] == slow.half_backlash[0]
    assert rows.half_backlash[1] != rows.half_backlash[0]


def test_plain_numbers_have_no_units() -> None:
    numbers = {"damping_ratio": 0.1, "frequency": 1.2, "stiffness_amplitude": 0.3}
    point = of_numbers({**numbers, "mean_force": 0.1, "force_amplitude": -1.0})
    assert not point.points.gears
    assert point.value("w") == 1.2
    assert point.along("omega")(1.3).flat.period == 2.0 * np.pi / 1.3
    with pytest.raises(InputError, match="allowed kind = 'gear'"):
        point.excitation()
