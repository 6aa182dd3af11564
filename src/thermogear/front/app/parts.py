"""The parts of the page, each made in slices from the case that the dials say."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.display import MICROMETRE, SPEED
from thermogear.base.errors import ThermogearError
from thermogear.base.plan import Alive
from thermogear.base.vocabulary import STILL
from thermogear.case.case import GearCase
from thermogear.case.dials import drawing
from thermogear.front.app.given import Given
from thermogear.front.app.wire import Show
from thermogear.study import live
from thermogear.study.notices import contact_notices, difference_notices
from thermogear.study.series import middle_and_worst
from thermogear.views.moving import moving
from thermogear.views.picture import Picture
from thermogear.views.plots import live as plot

OFTEN = 0.25
"""Seconds between two pictures of one that fills in."""


@dataclass(frozen=True, kw_only=True)
class Part:
    """What a part of the page shows: a picture, drawn gears, a table of rows, lines of words.

    ``pairs`` of a series to turn to, in words and as their dial. ``done`` of ``total`` where it
    fills in.
    """

    name: str
    picture: Picture | None = None
    gears: Any = None
    lines: list[str] = field(default_factory=list)
    rows: list[list[str]] = field(default_factory=list)
    pairs: list[tuple[str, int]] = field(default_factory=list)
    done: int = 1
    total: int = 1

    def message(self, *, number: int, milliseconds: float) -> dict[str, object]:
        """As the page takes it."""
        return {
            "kind": "part",
            "number": number,
            "name": self.name,
            "picture": "" if self.picture is None else moving(self.picture),
            "pairs": self.pairs,
            "gears": "" if self.gears is None else json.dumps(self.gears),
            "lines": self.lines,
            "rows": self.rows,
            "done": self.done,
            "total": self.total,
            "milliseconds": round(milliseconds, 1),
        }


@dataclass(eq=False)
class Kept:
    """What one page's parts remember, so that a dial makes anew only what hangs on it."""

    keys: dict[str, object] = field(default_factory=dict)
    runs: dict[str, live.LiveRunUp] = field(default_factory=dict)
    motions: dict[str, live.Motion] = field(default_factory=dict)

    def fresh(self, name: str, key: object) -> bool:
        """Whether a part shows something else with this key than it does now."""
        return self.keys.get(name) != key

    def forget(self, name: str) -> None:
        self.keys.pop(name, None)


@dataclass(frozen=True, eq=False)
class Look:
    """One state looked at: the ``case`` of it, and whether anybody still wants to see it.

    ``whole``: the case over its turn where ``case`` is its mean tooth.
    """

    given: Given
    case: GearCase
    show: Show
    alive: Alive
    kept: Kept
    whole: GearCase

    @property
    def speed(self) -> float:
        return float(self.case.speeds[0])

    @property
    def speeds(self) -> NDArray[np.float64]:
        """Of the run-up [rad/s]."""
        said = self.show.speeds
        return SPEED.stored(np.linspace(said.low, said.high, said.count))

    @property
    def key(self) -> str:
        """The case as one text: what shows all of it is made anew when any field changes."""
        return json.dumps(self.whole.data, sort_keys=True, default=str)

    def key_of(self, name: str) -> str:
        """What a part hangs on that is made of all of the case."""
        return self.key + str(self.show.speeds) * (name == "series")

    def told(self, stage: str, done: int, total: int) -> None:
        """A study's progress: it asks whether anybody still waits, and says nothing."""
        self.alive()


def mesh(look: Look) -> Iterator[Part]:
    data = live.mesh(look.case, look.alive)
    yield Part(name="mesh", picture=plot.stiffness(data), lines=plot.told_mesh(data))


def gap(look: Look) -> Iterator[Part]:
    data = live.gap(look.case, look.alive)
    if data is None:
        yield Part(name="gap", lines=[STILL["heat_not_settled"]])
        return
    yield Part(name="gap", picture=plot.gap(data))


def gears(look: Look) -> Iterator[Part]:
    from thermogear.study.drawing import drawing
    from thermogear.views.gears import gear_drawing

    data = drawing(look.case, operating=1).data
    yield Part(name="gears", gears=gear_drawing(data).to_json())


def orbit(look: Look) -> Iterator[Part]:
    look.kept.motions.clear()
    yield _orbit(look, {"the case's start": None})


def _orbit(look: Look, starts: dict[str, tuple[float, float] | None]) -> Part:
    kept = look.kept.motions
    try:
        for name, start in starts.items():
            look.alive()
            kept[name] = live.motion(live.point_of(look.case, start))
    except ThermogearError as error:
        if not kept:
            return Part(name="orbit", lines=[str(error)])
    lines: list[str] = []
    shown = dict(kept)
    for name, one in kept.items():
        before = list(shown)[: list(shown).index(name)]
        twin = next((other for other in before if _same(shown[other], one)), None)
        if twin is not None:
            lines.append(f"{name}: the same motion as {twin}")
            shown.pop(name)
            continue
        swing = MICROMETRE(float(np.ptp(one.data["displacement"].values)))
        lines.append(f"{name}: {one.words}; peak to peak {swing:.4g} µm")
    first = kept.get("the case's start")
    rows = []
    if first is not None and first.orbit is not None:
        from thermogear.views.write import page_of

        rows = [[line] for line in page_of(first.orbit).lines()]
    picture = plot.orbits({name: one.data for name, one in shown.items()})
    return Part(name="orbit", picture=picture, lines=lines, rows=rows)


def _same(one: live.Motion, other: live.Motion) -> bool:
    """Whether two closed orbits are one: the same section within a millionth of its size."""
    if one.orbit is None or other.orbit is None:
        return False
    first, second = (m.data["section_displacement"].values for m in (one, other))
    if first.size != second.size:
        return False
    size = float(np.max(np.abs(one.data["displacement"].values)))
    # the same orbit may be entered a period later
    return any(np.max(np.abs(np.roll(first, k) - second)) < 1e-6 * size for k in range(first.size))


def run_up(look: Look) -> Iterator[Part]:
    """Hot first, then undeformed; what hangs on nothing that was turned stays.

    Of the mean tooth: a run-up over a turn takes minutes.
    """
    whole, look = look, replace(look, case=look.case.mean_tooth())
    speeds, kept = look.speeds, look.kept
    last = 0.0
    keys = {s: live.fingerprint(look.case, speeds, s) for s in ("hot", "undeformed")}
    for state, key in keys.items():
        # nothing of another state of the dials is drawn beside what comes
        if not key or kept.fresh(f"run-up {state}", key):
            kept.runs.pop(state, None)
            kept.forget(f"run-up {state}")
    for state, key in keys.items():
        look.alive()
        if not key:
            yield Part(name="run-up", lines=_jammed(look, state), picture=_runs(look))
            continue
        if kept.fresh(f"run-up {state}", key):
            for one in live.run_ups(look.case, speeds, state, look.alive):
                kept.runs[state] = one
                now = time.monotonic()
                if now - last > OFTEN or one.done == one.total:
                    last = now
                    yield _run_part(look, one, state)
                else:
                    yield Part(name="", done=one.done, total=one.total)
            kept.keys[f"run-up {state}"] = key
        yield _run_part(look, kept.runs[state], state)
        inside = speeds[0] <= look.speed <= speeds[-1]
        if inside and state == "hot" and "orbit" in look.show.parts:
            yield _orbit(whole, dict(live.ends_at(kept.runs["hot"], look.speed)))


def series(look: Look) -> Iterator[Part]:
    """The band of the series, of some pairs at first; of a case that is a part of it, too."""
    key = look.key_of("series")
    if drawing(look.whole) is None or not look.kept.fresh("series", key):
        return
    look.kept.forget("series")
    for data in live.series(look.whole, look.speeds, look.alive):
        places = middle_and_worst(data["own_dynamic_factor"].values) or ()
        pairs = [("all pairs", -1), *zip(("median pair", "worst pair"), places, strict=False)]
        yield Part(
            name="series", picture=plot.series(data), lines=plot.told_series(data), pairs=pairs,
            done=data.sizes["part"], total=data.attrs["parts"],
        )  # fmt: skip
    look.kept.keys["series"] = key


def _jammed(look: Look, state: str) -> list[str]:
    try:
        live.point_of(look.case)
    except ThermogearError as error:
        return [f"{state}: {error}"]
    return [f"{state}: no motion at these speeds"]


def _runs(look: Look) -> Picture | None:
    data = {name: one.data for name, one in look.kept.runs.items()}
    return plot.run_up(data, look.speed) if data else None


def _run_part(look: Look, one: live.LiveRunUp, state: str) -> Part:
    lines = ["of the mean tooth over one mesh period"] * (look.case.file.gears.period == "mesh")
    for name, run in look.kept.runs.items():
        if not run.preview:
            notices = (*contact_notices(run.data), *difference_notices(run.data))
            lines += [f"{name}: {words}" for words in plot.jumps(run.data)]
            lines += [f"{name}: {notice.text}" for notice in notices]
    if one.preview:
        lines.append(f"{state}: a coarse look first")
    return Part(name="run-up", picture=_runs(look), lines=lines, done=one.done, total=one.total)


def answers(look: Look) -> Iterator[Part]:
    key = look.key
    if not look.kept.fresh("answers", key):
        return
    from thermogear.study.answers.survey import answers as study
    from thermogear.views.pages.answers import gravest

    look.kept.forget("answers")
    found = study(look.case, progress=look.told).answers
    rows = [[one.question, one.verdict, one.sentence, one.limit] for one in gravest(found)]
    yield Part(name="answers", rows=rows)
    look.kept.keys["answers"] = key


MAKERS: dict[str, Callable[[Look], Iterator[Part]]] = {
    "mesh": mesh,
    "orbit": orbit,
    "gears": gears,
    "gap": gap,
    "series": series,
    "run-up": run_up,
    "answers": answers,
}


def made(look: Look, name: str) -> Iterator[Part]:
    """A part in slices; what it refuses is a line of its own and ends no other part."""
    try:
        yield from MAKERS[name](look)
    except ThermogearError as error:
        look.kept.forget(name)
        yield Part(name=name, lines=[str(error)])
