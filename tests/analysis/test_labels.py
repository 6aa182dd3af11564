"""Labels of the published parameter rows, and what must never be mistaken."""

from dataclasses import replace

import numpy as np
import pytest

from said import numbers
from thermogear.analysis.agreement import End, judged
from thermogear.analysis.continuation import continuation
from thermogear.analysis.labels import (
    label,
    labels,
)
from thermogear.analysis.lyapunov import Lyapunov
from thermogear.analysis.orbits import periodic_orbit
from thermogear.analysis.proof import Label, periodic, proves_chaos
from thermogear.base.errors import InputError
from thermogear.base.vocabulary import label_words
from thermogear.dynamics.integrate import simulate
from thermogear.dynamics.models import TorsionalModel
from thermogear.dynamics.return_map import return_map

BASE = TorsionalModel(
    damping_ratio=0.1535,
    frequency=1.245,
    stiffness_amplitude=0.335,
    mean_force=0.017,
    force_amplitude=-1.16,
)
ROW = ["period-1", "period-2", "period-4", "chaotic"]


def heated(celsius):
    rise = (np.asarray(celsius, dtype=float) - 20.0) / 140.0
    return TorsionalModel(
        damping_ratio=0.1535,
        frequency=1.300551,
        stiffness_amplitude=0.335,
        mean_force=0.0136,
        force_amplitude=-0.928,
        half_backlash=1 - 0.2 * rise,
        thermal_stiffness=0.02 * rise,
    )


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("damping_ratio", [0.18, 0.168, 0.114, 0.10]),
        ("frequency", [1.3, 1.28, 1.13, 1.1]),
        ("stiffness_amplitude", [0.1, 0.3, 0.53, 0.9]),
    ],
)
def test_rows_of_table_4_2(name, values):
    found = labels(BASE.replace(**{name: values}))
    assert [one.name for one in found] == ROW
    assert found[3].lyapunov.value > 4 * found[3].lyapunov.error
    for one in found[:3]:
        assert abs(one.multipliers[0]) < 1.0


def test_heat_of_section_4_1_brings_in_the_half_frequency():
    found = labels(heated([20, 100, 140, 160]))
    assert [one.name for one in found] == ["period-1", "period-1", "period-2", "period-2"]
    assert found[1].multipliers[0].real == pytest.approx(-0.9958567045590561, abs=1e-7)


def test_half_order_amplitudes_of_section_4_1(compared):
    data = simulate(heated([20, 125, 140]), discard=20_000, periods=32)
    lines = 2 * np.abs(np.fft.rfft(data.x.values, axis=1)) / data.sizes["sample"]
    compared(
        "half-order amplitude at 20, 125 and 140 °C",
        "0, 0.0044, 0.0088, computed apart",
        lines[:, 16] - [0.0, 0.0044, 0.0088],
        5e-5,
    )


def test_a_long_transient_does_not_fool_the_label():
    """121 damping ratios where 50 discarded periods mislabel 49 points."""
    model = TorsionalModel(
        damping_ratio=np.linspace(0.02, 0.14, 121),
        frequency=1.268,
        stiffness_amplitude=0.6,
        mean_force=0.056,
        force_amplitude=0.314,
        half_backlash=1.0,
        thermal_stiffness=0.03,
    )
    # fewer starts than by default: the transients are the question here
    first = labels(model, starts=2)
    longer = labels(model, discard=4000, starts=2)
    clear = [
        (a, b) for a, b in zip(first, longer, strict=True) if "undecided" not in (a.name, b.name)
    ]
    assert len(clear) >= 119
    assert all(a.name == b.name for a, b in clear)
    assert {one.name for one in first} <= {
        "period-2", "period-4", "period-6", "period-8", "period-16", "chaotic", "undecided"
    }  # fmt: skip


def test_a_spiral_is_not_taken_for_a_longer_period():
    """Complex multipliers near a third of a turn return close after three periods."""
    model = TorsionalModel(
        damping_ratio=0.01,
        frequency=0.7,
        stiffness_amplitude=0.1,
        mean_force=0.1,
        force_amplitude=0.05,
    )
    assert str(label(model, initial_state=(1.1, 0.0))) == "period-1"


def test_at_the_border_itself_nothing_is_decided():
    flip = BASE.replace(damping_ratio=0.17004302692235368)
    assert label(flip).name == "undecided"


def test_a_diverging_motion_is_named_so():
    assert (
        label(
            TorsionalModel(
                damping_ratio=0.0,
                frequency=2.0,
                stiffness_amplitude=0.9,
                mean_force=0.1,
                force_amplitude=0.05,
            ),
            initial_state=(1.5, 0.3),
        ).name
        == "diverged"
    )


def test_one_label_wants_one_lane():
    with pytest.raises(InputError, match="one lane"):
        label(BASE.replace(frequency=[1.0, 1.1]))


def test_no_label_where_rounding_chooses_the_attractor():
    """A long chaotic transient ends on one of two orbits; the arithmetic decides which."""
    rng = np.random.default_rng(42)
    fields = [rng.uniform(*span, 500) for span in ((0.02, 0.2), (0.3, 2.2), (0, 0.9), (0.01, 0.3))]
    force, heat = rng.uniform(-1.2, 1.2, 500), rng.uniform(-0.03, 0.03, 500)
    zeta, w, eps, mean = (float(field[394]) for field in fields)
    model = TorsionalModel(
        damping_ratio=zeta,
        frequency=w,
        stiffness_amplitude=eps,
        mean_force=mean,
        force_amplitude=float(force[394]),
        half_backlash=1.0,
        thermal_stiffness=float(heat[394]),
    )
    found = label(model)
    assert str(found) in ("undecided", "period-2", "period-6")
    if str(found) != "undecided":
        assert found.orbit.stable


@pytest.mark.slow
def test_random_points_keep_their_labels(at_length):
    """Doubling transient or sub-steps changes no label; under 2 % stay undecided."""
    rng = np.random.default_rng(7)
    count = at_length(50, 500, "random motions with transients doubled")
    model = TorsionalModel(
        damping_ratio=rng.uniform(0.02, 0.2, count),
        frequency=rng.uniform(0.3, 2.2, count),
        stiffness_amplitude=rng.uniform(0, 0.9, count),
        mean_force=rng.uniform(0.01, 0.3, count),
        force_amplitude=rng.uniform(-1.2, 1.2, count),
        half_backlash=1.0,
        thermal_stiffness=rng.uniform(-0.03, 0.03, count),
    )
    # two starts: how long chaos lasts is another question
    first = labels(model, starts=2)
    longer = labels(model, discard=1000, cap=64_000, starts=2)
    for one, other in zip(first, longer, strict=True):
        assert one.name == other.name or "undecided" in (one.name, other.name)
    assert sum(one.name == "undecided" for one in first) < 0.02 * count
    assert not any("quasi" in str(one) for one in first)


def test_the_orbit_of_a_label_can_be_continued():
    model = TorsionalModel(
        damping_ratio=0.18,
        frequency=1.245,
        stiffness_amplitude=0.335,
        mean_force=0.017,
        force_amplitude=-1.16,
    )
    orbit = label(model).orbit
    assert orbit is not None
    assert orbit.model is model
    branch = continuation(orbit, "damping_ratio", 0.16)
    (flip,) = branch.of_kind("period doubling")
    assert flip.value == pytest.approx(0.170043027, abs=1e-9)


ONE = TorsionalModel(
    damping_ratio=0.036281193420631005,
    frequency=0.4856413205292942,
    stiffness_amplitude=0.28745010005734567,
    mean_force=0.3020883356856766,
    force_amplitude=0.5082231342633113,
    half_backlash=1.0579260211766828,
)
ENDING = (-0.22916572016971326, -1.707480535133318)


def test_chaos_that_ends_is_not_called_chaos():
    """A positive exponent over ten thousand periods; every start closes after five by 50 000."""
    found = label(ONE, initial_state=ENDING)
    assert found.name in ("period-5", "undecided")
    assert found.lyapunov is None
    assert found.orbit.period == 5
    if found.name == "period-5":
        assert (found.starts, found.discarded > 4000) == (16, True)
    else:
        assert 5.0 in numbers(found.reason.replace("period-", ""))


def test_chaos_says_how_long_and_from_how_many_starts():
    found = label(BASE.replace(damping_ratio=0.1), cap=4000, starts=3, follow=12_000)
    assert (found.name, found.starts) == ("chaotic", 3)
    assert found.followed >= 12_000
    assert str(found) == found.words
    assert numbers(found.words) == [found.followed, 3.0]
    assert numbers(found.reason)[-2:] == [3.0, found.followed]
    assert numbers(label_words("chaotic", followed=500, starts=1)) == [500.0, 1.0]
    assert label_words("period-2", followed=500, starts=4) == "period-2"
    # what went by is counted in mesh periods also where an orbit closes after turns
    of_turn = label_words("chaotic", followed=500, starts=1, mesh_periods=40)
    assert numbers(of_turn) == [500.0, 1.0]
    assert of_turn != label_words("chaotic", followed=500, starts=1)
    assert found.name == "chaotic"


def test_no_label_where_starts_a_rounding_apart_end_on_two_orbits_of_one_name():
    """Chaos ends on one of two orbits of period 1: two roundings may agree by chance."""
    model = TorsionalModel(
        damping_ratio=0.01258002655795161,
        frequency=0.8409540219767466,
        stiffness_amplitude=0.8475901176910461,
        mean_force=0.24003992245932934,
        force_amplitude=0.09292754646758228,
        half_backlash=1.431645049947806,
        thermal_stiffness=-0.019200613412541416,
    )
    found = label(model, initial_state=(0.6361446244245426, -1.6656484505018616))
    assert (found.name, found.period) == ("undecided", 0)
    assert numbers(found.reason)[-1] == 16.0  # starts


def test_a_label_stands_when_all_starts_agree():
    lane = BASE.replace(damping_ratio=0.168)
    orbit = periodic_orbit(lane, 2, (1.13, -0.28))
    turned = replace(orbit, points=orbit.points[::-1])
    aside = replace(orbit, points=orbit.points + 1e-3)
    two = Label("period-2", 2, "b", 1500, orbit)
    one, gone = Label("period-1", 1, "a", 500, orbit), Label("diverged", 0, "e", 600)
    chaos = Label("chaotic", 0, "c", 700)
    on, live, dull = End(two, 1600), End(None, 9000, True), End(None, 9000)
    # the same orbit in another phase is the same motion
    for ends in ([on], [on, End(replace(two, orbit=turned), 40)]):
        found = judged(two, ends)
        assert (found.name, found.starts, found.orbit) == ("period-2", 1 + len(ends), orbit)
        assert found.discarded == 1600
    assert judged(gone, [End(gone, 600)]).name == "diverged"
    assert judged(chaos, [on, on]).name == "period-2"
    found = judged(chaos, [live, live])
    assert (found.name, found.followed, found.starts) == ("chaotic", 9000, 2)
    for first, ends, words in (
        (two, [End(replace(two, orbit=aside), 40)], "2 period-2 orbits from 2 starts"),
        (two, [on, End(one, 40)], "period-1 or period-2 from 3 starts"),
        (chaos, [on, End(gone, 40), live], "diverged or period-2 from 3 starts"),
        (two, [on, live], "2 of 3 starts end as period-2, the others not in 9000 periods"),
        (chaos, [on, live], "1 of 2 starts end as period-2, the others not in 9000 periods"),
        (chaos, [live, dull], "neither closed nor chaotic to the end"),
    ):
        found = judged(first, ends)
        assert found.name == "undecided"
        assert words in found.reason


@pytest.mark.parametrize(
    ("batches", "positive"),
    [
        ([1.0, 1.1, 0.9, 1.0], True),
        ([-1.0, -1.1, -0.9, -1.0], False),
        ([0.01, 0.01, 2.0, 2.0], False),  # the mean within four standard errors
        ([3.0, 3.0, 3.0, 3.0, -0.1, -0.1, -0.1, -0.1], False),
        ([-0.1, -0.1, -0.1, -0.1, 3.0, 3.0, 3.0, 3.0], False),
        ([1.0, 1.1, np.nan, 1.0], False),
        ([1.0, 1.1, np.inf, 1.0], False),
    ],
)
def test_chaos_wants_a_finite_record_positive_in_both_halves(batches, positive):
    values = np.array(batches)
    with np.errstate(invalid="ignore"):
        error = float(values.std(ddof=1) / np.sqrt(values.size))
    assert (
        proves_chaos(
            Lyapunov(
                value=float(values.mean()), error=error, sum=-0.1, batches=values, state=np.zeros(2)
            )
        )
        == positive
    )
    # both halves count even where the mean stands far above its error
    assert proves_chaos(
        Lyapunov(
            value=float(values.mean()), error=1e-9, sum=-0.1, batches=values, state=np.zeros(2)
        )
    ) == (positive or batches == [0.01, 0.01, 2.0, 2.0])


def test_a_window_is_on_the_orbit_when_it_is_near_and_comes_nearer():
    model = TorsionalModel(
        damping_ratio=0.168,
        frequency=1.245,
        stiffness_amplitude=0.335,
        mean_force=0.017,
        force_amplitude=-1.16,
    )
    lane, unit = model.lanes(), model.lanes().unit[0]
    orbit = periodic_orbit(model, 2, (1.13, -0.28))
    assert orbit.stable
    steps = np.arange(-31, 1)
    on = orbit.points[steps % 2]

    def verdict(size, most=16, border=0.998):
        """Sections that far away: ``size`` of every period, the last 0."""
        window = on + size[:, None] * unit
        return periodic(lane, window, max_period=most, elapsed=500, near_border=border)

    near = 1e-9 * 0.8 ** (steps + 31)
    found, silent = verdict(near)
    assert (found.name, found.period, found.discarded, silent) == ("period-2", 2, 500, False)
    assert found.orbit.points == pytest.approx(orbit.points, abs=1e-9)
    assert "over 2 periods" in found.reason
    # away and not nearer; too far yet; nothing closes
    assert verdict(near[::-1]) == (None, False)
    assert verdict(3e-6 * 0.99 ** (steps + 31)) == (None, False)
    assert verdict(1e-2 * (-1.0) ** steps * np.arange(32)) == (None, True)
    assert verdict(near, most=1) == (None, True)
    # so near that only rounding is left needs not come nearer
    assert verdict(0.5e-10 * np.ones(32))[0].name == "period-2"
    # within the border of a bifurcation, and lost
    size = abs(orbit.multipliers[0])
    assert verdict(near, border=size + 1e-9)[0].name == "period-2"
    inside = verdict(near, border=size - 1e-9)[0]
    assert (inside.name, inside.period) == ("undecided", 2)
    assert "of a bifurcation" in inside.reason
    lost = on.copy()
    lost[3, 0] = np.inf
    assert periodic(lane, lost, max_period=16, elapsed=500, near_border=0.998)[0].name == "diverged"


def test_the_transient_told_is_the_one_that_ran():
    """Rounds of discard + 2 max_period periods, doubling; the orbit found closes by the map."""
    found = label(BASE.replace(damping_ratio=0.18), discard=100, max_period=8)
    lengths = np.cumsum([100 * 2**n + 16 for n in range(12)])
    assert found.discarded in lengths
    visit = return_map(BASE.replace(damping_ratio=0.18).lanes()).visit(found.orbit.state, 1)
    assert visit.points[-1] == pytest.approx(found.orbit.state, abs=1e-12)
    slow = label(BASE.replace(damping_ratio=0.1705), discard=20, max_period=4, cap=60)
    assert (slow.name, slow.period) == ("undecided", 0)
    assert slow.discarded == 28 + 48
    for wrong in ({"max_period": 0}, {"discard": 0}, {"discard": 1.5}):
        with pytest.raises(InputError, match=f"{next(iter(wrong))}: got"):
            labels(BASE, **wrong)


def test_progress_counts_both_runs_of_every_lane():
    told = []
    model = BASE.replace(damping_ratio=[0.18, 0.19, 0.2])
    labels(model, discard=50, max_period=4, progress=lambda done, of: told.append((done, of)))
    assert told[-1] == (6, 6)
    assert (3, 6) in told
    assert [done for done, _ in told] == sorted(done for done, _ in told)


def test_a_model_without_an_event_exact_map_is_refused_in_one_line():
    class Duffing:
        period = 2.0 * np.pi

        def derivative(self, t, y):
            return np.array([y[1], -y[0] - y[0] ** 3 + 0.1 * np.cos(t)])

    with pytest.raises(
        InputError, match=r"^model: got Duffing; allowed TorsionalModel, DeadZ"
    ) as e:
        label(Duffing())
    assert "\n" not in str(e.value)
