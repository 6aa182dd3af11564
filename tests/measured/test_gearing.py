"""Mesh line, shafts and tooth numbers from lines alone: synthetic trains, then the real rig."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from unittest.mock import Mock, patch

import numpy as np
import pytest
from record_makers import SHARED, mesh_train, quantised

from conftest import Compared
from said import numbers
from thermogear.base.errors import InputError
from thermogear.measured.evidence import Evidence
from thermogear.measured.gearing import Gearing, find_gearing, told_of_mate
from thermogear.measured.hypotheses import Gears, Hypothesis
from thermogear.measured.meshes import Stated
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import measure

# main mesh [cycles/sample], then main and second mesh in orders of the first shaft
TRUTH = {"h30hz0": (0.074385, 32.0, 19.2), "h30hz50": (0.074189, 32.0, 19.2)}


def twin(name: str) -> list[np.ndarray]:
    """A synthetic record of the real rig's gearing."""
    return list(quantised(mesh_train(88_000, TRUTH[name][0], noise=0.2)))


def path_of(name: str) -> Path:
    return SHARED / f"{name}.csv.gz"


@cache
def table_of(name: str) -> np.ndarray:
    return np.loadtxt(path_of(name), delimiter=",", skiprows=1).T


@pytest.mark.parametrize("name", TRUTH)
def test_the_rigs_orders_are_found_without_rate_or_teeth(name: str) -> None:
    position, main, second = TRUTH[name]
    gearing = find_gearing(twin(name))
    assert gearing.mesh_frequency == pytest.approx(position, abs=1.5e-6)
    assert gearing.shafts[0].ratio == pytest.approx(main, abs=0.005)
    assert [shaft.teeth for shaft in gearing.shafts] == [32, 80]
    assert gearing.shafts[1].order == pytest.approx(0.4, abs=1e-9)
    assert gearing.meshes[0].order == pytest.approx(second, abs=1e-9)
    assert gearing.meshes[0].teeth == (48, 64)


@pytest.mark.slow
@pytest.mark.parametrize("channels", [(0,), (1,), (2,), (3,), (0, 1, 2, 3)])
@pytest.mark.parametrize("name", TRUTH)
def test_the_real_records_name_no_wrong_gear(name: str, channels: tuple[int, ...]) -> None:
    """Hundreds of lines of three shafts in whole ratios: most channels leave the teeth open."""
    if not path_of(name).is_file():
        pytest.skip("the folder is not part of the project")
    table = table_of(name)
    found = find_gearing([table[i] for i in channels])
    assert {shaft.teeth for shaft in found.shafts} <= {32, 80}


@pytest.mark.parametrize("noise", [0.1, 0.5])
@pytest.mark.parametrize(
    "teeth", [(32, 80, 48, 64), (25, 75, 20, 60), (20, 30, 25, 40), (23, 92, 31, 47)]
)
def test_teeth_of_synthetic_trains(
    teeth: tuple[int, int, int, int], noise: float, compared: Compared
) -> None:
    gearing = find_gearing(list(mesh_train(60_000, 0.0713, teeth, noise)))
    # teeth that divide the other gear's may be its shaft's harmonics: they are not named
    named = [teeth[1]] if teeth[1] % teeth[0] == 0 else [teeth[0], teeth[1]]
    assert [shaft.teeth for shaft in gearing.shafts] == named
    compared(
        "mesh line of trains with unknown teeth",
        "the line put in",
        gearing.mesh_frequency / 0.0713 - 1.0,
        1e-4,
    )
    assert gearing.teeth == named[0]


def test_a_lone_harmonic_family_names_the_mesh_line_and_no_teeth() -> None:
    n = np.arange(30_000)
    x = sum(a * np.cos(2 * np.pi * 0.0613 * k * n) for k, a in ((1, 1.0), (2, 0.5), (3, 0.3)))
    gearing = find_gearing([x + 0.2 * np.random.default_rng(3).standard_normal(n.size)])
    assert gearing.mesh_frequency == pytest.approx(0.0613, abs=1e-6)
    assert (gearing.teeth, gearing.meshes) == (None, ())


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
    gearing: Gearing = find_gearing(list(mesh_train(60_000, noise=0.2)))
    said = [numbers(line) for line in gearing.evidence]
    for figures in ([32.0, 1.0], [80.0, 0.4], [19.2, 48.0, 64.0]):
        assert any(set(figures) <= set(row) for row in said), figures


def test_a_line_that_was_followed_may_be_a_harmonic() -> None:
    """Taken for the mesh line it made the shaft turn twice as fast, whatever the weights told."""
    n = np.arange(40_000)
    mesh, teeth = 0.05, 27
    x = 0.01 * np.random.default_rng(8).standard_normal(n.size)
    by = 1.0 + 0.2 * np.cos(2 * np.pi * mesh / teeth * n)
    for rank, size in ((1, 0.6), (2, 1.0), (3, 0.2)):
        x += size * by * np.cos(2 * np.pi * rank * mesh * n + rank)
    found = find_gearing([x], 2.0 * mesh, Stated(teeth=teeth), followed=0.001)
    assert found.weighed.mesh == pytest.approx(mesh, rel=1e-3)
    assert found.mesh_frequency == pytest.approx(mesh, rel=1e-4)


@pytest.mark.parametrize(("first", "taken"), [(1.0, 0.05), (0.3, 0.1)])
def test_an_undecided_mesh_line_is_no_harmonic_of_a_higher_one(first: float, taken: float) -> None:
    """Twice the mesh line was taken where its weight was 0.6 (3 of 960 drawn records)."""
    n = np.arange(20_000)
    x = 0.01 * np.random.default_rng(9).standard_normal(n.size)
    for rank, size in ((1, first), (2, 0.6)):
        x += size * np.cos(2 * np.pi * rank * 0.05 * n + rank)
    gears = Gears(mesh=0.1, level=4.0, teeth=(), sides=(), free=())
    undecided = Evidence(hypotheses=(Hypothesis(gears=(gears,), evidence=0.4, weight=0.6),))
    with patch("thermogear.measured.gearing.weigh", Mock(return_value=undecided)):
        found = find_gearing([x])
    assert found.mesh_frequency == pytest.approx(taken, rel=1e-4)


@pytest.mark.parametrize(("turns", "told"), [(6.0, 1), (15.0, 1), (33.0, 0)])
def test_few_turns_say_little_of_a_larger_mate(turns: float, told: int) -> None:
    n = np.arange(int(turns * 23 / 0.05))
    x = 0.01 * np.random.default_rng(10).standard_normal(n.size) + np.cos(2 * np.pi * 0.05 * n)
    found = measure(Record((Channel("a", x, "g"),), "made", 12_800.0, "made"), teeth=23)
    said = told_of_mate(found.gearing, teeth=23, samples=n.size) if found.gearing else []
    assert len(said) == told
    assert sum(one in found.notices for one in said) == told
