"""What should be known beside a store of long work, from its data alone."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from thermogear.base.vocabulary import STATUS

if TYPE_CHECKING:
    import xarray as xr

NO_BACK_IMPACT = (
    "the teeth never reach the back flanks anywhere in this range: a wider or narrower gap would "
    "change nothing here but the place x is counted from"
)


def with_notices(data: xr.Dataset) -> xr.Dataset:
    """The data with its notices, where the study stored none."""
    if "notices" in data.attrs:
        return data
    return data.assign_attrs(notices=json.dumps(back_side_notice(data)))


def back_side_notice(data: xr.Dataset) -> list[str]:
    """Whether the half backlash has any effect; nothing where a motion is not known."""
    if "back_share" not in data:
        return []
    # a jammed point has no gap to spare: there a wider one would change everything
    moves = data["status"].values == STATUS.index("ok")
    return [NO_BACK_IMPACT] * bool(np.all(moves & (data["back_share"].values == 0.0)))
