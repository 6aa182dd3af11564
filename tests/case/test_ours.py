"""A reason holds for the value it was written for: edited, overridden or left out, it is gone."""

from __future__ import annotations

import re

import pytest

from thermogear.base.errors import InputError, ValidityWarning
from thermogear.case.case import GearCase, load_case, load_example
from thermogear.case.examples import EXAMPLES, example_text

OF_THE_THESIS = ("rig", "table-4.2", "section-4.1")


def ours(text: str, *overrides: str) -> dict[str, tuple[str, str]]:
    """Field -> (value, reason) of what is ours in a case."""
    return {a.field: (a.value, a.reason) for a in load_case(text, overrides).assumptions}


def edited(old: str, new: str, text: str = "") -> str:
    """The rig's file with one line changed, as a user changes it."""
    text = text or example_text("rig")
    changed = re.sub(rf"^{old}.*$", new, text, count=1, flags=re.MULTILINE)
    assert changed != text
    return changed


@pytest.mark.parametrize("name", EXAMPLES)
def test_every_reason_of_a_ready_made_case_holds_there(name: str) -> None:
    text = example_text(name)
    declared = re.findall(r'^"(.+?)" = \{ value = ', text.partition("[ours]")[2], re.MULTILINE)
    found = ours(text)
    assert set(declared) <= set(found)
    assert all("default" not in found[field][1] for field in declared)
    if name in OF_THE_THESIS:  # where nothing is left to a default
        assert set(declared) == set(found)


@pytest.mark.parametrize("name", EXAMPLES)
def test_no_reason_speaks_of_the_rig(name: str) -> None:
    spoken = " ".join(reason for _, reason in ours(example_text(name)).values()).lower()
    if name == "rig":  # whoever copies the file has other gears
        assert "thesis" not in spoken
        assert "rig" not in spoken.replace("rig" + "id", "").split()


@pytest.mark.parametrize(
    ("old", "new", "field"),
    [
        ('face_width = "25 mm"', 'face_width = "40 mm"', "gears.pinion.face_width"),
        ('bore_radius = "25 mm"', 'bore_radius = "30 mm"', "gears.pinion.bore_radius"),
        ('torque = "100 N m"', 'torque = ["100 N m", "150 N m"]', "operating.torque"),
        ("dedendum = 1.25", "dedendum = 1.2", "gears.rack.dedendum"),
        ("bored = false", "bored = true", "inertia.bored"),
        ("harmonics = \\[", "harmonics = []", "transmission_error.harmonics"),
        ("initial_state", "initial_state = [0.0, 0.1]", "simulation.initial_state"),
        ('name = "M100"', 'name = "M220"', "oil.name"),
    ],
)
def test_an_edited_value_is_the_users_own_and_the_others_stay(
    old: str, new: str, field: str
) -> None:
    before = ours(example_text("rig"))
    after = ours(edited(old, new))
    assert set(before) - set(after) == {field}
    # a reason says nothing of other fields: none of them changes with this one
    assert after == {name: said for name, said in before.items() if name != field}


def test_no_figure_of_the_rig_is_told_of_another_pair() -> None:
    mine = edited('face_width = "25 mm"', 'face_width = "40 mm"')
    mine = mine.replace('bore_radius = "80 mm"', 'bore_radius = "60 mm"')
    said = " ".join(reason for _, reason in ours(mine).values())
    for figure in ("1.227", "1.633", "1.195", "printed stiffness", "0.223", "0.1 mm"):
        assert figure not in said


def test_values_are_compared_by_value() -> None:
    before = ours(example_text("rig"))
    for old, new in (
        ('face_width = "25 mm"', 'face_width = "0.025 m"'),
        ('torque = "100 N m"', 'torque = ["100000 N mm"]'),
        ('reference = "20 degC"', 'reference = "293.15 K"'),
        ("dedendum = 1.25", "dedendum = 1.250"),
        ("harmonics = \\[", 'harmonics = [{ amplitude = "0.005 mm", order = 1 }]'),
    ):
        assert set(ours(edited(old, new))) == set(before), new
    assert set(ours(example_text("rig"), "gears.wheel.face_width=2.5 cm")) == set(before)


def test_an_override_is_the_users_own() -> None:
    after = ours(example_text("rig"), "operating.torque=150 N m", "gears.rack.dedendum=1.2")
    gone = {"operating.torque", "gears.rack.dedendum"}
    assert set(ours(example_text("rig"))) - set(after) == gone


def test_where_a_line_is_deleted_the_default_acts_and_says_so() -> None:
    text = re.sub(r"^periods = 256.*\n", "", example_text("rig"), flags=re.MULTILINE)
    text = text.replace(
        '"simulation.periods" = { value = 256', '"simulation.periods" = { value = 64'
    )
    value, reason = ours(text)["simulation.periods"]
    assert value == "256"
    assert "default" in reason
    bare = re.sub(r"\[gears.rack\].*\n(.+\n)+", "", example_text("rig"))
    assert ours(bare)["gears.rack"][0] == "left out"
    assert "gears.rack.dedendum" not in ours(bare)


def test_a_reason_stands_beside_the_value_it_speaks_of() -> None:
    text = example_text("rig").partition("[ours]")[0]
    said = 'needs a value and a reason; write "oil.name" = { value = ..., reason = "..." }'
    for entry in ('""', "3", "{ value = 'M100' }", "{ reason = 'r' }",
                  "{ value = 'M100', reason = '' }"):  # fmt: skip
        with pytest.raises(InputError, match=r"ours\.oil\.name: ") as caught:
            load_case(f'{text}\n[ours]\n"oil.name" = {entry}\n')
        assert said in str(caught.value)


def test_reasons_of_older_files_are_left_out_and_said_so() -> None:
    text = example_text("rig").partition("[ours]")[0]
    older = f'{text}\n[ours]\n"oil.name" = "a guess"\n"oil.scuffing_load_stage" = "usual"\n'
    with pytest.warns(ValidityWarning) as caught:
        case = load_case(older)
    assert [str(one.message) for one in caught] == [
        "ours: 2 reasons without the value they speak of are left out; "
        'write "oil.name" = { value = ..., reason = "..." }'
    ]
    assert not {"oil.name", "oil.scuffing_load_stage"} & {a.field for a in case.assumptions}


def test_an_example_has_as_many_values_of_ours_as_its_table_says() -> None:
    case = load_example("rig")
    assert isinstance(case, GearCase)
    assert len(case.assumptions) == 63
