"""Long work part by part, coarse first, and ended where somebody asks for it."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.analysis.basins import basin_plan
from thermogear.analysis.diagram import diagram_plan
from thermogear.analysis.maps import map_plan, parameter_map
from thermogear.base.plan import Plan, Stopped, gather, slices
from thermogear.case.case import gear_case, load_case, load_example
from thermogear.case.family import GearFamily
from thermogear.dynamics.models import TorsionalModel
from thermogear.study.run import run
from thermogear.study.run_up import run_up_plan
from thermogear.study.sweep import sweep_plan

MODEL = TorsionalModel(
    damping_ratio=0.06,
    frequency=0.9,
    stiffness_amplitude=0.2,
    mean_force=0.1,
    force_amplitude=0.15,
)
RPM = np.pi / 30.0


def rig():  # type: ignore[no-untyped-def]
    return gear_case(load_example("rig"))


def plans() -> dict[str, Plan]:
    ratios = np.linspace(0.5, 1.4, 13)
    return {
        "diagram": diagram_plan(MODEL, "frequency", ratios, block=4, branch_period=0),
        "map": map_plan(
            MODEL, {"frequency": ratios, "force_amplitude": np.linspace(0.05, 0.3, 9)}, tile=5
        ),
        "run-up": run_up_plan(
            rig(), np.linspace(3800, 4600, 9) * RPM, branch_period=0, block=3, temperatures=["hot"]
        ),
        "sweep": sweep_plan(
            rig(), {"rpm": np.linspace(3000, 4000, 4) * RPM, "zeta": [0.05, 0.08, 0.1]}
        ),
        "basins": basin_plan(MODEL, x=np.linspace(-2, 2, 7), v=np.linspace(-1, 1, 5)),
    }


@pytest.mark.parametrize("name", ["diagram", "map", "run-up", "sweep", "basins"])
def test_slices_together_are_the_whole(name: str) -> None:
    plan = plans()[name]
    whole = gather(plan, threads=1)
    again = {n: np.full([plan.sizes[d] for d in v.dims], v.fill, v.dtype)
             for n, v in plan.variables().items()}  # fmt: skip
    seen = []
    for one in slices(plan, coarse=3, threads=2):
        seen.append(one.preview)
        if one.preview:
            assert name != "run-up"
        for key, variable in plan.variables().items():
            places = [one.where.get(d, np.arange(plan.sizes[d])) for d in variable.dims]
            again[key][np.ix_(*places)] = one.arrays[key]
    for key, values in again.items():
        assert np.array_equal(whole[key].values, values, equal_nan=values.dtype.kind == "f"), key
    # the preview comes first, all of it
    assert seen == sorted(seen, reverse=True)
    assert any(seen) == (name != "run-up")


def test_no_stored_number_stands_for_a_missing_one() -> None:
    """A whole number that may be missing is NaN, or its fill is told to whoever opens the file."""
    for plan in plans().values():
        for name, one in plan.variables().items():
            known = np.isnan(one.fill) or one.fill >= 0
            assert known or one.attributes["_FillValue"] == one.fill, (plan.kind, name)


def test_a_run_up_comes_in_order_of_speed() -> None:
    plan = plans()["run-up"]
    firsts: dict[int, list[int]] = {0: [], 1: []}
    for one in slices(plan):
        firsts[int(one.where["direction"][0])].append(int(one.where["pinion_speed"][0]))
    assert firsts == {0: [0, 3, 6], 1: [6, 3, 0]}


class Ended(Exception):
    """Somebody asked to stop."""


@pytest.mark.parametrize("name", ["diagram", "map", "run-up", "sweep", "basins"])
def test_work_ends_when_asked(name: str) -> None:
    plan, calls = plans()[name], 0

    def alive() -> None:
        nonlocal calls
        calls += 1
        if calls == 2:
            raise Ended

    with pytest.raises(Ended):
        gather(plan, threads=1, alive=alive)
    assert calls == 2


def test_closing_the_slices_ends_the_work() -> None:
    whole = slices(plans()["diagram"], threads=1)
    next(whole)
    whole.close()
    with pytest.raises(StopIteration):
        next(whole)


def test_a_run_and_a_map_end_when_asked() -> None:
    def alive() -> None:
        raise Stopped

    with pytest.raises(Stopped):
        run(gear_case(load_case("rig", {"operating.speed": "3000 rpm"})), alive=alive)
    with pytest.raises(Stopped):
        parameter_map(
            MODEL, {"frequency": [0.9, 1.0], "force_amplitude": [0.1, 0.2]}, alive=alive, threads=1
        )


def test_samples_end_between_cycles() -> None:
    def alive() -> None:
        raise Stopped

    family = GearFamily(rig(), ("pinion_torque",), alive=alive)
    with pytest.raises(Stopped):
        family.quasi_static(np.full((3, 1), 90.0), ("half_backlash",))
