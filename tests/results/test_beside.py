"""What stands beside a store of long work is told again when its page is drawn again."""

from __future__ import annotations

import json

import numpy as np
import xarray as xr

from thermogear.results.beside import NO_BACK_IMPACT, with_notices


def store(impacts: list[int], label: int = 1) -> xr.Dataset:
    labels = np.full(len(impacts), label)
    return xr.Dataset({"back_impacts": ("row", np.array(impacts)), "label": ("row", labels)})


def test_backlash_without_effect_is_told_from_the_data_alone() -> None:
    def told(data: xr.Dataset) -> list[str]:
        found: list[str] = json.loads(with_notices(data).attrs["notices"])
        return found

    assert told(store([0, 0, -1])) == [NO_BACK_IMPACT]
    assert told(store([0, 1])) == told(store([-1])) == told(store([0, 0], label=2)) == []
    own = store([0, 0]).assign_attrs(notices=json.dumps(["mine"]))
    assert told(own) == ["mine"]
