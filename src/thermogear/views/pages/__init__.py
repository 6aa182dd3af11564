"""A page for every kind of result.

A module of this folder that has ``KINDS`` and ``page(result)`` makes the pages of these kinds: a
new kind is a new file.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable

from thermogear.results.result import Result
from thermogear.views.page import Page


def _found() -> dict[str, Callable[[Result], Page]]:
    pages: dict[str, Callable[[Result], Page]] = {}
    for name in sorted(one.name for one in pkgutil.iter_modules(__path__)):
        module = importlib.import_module(f"{__name__}.{name}")
        for kind in getattr(module, "KINDS", ()):
            if kind in pages:
                raise ValueError(f"two pages of kind {kind}")
            pages[kind] = module.page
    return pages


PAGES: dict[str, Callable[[Result], Page]] = _found()
"""Kind of a result -> what makes its page."""
