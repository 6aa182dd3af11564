"""What should be known beside a store of long work, from its data alone."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.materials import NO_BATH
from thermogear.base.notice import Notice, stored_notices
from thermogear.base.vocabulary import NO_OIL_BATH, moves


def with_notices(data: Dataset) -> Dataset:
    """The data with its notices, where the study stored none."""
    if "notices" in data.attrs:
        return data
    return data.assign_attrs(notices=stored_notices(from_data(data)))


def from_data(data: Dataset, about: str = "") -> Iterator[Notice]:
    """Where no oil bath is kept, and whether the half backlash has any effect.

    Of the latter nothing where a motion is not known. ``about``: the name of what ``data`` hold.
    """
    status = data["status"].values if "status" in data else np.empty(0)
    hot = int((status == NO_OIL_BATH).sum())
    if hot:
        yield Notice.of("no_oil_bath", about=about, hot=hot, points=status.size, hottest=NO_BATH)
    # a jammed point has no gap to spare; points without an oil bath alone prove nothing
    if "back_share" not in data or not np.any(status == 0):
        return
    if np.all(moves(status) & (data["back_share"].values == 0.0)):
        yield Notice.of("backlash_without_effect", about=about)
