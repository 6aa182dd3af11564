"""Deviations of the flanks in a case file: read, refused under their field, felt by the mesh."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
import xarray as xr

from coded import coded
from thermogear.base.errors import GeometryError, InputError
from thermogear.case.case import GearCase, gear_case, load_case, load_example
from thermogear.case.flanks import relief_text
from thermogear.gears.deviations import FlankTable, PitchError, PressureAngleError, Relief
from thermogear.gears.population import Population, drawn_pair
from thermogear.mesh.cycle import mesh_cycle
from thermogear.study.run import run

ONE = ['operating.speed="1000 rpm"', "grid.path_positions=21", "grid.mesh_positions=64"]
TIP = ['gears.pinion.tip_relief={amount="20 um", length="4 mm"}']


def rig(*changes: str) -> GearCase:
    case = load_example("rig", [*ONE, *changes])
    assert isinstance(case, GearCase)
    return case


SERIES = """[gears]
module = "3 mm"
face_width = "30 mm"
[gears.pinion]
teeth = 20
[gears.wheel]
teeth = 40
[operating]
speed = "3000 rpm"
torque = "80 N m"
"""


def test_every_kind_of_deviation_is_read_in_si() -> None:
    errors = ", ".join(['"1 um"'] * 75)
    case = rig(
        *TIP,
        'gears.wheel.root_relief={amount="5 um", length="2 mm", shape="parabolic", flank="drive"}',
        f"gears.wheel.pitch_errors=[{errors}]",
        'gears.pinion.pressure_angle_error="0.05 deg"',
        'gears.wheel.profile={radius=["182 mm", "192 mm"], added=["0 um", "-8 um"]}',
    )
    tip, angle, root, pitch, wear = case.deviations
    assert isinstance(tip, Relief)
    assert (tip.gear, tip.end, tip.shape, tip.flank) == ("pinion", "tip", "linear", "both")
    assert (tip.amount, tip.length) == pytest.approx((20e-6, 4e-3), rel=1e-14)
    assert isinstance(angle, PressureAngleError)
    assert angle.error == pytest.approx(math.radians(0.05), rel=1e-14)
    assert isinstance(root, Relief)
    assert (root.gear, root.end, root.shape, root.flank) == ("wheel", "root", "parabolic", "drive")
    assert (root.amount, root.length) == pytest.approx((5e-6, 2e-3), rel=1e-14)
    assert isinstance(pitch, PitchError)
    assert pitch.errors == pytest.approx((1e-6,) * 75, rel=1e-14)
    assert isinstance(wear, FlankTable)
    np.testing.assert_allclose(np.asarray(wear.added), [0.0, -8e-6])
    assert rig().deviations == ()


@pytest.mark.parametrize(
    ("change", "field", "words"),
    [
        (
            'gears.pinion.tip_relief={amount="20 um", length="30 mm"}',
            "gears.pinion.tip_relief.length",
            "got 30 mm; allowed <= 25.3061 mm; the tip relief is longer than the active profile",
        ),
        (
            'gears.wheel.root_relief={amount="20 um", length="30 mm"}',
            "gears.wheel.root_relief.length",
            "the root relief is longer than the active profile",
        ),
        (
            'gears.pinion.pitch_errors=["1 um", "2 um"]',
            "gears.pinion.pitch_errors",
            "got 2 values; allowed one for each of the 25 teeth",
        ),
        (
            'gears.pinion.profile={radius=["65 mm", "60 mm"], added=["0 um", "1 um"]}',
            "gears.pinion.profile.radius",
            "allowed two or more, strictly rising",
        ),
        (
            'gears.pinion.profile={radius=["60 mm", "65 mm"], added=["0 um","1 um","2 um"]}',
            "gears.pinion.profile.added",
            "shape (3,)",
        ),
        (
            'gears.wheel.tip_relief={amount="20 um"}',
            "gears.wheel.tip_relief.length",
            "got nothing; needed",
        ),
        (
            'gears.wheel.tip_relief={amount="20 um", lenght="1 mm"}',
            "gears.wheel.tip_relief.lenght",
            "did you mean 'length'?",
        ),
    ],
)
def test_what_does_not_fit_is_refused_under_its_field(change: str, field: str, words: str) -> None:
    with pytest.raises(InputError) as caught:
        rig(change)
    assert caught.value.field == field
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)
    assert isinstance(caught.value, GeometryError) == ("longer" in words)


CONSISTENT = ['model.bundle="consistent"', 'draw.pictures=["path"]']


@pytest.fixture(scope="module")
def plain() -> xr.Dataset:
    """The mesh of a run without relief."""
    return run(rig(*CONSISTENT))["mesh"].to_dataset()


def test_a_relief_reaches_every_result_of_a_run(plain: xr.Dataset) -> None:
    relieved = run(rig(*CONSISTENT, *TIP))["mesh"].to_dataset()
    case = rig(*CONSISTENT, *TIP)
    cycle = mesh_cycle(
        case.pair,
        case.operating,
        case.models[0],
        deviations=[Relief("pinion", amount=20e-6, length=4e-3)],
        path_positions=21,
        mesh_positions=64,
    )
    hot = relieved.isel(bundle=0, state=1, operating=0)
    np.testing.assert_allclose(hot["mesh_stiffness"].values, cycle["mesh_stiffness"].values[0])
    # less double contact: the mean stiffness falls
    unrelieved = plain.isel(bundle=0, state=1, operating=0)
    assert float(hot["mean_stiffness"]) < float(unrelieved["mean_stiffness"])


def test_a_relief_of_nothing_changes_nothing(plain: xr.Dataset) -> None:
    none = 'gears.pinion.tip_relief={amount="0 um", length="4 mm"}'
    zero = run(rig(*CONSISTENT, none))["mesh"]
    np.testing.assert_array_equal(plain["mesh_stiffness"].values, zero["mesh_stiffness"].values)


def test_a_bundle_that_does_not_feel_deviations_is_named() -> None:
    tree = run(rig(*TIP, 'draw.pictures=["path"]'))
    assert coded(str(tree.attrs["notices"]))["deviations_not_felt"] == [{"bundles": ["thesis"]}]


def test_a_relief_pasted_into_a_case_is_the_same_relief() -> None:
    relief = Relief("wheel", amount=12.345e-6, length=3.456789e-3, shape="parabolic")
    table = relief_text("wheel", relief)
    assert table.startswith("[gears.wheel.tip_relief]\n")
    entries = ", ".join(table.splitlines()[1:])
    (read,) = rig(f"gears.wheel.tip_relief={{{entries}}}").deviations
    assert isinstance(read, Relief)
    assert read.amount == pytest.approx(relief.amount, rel=1e-12)
    assert read.length == pytest.approx(relief.length, rel=1e-12)
    assert read.shape == "parabolic"


@pytest.mark.parametrize(
    ("changes", "parts"),
    [
        ((), 64),
        (("flanks.accuracy=8",), 64),
        (("flanks.parts=16",), 16),
        (("flanks.seed=1",), 1),
        (("flanks.seed=3", "flanks.parts=100"), 100),
        (("flanks.teeth=drawn",), 64),
        (("flanks.teeth=drawn", "flanks.drawing=0"), 1),
        (("gears.period=mesh",), 1),
        (("gears.part=nominal",), 1),
        (("model.stiffness=textbook-30-degree",), 1),
        (("gears.pinion.eccentricity.amount=5 um",), 1),
        (("gears.wheel.tooth_profiles=[{slope=['2 um']}]",), 1),
        (("transmission_error.harmonics=[{order=1, amplitude='3 um'}]",), 1),
    ],
)
def test_a_class_without_a_seed_is_a_series(changes: tuple[str, ...], parts: int) -> None:
    case = gear_case(load_case(SERIES, changes))
    assert case.series == parts
    told = {one.field for one in case.assumptions}
    assert {"flanks.parts", "dynamics.damping_ratio_least"} <= told or parts != 64
    assert ("dynamics.damping_ratio_least" in told) == (parts > 1)
    # what other studies follow is the drawing that it was
    seeded = gear_case(load_case(SERIES, [*changes, "flanks.seed=1"]))
    if case.deviations and "flanks.seed=3" not in changes:
        assert case.deviations == seeded.deviations


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (("flanks.parts=15",), "flanks.parts: got 15; allowed 1, or 16..1024"),
        (("flanks.parts=64", "gears.pinion.eccentricity.amount=5 um"),
         "flanks.parts: got 64; allowed 1"),
        (("dynamics.damping_ratio=0.1", "dynamics.damping_ratio_least=0.02"),
         "dynamics.damping_ratio: got 0.1; allowed 0.02..0.07"),
    ],
)  # fmt: skip
def test_a_series_that_cannot_be_is_refused(changes: tuple[str, ...], message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        load_case(SERIES, changes)


def test_a_damping_that_is_stated_narrows_the_band() -> None:
    def dampings(*changes: str) -> tuple[float, ...]:
        names = (f"dynamics.damping_ratio{change}" for change in changes)
        return gear_case(load_case(SERIES, tuple(names))).dampings

    assert dampings() == pytest.approx((0.07, 0.02, math.sqrt(0.02 * 0.07)))
    assert dampings("=0.05") == (0.05,)
    assert dampings("=0.05", "_least=0.03") == (0.05, 0.03, 0.07)
    assert dampings("=0.05", "_least=0.05", "_most=0.05") == (0.05,)


def test_the_population_is_that_of_the_file() -> None:
    case = gear_case(load_case(SERIES, ["flanks.population.wave=0.1", "flanks.teeth=drawn"]))
    assert case.population == Population(wave=0.1)
    assert case.deviations == drawn_pair(case.pair, 6, seed=1, population=Population(wave=0.1))
