"""The one maker of labelled Datasets: what an entry may be, and what it refuses."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from thermogear.base.errors import InputError
from thermogear.base.vocabulary import (
    EDGE_CONTACT,
    REGIMES,
    STATUS,
    attributes,
    dressed,
    label,
    labelled,
)


def test_a_name_of_the_vocabulary_brings_its_words() -> None:
    data = label({"film_thickness": ("operating", [1e-6, 2e-6])}, {"pinion_speed": [100.0, 200.0]})
    assert data["film_thickness"].attrs == attributes("film_thickness")
    assert data["pinion_speed"].dims == ("pinion_speed",)
    assert data["pinion_speed"].attrs == {"units": "rad/s", "long_name": "pinion speed",
                                          "symbol": "ω₁"}  # fmt: skip


def test_a_quantity_of_its_own_is_described_on_the_spot() -> None:
    data = label({
        "share": (("a", "b"), np.ones((2, 3)), "1", "a share"),
        "time": ("a", [0, 1], "s", "not the vocabulary's time"),
        "bare": ("b", [1, 2, 3], ""),
        "wordy": ("b", [1, 2, 3], "", "no unit"),
    })  # fmt: skip
    assert data["share"].attrs == {"units": "1", "long_name": "a share"}
    assert data["time"].attrs == {"units": "s", "long_name": "not the vocabulary's time"}
    assert data["bare"].attrs == {}
    assert data["wordy"].attrs == {"long_name": "no unit"}
    assert data["bare"].dtype == np.asarray([1]).dtype
    xr.testing.assert_identical(
        data["share"].variable, dressed(("a", "b"), np.ones((2, 3)), "1", "a share")
    )


@pytest.mark.parametrize(
    ("name", "words"), [("status", STATUS), ("edge_contact", EDGE_CONTACT), ("regime", REGIMES)]
)
def test_flags_are_small_numbers_with_their_words(name: str, words: tuple[str, ...]) -> None:
    one = labelled(name, ("operating", np.array([0, 1])))
    assert one.dtype == np.int8
    assert one.attrs["flag_meanings"].split() == list(words)
    assert one.attrs["flag_values"].tolist() == list(range(len(words)))


def test_texts_have_no_unit_and_labelled_arrays_stay() -> None:
    grid = label({"note": ("row", ["a", "bc"])}, {"row": ["first", "second"]}, {"title": "two"})
    assert grid["note"].attrs == grid["row"].attrs == {}
    assert grid.attrs == {"title": "two"}
    again = label({"note": grid["note"], "row_length": ("row", [1, 2], "m", "length")})
    assert again["row"].values.tolist() == ["first", "second"]


def test_a_number_without_a_unit_says_the_nearest_name() -> None:
    with pytest.raises(InputError, match=r"^quantity: got 'film_thicknes'; did you mean 'film_th"):
        label({"film_thicknes": ("operating", [1.0])})
