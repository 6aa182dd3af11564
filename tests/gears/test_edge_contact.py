"""Where a tip corner carries, Hertz's pressure of the involutes is no number but a flag."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from thermogear.gears.contact import hertz_pressure, pair_reduced_modulus, reduced_radius
from thermogear.gears.deviations import BasePitchDifference
from thermogear.gears.geometry import Gear
from thermogear.gears.loaded import LoadedModel, loaded_contact, solve_mesh
from thermogear.gears.pair import GearPair

WIDTH = 20e-3
PAIR = GearPair(
    Gear(25, 5e-3, face_width=WIDTH, bore_radius=20e-3),
    Gear(75, 5e-3, face_width=WIDTH, bore_radius=60e-3),
)
LINE_LOADS = np.array([20.0, 50.0, 100.0, 200.0, 400.0, 800.0]) * 1e3
TWO_PAIRS = np.array([0.760, 0.790, 0.820, 0.860, 0.920, 0.995])
"""Share of the period with two pairs in contact, tip corners counted: computed apart."""
ON_THE_PATH = 0.715
"""The same at any load where contact on tip corners is left out."""
FLAGS = ["no_edge_contact", "wheel_tip_corner", "pinion_tip_corner", "both_tip_corners"]


@pytest.fixture(scope="module")
def data() -> xr.Dataset:
    return loaded_contact(PAIR, LINE_LOADS * WIDTH, dimensions=("load",))


def test_every_pressure_is_a_number_or_has_its_flag(data: xr.Dataset) -> None:
    flag, force = data.edge_contact.values, data.pair_force.values
    s = data.pair_position.values
    slack = 1e-9 * PAIR.base_pitch
    early = (force > 0.0) & (s < PAIR.path.a - slack)
    late = (force > 0.0) & (s > PAIR.path.e + slack)
    assert early.any()
    assert late.any()
    assert np.array_equal(flag, 1 * early + 2 * late)
    assert np.array_equal(np.isnan(data.contact_pressure.values), flag > 0)


def test_on_the_flanks_the_pressure_is_hertzs(data: xr.Dataset) -> None:
    s, force = data.pair_position.values, data.pair_force.values[3]
    valid = (force > 0.0) & (data.edge_contact.values[3] == 0)
    exact = hertz_pressure(force / WIDTH, reduced_radius(PAIR, s), pair_reduced_modulus(PAIR))
    assert np.allclose(data.contact_pressure.values[3][valid], exact[valid], rtol=1e-12)
    assert np.all(data.contact_pressure.values[3][force == 0.0] == 0.0)


def test_corners_carry_as_long_as_they_lengthen_the_double_contact(data: xr.Dataset) -> None:
    assert data.edge_contact_share.values == pytest.approx(TWO_PAIRS - ON_THE_PATH, abs=6e-3)
    assert np.all(np.diff(data.edge_contact_share.values) > 0.0)
    # and the mean number of pairs that carry with it
    assert data.effective_contact_ratio.values == pytest.approx(1.0 + TWO_PAIRS, abs=1e-2)
    parts = data.corner_period_share.values.sum(axis=-1)
    assert parts == pytest.approx(data.edge_contact_share.values, abs=1e-12)


def test_the_flag_says_what_its_values_mean(data: xr.Dataset) -> None:
    attributes = data.edge_contact.attrs
    assert data.edge_contact.dtype == np.int8
    assert attributes["flag_values"].tolist() == [0, 1, 2, 3]
    assert attributes["flag_values"].dtype == np.int8
    assert attributes["flag_meanings"].split() == FLAGS
    assert "edge" in data.contact_pressure.attrs["long_name"]


def test_without_corners_every_pressure_stands() -> None:
    got = loaded_contact(PAIR, 200e3 * WIDTH, model=LoadedModel(extended=False))
    assert float(got.edge_contact_share) == 0.0
    assert not got.edge_contact.values.any()
    assert np.isfinite(got.contact_pressure.values).all()
    unloaded = loaded_contact(PAIR, 0.0)
    assert float(unloaded.edge_contact_share) == 0.0
    assert np.array_equal(unloaded.contact_pressure.values, np.zeros((200, 4)))


@pytest.mark.parametrize("flank", ["drive", "back"])
def test_exchanged_gears_exchange_their_corners(flank: str) -> None:
    phase = np.linspace(0.013, 0.987, 80)
    one = solve_mesh(PAIR, 8e3, phase, flank=flank)
    two = solve_mesh(PAIR.swapped(), 8e3, PAIR.contact_ratio - phase, flank=flank)
    for mine, other in ((1, 2), (2, 1)):
        assert (one.edge == mine).any()
        mine_phases = (one.edge == mine).any(axis=-1)
        # an edge's lever is its own gear's: the corner may leave one sample sooner
        assert (mine_phases != (two.edge == other).any(axis=-1)).sum() <= 1
    with np.errstate(invalid="ignore"):
        assert np.array_equal(np.isnan(one.pressure), one.edge > 0)


@pytest.mark.parametrize(
    ("rounding", "leaves", "enters"),
    [
        (0.0, (0.79289, 0.80827), (0.925, 0.93692)),
        (0.05e-3, (0.7775, 0.80827), (0.93692, 0.95231)),
        (0.2e-3, (0.7775, 0.79289), (0.95231, 0.96769)),
    ],
)
def test_rounded_tips_leave_and_enter_where_finite_elements_have_them(
    rounding: float, leaves: tuple[float, float], enters: tuple[float, float]
) -> None:
    """Plane finite elements of whole gears, edges on flanks, 200 N/mm: phases from the sharp A.

    The last phase at which the leaving pair carries and the first at which it does not, the last
    at which the entering pair does not carry and the first at which it does.
    """
    gears = (replace(gear, tip_rounding=rounding) for gear in (PAIR.pinion, PAIR.wheel))
    pair = GearPair(*gears)
    phase = np.array([*leaves, *enters]) + (PAIR.path.a - pair.path.a) / pair.base_pitch
    mesh = solve_mesh(pair, 200e3 * WIDTH, phase, model=LoadedModel(body="bore_clamped"))
    assert np.count_nonzero(mesh.force > 0.0, axis=-1).tolist() == [2, 1, 1, 2]


@pytest.mark.parametrize("rounding", [0.0, 0.1e-3])
@pytest.mark.parametrize("tooth", ["beam", "solved"])
def test_nothing_jumps_where_a_contact_passes_onto_an_edge(rounding: float, tooth: str) -> None:
    """A hotter gear has the pair at the path's end carry all: its contact narrows to the edge's."""
    pair = GearPair(*(replace(g, tip_rounding=rounding) for g in (PAIR.pinion, PAIR.wheel)))
    beside = np.array([-1e-9, 1e-9])
    for strain, at in ((7e-4, pair.contact_ratio - 1.0), (-7e-4, 0.0)):
        mesh = solve_mesh(
            pair,
            2e3,
            at + beside,
            deviations=[BasePitchDifference(strain)],
            model=LoadedModel(tooth=tooth),
        )
        assert mesh.share.max(axis=-1).tolist() == [1.0, 1.0]
        assert sorted(mesh.edge.max(axis=-1)) == [0, 2 if at else 1]
        assert np.ptp(mesh.deflection) < 1e-12
        assert np.ptp(mesh.tangent) < 1e-5 * mesh.tangent[0]
