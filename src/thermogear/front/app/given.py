"""What the command line gave the app: a case, and a measured record; the same for every page."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from typing import TYPE_CHECKING

from thermogear.base.errors import InputError
from thermogear.base.toml import overridden
from thermogear.case.case import GearCase, case_of, gear_case
from thermogear.case.dials import balanced, turned
from thermogear.case.size import estimated_bytes
from thermogear.front.app.wire import State

if TYPE_CHECKING:
    from thermogear.measured.reduction import Measurement

MOST_MEMORY = 2**30
"""Of the curves and motions of a case [bytes]."""
MOST_PERIODS = 100_000
"""Mesh periods that a motion is followed, at most."""


@dataclass(frozen=True, eq=False)
class Given:
    """The ``case`` as it was read, ``name`` as one types it, and a ``record`` beside it."""

    name: str
    case: GearCase
    record: Measurement | None = None
    record_name: str = ""

    def changes(self, state: State) -> tuple[tuple[str, str], ...]:
        """All that a state puts into the case file, in order, each field once."""
        found = _joined(self.case.overrides, state.changes)
        if state.heat is not None:
            found = _joined(found, balanced(self._case(found), state.heat))
        return _joined(found, turned(self._case(found), state.dials)) if state.dials else found

    def at(self, state: State) -> GearCase:
        """The case of a state; InputError where no file could hold it, or it is too large here."""
        return self._case(self.changes(state), told=True)

    def _case(self, changes: tuple[tuple[str, str], ...], *, told: bool = False) -> GearCase:
        known = set(self.case.overrides)
        new = tuple(pair for pair in changes if pair not in known)
        if not new:
            return self.case
        data = overridden(self.case.data, new)
        case = gear_case(case_of(data, self.case.text, changes, told=told))
        return _bounded(case)

    def command(self, case: GearCase) -> str:
        """The command line that gives what a ``case`` of a state gives."""
        said = [f"--set {shlex.quote(f'{path}={text}')}" for path, text in case.overrides]
        return " ".join(["thermogear run", shlex.quote(self.name), *said, "-o results"])


def _joined(
    one: tuple[tuple[str, str], ...], other: tuple[tuple[str, str], ...]
) -> tuple[tuple[str, str], ...]:
    """Both, a later change of a field in place of the earlier one."""
    last = dict(other)
    return (*(pair for pair in one if pair[0] not in last), *last.items())


def _bounded(case: GearCase) -> GearCase:
    needed = estimated_bytes(case)
    if needed > MOST_MEMORY:
        raise InputError(
            "case",
            f"about {needed / 2**30:.3g} GiB of curves and motions",
            allowed=f"0..{MOST_MEMORY / 2**30:g} GiB in the app",
            fix="keep fewer points, periods or samples, or use `thermogear run`",
        )
    sim = case.simulation
    for name in ("discard", "most_discarded", "periods"):
        if getattr(sim, name) > MOST_PERIODS:
            raise InputError(
                f"simulation.{name}", getattr(sim, name), allowed=f"..{MOST_PERIODS} in the app",
                fix="use `thermogear run` for longer motions",
            )  # fmt: skip
    return case
