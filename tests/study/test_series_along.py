"""The series behind run-ups and sweeps: a part's own run, the answers' figures, no company."""

from __future__ import annotations

import numpy as np
import pytest

from coded import coded
from thermogear.base.errors import InputError
from thermogear.base.plan import gather, keep_going
from thermogear.base.units import RPM
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.family import GearFamily
from thermogear.study.run_up import run_up, run_up_plan
from thermogear.study.series import Series, Spread
from thermogear.study.series_along import at_points, over_speeds
from thermogear.study.sweep import sweep_plan
from thermogear.views.pages.sweeps import numbers

pytestmark = pytest.mark.filterwarnings("ignore::thermogear.base.errors.ValidityWarning")
CASE = """[gears]
module = "3 mm"
face_width = "30 mm"
[gears.pinion]
teeth = 20
[gears.wheel]
teeth = 20
[oil]
name = "ISO VG 100"
temperature = "80 degC"
[temperatures]
pinion_addendum = "90 degC"
wheel_addendum = "90 degC"
pinion_bore = "80 degC"
wheel_bore = "80 degC"
housing = "60 degC"
[flanks]
parts = 16
[grid]
path_positions = 41
mesh_positions = 48
harmonics = 12
[operating]
speed = "7000 rpm"
torque = "80 N m"
"""
SPEEDS = np.array([200.0, 2500.0, 4000.0]) * RPM
"""The first is too slow for a series."""


def case_of(*changes: str) -> GearCase:
    return gear_case(load_case(CASE, changes))


@pytest.fixture(scope="module")
def case() -> GearCase:
    return case_of()


def test_a_run_of_a_part_is_inside_the_band_where_the_series_has_it(case: GearCase) -> None:
    """Each part as a case of its own, followed over its turn by the other integrator."""
    speeds = SPEEDS[2:]
    result = run_up(case, speeds, temperatures=[None], branch_period=0)
    data = result.data
    assert data["series_dynamic_factor"].dims == ("state", "quantile", "damping", "pinion_speed")
    low, median, bad, high = data["series_dynamic_factor"].values[0, :, 0, 0]
    assert low < median < bad < high
    family = run_up_plan(case, speeds, temperatures=[None]).family(0)
    at = np.array([[case.speeds[0]]])
    hot = family.quasi_static(at, ("hot_pair", "cold_half_backlash"))["hot_pair"][0]
    motion = (
        Series.of(case)
        .followed(hot, family.excitations(at), speeds, own_speed=float(case.speeds[0]))
        .motion
    )
    factor = motion.dynamic_factor[0, :, 0]
    spread = Spread.of(factor)
    assert [low, median, bad, high] == [
        each.value for each in (spread.low, spread.middle, spread.bad, spread.high)
    ]
    # a series has 96 positions of a mesh period, a case of its own those of its grid
    one_part = ("flanks.parts=1", "flanks.teeth=drawn", "flanks.drawing=5", "gears.period=turn")
    drawn = case_of(*one_part, "grid.mesh_positions=96")
    own = run_up(drawn, speeds, temperatures=[None], branch_period=0).data
    assert own["dynamic_factor"].values[0, 0, 0] == pytest.approx(factor[5], rel=0.01)
    row = numbers(result)["series"][0]
    assert [row[name] for name in ("low", "median", "bad", "high")] == [low, median, bad, high]
    assert (row["pairs"], row["speed_rpm"]) == (16, pytest.approx(4000.0))
    (notice,) = coded(data.attrs["notices"])["run_of_a_series"]
    assert (notice["parts"], notice["own"], notice["periods"]) == (16, 1, None)
    assert (notice["slow"], notice["bad"], notice["speed"]) == (None, bad, speeds[0])


def test_a_point_of_a_sweep_has_its_own_gears_and_no_company(case: GearCase) -> None:
    """Class and speed vary: the columns of each row are those of a case that is so."""
    family = GearFamily(case, ("flanks.accuracy", "pinion_speed"))
    rows = np.array([[5.0, SPEEDS[1]], [8.0, SPEEDS[2]], [8.0, SPEEDS[0]]])
    every = at_points(family, rows, 16, keep_going)
    alone = at_points(family, rows[1:2], 16, keep_going)
    assert all(values[1] == alone[name][0] for name, values in every.items())
    other = case_of("flanks.accuracy=8", "operating.speed=4000 rpm")
    band = over_speeds(other, 16, [GearFamily(other, ("pinion_speed",))], SPEEDS[[0, 2]])
    assert np.isnan(band["series_dynamic_factor"].values[..., 0]).all()
    quantiles = [every[f"series_dynamic_factor_{n}"][1] for n in ("low", "median", "bad", "high")]
    assert quantiles == band["series_dynamic_factor"].values[0, :, 0, 1].tolist()
    assert every["series_parting_share"][1] == band["series_parting_share"].values[0, 0, 1]
    # a class further by three has errors of 2 sqrt(2) times, and the mesh deflects in both
    assert every["series_static_error_high"][1] > 1.5 * every["series_static_error_high"][0]
    # too slow for a motion, and the static error is known all the same
    assert every["series_parts"].tolist() == [16.0, 16.0, 0.0]
    assert np.isnan(every["series_dynamic_factor_bad"][2])
    assert every["series_static_error_bad"][2] == pytest.approx(
        every["series_static_error_bad"][1], rel=1e-3
    )


def test_a_sweep_stores_its_columns_and_a_jammed_point_is_a_status(case: GearCase) -> None:
    axes = {"cold_half_backlash": [6e-6, 60e-6]}
    plan = sweep_plan(case, axes)
    data = gather(plan, threads=2)
    assert data["series_parts"].values.tolist() == [0.0, 16.0]
    assert np.isnan(data["series_static_error_median"].values[0])
    (notice,) = coded(data.attrs["notices"])["sweep_of_a_series"]
    assert (notice["parts"], notice["accuracy"]) == (16, 6)


@pytest.mark.parametrize("change", ["flanks.seed=3", "flanks.parts=1", "gears.period=mesh"])
def test_one_part_has_nothing_of_a_series(change: str) -> None:
    text = CASE.replace("[flanks]\nparts = 16\n", "")
    one_part = gear_case(load_case(text, [change]))
    axes = {"pinion_speed": SPEEDS}
    for plan in (sweep_plan(one_part, axes), run_up_plan(one_part, SPEEDS)):
        assert "parts" not in plan.inputs()
        assert not [name for name in plan.variables() if name.startswith("series")]
    with pytest.raises(InputError, match=r"^parts: got 64; allowed 1;"):
        sweep_plan(one_part, axes, parts=64)


def test_how_many_parts_is_asked(case: GearCase) -> None:
    axes = {"pinion_speed": SPEEDS}
    whole = gear_case(load_case(CASE.replace("parts = 16", "parts = 64")))
    assert (run_up_plan(whole, SPEEDS).parts, sweep_plan(whole, axes).parts) == (64, 16)
    assert sweep_plan(case, axes, parts=1).parts == 1
    # numbers of the equation are not those of any gears
    assert sweep_plan(case, {"frequency": [0.5, 1.0]}).parts == 1
    for wrong in (0, 2, 15, 1025):
        with pytest.raises(InputError, match=rf"parts: got {wrong}; allowed 1 \| 16..1024"):
            run_up_plan(case, SPEEDS, parts=wrong)
