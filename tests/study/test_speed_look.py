"""A look over the speeds: resonances at fractions of the natural frequency, contact, ranges."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from said import numbers
from thermogear.analysis.settle import settle
from thermogear.analysis.side_by_side import RULE
from thermogear.base.display import rounded, worded
from thermogear.base.excitation import Excitation, Excitations, Periodic
from thermogear.base.units import RPM
from thermogear.case.points import points_of
from thermogear.case.response import respond
from thermogear.study.speeds import RECORD, Speeds, look, told

TEETH = 20
MASS, STIFFNESS, FORCE = 0.5, 2e8, 2000.0


def mesh(
    *orders: tuple[int, float], damping: float = 0.05, gap: float = 60e-6, ripple: float = 0.0
) -> Excitation:
    """A pair with an error of cosines (order, amplitude [m]) and a stiffness almost constant."""
    error = np.zeros(max((order for order, _ in orders), default=1), complex)
    for order, amplitude in orders:
        error[order - 1] = amplitude
    inertia = 2.0 * MASS * 0.03**2
    return Excitation(
        stiffness=Periodic(STIFFNESS, (ripple * STIFFNESS,)),
        error=Periodic(0.0, tuple(error)),
        half_backlash=gap,
        reference_half_backlash=min(gap, 60e-6),
        mean_force=FORCE,
        mesh_frequency=1000.0,
        inertias=(inertia, inertia),
        base_radii=(0.03, 0.03),
        torques=(FORCE * 0.03, FORCE * 0.03),
        damping_ratio=damping,
    )


def looked(one: Excitation, *own: float) -> Speeds:
    """The case's ``own`` speeds over the one where the mesh meets the natural frequency."""
    unit = one.natural_frequency / TEETH
    return look(Excitations.of([one]), teeth=TEETH, own=unit * np.array(own or (1.0,)))


def test_peaks_stand_at_fractions_of_the_natural_frequency(compared: Callable[..., None]) -> None:
    """An error of orders 1 to 4 meets the natural frequency at N = 1, 1/2, 1/3, 1/4."""
    one = mesh((1, 2e-7), (2, 2e-7), (3, 2e-7), (4, 2e-7))
    found = looked(one)
    unit = one.natural_frequency / TEETH
    peaks = sorted((speed / unit for speed, _ in found.peaks()), reverse=True)
    assert len(peaks) == 4
    compared(
        "resonances of a linear pair, in steps of 2.5 % of speed",
        "the natural frequency over 1, 2, 3, 4",
        np.log(np.array(peaks) * np.arange(1, 5)) / np.log1p(found.step),
        1.0,
    )
    assert found.lost == found.back == found.several == []


def test_the_linear_answer_is_the_closed_form(compared: Callable[..., None]) -> None:
    """k x/F = 1 + (e k/F) r^2/sqrt((1 - r^2)^2 + (2 zeta r)^2): the force goes with speed^2."""
    amplitude, damping = 5e-7, 0.1
    one = mesh((1, amplitude), damping=damping)
    found = looked(one)
    r = found.data["frequency_ratio"].values
    closed = 1.0 + amplitude * STIFFNESS / FORCE * r**2 / np.hypot(1 - r**2, 2 * damping * r)
    factor = found.data["dynamic_factor"].values
    # 64 samples a period miss the crest by at most 1 - cos(pi/64)
    compared(
        "dynamic factor of a linear pair over speed",
        "the closed form of forced vibration",
        factor / closed - 1.0,
        1.0 - float(np.cos(np.pi / 64.0)),
    )


def test_a_look_is_the_motion_of_each_speed_itself() -> None:
    """Whatever speed the mesh was computed at: the motion at another is that speed's own."""
    one = mesh((1, 4e-7), (3, 1e-7), ripple=0.05)
    there, here = looked(one), looked(replace(one, mesh_frequency=40.0 * one.mesh_frequency))
    for name in there.data:
        assert np.array_equal(there.data[name].values, here.data[name].values)
    speed = float(there.data["pinion_speed"][40])
    point = points_of(Excitations.of([replace(one, mesh_frequency=TEETH * speed)]))
    rest = np.array([[float(point.flat.half_backlash[0] + point.flat.force[0, 0].real), 0.0]])
    alone = respond(point, settle(point.flat, rest, RULE).state, RECORD, lines=False)
    assert there.data["dynamic_factor"][40] == pytest.approx(alone["dynamic_factor"][0], rel=1e-6)


def test_contact_is_lost_beyond_the_load_and_never_in_a_wide_preload() -> None:
    """An error whose force passes the mean one parts the flanks near resonance; a load far
    beyond it keeps them together at every speed."""
    shaking = mesh((1, 4e-6))
    ranges = looked(shaking).lost
    unit = shaking.natural_frequency / TEETH
    assert any(low < unit < high for low, high in ranges)
    assert all(low > 0.7 * unit for low, _ in ranges)
    pressed = replace(shaking, mean_force=20.0 * FORCE)
    assert looked(pressed).lost == []


def test_a_narrow_gap_is_crossed_and_a_wide_one_not() -> None:
    hammered = mesh((1, 1e-5), damping=0.02, gap=5e-6)
    assert looked(hammered).back != []
    assert looked(replace(hammered, half_backlash=1e-2)).back == []


@pytest.mark.parametrize(
    ("own", "low", "high"),
    [((1.0,), 0.05, 1.8), ((3.0,), 0.05, 3.3), ((0.08, 3.0), 0.05, 3.3), ((1e-3, 1e3), 0.05, 10.0)],
)  # fmt: skip
def test_own_speeds_widen_the_range(own: tuple[float, ...], low: float, high: float) -> None:
    found = looked(mesh((1, 1e-7)), *own)
    ratio = found.data["frequency_ratio"].values
    assert (ratio.min(), ratio.max()) == pytest.approx((low, high), rel=1e-9)
    assert 0.0 < found.step <= 0.025 + 1e-12


def test_loss_at_low_speed_is_looked_for_down_to_the_twentieth_harmonic() -> None:
    """An error of order 12 parts the flanks at a twelfth of the resonance, half of where looks
    once began: the range that is told begins in the middle of the look, not at its end."""
    one = mesh((12, 1.2e-6))
    found = looked(one)
    unit = one.natural_frequency / TEETH
    (low, high), *_ = found.lost
    assert found.grid[0] == pytest.approx(0.05 * unit)
    assert found.grid[0] < low < unit / 12.0 < high < 0.1 * unit


def test_ranges_are_told_in_rpm() -> None:
    """Of a range that reaches an end of the look, the end is told: no one has looked beyond."""

    def words(*ranges: tuple[float, float]) -> str:
        return worded(*told([(low * RPM, high * RPM) for low, high in ranges], ends=ends))[0]

    ends = (500.0 * RPM, 9000.0 * RPM)
    some = ((1000.0, 1100.0), (2000.0, 2000.0))
    assert numbers(words(*some)) == [1000.0, 1100.0, 2000.0]
    assert numbers(words(*some, *some)) == [1000.0, 1100.0, 2000.0, 1000.0, 1100.0, 1.0]
    for low, high, end in ((500, 600, "lowest"), (8000, 9000, "highest"), (500, 9000, "every")):
        assert numbers(words((float(low), float(high)))) == [low, high]
        assert end in words((float(low), float(high)))
    assert [rounded(v, digits=3) for v in (2.2712, 99.96, 12345.0)] == ["2.27", "100", "12300"]
