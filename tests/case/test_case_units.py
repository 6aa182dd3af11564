"""Units as text: published conversions, and what is no unit of the kind asked for."""

from __future__ import annotations

import contextlib
import math
import random
import subprocess
import sys

import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

from said import numbers
from thermogear.base.errors import InputError, short
from thermogear.case.units import _USUAL, KINDS, Kind, convert, read_quantity, shown


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("5 mm", "length", 0.005),
        ("5mm", "length", 0.005),
        ("0.4 um", "length", 0.4e-6),
        ("0.4 µm", "length", 0.4e-6),
        ("1 inch", "length", 0.0254),
        ("-8e-2 mm", "length", -8e-5),
        ("20 deg", "angle", math.pi / 9.0),
        ("0.35 rad", "angle", 0.35),
        ("100 degC", "temperature", 373.15),
        ("100 °C", "temperature", 373.15),
        ("212 degF", "temperature", 373.15),
        ("293.15 K", "temperature", 293.15),
        ("20 K", "temperature difference", 20.0),
        ("20 delta_degC", "temperature difference", 20.0),
        ("1000 rpm", "rotational speed", 1000.0 * math.pi / 30.0),
        ("1 turn/s", "rotational speed", 2.0 * math.pi),
        ("360 deg/s", "rotational speed", 2.0 * math.pi),
        ("100 rad/s", "rotational speed", 100.0),
        ("100 N m", "torque", 100.0),
        ("100 N*m", "torque", 100.0),
        ("100 N·m", "torque", 100.0),
        ("100 Nm", "torque", 100.0),
        ("1 kN m", "torque", 1000.0),
        ("0.01 kg m^2", "moment of inertia", 0.01),
        ("0.01 kg*m**2", "moment of inertia", 0.01),
        ("0.01 kg m²", "moment of inertia", 0.01),
        ("100 cSt", "kinematic viscosity", 1e-4),
        ("100 mm^2/s", "kinematic viscosity", 1e-4),
        ("0.9 g/cm^3", "density", 900.0),
        ("206 GPa", "pressure", 206e9),
        ("46 W/(m K)", "thermal conductivity", 46.0),
        ("470 J/(kg K)", "specific heat", 470.0),
        ("11.5e-6 1/K", "thermal expansion", 11.5e-6),
        ("11.5e-6 1/degC", "thermal expansion", 11.5e-6),
        ("11.5 um/(m K)", "thermal expansion", 11.5e-6),
        # as gear catalogues, drawings and data sheets write them
        ("0.4 μm", "length", 0.4e-6),
        ("20 degrees", "angle", math.pi / 9.0),
        ("20º", "angle", math.pi / 9.0),
        ("20 gon", "angle", math.pi / 10.0),
        ("100 ℃", "temperature", 373.15),
        ("100 deg C", "temperature", 373.15),
        ("100 degrees Celsius", "temperature", 373.15),
        ("1000 1/min", "rotational speed", 1000.0 * math.pi / 30.0),
        ("1000/min", "rotational speed", 1000.0 * math.pi / 30.0),
        ("1000 min^-1", "rotational speed", 1000.0 * math.pi / 30.0),
        ("1000 min-1", "rotational speed", 1000.0 * math.pi / 30.0),
        ("1000 min⁻¹", "rotational speed", 1000.0 * math.pi / 30.0),
        ("1000 U/min", "rotational speed", 1000.0 * math.pi / 30.0),
        ("1000 rev/min", "rotational speed", 1000.0 * math.pi / 30.0),
        ("1000 r/min", "rotational speed", 1000.0 * math.pi / 30.0),
        ("1000 RPM", "rotational speed", 1000.0 * math.pi / 30.0),
        ("10 rev/s", "rotational speed", 20.0 * math.pi),
        ("100 Nmm", "torque", 0.1),
        ("100 N*mm", "torque", 0.1),
        ("100 Ncm", "torque", 1.0),
        ("100 N⋅m", "torque", 100.0),
        ("100 N-m", "torque", 100.0),
        ("100 kNm", "torque", 1e5),
        ("100 mNm", "torque", 0.1),
        ("100 lbf-ft", "torque", 100.0 * 0.45359237 * 9.80665 * 0.3048),
        ("0.01 kgm²", "moment of inertia", 0.01),
        ("0.01 kg m2", "moment of inertia", 0.01),
        ("100 mm²/s", "kinematic viscosity", 1e-4),
        ("100 mm2/s", "kinematic viscosity", 1e-4),
        ("885 kg/m3", "density", 885.0),
        ("206000 N/mm2", "pressure", 206e9),
        ("46 W/mK", "thermal conductivity", 46.0),
        ("470 J/kgK", "specific heat", 470.0),
        ("15 W/m²K", "heat transfer coefficient", 15.0),
        ("6 l/min", "volume flow", 1e-4),
        ("6 L/min", "volume flow", 1e-4),
        ("0.36 m³/h", "volume flow", 1e-4),
    ],
)
def test_texts_become_si_numbers(text: str, kind: str, value: float) -> None:
    assert read_quantity(text, kind) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "kind", "why"),
    [
        (5, "length", "a bare number has no unit"),
        ("5", "length", "the unit is missing"),
        ("five mm", "length", "no number at its start"),
        ("", "length", "no number at its start"),
        ("5,0 mm", "length", "decimals follow a point, not a comma"),
        ("nan mm", "length", "not finite"),
        ("-inf mm", "length", "not finite"),
        ("5 kg", "length", "'kg' is no unit of length"),
        ("5 furlog", "length", "unit 'furlog' is not known"),
        ("5 9**9**9**9", "length", "what follows the number is no unit of length"),
        ("5 mm; import os", "length", "what follows the number is no unit of length"),
        ("5 " + "m" * 60, "length", "what follows the number is no unit of length"),
        ("50 Hz", "rotational speed", "'Hz' is no unit of rotational speed"),
        ("50 1/s", "rotational speed", "'1/s' is no unit of rotational speed"),
        ("20 grad", "angle", "'grad' may be a degree or a gon"),
        ("20 Grad", "angle", "'Grad' may be a degree or a gon"),
        ("1.500,5 mm", "length", "what follows the number is no unit of length"),
        ("100 J", "torque", "'J' is no unit of torque"),
        ("100 C", "temperature", "'C' is no unit of temperature"),
        ("20 delta_degC", "temperature", "'delta_degC' is no unit of temperature"),
        ("20 degC", "temperature difference", "'degC' has its zero elsewhere"),
        (True, "length", "not a text with number and unit of length"),
        (["5 mm"], "length", "not a text with number and unit of length"),
    ],
)
def test_what_is_no_quantity_says_why(text: object, kind: str, why: str) -> None:
    with pytest.raises(InputError) as caught:
        read_quantity(text, kind)
    assert (caught.value.why or "").startswith(why)
    assert caught.value.got == short(text)


@pytest.mark.parametrize(
    ("text", "kind", "fix"),
    [
        ("1,5 mm", "length", 'did you mean "1.5 mm"?'),
        ("-0,08mm", "length", 'did you mean "-0.08 mm"?'),
        ("1,5", "length", 'did you mean "1.5 mm"?'),
        ("1,500 rpm", "rotational speed", 'write "1.500 rpm" or "1500 rpm"'),
        ("1,2,3 mm", "length", 'write for instance "5 mm"'),
        ("50 Hz", "rotational speed", 'did you mean "50 rps" or "50 rad/s"?'),
        ("50 s^-1", "rotational speed", 'did you mean "50 rps" or "50 rad/s"?'),
        ("20 Grad", "angle", 'did you mean "20 deg"?'),
        ("100 nm", "torque", 'did you mean "100 N m"?'),
    ],
)
def test_what_may_have_been_meant(text: str, kind: str, fix: str) -> None:
    with pytest.raises(InputError) as caught:
        read_quantity(text, kind)
    assert caught.value.fix == fix


@pytest.mark.parametrize("kind", KINDS.values(), ids=lambda k: k.name)
def test_every_example_can_be_copied(kind: Kind) -> None:
    value = read_quantity(kind.example, kind.name)
    assert value > 0.0
    assert read_quantity(shown(value, kind.name, 12), kind.name) == pytest.approx(value, rel=1e-9)


@given(st.text(max_size=30), st.sampled_from(sorted(KINDS)))
def test_any_text_is_read_or_refused(text: str, kind: str) -> None:
    with contextlib.suppress(InputError):
        assert math.isfinite(convert(1.0, text, KINDS[kind]))


def test_every_unit_that_pint_knows_is_converted_or_refused() -> None:
    read = 0
    for unit in pint.UnitRegistry():
        for kind in KINDS.values():
            with contextlib.suppress(InputError):
                assert math.isfinite(convert(1.0, unit, kind))
                read += 1
    assert read > 100


def test_long_values_are_shortened() -> None:
    assert short("x" * 500).endswith("...")
    assert len(short("x" * 500)) == 60
    assert numbers(short(10**4000)) == [4001.0]


def test_usual_units_are_what_pint_makes_of_them_bit_for_bit() -> None:
    registry = pint.UnitRegistry()
    rng = random.Random(20261123)
    names = {"degC": "degC", "N m": "newton*meter"}
    for kind in KINDS.values():
        for unit in [*_USUAL[kind.name], *(["degC"] if kind.name == "temperature" else [])]:
            si = registry.parse_units(names.get(kind.si, kind.si))
            for _ in range(200):
                number = rng.uniform(0.1, 1.0) * 10.0 ** rng.randint(-3, 3)
                theirs = registry.Quantity(number, names.get(unit, unit)).to(si).magnitude
                assert convert(number, unit, kind) == theirs, (kind.name, unit, number)


def test_a_file_of_usual_units_loads_no_pint() -> None:
    code = (
        "import sys; from thermogear.case.case import load_example; load_example('fzg-c'); "
        "assert 'pint' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
