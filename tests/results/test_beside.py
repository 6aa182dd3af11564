"""What stands beside a store of long work is told again when its page is drawn again."""

from __future__ import annotations

import json

import numpy as np
import pytest
import xarray as xr

from said import numbers
from thermogear.base.vocabulary import STATUS
from thermogear.results.beside import NO_BACK_IMPACT, with_notices
from thermogear.study.notices import NOT_DECIDED, contact_notices

JAMMED = STATUS.index("jammed")


def store(shares: list[float], status: int = JAMMED, last: float = np.nan) -> xr.Dataset:
    known = np.where(np.isnan(shares), status, 0)
    shown = np.where(np.isnan(shares), last, shares)
    return xr.Dataset({"back_share": ("row", shown), "status": ("row", known)})


def test_backlash_without_effect_is_told_from_the_data_alone() -> None:
    def told(data: xr.Dataset) -> list[str]:
        found: list[str] = json.loads(with_notices(data).attrs["notices"])
        return found

    assert told(store([0.0, 0.0])) == [NO_BACK_IMPACT]
    assert told(store([0.0, 0.1])) == told(store([np.nan])) == []
    # what was not computed, or did not settle, may reach the back flanks; what jams lacks a gap
    for place, status in enumerate(STATUS):
        if status not in ("ok", "no_oil_bath"):
            assert told(store([0.0, 0.0, np.nan], place)) == []
    bath, gap = told(store([0.0, 0.0, np.nan], STATUS.index("no_oil_bath"), 0.0))
    assert (numbers(bath), gap) == ([1.0, 3.0, 150.0], NO_BACK_IMPACT)
    own = store([0.0, 0.0]).assign_attrs(notices=json.dumps(["mine"]))
    assert told(own) == ["mine"]


@pytest.mark.parametrize(
    ("status", "share", "valid"),
    [
        (["ok", "ok"], [0.0, 0.0], 2),
        (["ok", "assumed"], [0.0, np.nan], 1),
        (["no_oil_bath", "no_oil_bath"], [0.0, 0.0], 0),
    ],
)
def test_contact_is_kept_only_where_points_are_valid(
    status: list[str], share: list[float], valid: int
) -> None:
    """A claim that rests on no valid point is not decided; else it says how many there are."""
    along = ("pinion_speed",)
    data = xr.Dataset(
        {
            "status": (along, [STATUS.index(one) for one in status]),
            "label": (along, [0, 0]),
            "contact_loss_share": (along, share),
            "back_impacts": (along, [0.0, 0.0]),
            "mesh_force_min": (along, [1.0, 1.0]),
        },
        {"pinion_speed": [1.0, 2.0]},
    )
    (words,) = contact_notices(data)
    assert (words == NOT_DECIDED.format(2)) == (valid == 0)
    assert numbers(words) == [float(valid), 2.0]
    alone = store([0.0, 0.0, np.nan], STATUS.index("no_oil_bath"), 0.0).isel(row=[2])
    assert NO_BACK_IMPACT not in json.loads(with_notices(alone).attrs["notices"])
