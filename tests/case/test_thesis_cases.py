"""One rule says which cases are the thesis's: the values of the ready-made ones, not the title."""

from __future__ import annotations

import re

import pytest

from own_pair import OWN_PAIR
from thermogear.case.case import load_case, load_example
from thermogear.case.examples import EXAMPLES, example_text
from thermogear.case.thesis_cases import of_the_thesis

OF_THE_THESIS = ("rig", "table-4.2", "section-4.1")


@pytest.mark.parametrize("name", sorted(set(EXAMPLES) - set(OF_THE_THESIS)))
def test_the_other_ready_made_cases_are_not(name: str) -> None:
    assert not of_the_thesis(load_example(name))


@pytest.mark.parametrize("name", OF_THE_THESIS)
def test_the_ready_made_cases_are_the_thesis_s(name: str) -> None:
    assert of_the_thesis(load_example(name))
    assert of_the_thesis(load_example(name, ['title="Something else"', "simulation.periods=16"]))


@pytest.mark.parametrize(
    "free",
    [
        "operating.speed=2000 rpm",
        "operating.torque=0.1 kN m",
        "temperatures.row=[]",
        'temperatures.row=["433.15 K"]',
        "model.bundle=thesis",
        "model.friction=dry",
        "gears.wheel.face_width=2.5 cm",
        "grid.path_positions=41",
        "draw.base_sets=[]",
    ],
)
def test_values_of_the_rig_written_otherwise_and_parts_of_it_are_the_rig(free: str) -> None:
    assert of_the_thesis(load_example("rig", [free]))


def test_a_default_that_says_the_same_is_the_rig() -> None:
    text = re.sub(r"^(tip_diameter|profile_shift|radius|bored).*\n", "", example_text("rig"),
                  flags=re.MULTILINE)  # fmt: skip
    assert of_the_thesis(load_case(text))


@pytest.mark.parametrize(
    "changed",
    [
        "operating.speed=1500 rpm",
        "operating.torque=150 N m",
        'temperatures.row=["130 degC"]',
        "gears.module=4.999 mm",
        "gears.pinion.face_width=26 mm",
        "gears.wheel.bore_radius=60 mm",
        "oil.name=M220",
        "housing.material=aluminium",
        "temperatures.housing_below_addendum=0 K",
        "gearbox.immersion=0.2",
        "gearbox.measured.oil=80 degC",
        "inertia.radius=tip",
        "backlash.value=0.3 mm",
        "dynamics.damping_ratio=0.05",
        "transmission_error.harmonics=[]",
        'gears.pinion.tip_relief={amount="9 um", length="3 mm"}',
    ],
)
def test_other_values_make_another_case(changed: str) -> None:
    own = (
        '[materials.aluminium]\nyoungs_modulus = "70 GPa"\npoisson_ratio = 0.33\n'
        'density = "2.7 g/cm^3"\nthermal_conductivity = "160 W/(m K)"\n'
        'specific_heat = "900 J/(kg K)"\nthermal_expansion = "23e-6 1/K"\n\n[oil]'
    )
    text = example_text("rig").replace("[oil]", own, 1)
    assert of_the_thesis(load_case(text))
    text = text.replace('tip_diameter = "135 mm"', "").replace('tip_diameter = "385 mm"', "")
    assert not of_the_thesis(load_case(text, [changed]))


def test_somebody_elses_gears_are_not_the_thesis_s() -> None:
    assert not of_the_thesis(load_case(OWN_PAIR))
    assert not of_the_thesis(load_example("table-4.2", ["base.frequency=1.25"]))
