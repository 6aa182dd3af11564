"""What should be known beside a store of long work, from its data alone."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from thermogear.base.materials import NO_BATH
from thermogear.base.units import ZERO_CELSIUS
from thermogear.base.vocabulary import NO_OIL_BATH, moves

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
    return data.assign_attrs(notices=json.dumps(from_data(data)))


def from_data(data: xr.Dataset) -> list[str]:
    """Where no oil bath is kept, and whether the half backlash has any effect.

    Of the latter nothing where a motion is not known.
    """
    status = data["status"].values if "status" in data else np.empty(0)
    hot = int((status == NO_OIL_BATH).sum())
    found = [
        f"{hot} of {status.size} points rest on an oil bath that cannot exist (status no_oil_bath):"
        f" the oil is above its flash point, or above {NO_BATH - ZERO_CELSIUS:.0f} °C where that "
        "is not given; give oil.flash_point, or an oil that stays cooler"
    ] * (hot > 0)
    if "back_share" not in data:
        return found
    # a jammed point has no gap to spare; points without an oil bath alone prove nothing
    never = np.any(status == 0) and np.all(moves(status) & (data["back_share"].values == 0.0))
    return found + [NO_BACK_IMPACT] * bool(never)
