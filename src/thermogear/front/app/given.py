"""What the command line gave the app: a case, the same for every page."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from thermogear.base.errors import InputError, short
from thermogear.base.toml import overridden, tables
from thermogear.case.case import GearCase, case_of, gear_case
from thermogear.case.charts import GEARS
from thermogear.case.dials import Changes, balanced, turned
from thermogear.case.size import estimated_bytes
from thermogear.front.app.wire import State

MOST_MEMORY = 2**30
"""Of the curves and motions of a case [bytes]."""
MOST = {
    "simulation.discard": 100_000,
    "simulation.most_discarded": 100_000,
    "simulation.periods": 100_000,
    "grid.mesh_positions": 4096,
    "grid.path_positions": 10_001,
    "grid.harmonics": 256,
}
"""Mesh periods of a motion, points and harmonics of curves; more only where the file has more."""


@dataclass(frozen=True, eq=False)
class Given:
    """The ``case`` as it was read, and its ``name`` as one types it."""

    name: str
    case: GearCase

    @cached_property
    def file(self) -> dict[str, Any]:
        """The tables of the case file, without what the command line put into it."""
        return tables(self.name, self.case.text)

    def changes(self, state: State) -> Changes:
        """All that a state puts into the case file, in order, each field once."""
        found = _joined(self.case.overrides, state.changes)
        if state.heat is not None:
            found = _joined(found, balanced(self._case(found), state.heat))
        if state.dials:
            found = _joined(found, turned(self._case(found), state.dials))
        return found

    def at(self, state: State) -> GearCase:
        """The case of a state; InputError where no file could hold it, or it is too large here."""
        return self._case(self.changes(state), told=True)

    def _holds(self, path: str) -> bool:
        """Whether the file itself has a field, so that leaving it out says something."""
        try:
            overridden(self.file, ((path, ""),))
        except InputError:
            return False
        return True

    def _case(self, changes: Changes, *, told: bool = False) -> GearCase:
        if changes == self.case.overrides:
            return self.case
        changes = tuple(one for one in changes if one[1].strip() or self._holds(one[0]))
        data = overridden(self.file, changes)
        _require_files(data)
        return self._bounded(gear_case(case_of(data, self.case.text, changes, told=told)))

    def _bounded(self, case: GearCase) -> GearCase:
        """``case`` where it is no more work than an app may do, or no more than the file's own."""
        needed = estimated_bytes(case)
        if needed > max(MOST_MEMORY, estimated_bytes(self.case)):
            raise InputError(
                "case",
                f"about {needed / 2**30:.3g} GiB of curves and motions",
                allowed=f"0..{MOST_MEMORY / 2**30:g} GiB in the app",
                fix="keep fewer points, periods or samples, or use `thermogear run`",
            )
        for path, most in MOST.items():
            got, own = (_count(one, path) for one in (case, self.case))
            if got > max(most, own):
                raise InputError(
                    path, got, allowed=f"..{max(most, own)} in the app", fix="use `thermogear run`"
                )
        return case

    def command(self, case: GearCase) -> str:
        """The command line that gives what a ``case`` of a state gives."""
        said = [f"--set {shlex.quote(f'{path}={text}')}" for path, text in case.overrides]
        return " ".join(["thermogear run", shlex.quote(self.name), *said, "-o results"])


def _joined(one: Changes, other: Changes) -> Changes:
    """Both, a later change of a field in place of the earlier one."""
    last = dict(other)
    return (*(pair for pair in one if pair[0] not in last), *last.items())


def _require_files(data: dict[str, Any]) -> None:
    """Refuse the name of a file that the case had not when it was read: a page opens no files."""
    flanks, files = data.get("flanks"), data.get("files", {})
    if not isinstance(flanks, dict) or not isinstance(files, dict):
        return
    for gear in GEARS:
        given = flanks.get(gear)
        for name in [given] if isinstance(given, str) else given or ():
            if name not in files:
                raise InputError(
                    f"flanks.{gear}", short(name), why="a page opens no files",
                    fix=f"start the app with --set flanks.{gear}=FILE",
                )  # fmt: skip


def _count(case: GearCase, path: str) -> int:
    name = path.rpartition(".")[2]
    return int(getattr(case.simulation if path.startswith("simulation") else case, name))
