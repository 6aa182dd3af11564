"""The variance-based study: grouping changes nothing, one input alone is everything."""

from __future__ import annotations

import re
import sys
from dataclasses import replace

import numpy as np
import pytest

from thermogear.base.errors import InputError, ThermogearError
from thermogear.case.case import GearCase, gear_case, load_case, load_example
from thermogear.heat.lubrication import grade, kinematic_viscosity
from thermogear.mesh.cycle import mesh_cycle
from thermogear.mesh.model import MeshModel
from thermogear.study import sensitivity as study
from thermogear.study.sensitivity import Plan, evaluate, plain_words
from thermogear.study.watched import INPUTS, OUTPUTS, PART, inputs_of, outputs_of

BY_NAME = {one.name: one for one in INPUTS}


@pytest.fixture(scope="module")
def case() -> GearCase:
    found = load_example("rig")
    assert isinstance(found, GearCase)
    return found


def places(rows: int, seed: int = 3) -> np.ndarray:
    return np.random.default_rng(seed).random((rows, len(INPUTS)))


def test_a_sample_is_the_chain_of_the_case_it_describes(case: GearCase) -> None:
    at = places(1)
    found, jammed = evaluate(case, Plan(), at)
    value = {one.name: float(one.values(at[0, k])) for k, one in enumerate(INPUTS)}
    gear = value["gear"]
    overrides = {
        "gears.pinion.face_width": f"{value['face_width']} m",
        "gears.wheel.face_width": f"{value['face_width']} m",
        "gears.pinion.roughness": f"{value['roughness']} m",
        "gears.wheel.roughness": f"{value['roughness']} m",
        "operating.torque": f"{value['torque']} N m",
        "operating.speed": "2000 rpm",
        "backlash.value": f"{value['backlash']} m",
        "temperatures.pinion_addendum": f"{gear} K",
        "temperatures.wheel_addendum": f"{gear} K",
        "temperatures.pinion_bore_below_addendum": f"{value['shaft']} K",
        "temperatures.wheel_bore_below_addendum": f"{value['shaft']} K",
        "temperatures.housing_below_addendum": f"{value['housing']} K",
        "oil.temperature_below_addendum": f"{value['oil']} K",
    }
    same = load_example("rig", overrides)
    assert isinstance(same, GearCase)
    operating = replace(same.operating, housing=same.housing, lubricant=grade(value["viscosity"]))
    cycle = mesh_cycle(
        same.pair,
        operating,
        MeshModel.consistent(),
        path_positions=study.PATH,
        mesh_positions=study.PHASES,
    )
    assert jammed == 0
    assert found["flash"][0] == pytest.approx(
        float(cycle["flash_temperature_mixed"].max()), rel=1e-9
    )
    assert found["growth"][0] == pytest.approx(float(cycle["deformation_sum"].mean()), rel=1e-9)
    left = float(cycle["half_backlash"][0] / cycle["cold_half_backlash"][0])
    assert found["backlash_left"][0] == pytest.approx(left, rel=1e-9)


def test_samples_computed_together_are_those_computed_alone(case: GearCase) -> None:
    at = places(4)
    together, _ = evaluate(case, Plan(), at)
    for row in range(4):
        alone, _ = evaluate(case, Plan(), at[row : row + 1])
        for name in together:
            assert alone[name][0] == pytest.approx(together[name][row], rel=1e-9, abs=1e-12)


def test_one_input_alone_brings_all_the_variance(case: GearCase) -> None:
    plan = Plan(samples=64, inputs=(BY_NAME["gear"],))
    data = study.sensitivity(case, plan).data
    assert data.attrs["evaluations"] == 192
    growth = data.sel(output="growth")
    # as far from 1 as the estimate itself says it may be, at 95 %
    assert abs(float(growth["total"][0]) - 1.0) < float(growth["total_conf"][0]) < 0.3
    # what it cannot move has no index at all
    assert float(data["total"].sel(output="out_of_contact")[0]) == 0.0


@pytest.fixture(scope="module")
def small(case: GearCase):  # type: ignore[no-untyped-def]
    names = ("gear", "damping", "housing")
    return study.sensitivity(case, Plan(samples=16, inputs=tuple(BY_NAME[n] for n in names))).data


def test_damping_and_housing_touch_what_they_can(small) -> None:  # type: ignore[no-untyped-def]
    total = small["total"]
    for output in ("growth", "stiffness_change", "friction", "backlash_left"):
        assert float(total.sel(output=output, input="damping")) == pytest.approx(0.0, abs=1e-12)
    assert float(total.sel(output="growth", input="housing")) == pytest.approx(0.0, abs=1e-12)
    left = total.sel(output="backlash_left")
    assert float(left.sel(input="housing")) > 5.0 * float(left.sel(input="gear"))


def test_signs_of_the_stiffness_changes_do_not_depend_on_the_inputs(small) -> None:  # type: ignore[no-untyped-def]
    assert float(small["holds"].sel(output="stiffness_change")) == 0.0
    assert float(small["holds"].sel(output="stiffness_change_thesis")) == 1.0


def test_words_name_every_output(small) -> None:  # type: ignore[no-untyped-def]
    texts = plain_words(small)
    assert len(texts) == len(OUTPUTS)
    assert all(re.search(r"\d %", text) for text in texts)
    assert "temperature" in texts[[o.name for o in OUTPUTS].index("growth")]


def test_grades_lie_between_the_oils_they_are_fitted_to() -> None:
    oil = grade(100e-6)
    assert float(kinematic_viscosity(oil, 313.15)) == pytest.approx(100e-6, rel=1e-9)
    assert 10.5e-6 < float(kinematic_viscosity(oil, 373.15)) < 11.5e-6


def test_plans_that_make_no_sense_are_refused() -> None:
    with pytest.raises(InputError, match="samples: got 100; allowed a power of two, 8 or more"):
        Plan(samples=100)
    with pytest.raises(InputError, match="inputs: got 'widht'"):
        Plan(inputs=(replace(INPUTS[0], name="widht"),))
    with pytest.raises(InputError, match=r"confidence: got 1\.5"):
        Plan(confidence=1.5)


def test_a_missing_library_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "SALib.sample.sobol", None)
    with pytest.raises(ThermogearError, match=r"it needs SALib; in the checkout of thermogear: "):
        study.require_salib()


OWN = """
[gears]
module = "2.5 mm"
face_width = "28 mm"
[gears.pinion]
teeth = 21
[gears.wheel]
teeth = 44
[operating]
speed = ["1500 rpm", "2500 rpm"]
torque = "60 N m"
"""


def test_any_gears_are_varied_around_their_own_values() -> None:
    own = gear_case(load_case(OWN))
    inputs = {one.name: one for one in inputs_of(own)}
    # flanks of a class, no cosine: there is no amplitude to vary
    assert set(inputs) == {one.name for one in INPUTS} - {"error"} | {PART.name}
    assert inputs["torque"].low == pytest.approx(30.0)
    assert inputs["torque"].high == pytest.approx(120.0)
    assert inputs["face_width"].low == pytest.approx(0.6 * 0.028)
    assert inputs_of(gear_case(load_example("rig"))) == INPUTS
    names = {one.name for one in outputs_of(own)}
    assert names == {one.name for one in OUTPUTS} - {"stiffness_change_thesis"}

    plan = Plan(samples=8, inputs=tuple(inputs[n] for n in ("backlash", "housing", "torque")))
    data = study.sensitivity(own, plan).data
    assert data.attrs["jammed"] == 0
    assert data.attrs["speed"] == pytest.approx(2500.0 * np.pi / 30.0)
    left = data.sel(output="backlash_left")
    assert float(left["total"].sel(input="torque")) == pytest.approx(0.0, abs=1e-12)
    assert np.isnan(data.sel(output="swing")["holds"])
    assert not any("thesis" in text for text in data["sentence"].values)


HELD = [
    *(f"temperatures.{gear}_{body}='90 degC'"
      for gear in ("pinion", "wheel") for body in ("addendum", "bore")),
    "temperatures.housing='60 degC'", "oil.temperature='80 degC'",
]  # fmt: skip


def test_a_sample_of_a_part_is_that_of_the_case_with_its_drawing() -> None:
    whole = gear_case(load_case(OWN, HELD))
    plan = Plan(inputs=(BY_NAME["backlash"], replace(PART, high=4.0)))
    at = np.array([[0.1, 0.3], [0.9, 0.8], [0.4, 0.3]])
    together, _ = evaluate(whole, plan, at)
    for part, rows in ((1, [0, 2]), (3, [1])):
        mean = ("flanks.parts=1", "flanks.teeth=drawn", "gears.period=mesh")
        alone = gear_case(load_case(OWN, [*HELD, *mean, f"flanks.drawing={part}"]))
        assert alone.series == 1
        known, _ = evaluate(alone, replace(plan, inputs=plan.inputs[:1]), at[rows, :1])
        for name, values in known.items():
            np.testing.assert_allclose(together[name][rows], values, rtol=1e-9, err_msg=name)
    # of one part the input says nothing
    same, _ = evaluate(alone, plan, at[1:2])
    np.testing.assert_allclose(same["swing"], together["swing"][1:2], rtol=1e-9)
