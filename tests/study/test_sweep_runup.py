"""Sweeps and run-ups of the rig: static limits, linear response, hysteresis, one by one."""

import numpy as np
import pytest

from coded import coded
from thermogear.base.errors import InputError
from thermogear.case.case import load_case, load_example
from thermogear.case.response import Recording, respond
from thermogear.study.notices import difference_notices
from thermogear.study.run_up import run_up
from thermogear.study.sweep import sweep

RPM = np.pi / 30.0


def notices_of(data):
    return coded(data.attrs["notices"])


@pytest.fixture(scope="module")
def rig():
    return load_example("rig")


@pytest.fixture(scope="module")
def runs(rig):
    """Through the jump near 4400..5000 rpm, cold and at 140 C, with folds."""
    speeds = np.arange(4200.0, 5301.0, 100.0) * RPM
    return run_up(rig, speeds, temperatures=(None, 413.15), branch_period=1).data


@pytest.fixture(scope="module")
def plain(rig):
    """The same, cold, without folds."""
    speeds = np.arange(4200.0, 5301.0, 100.0) * RPM
    return run_up(rig, speeds, temperatures=(None,), branch_period=0).data


def test_slow_mesh_carries_its_static_force(rig):
    """Turning slowly the mesh force is the static one: K_v tends to 1."""
    data = run_up(rig, np.array([60.0, 120.0]) * RPM, temperatures=(None,), branch_period=0).data
    factor = data.dynamic_factor.values[0]
    assert np.all(np.abs(factor - 1.0) < 0.02)
    assert np.all(factor[:, 0] - 1.0 < factor[:, 1] - 1.0)
    static = rig.torques[0] / rig.pair.pinion.base_radius
    assert data.mesh_force_max.values == pytest.approx(static * factor[None], rel=1e-9)


@pytest.mark.slow
def test_jumps_lie_at_their_folds(runs):
    for state in (0, 1):
        mine = runs.jump_state.values == state
        up = mine & (runs.jump_direction.values > 0)
        down = mine & (runs.jump_direction.values < 0)
        assert up.sum() == 1
        assert down.sum() == 1
        rise, fall = runs.jump_fold.values[up][0], runs.jump_fold.values[down][0]
        assert fall < rise
        assert runs.jump_from.values[up][0] <= rise <= runs.jump_to.values[up][0]
        assert runs.jump_to.values[down][0] <= fall <= runs.jump_from.values[down][0]
    # heat softens the steel: the resonance and its folds move down
    cold, hot = (
        np.sort(runs.jump_fold.values[runs.jump_state.values == state]) for state in (0, 1)
    )
    assert np.all(hot < cold)


def test_between_the_jumps_two_motions_coexist(plain):
    speeds = plain.pinion_speed.values
    size = plain.dte_peak_to_peak.values[0]
    assert plain.jump_direction.values.tolist() == [1, -1]
    between = (speeds >= plain.jump_from.values[1]) & (speeds <= plain.jump_from.values[0])
    assert between.sum() >= 4
    assert np.all(size[1, between] > 1.2 * size[0, between])
    assert np.allclose(size[1, ~between], size[0, ~between], rtol=1e-6)


def variant(torque, damping, error):
    """The rig with another torque [N m], damping ratio and amplitude of the error [um]."""
    return load_case(
        "rig",
        {
            "operating.torque": f"{torque} N m",
            "dynamics.damping_ratio": f"{damping}",
            "transmission_error.harmonics": (
                f'[{{ order = 1, amplitude = "{error} um", phase = "0 deg" }}]'
            ),
        },
    )


def test_steep_growth_that_is_the_same_both_ways_is_no_jump():
    """16 % from 2280 to 2380 rpm, up and down alike: a rule of thumb called it a jump."""
    data = run_up(
        variant(60, 0.055, 10), np.array([2280.0, 2380.0]) * RPM, temperatures=(None,),
        branch_period=0,
    ).data  # fmt: skip
    size = data.dte_peak_to_peak.values[0]
    assert size[0] == pytest.approx(size[1], rel=1e-9)
    assert data.sizes["jump"] == 0


def test_jumps_are_the_same_in_coarse_and_in_fine_steps():
    """A fold at 2415.88 rpm and one at 2305.37, missed by a rule of thumb."""
    lists = []
    for step in (100.0, 50.0):
        speeds = np.arange(2200.0, 2501.0, step) * RPM
        data = run_up(variant(100, 0.03, 5), speeds, temperatures=(None,), branch_period=0).data
        lists.append(data.jump_fold.values / RPM)
        assert data.jump_direction.values.tolist() == [1, -1]
        # a run back from either meets the other
        assert data.jump_return.values[::-1] == pytest.approx(data.jump_fold.values, rel=1e-12)
    assert lists[0] == pytest.approx([2415.8812, 2305.3679], abs=1e-3)
    assert lists[1] == pytest.approx(lists[0], abs=1e-5)
    assert np.any(data.contact_loss_share.values > 0.0)
    assert "contact_lost" in notices_of(data)


def test_contact_that_lasts_is_not_called_lost():
    """A share of 4e-15 was rounding, and the words said that contact is lost at 1800 rpm."""
    data = run_up(
        variant(60, 0.05, 10), np.array([1800.0, 2400.0]) * RPM, temperatures=(None,),
        branch_period=0,
    ).data  # fmt: skip
    assert np.all(data.contact_loss_share.values[..., 0] == 0.0)
    assert np.all(data.contact_loss_share.values[..., 1] > 0.01)
    (told,) = notices_of(data)["contact_lost"]
    assert told["speeds"] == [[data.pinion_speed.values[1]] * 2]
    assert (told["computed"], told["states"]) == ([data.pinion_speed.values.tolist()], 1)


def test_where_the_runs_differ_is_said(plain):
    (told,) = notices_of(plain)["up_and_down_differ"]
    low, high = np.array(told["speeds"][0]) / RPM
    fold, rise = np.sort(plain.jump_fold.values) / RPM
    assert fold < low <= fold + 100.0
    assert rise - 100.0 <= high < rise
    same = plain.isel(direction=[0, 0])
    assert list(difference_notices(same)) == []


def test_waterfall_holds_the_power_of_the_transmission_error(plain):
    """Period-1 motion below order 10: the lines' squares add up to twice the variance."""
    periodic = plain.period.values == 1
    lines = (plain.dte_line.values**2).sum(axis=-1)[periodic]
    assert lines == pytest.approx(2.0 * plain.dte_rms.values[periodic] ** 2, rel=2e-3)


def test_notices_say_where_the_tests_lie(plain):
    (told,) = notices_of(plain)["range_of_frequencies"]
    speeds = np.array(told["speeds"])
    assert speeds / RPM == pytest.approx([1000.0, 2000.0, 3000.0])
    # a speed over that of the resonance is a mesh frequency over the natural one
    assert told["at"][0] == pytest.approx(speeds[[0, -1]] / told["resonance"])
    ratios = plain.frequency_ratio.values
    assert told["ratios"] == [[ratios.min(), ratios.max()]]


def test_sweep_points_do_not_know_each_other(rig):
    axes = {"rpm": np.array([900.0, 6000.0]) * RPM, "gear_temperature": [380.0, 420.0]}
    whole = sweep(rig, axes).data
    for i in range(2):
        for j in range(2):
            alone = sweep(
                rig,
                {
                    "pinion_speed": axes["rpm"][i : i + 1],
                    "gear_temperature": [axes["gear_temperature"][j]],
                },
            ).data
            for name in ("label", "period", "dte_rms", "dynamic_factor", "dte_line"):
                one, many = alone[name].values[0, 0], whole[name].values[i, j]
                assert np.allclose(one, many, rtol=1e-9, atol=1e-15), name


def test_jammed_corner_of_a_sweep_is_a_status(rig):
    data = sweep(rig, {"backlash": [2e-6, 125e-6]}).data
    assert data.status.values.tolist() == [1, 0]
    assert np.isnan(data.dynamic_factor.values[0])
    assert notices_of(data)["points_jammed"] == [{"count": 1, "points": 2}]


def test_response_of_a_motion_in_lasting_contact_is_linear(rig):
    """Twice the record length changes no figure of a period-1 motion."""
    from thermogear.analysis.settle import Rule, settle
    from thermogear.case.family import GearFamily

    points = GearFamily(rig, ("pinion_speed",))(np.array([[1000.0 * RPM]]))
    state = settle(points.flat, np.zeros((1, 2)), Rule(settled=1e-9)).state
    one = respond(points, state, Recording(periods=8), lines=True)
    two = respond(points, state, Recording(periods=16), lines=True)
    for name in ("dte_rms", "dte_peak_to_peak", "dynamic_factor", "mesh_force_max"):
        assert one[name] == pytest.approx(two[name], rel=1e-7), name


def test_bad_words_are_one_line(rig):
    with pytest.raises(InputError, match=r"pinion_speed: got 0 rpm; allowed 0\.1"):
        run_up(rig, [0.0, 10.0])
    with pytest.raises(InputError, match="allowed kind = 'gear'"):
        run_up(load_example("table-4.2"), [10.0])
    with pytest.raises(InputError, match="axes: got none; allowed at least one parameter"):
        sweep(rig, {})
