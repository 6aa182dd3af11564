"""A case gives the parameters of its friction law: what they do, how they are refused."""

from __future__ import annotations

import json
import re
from typing import Any

import numpy as np
import pytest
import xarray as xr

from thermogear.base.errors import InputError
from thermogear.case.case import GearCase, load_case, load_example
from thermogear.case.citations import citations
from thermogear.case.examples import example_text
from thermogear.case.schema import json_schema
from thermogear.gears.contact import path_of_contact
from thermogear.heat.friction import LAWS, LUBRICATED, LambdaBlend, Schlenk, friction_law
from thermogear.heat.law_parameters import parameters
from thermogear.heat.laws import FZG_LUBRICANT_FACTOR, doleschel_share
from thermogear.mesh.elastic import elastic_pair
from thermogear.mesh.friction_path import FrictionPath
from thermogear.mesh.model import MeshModel
from thermogear.mesh.thermal import HotPair
from thermogear.study.friction import friction_survey

ONE = ('model.bundle="consistent"', "grid.path_positions=21", "grid.mesh_positions=60")


def rig(*changes: str) -> GearCase:
    case = load_example("rig", [*ONE, *changes])
    assert isinstance(case, GearCase)
    return case


def path(*changes: str) -> FrictionPath:
    """The lubricated contact of the rig, its temperatures given."""
    case = rig(*changes)
    hot = HotPair(case.pair, case.stated, case.models[0])
    return FrictionPath(elastic_pair(hot), path_of_contact(case.pair, 21))


def cycle(*changes: str) -> xr.Dataset:
    case = rig(*changes)
    return case.cycle(case.stated, case.models[0])


def test_boundary_friction_acts_by_doleschels_share() -> None:
    usual, mine = path(), path("model.friction.boundary=0.09")
    share = doleschel_share(np.asarray(usual.state.central_film_parameter))
    assert np.any(share > 0.0)
    np.testing.assert_allclose(mine.friction - usual.friction, 0.02 * share, rtol=0, atol=1e-16)


def test_a_lubricant_factor_multiplies_and_a_ceiling_cuts() -> None:
    usual = path("model.friction=schlenk").friction
    mine = path("model.friction=schlenk", "model.friction.factor=0.8").friction
    oil = FZG_LUBRICANT_FACTOR[path().state.lubricant_kind]
    np.testing.assert_allclose(mine, usual * 0.8 / oil, rtol=1e-14)
    usual = path("model.friction=xu-kahraman").friction
    ceiling = 0.5 * float(usual.max())
    cut = path("model.friction=xu-kahraman", f"model.friction.ceiling={ceiling}").friction
    assert np.array_equal(cut, np.minimum(usual, ceiling))


def test_a_law_inside_a_law_takes_its_parameters() -> None:
    mine = path("model.friction=lambda-blend", "model.friction.film.ceiling=0.03")
    film = friction_law("xu-kahraman", smooth=True, ceiling=0.03)(mine.state)
    share = doleschel_share(np.asarray(mine.state.central_film_parameter))
    np.testing.assert_allclose(mine.friction, share * 0.07 + (1.0 - share) * film, rtol=1e-14)


def test_the_parameters_of_a_law_reach_the_mesh_cycle() -> None:
    mine = cycle("model.friction=boundary", "model.friction.coefficient=0.12")
    assert np.all(mine["friction_coefficient"].values == 0.12)
    assert json.loads(mine.attrs["choices"])["friction"] == "boundary(coefficient=0.12)"


@pytest.mark.parametrize("law", LUBRICATED, ids=lambda law: law.name)
def test_defaults_written_out_are_the_plain_name(law: Any) -> None:
    def written(values: dict[str, Any]) -> str:
        return ", ".join(
            f"{k} = {{ {written(parameters(v))} }}" if hasattr(v, "name")
            else f"{k} = {str(v).lower()}"
            for k, v in values.items() if v is not None
        )  # fmt: skip

    plain = f'friction = "{law.name}"'
    table = f'friction = {{ law = "{law.name}", {written(parameters(law))} }}'
    text = example_text("rig").replace("[model]", "[model]\nBESIDE")
    cases = [load_case(text.replace("BESIDE", each)) for each in (plain, table)]
    assert [one.models for one in cases if isinstance(one, GearCase)] == [
        tuple(m.override(friction=law.name) for m in (MeshModel.consistent(), MeshModel.thesis()))
    ] * 2


def test_defaults_written_out_give_the_same_bits() -> None:
    plain = cycle("model.friction=lambda-blend")
    xr.testing.assert_identical(plain, cycle())
    xr.testing.assert_identical(
        plain, cycle("model.friction.law=lambda-blend", "model.friction.boundary=0.07")
    )


def test_parameters_without_a_law_go_to_the_bundles_whose_law_has_them() -> None:
    both = rig("model.bundle=both", "model.friction.boundary=0.08").models
    assert [m.name for m in both] == [
        "consistent + friction=lambda-blend(boundary=0.08)", "thesis",
    ]  # fmt: skip
    assert both[0].law == LambdaBlend(boundary=0.08)
    assert both[1] == MeshModel.thesis()


REFUSED = [
    (
        ["model.friction.law=lambda-blend", "model.friction.boundry=0.08"],
        "model.friction.boundry: got an unknown parameter; the law lambda-blend does not have it; "
        "did you mean 'boundary'?",
    ),
    (
        ["model.friction=schlenk", "model.friction.boundary=0.08"],
        "model.friction.boundary: got an unknown parameter; the law schlenk does not have it; "
        "known: ceiling, factor",
    ),
    (
        ["model.friction.factor=0.8"],
        "model.friction.factor: got an unknown parameter; the law lambda-blend does not have it; "
        "known: boundary, film",
    ),
    (
        ["model.friction.boundary=2"],
        "model.friction.boundary: got 2; allowed 0.001..1; write for instance 0.07",
    ),
    (
        ["model.friction.boundary=much"],
        "model.friction.boundary: got 'much'; allowed 0.001..1; text where a pure number is "
        "needed; write for instance 0.07, without quotes and unit",
    ),
    (
        ["model.friction=xu-kahraman", "model.friction.pitch_floor=0"],
        "model.friction.pitch_floor: got 0; allowed 1e-06..1; write for instance 0.01",
    ),
    (
        ["model.friction.film.ceilin=0.3"],
        "model.friction.film.ceilin: got an unknown key; [model.friction.film] does not have it; "
        "did you mean 'ceiling'?",
    ),
    (
        ["model.friction=dry", "model.friction.coefficient=0.3"],
        "model.friction.coefficient: got 0.3; dry friction's coefficient is a choice of its own; "
        "write model.dry_coefficient = 0.3",
    ),
]


@pytest.mark.parametrize(("changes", "message"), REFUSED)
def test_refusals_name_field_value_and_way_out(changes: list[str], message: str) -> None:
    with pytest.raises(InputError) as found:
        rig(*changes)
    assert str(found.value) == message


def test_an_unknown_law_in_the_table_says_the_nearest() -> None:
    with pytest.raises(InputError, match=r"^model.friction.law: got 'schlenck'; .* 'schlenk'\?$"):
        rig("model.friction.law=schlenck")


def test_python_takes_a_name_or_a_law_and_refuses_both() -> None:
    model = MeshModel.consistent()
    assert model.override(friction=LambdaBlend()) is model
    mine = model.override(friction=Schlenk(factor=0.9))
    assert mine.choices()["friction"] == "schlenk(factor=0.9)"
    assert mine.law == friction_law("schlenk", factor=0.9)
    with pytest.raises(InputError, match=r"^coefficient: got 1.5; allowed 0.001..1$"):
        friction_law("boundary", coefficient=1.5)
    with pytest.raises(InputError, match=r"^exponent: got an unknown parameter; the law boundary"):
        friction_law("boundary", exponent=1.5)
    with pytest.raises(InputError, match=r"^model.friction: got 3; allowed benedict-kelley \|"):
        MeshModel(name="mine", friction=3)  # type: ignore[arg-type]


def test_survey_and_sources_tell_the_law_with_its_parameters() -> None:
    case = rig("model.friction.boundary=0.08")
    found = friction_survey(case)
    name = "lambda-blend(boundary=0.08)"
    data = found.groups["laws"]
    assert data.attrs["chosen"] == name
    assert [str(n) for n in data["law"].values] == [
        name if n == "lambda-blend" else n for n in LAWS
    ]
    np.testing.assert_allclose(
        data["friction_coefficient"].sel(law=name).values,
        case.cycle(case.stated, case.models[0])["friction_coefficient"].values,
        rtol=1e-12,
    )
    assert LAWS["lambda-blend"].source in [one["text"] for one in citations(case)]


def test_the_schema_takes_a_name_and_a_table() -> None:
    name, table = json_schema()["$defs"]["ModelTable"]["properties"]["friction"]["anyOf"]
    assert name["enum"] == list(LAWS)
    assert {"$ref": "#/$defs/FrictionTable"} in table["anyOf"]
    fields = json_schema()["$defs"]["FrictionTable"]["properties"]
    assert set(fields) == {"law", *(n for law in LUBRICATED for n in parameters(law))}
    assert fields["boundary"]["anyOf"][0] == {"type": "number", "minimum": 0.001, "maximum": 1.0}
    laws = re.findall(r"[a-z]+[-\d]*\d|schlenk|fernandes", fields["factor"]["x-left-out"])
    assert laws == ["schlenk", "iso-13989-1", "fernandes", "iso-13989-2"]


def test_a_reason_may_stand_for_a_parameter() -> None:
    case = load_case(
        example_text("rig").replace(
            "[model]", "[model.friction]\nlaw = 'lambda-blend'\nboundary = 0.08\n\n[model]"
        )
        + '\n[ours."model.friction.boundary"]\nvalue = 0.08\nreason = "measured"\n'
    )
    mine = [a for a in case.assumptions if a.field == "model.friction.boundary"]
    assert [(a.value, a.reason) for a in mine] == [("0.08", "measured")]
