"""Duty tables and records as users write them: what is read, and one line for what is wrong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.case.case import GearCase, load_example
from thermogear.case.duty import point_duty, read_duty, read_measured
from thermogear.case.ranges import CRUSHING, crushing_torque

RPM = np.pi / 30.0


@pytest.fixture(scope="module")
def case() -> GearCase:
    found = load_example("rig", ['model.bundle="consistent"'])
    assert isinstance(found, GearCase)
    return found


def written(folder: Path, text: str, encoding: str = "utf-8") -> Path:
    path = folder / "table.csv"
    path.write_bytes(text.encode(encoding))
    return path


def test_a_table_is_read_with_its_units(case: GearCase, tmp_path: Path) -> None:
    text = (
        "time [min],speed [rpm],torque [N m],ambient [degC]\n"
        "# a start, a stop\n0,3000,100,20\n\n10,0,0,20\n12.5,1500,80,35\n60,0,0,20\n"
    )
    for encoding in ("utf-8", "utf-8-sig", "utf-16"):
        found = read_duty(written(tmp_path, text, encoding), case)
        assert found.time.tolist() == [0.0, 600.0, 750.0, 3600.0]
        np.testing.assert_allclose(found.speed, RPM * np.array([3000.0, 0.0, 1500.0]))
        assert found.torque.tolist() == [100.0, 0.0, 80.0]
        np.testing.assert_allclose(found.ambient, [293.15, 293.15, 308.15])


def test_other_units_order_and_separators(case: GearCase, tmp_path: Path) -> None:
    text = "Torque [kNm];time [h];speed [rad/s]\n0,1;0;200\n0,05;0,5;100\n"
    found = read_duty(written(tmp_path, text), case)
    np.testing.assert_allclose(found.time, [0.0, 1800.0])
    np.testing.assert_allclose([found.speed[0], found.torque[0]], [200.0, 100.0])
    # the ambient left out is the case's
    assert found.ambient.tolist() == [case.gearbox.surroundings.ambient]


HEAD = "time [min],speed [rpm],torque [N m],ambient [degC]\n"
GOOD = "0,3000,100,20\n10,0,0,20\n"
WRONG = {
    "empty": ("", "duty: got an empty file; allowed a table; begin with time [min],speed [rpm],"),
    "comments": ("# nothing\n", "duty: got an empty file; allowed a table; begin with time [min]"),
    "head only": (HEAD, "duty: got 0 rows; allowed two or more; the last row says when the duty"),
    "one row": (HEAD + "0,3000,100,20\n", "duty: got 1 rows; allowed two or more; the last row"),
    "negative time": (
        HEAD + "0,3000,100,20\n-5,0,0,20\n",
        "duty.time: got -5 min in row 2; allowed >= 0 min",
    ),
    "not rising": (
        HEAD + "0,3000,100,20\n10,0,0,20\n10,100,0,20\n",
        "duty.time: got 10 min in row 3, after 10 min; allowed times that rise",
    ),
    "late start": (
        HEAD + "5,3000,100,20\n10,0,0,20\n",
        "duty.time: got 5 min in row 1; allowed 0 min in the first row",
    ),
    "gap": (
        HEAD + "0,3000,,20\n10,0,0,20\n",
        "duty.torque: got an empty cell in row 1; allowed a number; fill the gap, or leave the",
    ),
    "missing cell": (
        HEAD + "0,3000,100\n10,0,0,20\n",
        "duty: got 3 cells in row 1; allowed 4, as in the head; decimals follow a point",
    ),
    "word": (
        HEAD + "0,fast,100,20\n10,0,0,20\n",
        "duty.speed: got 'fast' in row 1; allowed a number",
    ),
    "nan": (HEAD + "0,nan,100,20\n10,0,0,20\n", "duty.speed: got 'nan' in row 1; allowed a number"),
    "backwards": (
        HEAD + "0,-3000,100,20\n10,0,0,20\n",
        "duty.speed: got -3000 rpm in row 1; allowed 0..500000 rpm",
    ),
    "driven": (
        HEAD + "0,3000,-100,20\n10,0,0,20\n",
        "duty.torque: got -100 N m in row 1; allowed 0..1.045e+04 N m; the pinion drives; a stop",
    ),
    "crushing": (
        HEAD + "0,3000,100,20\n5,3000,9e4,20\n10,0,0,20\n",
        "duty.torque: got 9e4 N m in row 2; allowed 0..1.045e+04 N m; above it more than 4 GPa "
        "between the flanks, where no steel stays elastic",
    ),
    "too cold": (
        HEAD + "0,3000,100,-40\n10,0,0,20\n",
        "duty.ambient: got -40 degC in row 1; allowed -20..150 degC; the range of the viscosity "
        "line of M100",
    ),
    "in kelvins": (
        HEAD + "0,3000,100,293.15\n10,0,0,20\n",
        "duty.ambient: got 293.15 degC in row 1; allowed -20..150 degC",
    ),
    "no unit": (
        "time [min],speed [rpm],torque [N m],ambient\n" + GOOD,
        "duty.ambient: got column 'ambient'; its unit is missing; write ambient [degC]",
    ),
    "wrong unit": (
        "time [min],speed [Hz],torque [N m]\n0,1,1\n1,0,0\n",
        "duty.speed: got unit [Hz]; 'Hz' is no unit of rotational speed; write speed [rpm]",
    ),
    "unknown column": (
        "time [min],sped [rpm],torque [N m]\n0,1,1\n1,0,0\n",
        "duty: got column 'sped [rpm]'; allowed time | speed | torque | ambient; did you mean "
        "'speed'?",
    ),
    "twice": ("time [min],speed [rpm],speed [rpm]\n0,1,1\n", "duty.speed: got two columns"),
    "no torque": (
        "time [min],speed [rpm]\n0,3000\n10,0\n",
        "duty.torque: got no such column; begin with time [min],speed [rpm],torque [N m]",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", WRONG)
def test_what_is_wrong_is_one_line(what: str, case: GearCase, tmp_path: Path) -> None:
    text, line = WRONG[what]
    with pytest.raises(InputError) as caught:
        read_duty(written(tmp_path, text), case)
    assert str(caught.value).startswith(line)
    assert "\n" not in str(caught.value)


def test_files_that_are_none(case: GearCase, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"^--duty: got .*nothing\.csv; there is no such file$"):
        read_duty(tmp_path / "nothing.csv", case, "--duty")
    with pytest.raises(InputError, match=r"^duty: got .*; there is no such file$"):
        read_duty(tmp_path, case)
    binary = tmp_path / "binary.csv"
    binary.write_bytes(bytes(range(256)))
    with pytest.raises(InputError, match=r"^duty: got .*; it is no text; save it as CSV in UTF-8$"):
        read_duty(binary, case)


def test_the_crushing_torque_is_where_the_pressure_has_its_limit(case: GearCase) -> None:
    from thermogear.gears.contact import hertz_pressure, pair_reduced_modulus, reduced_radius

    pair = case.pair
    load = crushing_torque(pair) / pair.pinion.base_radius / pair.face_width
    pressure = hertz_pressure(load, reduced_radius(pair, pair.path.c), pair_reduced_modulus(pair))
    assert float(pressure) == pytest.approx(CRUSHING, rel=1e-12)
    assert point_duty(case, 100.0, crushing_torque(pair)).pieces == 1
    with pytest.raises(InputError, match=r"^--at: got 11000 N m; allowed 0\.\.1\.045e\+04 N m$"):
        point_duty(case, 100.0, 11000.0, "--at")


def test_without_a_table_the_air_must_suit_the_oil_too() -> None:
    cold = load_example("rig", ['gearbox.ambient="-40 degC"'])
    assert isinstance(cold, GearCase)
    with pytest.raises(
        InputError, match=r"^gearbox\.ambient: got -40 degC; allowed -20\.\.150 degC"
    ):
        point_duty(cold, 100.0, 50.0)


# --- records ---------------------------------------------------------------------------------


def test_a_record_is_read_and_may_have_gaps(tmp_path: Path) -> None:
    text = "time [s],pinion_tooth [degC],oil [K],thermocouple [degF]\n0,20,,68\n60,30,300,\n"
    found = read_measured(written(tmp_path, text))
    assert found.names == ("pinion_tooth", "oil", "thermocouple")
    assert found.time.tolist() == [0.0, 60.0]
    np.testing.assert_allclose(found.values[:, 0], [293.15, 303.15])
    np.testing.assert_allclose(found.values[0, 2], 293.15)
    assert np.isnan(found.values[[0, 1], [1, 2]]).all()


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("", "measured: got an empty file; allowed a table; begin with time [min],oil [degC]"),
        (
            "time [min],oil\n0,20\n",
            "measured.oil: got column 'oil'; its unit is missing; write oil [degC]",
        ),
        (
            "time [min],oill [degC]\n0,20\n",
            "measured: got column 'oill [degC]'; allowed time | oil | housing | ",
        ),
        ("oil [degC]\n20\n", "measured.time: got no such column; begin with time [min],"),
        (
            "time [min]\n0\n1\n",
            "measured: got no temperature; allowed time and one or more of oil,",
        ),
        ("time [min],oil [degC]\n0,\n1,\n", "measured: got no temperature; allowed time and one"),
        ("time [min],oil [degC]\n-1,20\n", "measured.time: got -1 min in row 1; allowed >= 0 min"),
        (
            "time [min],oil [degC]\n1,20\n1,21\n",
            "measured.time: got 1 min in row 2, after 1 min; allowed times that rise",
        ),
        ("time [min],oil [degC]\n,20\n", "measured.time: got  min in row 1; allowed >= 0 min"),
    ],
)
def test_a_wrong_record_is_one_line(text: str, line: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        read_measured(written(tmp_path, text))
    assert str(caught.value).startswith(line)
