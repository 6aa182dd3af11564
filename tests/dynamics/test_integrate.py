"""Motion against closed forms, balances, symmetries and an independent integrator."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.base.excitation import Excitation, Periodic
from thermogear.base.vocabulary import STATUS
from thermogear.dynamics.adaptive import Gap, follow
from thermogear.dynamics.integrate import simulate
from thermogear.dynamics.models import DeadZoneModel, PairModel, TorsionalModel, from_excitation
from thermogear.dynamics.tables import Pieces

TRUTH = json.loads((Path(__file__).parent / "truth.json").read_text())
BASE = TorsionalModel(
    damping_ratio=0.1535,
    frequency=1.245,
    stiffness_amplitude=0.335,
    mean_force=0.017,
    force_amplitude=-1.16,
)
RATTLE = TorsionalModel(
    damping_ratio=[0.05, 0.05, 0.03, 0.1535],
    frequency=[0.7, 1.1, 1.3, 1.245],
    stiffness_amplitude=0.2,
    mean_force=0.1,
    force_amplitude=[0.2, 0.2, -0.05, -1.16],
)
PAIR = Excitation(
    stiffness=Periodic(4e8, (6e7, 2e7j)),
    error=Periodic(0.0, (2e-6, 1e-6j)),
    half_backlash=50e-6,
    reference_half_backlash=60e-6,
    mean_force=2000.0,
    mesh_frequency=9000.0,
    inertias=(0.001, 0.02),
    base_radii=(0.05, 0.15),
    torques=(100.0, 300.0),
    damping_ratio=0.07,
)


@pytest.mark.parametrize("method", ["exact", "rk4"])
def test_linear_frequency_response(method, compared):
    """No contact loss, constant stiffness: x = b + F_m + F_h cos(w t - phi)/|...|."""
    w = np.array([0.3, 0.7, 0.95, 1.4])
    zeta, mean, amplitude = 0.08, 0.6, 0.05
    model = TorsionalModel(
        damping_ratio=zeta,
        frequency=w,
        stiffness_amplitude=0.0,
        mean_force=mean,
        force_amplitude=amplitude,
    )
    data = simulate(
        model, periods=1, discard=150, method=method, steps_per_period=1024, initial_state=(1.6, 0)
    )
    response = amplitude / ((1 - w**2) + 2j * zeta * w)
    phase = np.arange(64) / 64
    expected = 1 + mean + (response[:, None] * np.exp(2j * np.pi * phase)).real
    compared(
        "linear frequency response, exact maps and Runge-Kutta",
        "closed form",
        data.x.values - expected,
        2e-8,
    )


@pytest.mark.parametrize("method", ["exact", "rk4"])
def test_scaling_by_powers_of_two_and_the_mirror_are_exact_to_the_last_bit(method):
    first = simulate(RATTLE, periods=20, method=method, initial_state=(0.3, 0.1))
    for factor in (2.0**-20, 0.5, 8.0):
        other = simulate(
            RATTLE.replace(
                mean_force=factor * 0.1,
                force_amplitude=factor * np.asarray(RATTLE.force_amplitude),
                half_backlash=factor,
            ),
            periods=20,
            method=method,
            initial_state=(factor * 0.3, factor * 0.1),
        )
        assert np.array_equal(other.x.values, factor * first.x.values)
        assert np.array_equal(other.v.values, factor * first.v.values)
    mirror = simulate(
        RATTLE.replace(mean_force=-0.1, force_amplitude=-np.asarray(RATTLE.force_amplitude)),
        periods=20,
        method=method,
        initial_state=(-0.3, -0.1),
    )
    assert np.array_equal(mirror.x.values, -first.x.values)


@pytest.mark.parametrize("method", ["exact", "rk4"])
def test_a_lane_does_not_depend_on_its_company_or_on_threads(method):
    rng = np.random.default_rng(5)
    count = 150
    fields = {
        "damping_ratio": rng.uniform(0.02, 0.2, count),
        "frequency": rng.uniform(0.3, 2.2, count),
        "stiffness_amplitude": rng.uniform(0, 0.6, count),
        "mean_force": rng.uniform(0.01, 0.3, count),
        "force_amplitude": rng.uniform(-1, 1, count),
    }
    options = {"periods": 10, "samples_per_period": 0, "method": method}
    many = simulate(TorsionalModel(**fields), threads=2, **options)
    again = simulate(TorsionalModel(**fields), threads=1, **options)
    assert np.array_equal(many.section_x, again.section_x)
    for size in range(1, 20):  # the ends of vector loops are compiled apart
        few = simulate(TorsionalModel(**{k: v[7 : 7 + size] for k, v in fields.items()}), **options)
        assert np.array_equal(few.section_x.values, many.section_x.values[7 : 7 + size])
    for lane in (0, 77, 149):
        alone = simulate(TorsionalModel(**{k: v[lane] for k, v in fields.items()}), **options)
        assert np.array_equal(alone.section_x.values[0], many.section_x.values[lane])
        assert np.array_equal(alone.section_v.values[0], many.section_v.values[lane])


def test_energy_balance_and_mean_mesh_force(compared):
    """dE = int(F v - c v^2 + k' f^2/2) over the run, and <k f> = F_m on a closed orbit."""
    per = 8192
    model = TorsionalModel(
        damping_ratio=0.1535,
        frequency=1.245,
        stiffness_amplitude=0.335,
        mean_force=0.017,
        force_amplitude=-1.16,
    )
    data = simulate(model, periods=2, discard=300, samples_per_period=per)
    x, v = data.x.values[0], data.v.values[0]
    phase = 2 * np.pi * np.arange(2 * per) / per
    f = x - np.clip(x, -1, 1)
    k, slope = 1 + 0.335 * np.cos(phase), -0.335 * 1.245 * np.sin(phase)
    force = 0.017 - 1.16 * np.cos(phase)
    power = force * v - 2 * 0.1535 * v**2 + 0.5 * slope * f**2
    span = 2 * model.period
    energy = 0.5 * v**2 + 0.5 * k * f**2
    scale = np.mean(np.abs(power)) * span
    assert abs(energy[0] - energy[-1]) > 0  # the balance below is not empty
    compared(
        "energy over two periods of a rattle",
        "work of force, damping and stiffness",
        power.mean() * span / scale,
        1e-5,
    )
    compared(
        "mean tooth force on a closed orbit",
        "mean of the driving force",
        np.mean(k * f) - 0.017,
        2e-6,
    )


@pytest.mark.parametrize("method", ["rk4", "adaptive"])
def test_other_methods_agree_with_the_exact_maps(method, compared):
    options = {"periods": 4, "steps_per_period": 8192, "initial_state": (0.2, 0.3)}
    exact = simulate(RATTLE, method="exact", **options)
    other = simulate(RATTLE, method=method, **options)
    limit = 3e-7 if method == "rk4" else 1e-10
    gaps = [np.abs(other.x - exact.x).max(), np.abs(other.v - exact.v).max()]
    known = {
        "rk4": "Runge-Kutta, 8192 steps a period",
        "adaptive": "DOP853 restarted at every contact",
    }
    compared("exact maps, rattling, four periods", known[method], gaps, limit)


def test_runge_kutta_is_of_fourth_order_where_the_motion_is_smooth():
    model = TorsionalModel(
        damping_ratio=0.05,
        frequency=0.7,
        stiffness_amplitude=0.1,
        mean_force=0.3,
        force_amplitude=0.05,
    )
    options = {"periods": 3, "samples_per_period": 0, "initial_state": (1.4, 0.0)}
    exact = simulate(model, method="exact", **options).section_x.values[0, -1]
    errors = [
        abs(
            simulate(model, method="rk4", steps_per_period=n, **options).section_x.values[0, -1]
            - exact
        )
        for n in (32, 64, 128)
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.15)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(4.0, abs=0.15)


def test_single_precision_follows_double_to_its_own_digits():
    one = simulate(BASE, periods=3, method="rk4", precision="float32")
    two = simulate(BASE, periods=3, method="rk4")
    assert 0 < np.abs(one.x - two.x).max() < 1e-4


def test_single_precision_is_refused_where_no_kernel_has_it():
    pair = PairModel.from_excitation(PAIR)
    with pytest.raises(InputError, match=r"precision: got 'float32'; allowed 'float64'"):
        simulate(pair, method="rk4", precision="float32", periods=1)


def test_rescaling_removes_thermal_stiffness_and_hot_backlash(compared):
    """eps_T and b' are the cold equation with s = sqrt(1 + eps_T), b' = 1."""
    heat, backlash = 0.02, 0.8
    s = np.sqrt(1 + heat)
    hot = TorsionalModel(
        damping_ratio=0.1535,
        frequency=1.245,
        stiffness_amplitude=0.335,
        mean_force=0.017,
        force_amplitude=-1.16,
        half_backlash=backlash,
        thermal_stiffness=heat,
    )
    cold = TorsionalModel(
        damping_ratio=0.1535 / s,
        frequency=1.245 / s,
        stiffness_amplitude=0.335 / s**2,
        mean_force=0.017 / (s**2 * backlash),
        force_amplitude=-1.16 / (s**2 * backlash),
    )
    one = simulate(hot, periods=20, initial_state=(0.4, 0.2))
    two = simulate(cold, periods=20, initial_state=(0.4 / backlash, 0.2 / (s * backlash)))
    compared(
        "hot motion, thermal stiffness and hot backlash",
        "the cold motion rescaled",
        one.x.values - backlash * two.x.values,
        1e-11,
    )


def test_half_period_shift_reverses_both_amplitudes():
    one = simulate(BASE, periods=4, discard=400)
    two = simulate(
        BASE.replace(stiffness_amplitude=-0.335, force_amplitude=1.16), periods=4, discard=400
    )
    x, shifted = one.x.values[0], two.x.values[0]
    gaps = [np.abs(np.roll(x, -32 - 64 * k) - shifted).max() for k in range(2)]
    assert min(gaps) < 1e-11


@pytest.mark.parametrize(("method", "limit"), [("rk4", 1e-9), ("exact", 1e-12)])
def test_two_gears_move_as_one_oscillator(method, limit, compared):
    options = {"method": method, "steps_per_period": 1024, "periods": 15}
    pair = PairModel.from_excitation(PAIR)
    angles = simulate(pair, initial_state=(70e-6, 0.0), **options)
    line = simulate(from_excitation(PAIR), initial_state=(70 / 60, 0.0), **options)
    compared(
        f"two gears with their angles, {method}",
        "one oscillator on the line of action",
        angles.x / 60e-6 - line.x,
        limit,
    )


@pytest.mark.parametrize("method", ["exact", "rk4"])
def test_momentum_of_balanced_torques_is_constant(method, compared):
    pair = PairModel.from_excitation(PAIR)
    data = simulate(pair, method=method, periods=40, initial_state=(70e-6, 0.0))
    states = np.array([data[n].values[0] for n in ("theta1", "theta2", "omega1", "omega2")])
    share = 0.001 * np.abs(states[2]).max() / 0.05
    drift = (pair.momentum(states) - pair.momentum(states[:, 0])) / share
    compared("momentum of the pair over 40 periods", "its first value", drift, 1e-12)


def test_unbalanced_torques_accelerate_the_rigid_mode():
    changed = PairModel.from_excitation(PAIR)
    pair = PairModel(**(changed.__dict__ | {"torques": (100.0, 290.0)}))
    exact = simulate(pair, periods=6, initial_state=(70e-6, 0.0))
    other = simulate(pair, method="adaptive", periods=6, initial_state=(70e-6, 0.0))
    for name in ("theta1", "theta2", "omega1", "omega2"):
        scale = float(np.abs(exact[name]).max())
        assert np.abs(exact[name] - other[name]).max() < 1e-10 * scale


@pytest.mark.parametrize("count", [12, 40])
def test_tables_of_many_harmonics(count, compared):
    ranks = np.arange(1, count + 1)
    k = Periodic(1.0, tuple(0.25 / ranks * np.exp(0.7j * ranks)))
    force = Periodic(0.08, tuple(0.4 / ranks**1.5 * np.exp(-0.3j * ranks**2)))
    model = DeadZoneModel(damping_ratio=0.06, frequency=0.9, stiffness=k, force=force)
    exact = simulate(model, periods=1)
    reference = simulate(model, periods=1, method="adaptive")
    assert exact.contact_losses.item() > 0
    compared(
        "exact maps with 12 and 40 harmonics",
        "DOP853 restarted at every contact",
        exact.x - reference.x,
        1e-11,
    )


def test_tables_with_jumps_have_their_borders_at_the_jumps():
    k = Pieces.constant(starts=(0.0, 0.37, 0.8123), values=(1.2, 0.8, 1.1))
    force = Pieces(starts=(0.0, 0.5), coefficients=((0.3, -0.4), (0.1, 0.2)))
    model = DeadZoneModel(damping_ratio=0.06, frequency=0.8, stiffness=k, force=force)
    exact = simulate(model, periods=4, initial_state=(1.2, 0.3))
    reference = simulate(model, periods=4, method="adaptive", initial_state=(1.2, 0.3))
    assert exact.contact_losses.item() > 0
    assert np.abs(exact.x - reference.x).max() < 1e-11
    assert np.abs(exact.v - reference.v).max() < 1e-11


def test_a_model_of_the_state_falls_back_and_says_why():
    class Duffing:
        period = 2 * np.pi

        def derivative(self, t, y):
            return np.array([y[1], -y[0] - y[0] ** 3 + 0.1 * np.cos(t)])

    data = simulate(Duffing(), periods=2)
    assert data.attrs["method"] == "adaptive"
    assert {"coefficients", "state"} <= set(re.findall(r"\w+", data.attrs["method_reason"]))
    with pytest.raises(InputError, match="piecewise-linear force"):
        simulate(Duffing(), method="exact")


class TwoBodies:
    """Two rotations of a pair as a model of its own: a derivative and a period, no lanes."""

    def __init__(self, pair, *, relative):
        self.pair, self.period, self.derivative = pair, pair.period, pair.derivative
        if relative:
            self.displacement, self.half_backlash = pair.displacement, pair.half_backlash
            self.states = ("theta1", "theta2", "omega1", "omega2")


def test_four_states_go_by_their_own_names():
    """The second of four states is a rotation and no velocity."""
    pair = PairModel.from_excitation(PAIR)
    start = pair.start(x=2.0 * pair.half_backlash, v=0.0)
    run = {"periods": 3, "samples_per_period": 16, "initial_state": start, "method": "adaptive"}
    known = simulate(pair, **run)
    named = simulate(TwoBodies(pair, relative=True), **run)
    for name in ("x", "v", "section_x", "theta2", "omega1", "section_omega2"):
        scale = np.abs(known[name].values).max()
        np.testing.assert_allclose(named[name].values, known[name].values, atol=1e-9 * scale)
    bare = simulate(TwoBodies(pair, relative=False), **run)
    assert "x" not in bare
    assert "section_v" not in bare
    assert bare["y2"].shape == (1, 48)
    assert bare["status"].values.tolist() == [0]
    assert bare["section_y2"].values[0, 0] == start[1]
    assert "y4" in bare["y4"].attrs["long_name"].split()


@pytest.mark.parametrize("method", ["exact", "rk4"])
def test_a_diverging_lane_is_a_status_and_its_neighbours_go_on(method):
    """w = 2 and eps = .9: the straight system gains energy every period, for ever."""
    model = TorsionalModel(
        damping_ratio=0.0,
        frequency=[2.0, 1.3],
        stiffness_amplitude=[0.9, 0.1],
        mean_force=0.1,
        force_amplitude=0.05,
    )
    data = simulate(model, periods=200, method=method, initial_state=(1.5, 0.3))
    meanings = data.status.attrs["flag_meanings"].split()
    assert [meanings[i] for i in data.status.values] == ["diverged", "ok"]
    assert tuple(meanings) == STATUS
    assert np.isnan(data.section_x.values[0, -1])
    alone = simulate(
        TorsionalModel(
            damping_ratio=0.0,
            frequency=1.3,
            stiffness_amplitude=0.1,
            mean_force=0.1,
            force_amplitude=0.05,
        ),
        periods=200,
        method=method,
        initial_state=(1.5, 0.3),
    )
    assert np.array_equal(alone.x.values[0], data.x.values[1])


def test_the_dataset_says_what_it_holds():
    data = simulate(BASE, periods=3, discard=5, samples_per_period=32)
    assert data.sizes == {"point": 1, "sample": 96, "section": 4, "side": 3}
    assert data.section.values.tolist() == [5, 6, 7, 8]
    assert data.time.values[0, 32] == pytest.approx(6 * BASE.period)
    assert data.x.values[0, ::32] == pytest.approx(data.section_x.values[0, :3], abs=0)
    assert data.attrs["method"] == "exact"
    assert float(data.time_share.sum()) == pytest.approx(1.0, abs=1e-13)
    for name in data.data_vars:
        assert "long_name" in data[name].attrs, name


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"periods": 0}, "periods: got 0; allowed a whole number >= 1"),
        ({"discard": -1}, "discard: got -1; allowed a whole number >= 0"),
        (
            {"method": "rk5"},
            "method: got 'rk5'; allowed auto | exact | rk4 | adaptive; did you mean 'rk4'?",
        ),
        ({"initial_state": (np.nan, 0)}, "initial_state: got [nan, 0.0]; allowed finite numbers"),
        ({"initial_state": (0, 0, 0)}, "initial_state: got shape (3,); allowed (2,) or (1, 2)"),
        (
            {"method": "rk4", "steps_per_period": 100},
            "samples_per_period: got 64; allowed a divisor of steps_per_period = 100",
        ),
    ],
)
def test_bad_requests_are_refused_in_one_line(options, message):
    with pytest.raises(InputError) as caught:
        simulate(BASE, **options)
    assert str(caught.value) == message


def test_progress_reaches_the_total_and_an_error_in_it_stops_the_run():
    seen = []
    simulate(BASE, periods=50, discard=50, progress=lambda done, total: seen.append((done, total)))
    assert seen[-1] == (100, 100)

    def stop(_done, _total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulate(BASE, periods=50, progress=stop)


def test_a_start_at_rest_finds_the_graze_between_two_steps():
    """x = x_0 + a (1 - cos t): an edge 1e-9 below the top is crossed at pi -+ sqrt(2e-9/a)."""
    a, low = 0.3, 0.2

    def push(t, y, _region):
        return np.array([y[1], a * np.cos(t)])

    for way in (1.0, -1.0):
        gap = Gap(lambda _t, y: y[0], lambda _t, y: y[1], low + 2 * a - 1e-9)
        _, _, crossings = follow(
            lambda t, y, r, way=way: way * push(t, way * y, r),
            gap,
            2 * np.pi,
            np.array([way * low, 0.0]),
            periods=1,
            samples=0,
        )
        near = np.sqrt(2e-9 / a)
        assert crossings == pytest.approx([np.pi - near, np.pi + near], abs=1e-8)
