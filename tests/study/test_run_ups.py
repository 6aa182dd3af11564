"""Run-ups of samples side by side: each as it runs alone, jumps where one run-up has them."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.case.case import gear_case, load_case, load_example
from thermogear.study.run_up import run_up
from thermogear.study.run_ups import run_ups

RPM = np.pi / 30.0
SPEEDS = np.linspace(4200, 5200, 21) * RPM


def rig():  # type: ignore[no-untyped-def]
    return gear_case(load_example("rig"))


def test_a_sample_runs_as_if_alone() -> None:
    zeta = np.array([0.05, 0.07, 0.09])
    torque = np.array([90.0, 100.0, 110.0])
    samples = {"dynamics.damping_ratio": zeta, "torque": torque}
    whole = run_ups(rig(), SPEEDS[::3], samples, threads=2)
    assert dict(whole.sizes)["sample"] == 3
    for place in range(3):
        alone = run_ups(rig(), SPEEDS[::3], {n: v[[place]] for n, v in samples.items()}, threads=1)
        for name in whole.data_vars:
            one, many = alone[name].values[:, 0], whole[name].values[:, place]
            assert np.array_equal(one, many, equal_nan=one.dtype.kind == "f"), name


def test_jumps_lie_where_one_run_up_has_them() -> None:
    """The rig at its own values, hot: the step over a jump holds the jump of the run-up."""
    lanes = run_ups(rig(), SPEEDS, {"damping_ratio": [0.07]})
    alone = run_up(rig(), SPEEDS, temperatures=["hot"], branch_period=0).data
    for direction in (0, 1):
        swing = lanes["dte_peak_to_peak"].values[direction, 0]
        single = alone["dte_peak_to_peak"].values[0, direction]
        quiet = np.isclose(swing, single, rtol=1e-6)
        # where they differ, a jump lies within the step
        assert (~quiet).sum() <= 2
        place = int(np.argmax(np.abs(np.diff(single))))
        mine = int(np.argmax(np.abs(np.diff(swing))))
        assert abs(place - mine) <= 1


def test_a_bad_sample_is_a_status_and_bad_words_are_refused() -> None:
    some = run_ups(rig(), SPEEDS[:2], {"cold_half_backlash": [2e-6, 125e-6]})
    assert (some["status"].values[:, 0] == 1).all()
    assert (some["status"].values[:, 1] == 0).all()
    with pytest.raises(InputError, match="samples: got none"):
        run_ups(rig(), SPEEDS, {})
    with pytest.raises(InputError, match=r"samples: got torque \(2,\), zeta \(3,\)"):
        run_ups(rig(), SPEEDS, {"torque": [1.0, 2.0], "zeta": [0.1, 0.2, 0.3]})
    for name in ("rpm", "operating.speed"):
        with pytest.raises(InputError, match="samples: got the speed"):
            run_ups(rig(), SPEEDS, {name: [1.0]})


@pytest.mark.filterwarnings("ignore::thermogear.base.errors.ValidityWarning")
@pytest.mark.parametrize(
    ("module", "angle", "teeth", "shift", "torque"),
    [(1.5, 20.0, (31, 47), 0.1, 12.0), (6.0, 22.5, (19, 52), 0.3, 900.0)],
)
def test_somebody_elses_gears_run_as_one_run_up(module, angle, teeth, shift, torque) -> None:  # type: ignore[no-untyped-def]
    """Flanks of a class, undeformed, over the resonance: lanes and the single run-up agree."""
    text = f"""
[gears]
module = "{module} mm"
pressure_angle = "{angle} deg"
face_width = "{10 * module} mm"
[gears.pinion]
teeth = {teeth[0]}
profile_shift = {shift}
[gears.wheel]
teeth = {teeth[1]}
[operating]
speed = "2000 rpm"
torque = "{torque} N m"
[flanks]
parts = 16
"""
    case = gear_case(load_case(text))
    probe = run_ups(case, [200.0], {"damping_ratio": [0.07]}, state="undeformed")
    speeds = np.linspace(0.4, 1.1, 4) * 200.0 / float(probe["frequency_ratio"].values[0, 0, 0])
    lanes = run_ups(case, speeds, {"damping_ratio": [0.07]}, state="undeformed")
    alone = run_up(case, speeds, temperatures=["undeformed"], branch_period=0).data
    for name in ("dte_peak_to_peak", "mesh_force_max"):
        one, many = alone[name].values[0], lanes[name].values[:, 0]
        assert many == pytest.approx(one, rel=1e-6), name
