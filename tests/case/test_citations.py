"""The sources a page names are those of the laws its case used."""

from __future__ import annotations

import pytest

from thermogear.case.case import load_example
from thermogear.case.citations import citations


def keys(*changes: str) -> set[str]:
    return {one["key"] for one in citations(load_example("rig", changes))}


def test_a_bundle_cites_its_own_laws_alone() -> None:
    consistent = keys("model.bundle=consistent")
    assert {"lambda-blend", "grubin", "jaeger", "weber-banaschek"} <= consistent
    assert not {"benedict-kelley", "yang-sun", "sainsot"} & consistent
    thesis = keys("model.bundle=thesis")
    assert {"benedict-kelley", "yang-sun", "sainsot", "blok"} <= thesis
    assert not {"lambda-blend", "grubin", "jaeger", "weber-banaschek"} & thesis
    assert keys("model.bundle=both") == consistent | thesis


@pytest.mark.parametrize(
    ("choice", "cited", "others"),
    [
        ("friction=xu-kahraman", {"xu-kahraman"}, {"lambda-blend", "grubin", "benedict-kelley"}),
        ("friction=dry", set(), {"dry", "lambda-blend", "benedict-kelley"}),
        ("flash=blok", {"blok"}, {"jaeger"}),
        ("sharing=stiffness", {"yang-sun"}, set()),
        ("stiffness=textbook-30-degree", {"yang-sun", "sainsot"}, set()),
    ],
)
def test_a_choice_changes_what_is_cited(choice: str, cited: set[str], others: set[str]) -> None:
    found = keys("model.bundle=consistent", f"model.{choice}")
    assert cited <= found
    assert not others & found


def test_every_source_is_named_once() -> None:
    found = citations(load_example("rig", ("model.bundle=both",)))
    rows = [tuple(one.values()) for one in found]
    assert len(set(rows)) == len(rows)
    assert all(all(row) for row in rows)


def test_a_dimensionless_case_of_the_thesis_cites_the_thesis_alone() -> None:
    assert [one["key"] for one in citations(load_example("table-4.2"))] == ["thesis"]
