"""One open page's desk: from a state to everything that is shown of it, and to files."""

from __future__ import annotations

import time
import warnings
from collections.abc import Generator
from typing import TYPE_CHECKING, Any

import numpy as np

from thermogear.base.display import CELSIUS, MILLISECOND, SPEED
from thermogear.base.errors import ValidityWarning
from thermogear.base.plan import Alive
from thermogear.base.progress import asking
from thermogear.case.dials import dials, drawing
from thermogear.case.thermal_state import HOT
from thermogear.front.app.given import Given
from thermogear.front.app.wire import PARTS, Export, Post, Show
from thermogear.study.declared import fault_notices

if TYPE_CHECKING:
    from thermogear.case.case import GearCase


LONG = ("series", "run-up", "answers")
MOST_LIVE = 60
"""Mesh periods of a turn that are shown while a dial moves; of more the mean tooth is."""
CALM = 0.08
"""Seconds without a newer wish before a long part is begun: a dial that moves begins none."""


class Desk:
    """Works for one page on what the command line gave; ``post`` tells the page."""

    def __init__(self, given: Given, post: Post) -> None:
        from thermogear.front.app.parts import Kept

        self.given, self.post, self.kept = given, post, Kept()

    def show(self, show: Show, alive: Alive) -> Generator[None, None, None]:
        """Tell the page everything of a state, the quick parts first; a step each time."""
        from thermogear.front.app.parts import Look, Part, made

        start, came = time.process_time(), time.monotonic()
        with warnings.catch_warnings(
            record=True, action="always", category=ValidityWarning
        ) as said:
            case = self.given.at(show.state)
        told = list(dict.fromkeys(str(one.message) for one in said))
        # a longer turn would not follow a dial
        of, seen = case.period.mesh_periods, case
        if of > MOST_LIVE:
            seen = case.mean_tooth()
            told.append(f"The teeth differ over {of} mesh periods: here is their mean tooth alone")
        told += [one.text for one in fault_notices(seen)]
        self.post("now", self._now(case, show, told))
        look = Look(self.given, seen, show, alive, self.kept, case)
        # what takes long is emptied, so that nothing old stands beside new dials
        for name in ("series", "answers"):
            if name in show.parts and self.kept.fresh(name, look.key_of(name)):
                empty = Part(name=name, lines=["computing"])
                self.post(f"part {name}", empty.message(number=show.number, milliseconds=0.0))
        for name in (one for one in PARTS if one in show.parts):
            alive()
            while name in LONG and time.monotonic() - came < CALM:
                time.sleep(0.01)
                alive()
            for part in made(look, name):
                if part.name:
                    spent = MILLISECOND(time.process_time() - start)
                    self.post(
                        f"part {part.name}", part.message(number=show.number, milliseconds=spent)
                    )
                else:
                    self.post("progress", {"kind": "progress", "number": show.number, "name": name,
                                           "done": part.done, "total": part.total})  # fmt: skip
                yield
                alive()
                start = time.process_time()

    def _now(self, case: GearCase, show: Show, told: list[str]) -> dict[str, object]:
        from thermogear.case.form import form

        return {
            "kind": "now",
            "number": show.number,
            "title": case.title,
            "dials": [one.row for one in dials(case)],
            "fields": {one.path: one.given for one in form(case.data) if one.given},
            "computed": case.computed,
            "temperatures": temperatures(case),
            "command": self.given.command(case),
            "warnings": told,
        }

    def export(self, export: Export, alive: Alive) -> dict[str, object]:
        """The state as a file to keep."""
        name, text = getattr(self, f"_{export.what}")(export, alive)
        return {"kind": "file", "number": export.number, "what": export.what, "name": name,
                "text": text}  # fmt: skip

    def _case(self, export: Export, _: Alive) -> tuple[str, str]:
        from thermogear.base.toml import written

        case = self.given.at(export.state)
        head = f"# {case.title}: from `thermogear app {self.given.name}`, comments left out.\n\n"
        return "case.toml", head + written(case.data)

    def _command(self, export: Export, _: Alive) -> tuple[str, str]:
        return "command.txt", self.given.command(self.given.at(export.state)) + "\n"

    def _report(self, export: Export, alive: Alive) -> tuple[str, str]:
        from thermogear.study.run import run
        from thermogear.thesis.errata import with_errata
        from thermogear.views.page import render
        from thermogear.views.write import page_of

        def report(stage: str, done: int, total: int) -> None:
            self.post("progress", {"kind": "progress", "number": export.number, "name": stage,
                                   "done": done, "total": total})  # fmt: skip

        case = self.given.at(export.state)
        with warnings.catch_warnings(action="ignore", category=ValidityWarning):
            page = page_of(with_errata(run(case, progress=asking(alive, report)), case))
        return "report.html", render(page.showing("first", "All of them: thermogear run"))


def temperatures(case: GearCase) -> list[list[str]]:
    """What the bodies have at the first operating point, in degC."""
    at = case.operating_of(case.models[0])
    names = ("pinion_addendum", "wheel_addendum", "pinion_bore", "wheel_bore", "housing")
    rows: list[tuple[str, Any]] = [
        (name.replace("_addendum", " teeth").replace("_", " "), getattr(at.temperatures, name))
        for name in names
    ]
    rows.append(("oil", at.oil_temperature))
    if not HOT.settled(case, case.models[0]):
        return [[words, "not known"] for words, _ in rows]
    return [
        [words, f"{CELSIUS(float(np.ravel(value)[0])):.1f} °C".replace("-", "−")]
        for words, value in rows
    ]


def hello(given: Given) -> dict[str, object]:
    """What a page needs once: the fields of a case file, the range of speeds."""
    from thermogear.case.form import form

    case = given.case
    return {
        "kind": "hello",
        "name": given.name,
        "form": [one.row for one in form(case.data)],
        "speeds": speeds(case),
        "series": drawing(case) is not None,
    }


def speeds(case: GearCase) -> dict[str, float]:
    """A range [rpm] that holds the pair's resonance and the case's own speeds."""
    from thermogear.case.family import GearFamily

    points = GearFamily(case, ())(np.empty((1, 0)))
    rate = float(points.rate[0])
    own = SPEED(max(case.speeds))
    natural = SPEED(rate / case.pair.pinion.teeth)
    top = max(own, natural) if np.isfinite(natural) and natural > 0.0 else own
    step = 10.0 ** np.floor(np.log10(top))
    high = min(float(np.ceil(1.25 * top / step * 2.0) * step / 2.0), 500_000.0)
    low = max(0.1, float(f"{min(high / 20.0, SPEED(min(case.speeds))):.2g}"))
    return {"low": low, "high": high, "count": 300}
