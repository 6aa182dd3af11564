"""What the page may say: honest messages are read, every other is one line."""

from __future__ import annotations

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as some

pytest.importorskip("uvicorn")

from thermogear.base.errors import InputError
from thermogear.front.app import wire

ANY_JSON = some.recursive(
    some.none() | some.booleans() | some.integers() | some.floats() | some.text(max_size=20),
    lambda one: some.lists(one, max_size=4)
    | some.dictionaries(
        some.sampled_from(("kind", "number", "state", "changes", "dials", "heat", "parts", "x\n")),
        one, max_size=5,
    ),
    max_leaves=12,
)  # fmt: skip


def test_a_whole_message_is_read_as_it_was_said() -> None:
    said = {
        "kind": "show", "number": 7,
        "state": {"changes": [["oil.name", "M220"], ["title", ""]], "dials": {"speed": 4500.5},
                  "heat": True},
        "speeds": {"low": 1000.0, "high": 5000.0, "count": 90}, "parts": ["run-up", "mesh"],
    }  # fmt: skip
    assert wire.read(json.dumps(said)).model_dump(mode="json") == said
    export = wire.read('{"kind":"export","number":2,"what":"case"}')
    assert isinstance(export, wire.Export)
    assert export.state == wire.State()
    assert isinstance(wire.read('{"kind":"stop","number":0}'), wire.Stop)


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("[]", "message"),
        ('{"kind":"show"}', "show.number"),
        ('{"kind":"show","number":1,"speeds":{"low":500,"high":500}}', "show.speeds"),
        ('{"kind":"show","number":1,"speeds":{"low":0}}', "show.speeds.low"),
        ('{"kind":"show","number":1,"state":{"dials":{"speed":1e999}}}', "show.state.dials.speed"),
        ('{"kind":"show","number":1,"parts":["all"]}', "show.parts.0"),
        ('{"kind":"export","number":1,"what":"../case"}', "export.what"),
        ('{"kind":"stop","number":1.5}', "stop.number"),
        ('{"kind":"stop","number":1,"also":2}', "stop.also"),
    ],
)
def test_a_refusal_names_the_place(text: str, place: str) -> None:
    with pytest.raises(InputError) as caught:
        wire.read(text)
    assert caught.value.field == place


def one_line(error: InputError) -> bool:
    words = str(error)
    return words.isprintable() and 0 < len(words) < 400


@settings(max_examples=300, deadline=None, derandomize=True)
@given(ANY_JSON)
def test_whatever_comes_is_a_message_or_one_line(value: object) -> None:
    kinds = [value]
    if isinstance(value, dict):
        kinds += [{"number": 1} | value | {"kind": kind} for kind in ("show", "export", "stop")]
    for one in kinds:
        try:
            found: object = wire.read(json.dumps(one))
        except InputError as error:
            found = error
        said = isinstance(found, wire.Show | wire.Export | wire.Stop)
        assert said or (isinstance(found, InputError) and one_line(found))


@settings(max_examples=200, deadline=None, derandomize=True)
@given(some.text(max_size=200))
def test_any_text_is_a_message_or_one_line(text: str) -> None:
    with pytest.raises(InputError) as caught:
        wire.read(text)
    assert one_line(caught.value)
