"""A page for every kind of result."""

from __future__ import annotations

from collections.abc import Callable

from thermogear.results.result import Result
from thermogear.views.page import Page
from thermogear.views.pages import (
    contact,
    friction,
    motion,
    record,
    relief,
    run,
    sensitivity,
    sweeps,
    temperature,
    thesis,
    versus,
    warm_up,
)

PAGES: dict[str, Callable[[Result], Page]] = {
    "gear": run.page,
    "dimensionless": run.page,
    "friction": friction.page,
    "temperature": temperature.page,
    "warmup": warm_up.page,
    "relief": relief.page,
    "contact": contact.page,
    "orbit": motion.page,
    "lyapunov": motion.page,
    "branch": motion.page,
    "cascade": motion.page,
    "shared": motion.page,
    "diagram": sweeps.page,
    "map": sweeps.page,
    "basins": sweeps.page,
    "sweep": sweeps.page,
    "run-up": sweeps.page,
    "versus": versus.page,
    "measured": record.page,
    "comparison": record.page,
    "sensitivity": sensitivity.page,
    "thesis": thesis.page,
}
"""Kind of a result -> what makes its page."""

STORED = ("diagram", "map", "basins", "sweep", "run-up")
"""Kinds of long work, which stand in a store of their own."""
