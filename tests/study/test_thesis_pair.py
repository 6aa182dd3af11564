"""The thesis's steps for somebody's own pair: what is found is what is stored."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from html import unescape
from typing import Any

import numpy as np
import pytest

from in_words import in_words
from own_pair import OWN_PAIR
from said import numbers
from thermogear.base.errors import InputError
from thermogear.case.allowed import FLUCTUATION
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.family import family
from thermogear.case.points import largest_fluctuation
from thermogear.results.result import Result
from thermogear.study import thesis_pair as study
from thermogear.study.thesis_pair import thesis_pair
from thermogear.views.page import Pictures, Table, render
from thermogear.views.pages import thesis_pair as thesis_pair_page
from thermogear.views.plots import temperature
from thermogear.views.plots.motion import label_of
from thermogear.views.write import page_of

pytestmark = pytest.mark.filterwarnings("ignore::thermogear.base.errors.ValidityWarning")
SMALL = ["grid.path_positions=21", "grid.mesh_positions=32", "simulation.periods=16",
         "simulation.samples=32", "grid.harmonics=8", "simulation.discard=100"]  # fmt: skip
TWO_SPEEDS = 'operating.speed=["1500 rpm", "9000 rpm"]'
STEPS: dict[str, Any] = {"temperatures": (353.15, 393.15), "values": 5}


def own(*changes: str) -> GearCase:
    return gear_case(load_case(OWN_PAIR, [*SMALL, *changes]))


def prose(result: Result) -> str:
    """What a reader reads, without the case file."""
    html = re.sub(r"<style.*?</style>|<pre.*?</pre>", "", render(page_of(result)), flags=re.DOTALL)
    return " ".join(unescape(re.sub(r"<[^>]+>", " ", html)).split())


@pytest.fixture(autouse=True, scope="module")
def _told() -> Iterator[None]:
    """Pictures in words."""
    with in_words():
        yield


@pytest.fixture(scope="module")
def moving() -> Result:
    return thesis_pair(own(TWO_SPEEDS), **STEPS)


def over_damping_alone(case: GearCase, **how: Any) -> Result:
    """Its diagram over damping alone: two others say no other words."""
    every = study._axes
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            study, "_axes", lambda *given: {"damping_ratio": every(*given)["damping_ratio"]}
        )
        return thesis_pair(case, **how)


@pytest.fixture(scope="module")
def jammed() -> Result:
    return over_damping_alone(own("backlash.value=0.02 mm"), **STEPS)


def test_a_factor_scales_the_fluctuation_of_the_stiffness_and_nothing_else() -> None:
    """k = k_m (1 + s w): the mean stays, 1 changes no bit, and k reaches zero at s = -1/min w."""
    case = own()
    plain = family(case)(np.empty((1, 0)))
    with_factor = family(case, ["fluctuation"])
    points = with_factor(np.array([[1.0], [0.0], [2.0]]))
    own_series = plain.flat.stiffness[0]
    assert np.array_equal(points.flat.stiffness[0], own_series)
    assert not points.flat.stiffness[1, 1:].any()
    assert np.array_equal(points.flat.stiffness[2, 1:], 2.0 * own_series[1:])
    for name in ("period", "damping", "half_backlash", "force"):
        values = getattr(points.flat, name)
        assert np.array_equal(values, np.broadcast_to(getattr(plain.flat, name), values.shape))
    (most,) = largest_fluctuation(plain)
    turns = np.exp(2j * np.pi * np.outer(np.arange(own_series.size), np.arange(4000) / 4000))
    waves = (own_series[1:] @ turns[1:]).real
    assert most == pytest.approx(own_series[0].real / -waves.min(), rel=2e-2)
    cosine = replace(plain, flat=replace(plain.flat, stiffness=np.array([[1.0, 0.4]], complex)))
    assert largest_fluctuation(cosine) == pytest.approx([2.5], rel=1e-15)
    with pytest.raises(InputError) as refused:
        with_factor(np.array([[1.5 * most]]))
    assert str(refused.value) == (
        f"stiffness_fluctuation: got {1.5 * most:g}; allowed below {most:.4g}; the mesh stiffness "
        "would reach zero"
    )


def test_the_point_nearest_to_resonance_is_taken(moving: Result) -> None:
    """The mesh of both points and its natural frequency: the ratios' distances from one decide."""
    mesh = moving.groups["mesh"]
    assert mesh.sizes["operating"] == 1
    ratio = float(mesh["frequency_ratio"].sel(state="undeformed").item())
    slower, faster = ratio * 1500.0 / 9000.0, ratio
    assert abs(faster - 1.0) < abs(slower - 1.0)
    assert float(mesh["pinion_speed"].item()) == pytest.approx(9000.0 * np.pi / 30.0)
    with pytest.raises(InputError, match=re.escape("--operating: got 3; allowed 1..2")):
        thesis_pair(own(TWO_SPEEDS), operating=3)


def test_every_temperature_has_its_four_views(moving: Result) -> None:
    row = moving.groups["temperature"]
    history, phase, section, lines = temperature.views(row, bundle=0, operating=0).panels
    for place, panels in enumerate(zip(history, phase, section, lines, strict=True)):
        one = row.isel(bundle=0, operating=0, gear_temperature=place)
        x = 1e6 * (one["displacement"].values - float(one["half_backlash"]))
        drawn = [panel.marks[0] for panel in panels]
        assert drawn[0].y[0] == pytest.approx(x[0], rel=1e-12)
        assert drawn[0].x[0] == 0.0
        assert drawn[1].x[0] == pytest.approx(x[0], rel=1e-12)
        dots = panels[2].marks[-1]
        first = 1e6 * float(one["section_displacement"].values[0] - one["half_backlash"])
        assert np.any(np.isclose(dots.x, first, rtol=1e-3))
        kept = one["order"].values > 0.0
        greatest = 1e6 * float(one["line_amplitude"].values[kept].max())
        stems = next(mark for mark in panels[3].marks if type(mark).__name__ == "Stems")
        assert max(stems.y) == pytest.approx(greatest, rel=1e-12)


def test_findings_are_the_stored_figures(moving: Result) -> None:
    found = page_of(moving).figures
    row = moving.groups["temperature"].isel(bundle=0, operating=0)
    swing = [1e6 * float(v) for v in row["peak_to_peak_displacement"].values]
    said = numbers(found["findings"]["Gear temperature"])
    assert {80.0, 120.0, *(float(f"{value:.3g}") for value in swing)} <= set(said)
    path = moving.groups["path"].isel(bundle=0, state=-1, operating=0)
    friction = numbers(found["findings"]["Mixed and dry friction"])
    expected = [
        value
        for kind in ("mixed", "dry")
        for value in (
            float(path[f"friction_coefficient_{kind}"].mean()),
            float(path[f"flash_temperature_{kind}"].max()),
        )
    ]
    assert friction == pytest.approx(expected, rel=5e-3)


def test_pages_have_no_empty_table_and_speak_of_a_jam_where_one_is(
    moving: Result, jammed: Result
) -> None:
    for result in (moving, jammed):
        for section in page_of(result).sections:
            for block in section.blocks:
                assert not isinstance(block, Table) or block.rows
    assert not re.search(r"\bjam", prose(moving))
    said = prose(jammed)
    row = jammed.groups["temperature"].isel(bundle=0, operating=0)
    assert set(row["label"].values.ravel().tolist()) == {"jammed"}
    assert re.search(r"\bjam", said)
    told = page_of(jammed).figures["findings"]["Gear temperature"]
    # at the tightest phase, where it jams: never more than nothing
    gaps = sorted(1e6 * row["least_half_backlash"].values)
    assert max(gaps) <= 0.0
    assert numbers(told)[2:4] == pytest.approx(gaps, rel=5e-3)
    jams = sorted(row["jam_temperature"].values - 273.15)
    assert numbers(told)[4:6] == pytest.approx([jams[0], jams[-1]], abs=0.51)


def test_temperatures_that_a_material_does_not_have_are_left_out() -> None:
    """POM's modulus ends at 133.6 degC; without any that it has the first is refused."""
    plastic = own('gears.pinion.material="POM"', "operating.torque=1 N m")
    found = over_damping_alone(plastic, temperatures=(333.15, 433.15), values=3)
    assert found.groups["temperature"]["gear_temperature"].values.tolist() == [333.15]
    told = page_of(found).figures["findings"]["Gear temperature"]
    assert numbers(told)[-2:] == [160.0, 133.6]
    with pytest.raises(InputError, match=r"^temperature of POM: got .* degC; allowed < 133\.6"):
        thesis_pair(plastic, temperatures=(433.15,))


def test_a_stiffness_that_does_not_fluctuate_is_no_motion_of_its_own(moving: Result) -> None:
    """What moves undeformed lacks a diagram for another cause than its motion."""
    name, cold = FLUCTUATION, moving.groups["motion"].isel(bundle=0, operating=0, state=0)
    bare = replace(moving, groups={"motion": moving.groups["motion"]})
    told, blocks = thesis_pair_page._diagram(name, bare, Pictures())
    assert label_of(cold) not in told
    assert blocks == []
