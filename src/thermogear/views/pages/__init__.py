"""A page for every kind of result.

A module of this folder that has ``KINDS`` and ``page(result)`` makes the pages of these kinds: a
new kind is a new file.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import cast

from thermogear.results.result import Result
from thermogear.views.page import Page

Maker = Callable[[Result], Page]


class _Pages(Mapping[str, Maker]):
    """Kind of a result -> what makes its page; a module is loaded when its kind is asked for.

    The module of a kind's own name is looked at first, before all the others.
    """

    def __getitem__(self, kind: str) -> Maker:
        if kind in _names():
            module = importlib.import_module(f"{__name__}.{kind}")
            if kind in getattr(module, "KINDS", ()):
                return cast(Maker, module.page)
        return _found()[kind]

    def __iter__(self) -> Iterator[str]:
        return iter(_found())

    def __len__(self) -> int:
        return len(_found())


@cache
def _names() -> tuple[str, ...]:
    return tuple(sorted(one.name for one in pkgutil.iter_modules(__path__)))


@cache
def _found() -> dict[str, Maker]:
    pages: dict[str, Maker] = {}
    for name in _names():
        module = importlib.import_module(f"{__name__}.{name}")
        for kind in getattr(module, "KINDS", ()):
            if kind in pages:
                raise ValueError(f"two pages of kind {kind}")
            pages[kind] = module.page
    return pages


PAGES: Mapping[str, Maker] = _Pages()
"""Kind of a result -> what makes its page."""
