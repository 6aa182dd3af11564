"""Orbits, exponents and branches of subjects: laws and published numbers, by case or numbers."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from coded import coded
from said import numbers
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.base.parameters import NUMBERS, long_name
from thermogear.case.case import DimensionlessCase, GearCase, load_example
from thermogear.case.family import GearFamily
from thermogear.case.one_point import (
    OnePoint,
    of_case,
    of_numbers,
    parameter_name,
    parameter_value,
)
from thermogear.study.branches import (
    branch_results,
)
from thermogear.study.orbit import lyapunov_results, orbit_results

TRUTH = {
    case["id"]: case
    for case in json.loads(
        (Path(__file__).parents[1] / "dynamics" / "truth.json").read_text(encoding="utf-8")
    )["cases"]
}
BASE = {"zeta": 0.1535, "w": 1.245, "eps": 0.335, "fm": 0.017, "fh": -1.16}


def plain(**changes: float) -> OnePoint:
    return of_numbers({long_name(k): v for k, v in {**BASE, **changes}.items()})


@pytest.fixture(scope="module")
def rig_case() -> GearCase:
    case = load_example("rig")
    assert isinstance(case, GearCase)
    return replace(case, mesh_positions=60, harmonics=12)


def table() -> DimensionlessCase:
    case = load_example("table-4.2")
    assert isinstance(case, DimensionlessCase)
    return case


def test_orbit_of_plain_numbers_is_the_published_one() -> None:
    truth = TRUTH["S2"]
    found = orbit_results(plain(), 2)
    summary, data = found.summary, found.tree["orbit"].to_dataset()
    assert summary["state"] == pytest.approx(truth["poincare_points"][0], abs=1e-9)
    assert [mu["real"] for mu in summary["multipliers"]] == pytest.approx(
        [pair[0] for pair in truth["floquet_multipliers"]], abs=1e-7
    )
    assert summary["contact_losses"] == truth["contact_losses_per_orbit"]
    assert summary["time_share"]["drive"] == pytest.approx(truth["time_fraction_drive"], abs=1e-9)
    assert (summary["least"], summary["greatest"]) == pytest.approx(
        (truth["x_min"], truth["x_max"]), abs=1e-9
    )
    # the lines carry the orbit's mean square
    lines = data["line_amplitude"].values
    square = lines[0] ** 2 + 0.5 * np.sum(lines[1:] ** 2)
    assert np.sqrt(square) == pytest.approx(truth["x_rms"], rel=1e-8)
    assert {line["order"] for line in summary["lines"] if line["half_order"]} >= {0.5, 1.5, 2.5}
    (told,) = coded(found.notices)["back_flank_not_reached"]
    assert told["down_to"] == pytest.approx(0.706922, abs=5e-7)


def test_a_motion_that_closes_sooner_has_its_least_period() -> None:
    asked, least = orbit_results(plain(), 4), orbit_results(plain(), 2)
    assert asked.summary["period"] == 2
    assert asked.summary["multipliers"][0]["real"] == pytest.approx(
        least.summary["multipliers"][0]["real"], abs=1e-9
    )
    assert coded(asked.notices)["other_period"] == [{"asked": 4, "period": 2}]


def test_direct_newton_reaches_an_unstable_orbit() -> None:
    truth = TRUTH["D3"]
    numbers = {
        number: truth["params"][name]
        for number, name in zip(
            NUMBERS,
            ("zeta", "omega_h", "epsilon", "F_m", "F_h", "b_prime", "epsilon_T"),
            strict=True,
        )
    }
    found = orbit_results(of_numbers(numbers, (0.78, 0.045)), 1, transient=False)
    summary = found.summary
    assert summary["state"] == pytest.approx(truth["poincare_points"][0], abs=1e-9)
    assert not summary["stable"]
    assert "orbit_unstable" in coded(found.notices)


def test_no_closed_orbit_inside_chaos_says_so() -> None:
    with pytest.raises(
        ConvergenceError, match=r"is chaotic for 32 268 periods, 16 starts \(largest Lyapunov"
    ) as found:
        orbit_results(plain(zeta=0.1))
    said = re.search(r"exponent (\S+) \+- (\S+) > 0", str(found.value))
    truth = TRUTH["Sc"]
    error = np.hypot(float(said[2]), truth["lyapunov_max_se"])
    assert float(said[1]) == pytest.approx(truth["lyapunov_max"], abs=3 * error + 1e-3)


def test_lyapunov_exponent_and_its_sum() -> None:
    truth = TRUTH["Sc"]
    summary = lyapunov_results(plain(zeta=0.1)).summary
    assert summary["exponent"] == pytest.approx(
        truth["lyapunov_max"], abs=3 * np.hypot(summary["error"], truth["lyapunov_max_se"]) + 1e-3
    )
    assert summary["sum"] == pytest.approx(-0.2, abs=1e-15)
    assert numbers(summary["verdict"]) == [22000.0, 1.0]


def test_chaos_that_has_ended_by_the_end_of_its_record_is_said() -> None:
    """On its period-5 orbit by 18 000 periods; it was called chaotic for 22 000."""
    values = {
        "damping_ratio": 0.036281193420631005,
        "frequency": 0.4856413205292942,
        "stiffness_amplitude": 0.28745010005734567,
        "mean_force": 0.3020883356856766,
        "force_amplitude": 0.5082231342633113,
        "half_backlash": 1.0579260211766828,
    }
    subject = of_numbers(values, (-0.22516572016971326, -1.704480535133318))
    found = lyapunov_results(subject)
    assert numbers(found.summary["verdict"]) == [5.0, 22000.0]
    assert set(coded(found.notices)) == {"exponent_of_transient"}


def test_an_interrupted_exponent_keeps_its_batches() -> None:
    def stop(_stage: str, done: int, _total: int) -> None:
        if done == 3:
            raise KeyboardInterrupt

    found = lyapunov_results(plain(), batches=20, batch_periods=50, discard=300, progress=stop)
    assert found.interrupted
    assert found.summary["batches"] == 6
    # lambda_1 of a stable orbit is ln|mu|/(n T)
    truth = TRUTH["S2"]["lyapunov"][0]
    assert found.summary["exponent"] == pytest.approx(truth, abs=1e-6)


def test_an_interrupted_branch_keeps_its_orbits(tmp_path: Path) -> None:
    def stop(stage: str, done: int, _total: int) -> None:
        if stage == "branch" and done > 200:
            raise KeyboardInterrupt

    found = branch_results(plain(zeta=0.18), "damping_ratio", 0.1, progress=stop)
    assert found.interrupted
    assert found.summary["branches"][0]["ended"] == "interrupted"
    assert found.summary["branches"][0]["points"] > 3
    path = found.write(tmp_path)
    with xr.open_datatree(path, engine="h5netcdf") as tree:
        assert tree["branch_0"]["value"].values[0] == pytest.approx(0.18)


def test_doubled_branches_are_followed_to_the_end() -> None:
    summary = branch_results(plain(zeta=0.18), "damping_ratio", 0.1, switch=2).summary
    assert [b["period"] for b in summary["branches"]] == [1, 2, 4]
    flips = [b["value"] for b in summary["bifurcations"] if b["kind"] == "period doubling"]
    assert flips == pytest.approx([0.170043027, 0.115498003, 0.109948814], abs=6e-10)


def test_a_gear_pair_speaks_in_micrometres_and_hertz(rig_case: GearCase) -> None:
    subject = of_case(rig_case, operating=3)
    found = orbit_results(subject)
    data, summary = found.tree["orbit"].to_dataset(), found.summary
    assert summary["mesh_frequency_hz"] == pytest.approx(25 * 3000 / 60)
    assert data["line_frequency"].values == pytest.approx(data["order"].values * 1250.0)
    assert data["displacement"].attrs["units"] == "m"
    b = rig_case.cold_backlash.half
    assert summary["state_si"][0] == pytest.approx(summary["state"][0] * b)
    # the mean mesh force is T1/r_b1, so the load factor is 1 plus the fluctuation
    assert summary["dynamic_load_factor"] > 1.0


def test_the_flanks_of_a_gear_case_reach_its_orbits() -> None:
    """The excitation behind orbits and branches is that of a sweep, tip relief included."""
    relieved = ['gears.pinion.tip_relief={amount="20 um", length="4 mm"}']
    case = load_example("rig", relieved)
    assert isinstance(case, GearCase)
    phase = np.arange(64) / 64
    ours, without = (
        of_case(one).points.flat.values("stiffness", phase) for one in (case, load_example("rig"))
    )
    swept = GearFamily(case, ("pinion_speed",))(np.array([[case.speeds[0]]]))
    np.testing.assert_allclose(ours, swept.flat.values("stiffness", phase), rtol=1e-12)
    assert np.max(np.abs(ours / without - 1.0)) > 0.01


def test_speed_moves_the_frequency_alone(rig_case: GearCase) -> None:
    slow, fast = (of_case(rig_case, operating=k) for k in (1, 3))
    models, present = slow.along("speed"), slow.value("speed")
    assert present == pytest.approx(1000 * np.pi / 30)
    moved, there = models(3000 * np.pi / 30).model(), fast.points.model()
    assert moved.frequency == pytest.approx(there.frequency, rel=1e-14)
    assert moved.stiffness == there.stiffness
    assert moved.force.harmonics == pytest.approx(there.force.harmonics, rel=1e-12)  # type: ignore[union-attr]


def test_temperature_begins_where_the_case_stands(rig_case: GearCase) -> None:
    subject = of_case(rig_case)
    models, present = subject.along("temperature"), subject.value("temperature")
    assert present == pytest.approx(140.0 + 273.15)
    here = subject.points.model().frequency
    assert models(present).model().frequency == pytest.approx(here, rel=1e-14)
    # E falls with temperature, and the natural frequency with it
    assert models(present + 20.0).model().frequency > here  # type: ignore[operator]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"row": "zetta"}, r"--row: got 'zetta'; allowed zeta \| omega \| epsilon; did you mean"),
        ({"point": 9}, r"--point: got 9; allowed 1\.\.4"),
    ],
)
def test_what_is_not_in_a_dimensionless_case(changes: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        of_case(table(), **changes)  # type: ignore[arg-type]


def test_what_does_not_fit_a_gear_case(rig_case: GearCase) -> None:
    with pytest.raises(InputError, match="--zeta: got a number beside a gear case"):
        of_case(rig_case, numbers={"damping_ratio": 0.1})
    with pytest.raises(InputError, match="--state: got undeformed, with a temperature to vary"):
        of_case(rig_case, state="undeformed").along("temperature")
    with pytest.raises(InputError, match="--bundle: got 'thesys'"):
        of_case(rig_case, bundle="thesys")
    with pytest.raises(InputError, match=r"--parameter: got 'sped'.*did you mean 'speed'"):
        parameter_name(of_case(rig_case), "sped")
    with pytest.raises(InputError, match="--to: got '4000 Hz'"):
        parameter_value("--to", of_case(rig_case), "speed", "4000 Hz")
