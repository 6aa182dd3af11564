"""What the page of a gear survey is put together from."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import xarray as xr

from thermogear.views.page import Table
from thermogear.views.picture import Picture

Groups = Mapping[str, xr.Dataset]


@dataclass(frozen=True)
class Drawn:
    """A picture to draw: a name for its files, what it shows and what one should see."""

    name: str
    heading: str
    caption: str
    make: Callable[[], Picture]
    wide: bool = False


@dataclass(frozen=True)
class Survey:
    """A page to make: its sentence, its pictures, its tables, and lines to copy."""

    summary: str
    pictures: Sequence[Drawn]
    tables: Sequence[Table] = ()
    code: str = ""
