"""Cases written as REXS models, and read again: the same case, bit for bit."""

from __future__ import annotations

import json
import math
import random
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from thermogear import ConvergenceError, InputError, ValidityWarning, read_rexs, write_rexs
from thermogear.base.period import Period
from thermogear.case.case import GearCase, gear_case, load_case, load_example
from thermogear.case.examples import EXAMPLES
from thermogear.case.new import NewCase
from thermogear.case.rexs import exporting
from thermogear.case.rexs.attributes import CASE
from thermogear.case.rexs.exporting import WRITTEN
from thermogear.case.rexs.importing import imported

GEARS = [name for name in EXAMPLES if load_example(name).kind == "gear"]
ENDINGS = (".rexs", ".rexsj", ".rexsz")


@pytest.fixture
def without_results(monkeypatch: pytest.MonkeyPatch) -> None:
    """Files are written as for a pair without a hot state: nothing is computed."""
    monkeypatch.setattr(exporting._Maker, "computed", lambda _: None)


@cache
def fzg_c() -> GearCase:
    """One case for the tests that only read it: its heat balance is computed once."""
    return gear_case(load_example("fzg-c"))


def there_and_back(case: GearCase, path: Path, version: str = "1.7") -> GearCase:
    found = imported(read_rexs(write_rexs(case, path, version=version)))
    assert found.notes == ()
    return gear_case(load_case(found.text))


def assert_same(mine: GearCase, other: GearCase) -> None:
    """Everything a study reads of a case, to the last bit."""
    assert mine.data == other.data
    assert mine.pair == other.pair
    for name in ("speed", "torque", "oil_temperature", "half_backlash"):
        one, two = getattr(mine.stated, name), getattr(other.stated, name)
        assert np.array_equal(one, two), name
    assert mine.stated.lubricant == other.stated.lubricant
    assert mine.models == other.models
    assert mine.inertias == other.inertias
    assert mine.cold_backlash == other.cold_backlash
    assert [repr(one) for one in mine.deviations] == [repr(one) for one in other.deviations]


def drawn(seed: int) -> GearCase:
    """A pair of our own, drawn by a seed, with values that no decimal holds exactly."""
    draw = random.Random(seed)
    while True:
        teeth = (draw.randint(18, 45), draw.randint(20, 90))
        module = draw.uniform(1.0, 6.0)
        text = NewCase(
            teeth=teeth,
            module=f"{module!r} mm",
            face_width=f"{draw.uniform(5.0, 12.0) * module!r} mm",
            speed=f"{draw.uniform(300.0, 6000.0)!r} rpm",
            torque=f"{draw.uniform(2.0, 4.0) * module**3!r} N m",
            profile_shift=(draw.uniform(0.0, 0.4), draw.uniform(-0.1, 0.3)),
            oil_temperature=f"{draw.uniform(40.0, 90.0)!r} degC",
        )
        relief = (
            f"[gears.pinion.tip_relief]\namount = '{draw.uniform(5.0, 30.0)!r} um'\n"
            f"length = '{draw.uniform(0.2, 0.5) * module!r} mm'\nshape = 'parabolic'\n"
            f"flank = 'drive'\n"
        )
        try:
            return gear_case(load_case(text.text() + relief))
        except InputError:
            continue


@pytest.mark.filterwarnings("ignore::thermogear.ValidityWarning")  # hot oil of FZG A
@pytest.mark.parametrize("name", GEARS)
def test_ready_cases_come_back(name: str, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    case = gear_case(load_example(name))
    if name != "bgu-17-38":  # one that computes its oil temperature
        request.getfixturevalue("without_results")
    path = tmp_path / f"gearbox{ENDINGS[GEARS.index(name) % 3]}"
    assert_same(case, there_and_back(case, path))


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.usefixtures("without_results")
def test_drawn_pairs_come_back(seed: int, tmp_path: Path) -> None:
    case = drawn(seed)
    version = WRITTEN[seed % len(WRITTEN)]
    again = there_and_back(case, tmp_path / f"gearbox{ENDINGS[seed % 3]}", version)
    assert_same(case, again)
    if seed < 2:
        one, two = (
            each.cycle(each.operating_of(each.models[0]), each.models[0]) for each in (case, again)
        )
        assert one.identical(two)


@pytest.mark.parametrize("edge", ["tip_rounding", "tip_chamfer"])
@pytest.mark.usefixtures("without_results")
def test_an_edge_comes_back_and_ends_the_flank_for_other_programs(
    edge: str, tmp_path: Path
) -> None:
    names = ("pinion", "wheel")
    case = gear_case(load_example("fzg-c", [f"gears.{n}.{edge}=0.2 mm" for n in names]))
    path = tmp_path / "gearbox.rexs"
    assert_same(case, there_and_back(case, path))
    again = gear_case(load_case(imported(read_rexs(foreign(path))).text))
    for name in names:
        mine, other = getattr(case.pair, name), getattr(again.pair, name)
        assert other.tip_form_radius == pytest.approx(mine.tip_form_radius, rel=1e-11)
        assert mine.tip_form_radius < mine.tip_radius == pytest.approx(other.tip_radius)


@pytest.mark.usefixtures("without_results")
def test_a_whole_turn_comes_back(tmp_path: Path) -> None:
    """REXS has no word for single teeth: the case kept in the file has them all."""
    errors = [f"{(7 * n) % 5 - 2} um" for n in range(24)]
    changes = [
        'gears.pinion.eccentricity={run_out="20 um", angle="30 deg"}',
        f"gears.wheel.pitch_errors={errors}",
        "gears.pitch_errors_along=arc",
        'gears.pinion.teeth_differ=[{tooth=3, index="5 um", slope="-4 um"}]',
        "gears.marks=[2, 5]",
    ]
    case = gear_case(load_example("fzg-c", changes))
    again = there_and_back(case, tmp_path / "gearbox.rexs")
    assert_same(case, again)
    assert again.deviations == case.deviations
    assert again.period == case.period == Period(48, (16, 24))


@pytest.mark.usefixtures("without_results")
def test_overrides_are_part_of_the_case(tmp_path: Path) -> None:
    case = gear_case(
        load_example("fzg-c", ["operating.torque=150 N m", "dynamics.damping_ratio=0.1"])
    )
    again = there_and_back(case, tmp_path / "gearbox.rexs")
    assert_same(case, again)
    assert again.damping_ratio == 0.1


@pytest.mark.usefixtures("without_results")
def test_every_version_has_its_own_names_and_units(tmp_path: Path) -> None:
    case = fzg_c()
    new, old = (
        write_rexs(case, tmp_path / f"{version}.rexs", version=version).read_text(encoding="utf-8")
        for version in ("2.0.0", "1.7")
    )
    for text, unit in ((new, "MPa"), (old, "N / mm^2")):
        assert f'id="elastic_modulus" unit="{unit}">206000.0<' in text
    assert 'id="tip_corner_radius_factor_reference_profile"' in new
    assert 'id="tip_radius_factor"' in old
    assert 'id="arithmetic_mean_roughness_flank_iso_4287_1997" unit="mum">0.35<' in new


def foreign(path: Path, *changes: tuple[str, str]) -> Path:
    """The file as a program writes it that keeps nothing of ours, with values changed."""
    text = path.read_text(encoding="utf-8")
    text = re.sub(r'\s*<attribute id="custom_thermogear[^<]*</attribute>', "", text)
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.usefixtures("without_results")
def test_without_our_attributes_the_converted_values_give_the_pair(tmp_path: Path) -> None:
    case = drawn(11)
    path = foreign(write_rexs(case, tmp_path / "gearbox.rexs"))
    again = gear_case(load_case(imported(read_rexs(path)).text))
    for name in ("pinion", "wheel"):
        mine, other = getattr(case.pair, name), getattr(again.pair, name)
        assert mine.teeth == other.teeth
        for size in ("module", "profile_shift", "face_width", "tip_radius", "root_radius"):
            assert getattr(other, size) == pytest.approx(getattr(mine, size), rel=1e-11), size
        assert other.material.youngs_modulus == mine.material.youngs_modulus
    assert again.stated.speed == pytest.approx(case.stated.speed, rel=1e-11)
    assert again.torques == pytest.approx(case.torques, rel=1e-11)
    assert again.pair.centre_distance == pytest.approx(case.pair.centre_distance, rel=1e-11)
    relief = again.file.gears.pinion.tip_relief
    mine_relief = case.file.gears.pinion.tip_relief
    assert relief is not None
    assert mine_relief is not None
    assert relief.amount == pytest.approx(mine_relief.amount, rel=1e-9)
    assert relief.length == pytest.approx(mine_relief.length, rel=1e-8)
    assert (relief.shape, relief.flank) == ("parabolic", "drive")
    assert again.cold_backlash.half == pytest.approx(case.cold_backlash.half, rel=1e-9)
    assert again.stated.oil_temperature == pytest.approx(case.stated.oil_temperature, rel=1e-11)


@pytest.mark.parametrize(
    ("old", "new", "path", "value"),
    [
        ('"face_width" unit="mm">14.0', '"face_width" unit="mm">15.5', "pinion.face_width", 0.0155),
        (
            '"addendum_modification_coefficient" unit="none">0.1817',
            '"addendum_modification_coefficient" unit="none">0.17',
            "pinion.profile_shift",
            0.17,
        ),
    ],
)
def test_what_another_program_changed_counts_and_is_said(
    old: str, new: str, path: str, value: float, tmp_path: Path
) -> None:
    case = fzg_c()
    file = write_rexs(case, tmp_path / "gearbox.rexs")
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_text(text.replace(old, new), encoding="utf-8")
    found = imported(read_rexs(file))
    again = gear_case(load_case(found.text))
    gear, field = path.split(".")
    assert getattr(getattr(again.pair, gear), field) == pytest.approx(value, rel=1e-14)
    assert "changed" in found.text
    assert again.data["operating"] == case.data["operating"]


def test_a_changed_load_and_oil_replace_theirs(tmp_path: Path) -> None:
    case = fzg_c()
    file = write_rexs(case, tmp_path / "gearbox.rexs")
    text = file.read_text(encoding="utf-8")
    text = text.replace('unit="1 / min">1500.0', 'unit="1 / min">1600.0')
    text = text.replace('celsius" unit="kg / dm^3">0.8921', 'celsius" unit="kg / dm^3">0.9')
    file.write_text(text, encoding="utf-8")
    again = gear_case(load_case(imported(read_rexs(file)).text))
    assert sorted(again.speeds) == pytest.approx(
        [rpm * math.pi / 30.0 for rpm in (1000.0, 1600.0, 2166.0)], rel=1e-12
    )
    assert again.stated.lubricant.density_15 == pytest.approx(900.0, rel=1e-14)


def test_results_stand_in_the_load_cases(tmp_path: Path) -> None:
    case = fzg_c()
    model = read_rexs(write_rexs(case, tmp_path / "gearbox.rexsj"))
    assert len(model.load_cases) == 3
    first = case.models[0]
    cycle = case.cycle(case.operating_of(first), first)
    for k, load in enumerate(model.load_cases):
        stage = load.components[3]
        stiffness = stage["meshing_stiffness_characteristic"]
        assert stiffness.unit == "N / mm"
        assert np.array_equal(
            np.array(stiffness.value, dtype=float), 1e-3 * cycle["mesh_stiffness"].values[k]
        )
        power = stage["custom_thermogear_frictional_power"]
        assert (power.unit, power.value) == ("W", float(cycle["frictional_power"].values[k]))
    ratio = model.accumulation[3]["total_contact_ratio"].value
    assert ratio == case.pair.contact_ratio


def test_what_cannot_be_exported(tmp_path: Path) -> None:
    case = fzg_c()
    with pytest.raises(InputError, match="kind = 'dimensionless'"):
        write_rexs(load_example("table-4.2"), tmp_path / "a.rexs")  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"output: got 'a.txt'; allowed .rexs"):
        write_rexs(case, tmp_path / "a.txt")
    with pytest.raises(InputError, match=r"REXS version: got '1\.2'"):
        write_rexs(case, tmp_path / "a.rexs", version="1.2")
    (tmp_path / "a.rexs").write_text("x")
    with pytest.raises(InputError, match="it is there already"):
        write_rexs(case, tmp_path / "a.rexs")
    wide = gear_case(load_example("fzg-c", ["operating.speed=[" + "'1 rpm'," * 2001 + "]"]))
    with pytest.raises(InputError, match=r"operating: got 2001 points; allowed 1..2000"):
        write_rexs(wide, tmp_path / "b.rexs")


def test_a_pair_without_a_hot_state_is_written_without_results(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(*_: object) -> None:
        raise ConvergenceError("the heat balance does not settle")

    case = drawn(3)
    monkeypatch.setattr(GearCase, "cycle", never)
    with pytest.warns(ValidityWarning, match="written without results: the heat balance does not"):
        path = write_rexs(case, tmp_path / "gearbox.rexs")
    model = read_rexs(path)
    assert 3 not in model.load_cases[0].components
    assert_same(case, gear_case(load_case(imported(model).text)))


def test_a_stored_case_is_checked_like_any_other(tmp_path: Path) -> None:
    case = fzg_c()
    file = write_rexs(case, tmp_path / "gearbox.rexsj")
    content = json.loads(file.read_text(encoding="utf-8"))
    for component in content["model"]["components"]:
        for attribute in component["attributes"]:
            if attribute["id"] == CASE:
                kept = json.loads(attribute["string"])
                kept["text"] = kept["text"].replace("teeth = 16", "teeth = 1600000")
                attribute["string"] = json.dumps(kept)
    file.write_text(json.dumps(content), encoding="utf-8")
    with pytest.raises(
        InputError, match=r"stage 1.gears.pinion.teeth: got 1600000; allowed 5..2000"
    ):
        imported(read_rexs(file))
