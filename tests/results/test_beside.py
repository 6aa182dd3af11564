"""What stands beside a store of long work is told again when its page is drawn again."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
import xarray as xr

from coded import coded
from thermogear.base.notice import SENTENCE
from thermogear.base.vocabulary import STATUS
from thermogear.results.beside import with_notices
from thermogear.study.notices import contact_notices

JAMMED = STATUS.index("jammed")


def store(shares: list[float], status: int = JAMMED, last: float = np.nan) -> xr.Dataset:
    known = np.where(np.isnan(shares), status, 0)
    shown = np.where(np.isnan(shares), last, shares)
    return xr.Dataset({"back_share": ("row", shown), "status": ("row", known)})


def test_backlash_without_effect_is_told_from_the_data_alone() -> None:
    def told(data: xr.Dataset) -> dict[str, list[Mapping[str, Any]]]:
        return coded(str(with_notices(data).attrs["notices"]))

    free: dict[str, list[Mapping[str, Any]]] = {"backlash_without_effect": [{}]}
    assert told(store([0.0, 0.0])) == free
    assert told(store([0.0, 0.1])) == told(store([np.nan])) == {}
    # what was not computed, or did not settle, may reach the back flanks; what jams lacks a gap
    for place, status in enumerate(STATUS):
        if status not in ("ok", "no_oil_bath"):
            assert told(store([0.0, 0.0, np.nan], place)) == {}
    bath = {"hot": 1, "points": 3, "hottest": 423.15}
    hot = store([0.0, 0.0, np.nan], STATUS.index("no_oil_bath"), 0.0)
    assert told(hot) == {"no_oil_bath": [bath], **free}
    own = store([0.0, 0.0]).assign_attrs(notices=json.dumps(["mine"]))
    assert told(own) == {SENTENCE: [{}]}


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
    never = {"contact_never_lost": [{"valid": valid, "points": 2}]}
    open_ = {"contact_loss_not_decided": [{"valid": 0, "points": 2}]}
    assert coded(contact_notices(data)) == (never if valid else open_)
    alone = store([0.0, 0.0, np.nan], STATUS.index("no_oil_bath"), 0.0).isel(row=[2])
    assert set(coded(str(with_notices(alone).attrs["notices"]))) == {"no_oil_bath"}
