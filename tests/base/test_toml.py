"""Dotted overrides put into tables and taken out of them; whole tables written as TOML."""

from __future__ import annotations

import copy
import datetime
import tomllib
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from thermogear import InputError
from thermogear.base import toml
from thermogear.base.toml import overridden, settable, tables, written
from thermogear.case.examples import EXAMPLES, example_text

_PLAIN = st.one_of(
    st.text(max_size=8),
    st.integers(-(2**62), 2**62),
    st.floats(allow_nan=False),
    st.booleans(),
    st.dates(),
    st.times(),
    st.datetimes(timezones=st.just(datetime.UTC)),
)
_KEYS = st.text(max_size=5)
_TABLES = st.recursive(
    st.dictionaries(_KEYS, _PLAIN, max_size=3),
    lambda one: st.dictionaries(
        _KEYS, st.one_of(_PLAIN, one, st.lists(st.one_of(_PLAIN, one), max_size=3)), max_size=3
    ),
    max_leaves=12,
)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(_TABLES)
def test_what_is_written_reads_back_the_same(data: dict[str, Any]) -> None:
    assert tomllib.loads(written(data)) == data


@settings(max_examples=60, deadline=None, derandomize=True)
@given(_PLAIN)
def test_a_value_behind_set_reads_back_the_same(value: object) -> None:
    assert overridden({}, (("a.b", toml.given(value)),)) == {"a": {"b": value}}


@pytest.mark.parametrize("name", EXAMPLES)
def test_every_example_reads_back_the_same(name: str) -> None:
    data = tomllib.loads(example_text(name))
    assert tomllib.loads(written(data)) == data


def test_lists_of_tables_stand_under_double_headings() -> None:
    text = written({"a": [{"b": 0.1, "c": [{"d": "x"}]}, {}], "empty": {}, "none": None, "l": []})
    assert text == 'l = []\n\n[[a]]\nb = 0.1\n\n[[a.c]]\nd = "x"\n\n[[a]]\n\n[empty]\n'


def test_nothing_behind_the_sign_leaves_a_field_out() -> None:
    data = {"a": {"b": 1, "c": {"d": 2}}, "e": 3}
    assert overridden(data, (("a.b", ""), ("e", " "))) == {"a": {"c": {"d": 2}}}
    assert overridden(data, (("a.c", ""),)) == {"a": {"b": 1}, "e": 3}
    assert overridden(data, (("a", ""), ("a.c.d", ""))) == {"e": 3}
    assert overridden(data, (("a", ""), ("a.c.d", "5"))) == {"a": {"c": {"d": 5}}, "e": 3}
    assert overridden(data, (("a.b", "7"), ("a.b", ""))) == {"a": {"c": {"d": 2}}, "e": 3}
    assert data == {"a": {"b": 1, "c": {"d": 2}}, "e": 3}


def test_an_earlier_change_left_out_more() -> None:
    """The rest of the path is looked for in its own table, never in one above."""
    data = {"title": "x", "a": {"title": "y"}}
    assert overridden(data, (("a", ""), ("a.title", ""))) == {"title": "x"}


def test_a_name_in_place_of_a_table_is_its_field() -> None:
    assert overridden({"model": {"friction": "xu"}}, (("model.friction.law", ""),)) == {
        "model": {"friction": {}}
    }


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("a.bc", "a.bc: got nothing to leave out; [a] of the file does not hold bc; did you mean"),
        ("x", "x: got nothing to leave out; the file does not hold x; known: a, e"),
        ("a.b.c", "a.b.c: got nothing to leave out; [a.b] of the file does not hold c; write"),
    ],
)
def test_what_the_file_does_not_hold_is_refused(path: str, words: str) -> None:
    data = {"a": {"bcd": 1, "b": 2}, "e": 3}
    with pytest.raises(InputError) as error:
        overridden(data, ((path, ""),))
    assert str(error.value).startswith(words)
    assert "\n" not in str(error.value)
    assert data == {"a": {"bcd": 1, "b": 2}, "e": 3}


def test_an_entry_is_named_by_its_number_or_its_name() -> None:
    data = {"bearings": [{"name": "pinion left"}, {"name": "wheel left", "play": "9 um"}]}
    named = overridden(data, (("bearings.wheel left.play", "12 um"),))
    assert named == overridden(data, (("bearings.1.play", "12 um"),)) != data
    for path, words in (
        ("bearings.rear.play", "0..1, or all, or a name: pinion left, wheel left"),
        ("sensors.all.play", "got no list; the file holds no sensors"),
        ("sensors.0.play", "got no list; the file holds no sensors"),
        ("a.b!", "got no path; allowed dotted names: gears.pinion.teeth"),
    ):
        with pytest.raises(InputError) as error:
            overridden(data, ((path, "3"),))
        assert error.value.field.strip("'") == path
        assert str(error.value).endswith(words)


def test_what_only_an_override_put_in_is_not_in_the_file() -> None:
    with pytest.raises(InputError, match="nothing to leave out"):
        overridden({"a": {}}, (("a.b", "1"), ("a.b", "")))


@pytest.mark.parametrize("names", ["a" + ".a" * 50_000, '"a"' + " . 'b'" * 50_000])
@pytest.mark.parametrize("form", ["{} = 1", "[{}]", "x = {{ {} = 1 }}"])
def test_a_key_of_thousands_of_names_is_refused_before_it_is_parsed(names: str, form: str) -> None:
    with pytest.raises(InputError) as error:
        tables("case", "b = 1\n" + form.format(names))
    assert str(error.value) == (
        "case: got a key of more than 16 names in line 2; allowed TOML of a case"
    )
    assert not settable("a" + ".a" * 16)
    assert settable("a" + ".a" * 15)
    assert tables("case", form.format("a" + ".a" * 15))


def test_text_is_no_key() -> None:
    text = "a.b. " * 15 + "x" * 100_000
    assert tables("case", f'note = "{text}"')["note"] == text


LISTS = {"bearings": [{"play": "9 um"}, {}], "speed": ["1 rpm", "2 rpm"], "a": [{"b": [{"c": 1}]}]}


@pytest.mark.parametrize(
    ("path", "text", "made"),
    [
        ("bearings.1.play", "12 um", {"bearings": [{"play": "9 um"}, {"play": "12 um"}]}),
        ("bearings[0].play", "12 um", {"bearings": [{"play": "12 um"}, {}]}),
        ("bearings.all.play", "12 um", {"bearings": [{"play": "12 um"}] * 2}),
        ("bearings.all.play", "", {"bearings": [{}, {}]}),
        ("bearings.0", "", {"bearings": [{}]}),
        ("speed.1", "3 rpm", {"speed": ["1 rpm", "3 rpm"]}),
        ("a.0.b.all.c", "5", {"a": [{"b": [{"c": 5}]}]}),
    ],
)
def test_a_key_of_a_list_is_the_number_of_an_entry(
    path: str, text: str, made: dict[str, Any]
) -> None:
    given = copy.deepcopy(LISTS)
    assert overridden(given, toml.pairs({path: text})) == LISTS | made
    assert given == LISTS


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("bearings.2.play", "bearings.2.play: got entry 2 of bearings; allowed 0..1, or all"),
        ("bearings.x.play", "bearings.x.play: got entry x of bearings; allowed 0..1, or all"),
        ("speed.1.x", "speed.1.x: got an unknown path; speed.1 is a value, not a table"),
    ],
)
def test_an_entry_that_is_none_is_one_line(path: str, said: str) -> None:
    with pytest.raises(InputError) as error:
        overridden(LISTS, ((path, "12 um"),))
    assert str(error.value) == said


def test_a_bearing_that_its_shaft_names_has_a_number_too() -> None:
    """In the order of the shafts, the left end first; the shaft then names it no longer."""
    shafts = [{"gear": "pinion", "bearings": "6205"}, {"gear": "wheel", "bearings": ["1", "2"]}]
    found = overridden({"shafts": shafts}, (("bearings.3.play", "12 um"),))
    ends = [
        {"shaft": shaft, "end": end, "type": name}
        for shaft, end, name in (
            ("pinion", "left", "6205"), ("pinion", "right", "6205"),
            ("wheel", "left", "1"), ("wheel", "right", "2"),
        )
    ]  # fmt: skip
    assert found["shafts"] == [{"gear": "pinion"}, {"gear": "wheel"}]
    assert found["bearings"] == [*ends[:3], ends[3] | {"play": "12 um"}]
