"""Mesh line and what stands beside it, from lines alone: synthetic trains, then the real rig."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from record_makers import SHARED, mesh_train, quantised

from conftest import Compared
from said import numbers
from thermogear.base.errors import InputError
from thermogear.measured.gearing import find_gearing
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import measure

TRUTH = {"h30hz0": 0.074385, "h30hz50": 0.074189}
"""Main mesh line [cycles/sample], of 32 teeth; the second shaft has 80."""


def path_of(name: str) -> Path:
    return SHARED / f"{name}.csv.gz"


@cache
def table_of(name: str) -> np.ndarray:
    return np.loadtxt(path_of(name), delimiter=",", skiprows=1).T


@pytest.mark.parametrize("name", TRUTH)
def test_shafts_of_the_rigs_twin_are_told_as_distances(name: str) -> None:
    """Both gears' shafts show as lines at equal distances, and no teeth are named."""
    table = quantised(mesh_train(88_000, TRUTH[name], noise=0.2))
    gearing = find_gearing(list(table))
    assert gearing.mesh_frequency == pytest.approx(TRUTH[name], abs=1.5e-6)
    assert not gearing.confirmed
    ratios = [gearing.mesh_frequency / family.distance for family in gearing.families]
    for teeth in (32.0, 80.0):
        assert min(abs(ratio / teeth - 1.0) for ratio in ratios) < 5e-4
    assert [find_gearing(list(table), teeth=z).confirmed for z in (32, 80, 31, 47)] == [
        True, True, False, False,
    ]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", TRUTH)
def test_the_real_records_confirm_the_teeth_and_their_parts_alone(name: str) -> None:
    """Sidebands of 32 and 80 teeth show; so do those of their parts, and of no other number."""
    if not path_of(name).is_file():
        pytest.skip("the folder is not part of the project")
    table = list(table_of(name))
    assert find_gearing(table).mesh_frequency == pytest.approx(TRUTH[name], abs=1.5e-6)
    for teeth in (32, 80):
        assert find_gearing(table, teeth=teeth).confirmed
    for teeth in (25, 47, 59, 71, 96):  # a line beside is at order 31 of the shaft, as of 31 teeth
        assert not find_gearing(table, teeth=teeth).confirmed


@pytest.mark.parametrize("noise", [0.1, 0.5])
@pytest.mark.parametrize(
    "teeth", [(32, 80, 48, 64), (25, 75, 20, 60), (20, 30, 25, 40), (23, 92, 31, 47)]
)
def test_teeth_of_synthetic_trains(
    teeth: tuple[int, int, int, int], noise: float, compared: Compared
) -> None:
    table = list(mesh_train(60_000, 0.0713, teeth, noise))
    gearing = find_gearing(table, teeth=teeth[0])
    assert gearing.confirmed
    compared(
        "mesh line of trains with unknown teeth",
        "the line put in",
        gearing.mesh_frequency / 0.0713 - 1.0,
        1e-4,
    )


def test_a_lone_harmonic_family_names_the_mesh_line_and_no_distance() -> None:
    n = np.arange(30_000)
    x = sum(a * np.cos(2 * np.pi * 0.0613 * k * n) for k, a in ((1, 1.0), (2, 0.5), (3, 0.3)))
    gearing = find_gearing([x + 0.2 * np.random.default_rng(3).standard_normal(n.size)], teeth=25)
    assert gearing.mesh_frequency == pytest.approx(0.0613, abs=1e-6)
    assert (gearing.families, gearing.confirmed, gearing.teeth) == ((), False, None)


def two_lines(random: np.random.Generator, swell: float) -> np.ndarray:
    """A line of 23 teeth, and a louder one of another stage, whose first shaft's turns swell the
    former alone."""
    turn = np.arange(16_384) * 0.0027
    x = 0.03 * random.normal(size=turn.size)
    by = 1.0 + swell * np.cos(2 * np.pi * turn)
    for teeth, size, swelling in ((23.0, 0.4, by), (23.0 * 31.0 / 57.0, 1.0, 1.0)):
        for rank in (1, 2, 3):
            phase = 2.0 * np.pi * rank * teeth * turn + random.uniform(0.0, 6.0)
            x += size / rank * swelling * np.cos(phase)
    return np.asarray(x)


def test_sidebands_of_the_teeth_given_tell_which_line_is_theirs() -> None:
    """Of two lines the louder is read, and another where the sidebands of the teeth given are."""
    random = np.random.default_rng(26_11_2026)
    second = 0.0027 * 23.0 * 31.0 / 57.0
    plain = find_gearing([two_lines(random, 0.0)], teeth=23)
    assert plain.mesh_frequency == pytest.approx(second, rel=1e-4)
    assert (plain.confirmed, plain.teeth) == (False, None)
    swelling = find_gearing([two_lines(random, 0.1)], teeth=23)
    assert swelling.mesh_frequency == pytest.approx(0.0027 * 23.0, rel=1e-4)
    assert swelling.confirmed


def test_noise_alone_names_nothing_certain() -> None:
    noise = list(np.random.default_rng(9).standard_normal((2, 20_000)))
    with pytest.raises(InputError, match=r"^mesh line: got none; no line stands out"):
        find_gearing(noise)


def test_refusals() -> None:
    with pytest.raises(InputError, match=r"^record: got 100 samples; allowed >= 256"):
        find_gearing([np.sin(np.arange(100.0))])
    with pytest.raises(InputError, match=r"^record: got gaps; allowed finite samples"):
        find_gearing([np.full(1000, np.nan)])


def test_evidence_is_in_words_with_numbers() -> None:
    """Two samples of these arrays in one of the record: places are told as the record's."""
    gearing = find_gearing(list(mesh_train(60_000, noise=0.2)), told_as=2.0)
    said = [numbers(line) for line in gearing.evidence]
    assert 2.0 * gearing.mesh_frequency == pytest.approx(said[0][0], abs=1e-6)
    for family, row in zip(gearing.families, said[1:], strict=False):
        assert row == pytest.approx([family.lines, 2.0 * family.distance], abs=1e-6)


@pytest.mark.parametrize(("near", "of"), [(0.05, 0), (0.1, 2)])
def test_a_line_that_is_followed_may_be_a_harmonic(near: float, of: int) -> None:
    """Taken for the mesh line it made the shaft turn twice as fast."""
    n = np.arange(40_000)
    x = 0.01 * np.random.default_rng(8).standard_normal(n.size)
    for rank, size in ((1, 0.6), (2, 1.0), (3, 0.2)):
        x += size * np.cos(2 * np.pi * rank * 0.05 * n + rank)
    gearing = find_gearing([x], near, teeth=27)
    assert gearing.mesh_frequency == pytest.approx(near, rel=1e-4)
    assert (gearing.confirmed, gearing.rank_of) == (False, of)


def test_a_speed_is_withheld_where_the_gear_s_mesh_line_is_not_decided() -> None:
    """The louder line is the second stage's: without a speed nothing tells which is the first's."""
    random = np.random.default_rng(27)
    true = 2.0 * np.pi * 10_240.0 * 0.0027
    for _ in range(2):
        record = Record((Channel("a", two_lines(random, 0.0), "g"),), "made", 10_240.0, "made")
        undecided = measure(record, teeth=23, sidebands=0, harmonics=1)
        assert np.isnan(undecided.lines[0].shaft_speed)
        (held,) = [one.data for one in undecided.notices if one.code == "shaft_speed_undecided"]
        assert held["teeth"] == 23
        line = measure(record, teeth=23, speed=1.01 * true, sidebands=0, harmonics=1).lines[0]
        assert abs(line.shaft_speed - true) < 3.0 * line.speed_half_width
