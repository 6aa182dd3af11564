"""Rates of the catalogue's bearings, which a record's envelope is held against."""

from __future__ import annotations

from collections.abc import Sequence

from thermogear.measured.swelling import BearingRates
from thermogear.shafts.bearings.catalogue import CATALOGUE, catalogue_bearing


def bearing_rates(names: Sequence[str] = ()) -> tuple[BearingRates, ...]:
    """Of the bearings named, as "6205"; of every one of the catalogue where none is.

    Raises InputError for a name that the catalogue has not.

    >>> [f"{b.outer:.2f} {b.inner:.2f}" for b in bearing_rates(["6205"])]
    ['3.57 5.43']
    """
    chosen = [catalogue_bearing(name) for name in names] or list(CATALOGUE.values())
    return tuple(
        BearingRates.of(
            bearing.designation,
            elements=bearing.elements,
            ratio=bearing.ratio,
            contact_angle=bearing.contact_angle,
        )
        for bearing in chosen
    )
