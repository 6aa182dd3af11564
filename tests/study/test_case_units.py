"""Units as text: published conversions, and what is no unit of the kind asked for."""

from __future__ import annotations

import contextlib
import math

import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

from thermogear.base.errors import InputError
from thermogear.study.units import KINDS, Kind, convert, read_quantity, short, shown


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
    assert short(10**4000) == "a whole number of about 4001 digits"
