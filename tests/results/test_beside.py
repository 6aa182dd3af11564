"""What stands beside a store of long work is told again when its page is drawn again."""

from __future__ import annotations

import json

import numpy as np
import xarray as xr

from thermogear.base.vocabulary import ASSUMED
from thermogear.results.beside import NO_BACK_IMPACT, with_notices


def store(shares: list[float], status: int = 0) -> xr.Dataset:
    known = np.where(np.isnan(shares), ASSUMED, status)
    return xr.Dataset({"back_share": ("row", np.array(shares)), "status": ("row", known)})


def test_backlash_without_effect_is_told_from_the_data_alone() -> None:
    def told(data: xr.Dataset) -> list[str]:
        found: list[str] = json.loads(with_notices(data).attrs["notices"])
        return found

    assert told(store([0.0, 0.0, np.nan])) == [NO_BACK_IMPACT]
    assert told(store([0.0, 0.1])) == told(store([np.nan])) == told(store([0.0], status=1)) == []
    own = store([0.0, 0.0]).assign_attrs(notices=json.dumps(["mine"]))
    assert told(own) == ["mine"]
