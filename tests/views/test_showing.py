"""A page that shows fewer pictures: those that carry the answer, or none."""

from __future__ import annotations

import dataclasses

import pytest

from thermogear import run
from thermogear.case.case import load_example
from thermogear.results.result import Result
from thermogear.views.page import Gallery, Page, Table, render
from thermogear.views.pages.run import FIRST
from thermogear.views.write import page_of, pictures

EVERY = "All of them: thermogear report mine"


@pytest.fixture(scope="module")
def result() -> Result:
    small = {"operating.speed": "3000 rpm", "model.bundle": "consistent"}
    return run(load_example("rig", {**small, "draw.pictures": '["path", "motion"]'}))


def tables(page: Page) -> list[Table]:
    return [one for part in page.sections for one in part.blocks if isinstance(one, Table)]


def test_the_first_pictures_are_one_of_each_kind_and_the_page_says_how_to_get_all(
    result: Result,
) -> None:
    whole = page_of(result)
    some = whole.showing("first", EVERY)
    shown = [one.name for one in some.pictures]
    assert 3 <= len(shown) <= 5
    assert all(sum(name in names for name in shown) <= 1 for names in FIRST)
    assert some.sections[1].name == "pictures"
    text = render(some)
    assert text.count("<figure") == text.count("<svg") == len(shown)
    assert f"{len(shown)} of {len(list(whole.pictures))} pictures. {EVERY}" in text


@pytest.mark.parametrize("which", ["first", "none", "all"])
def test_every_table_stays_whatever_is_drawn(result: Result, which: str) -> None:
    whole = page_of(result)
    assert tables(whole.showing(which, EVERY)) == tables(whole)


def test_none_draws_nothing_and_all_is_the_page_itself(result: Result) -> None:
    whole = page_of(result)
    assert not list(whole.showing("none", EVERY).pictures)
    assert whole.showing("all", EVERY) is whole
    assert list(pictures(result)) == [one.name for one in whole.pictures]


def test_no_picture_is_made_before_it_is_drawn(result: Result) -> None:
    def refuse() -> None:
        raise AssertionError("a picture nobody asked for")

    whole = page_of(result)
    kept = {one.name for one in whole.showing("first", EVERY).pictures}
    sections = [
        dataclasses.replace(
            part,
            blocks=[
                Gallery(
                    [
                        one if one.name in kept else dataclasses.replace(one, make=refuse)
                        for one in block.pictures
                    ]
                )
                if isinstance(block, Gallery)
                else block
                for block in part.blocks
            ],
        )
        for part in whole.sections
    ]
    assert "<svg" in render(dataclasses.replace(whole, sections=sections).showing("first", EVERY))


def test_rows_without_gears_show_their_first_pictures() -> None:
    page = page_of(run(load_example("section-4.1"))).showing("first", EVERY)
    assert 0 < len(list(page.pictures)) <= len(FIRST)
