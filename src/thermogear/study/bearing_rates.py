"""Rates of the catalogue's bearings, which a record's envelope is held against."""

from __future__ import annotations

from collections.abc import Sequence

from thermogear.measured.impacts import BearingRates
from thermogear.shafts.bearings.catalogue import catalogue_bearing


def bearing_rates(names: Sequence[str]) -> tuple[BearingRates, ...]:
    """Of the bearings named, as "6205"; none where no name is.

    Raises InputError for a name that the catalogue has not.

    >>> [f"{b.outer:.2f} {b.inner:.2f}" for b in bearing_rates(["6205"])]
    ['3.57 5.43']
    """
    chosen = [catalogue_bearing(name) for name in names]
    return tuple(
        BearingRates.of(
            bearing.designation,
            elements=bearing.elements,
            ratio=bearing.ratio,
            contact_angle=bearing.contact_angle,
        )
        for bearing in chosen
    )
