"""What a drive train loses contact at: flanks and bearings over one parameter or two."""

from __future__ import annotations

from collections import Counter

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Dataset, Flags
from thermogear.base.display import PERCENT
from thermogear.base.vocabulary import contact_name
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.parameters import axis_words, each_state, named, shown
from thermogear.views.plots.sweeps import edges, hatch_assumed, regimes
from thermogear.views.style import FAINT, INK, OKABE_ITO, QUIET, WIDE

DRIVE, BACK, FIRST = 1, 2, 4
"""Flags of what loses contact: the drive flank, the back flank (hit), the first bearing."""
JAMMED = 4
"""Its label."""
PARTED = 1e-9
"""Share of the time out of drive contact [1] that is more than rounding."""
FIRST_BEARING, BORDERS = 2, ((), (5.0, 2.0), (1.5, 1.5))
"""Number of the first contact that is a bearing; dashes of drive flank, back flank, bearings."""
MOST = 6
"""Sets of bearings with a colour of their own."""
ALIKE, UNKNOWN, LOCKED = FAINT, "#999999", "#ffffff"
TEETH = (
    ("teeth always in contact", ALIKE),
    ("drive flank parts", "#E69F00"),
    ("drive flank parts, back flank is hit", "#D55E00"),
)
SETS = ("#0072B2", "#56B4E9", "#009E73", "#CC79A7", "#F0E442", "#8a5a2b")
BLANK = (("not known", UNKNOWN), ("jammed", LOCKED))


def has_lost(data: Dataset) -> bool:
    """Whether the stored result says what loses contact."""
    return "lost_contact" in data


def lost_of(data: Dataset) -> NDArray[np.int64]:
    """The sums of flags, -1 where nothing is known (which no file holds: there it is missing)."""
    return np.asarray(np.nan_to_num(data["lost_contact"].values, nan=-1.0), dtype=np.int64)


def things(data: Dataset) -> dict[str, Flags]:
    """Where what loses contact, arrays as the labels': flanks first, then each bearing."""
    lost = lost_of(data)
    some = np.where(lost > 0, lost, 0)
    found = {
        "the drive flank parts": (some & DRIVE) > 0,
        "the back flank is hit": (some & BACK) > 0,
    }
    for place, name in enumerate(named(data, "bearing")):
        found[f"bearing {name} is unloaded at times"] = (some & (FIRST << place)) > 0
    return found


def map_picture(data: Dataset) -> Picture:
    """The regime over two parameters, in every state of heat that it has; what is assumed hatched.

    Of a pair beside it what the teeth lose contact at, which a train has a picture of its own for.
    """
    panels = []
    for state, one in each_state(data):
        panels.append(regimes(one))
        panels[-1].title = state
    if not has_lost(data):
        drive, back = data["drive_share"].values, data["back_share"].values
        lost = np.where(drive < 1.0 - PARTED, DRIVE, 0) + np.where(back > 0.0, BACK, 0)
        lost = np.where(np.isfinite(drive), lost, -1)
        panels.append(_teeth(data.assign(lost_contact=(data["label"].dims, lost)), ""))
    return Picture([panels], size=(WIDE, 4.6), legend=4, share_y="row")


def lost_contact_picture(data: Dataset) -> Picture:
    """Which flank, and which bearing, loses contact over two parameters, in every state of heat."""
    states = each_state(data)
    sets = _sets(data)
    panels = [[_teeth(one, name) for name, one in states],
              [_bearings(one, name, sets) for name, one in states]]  # fmt: skip
    if len(states) == 1:
        return Picture([[panels[0][0], panels[1][0]]], size=(WIDE, 4.6), legend=3, share_y="row")
    return Picture(panels, size=(WIDE, 8.2), legend=3, share_y="row", share_x="column")


def _panel(data: Dataset, words: str) -> Panel:
    along, up = (Axis(axis_words(str(name), data[name])) for name in data["label"].dims[-2:])
    return Panel(along, up, words)


def _put(
    panel: Panel, data: Dataset, codes: NDArray[np.int64], looks: list[tuple[str, str]]
) -> Panel:
    one, two = (str(name) for name in data["label"].dims[-2:])
    names, colours = zip(*looks, *BLANK, strict=True)
    whole = np.where(lost_of(data) < 0, len(looks), codes)
    whole = np.where(data["label"].values == JAMMED, len(looks) + 1, whole)
    borders = edges(shown(one, data[one])), edges(shown(two, data[two]))
    panel.field(*borders, whole.T, colours=colours, classes=names)
    hatch_assumed(panel, data)
    return panel


def _teeth(data: Dataset, state: str) -> Panel:
    lost = lost_of(data)
    codes = np.where(lost & BACK, 2, np.where(lost & DRIVE, 1, 0))
    panel = _put(_panel(data, f"teeth{f', {state}' * bool(state)}"), data, codes, list(TEETH))
    draw_borders(panel, data, flanks=True)
    return panel


def draw_borders(panel: Panel, data: Dataset, flanks: bool) -> None:
    """The borders of contact loss that were followed: of ``flanks``, else of bearings."""
    state = int(data["state"]) if "state" in data.coords and not data["state"].ndim else 0
    first, second = (str(name) for name in data["label"].dims[-2:])
    bearings = named(data, "bearing") if "bearing" in data.coords else []
    for row in range(data.sizes.get("border", 0)):
        contact = int(data["border_contact"][row])
        if int(data["border_state"][row]) == state and (contact < FIRST_BEARING) == flanks:
            place = BORDERS[min(contact, FIRST_BEARING)]
            panel.curve(
                shown(first, data["border_first"][row]), shown(second, data["border_second"][row]),
                colour=INK, dash=place, width=1.4, order=3.0,
                label=f"border: {contact_name(contact, bearings)}",
            )  # fmt: skip


def _sets(data: Dataset) -> list[int]:
    """The sets of unloaded bearings that occur, the most frequent first."""
    lost = lost_of(data)
    found = Counter((lost[lost > 0] // FIRST).ravel().tolist())
    return [one for one, _ in found.most_common() if one][:MOST]


def _bearings(data: Dataset, state: str, sets: list[int]) -> Panel:
    bearings, lost = named(data, "bearing"), lost_of(data)
    own = np.where(lost > 0, lost, 0) // FIRST
    looks = [("bearings always loaded", ALIKE)]
    codes = np.where(own == 0, 0, len(sets) + 1)
    for place, one in enumerate(sets):
        which = [name for b, name in enumerate(bearings) if one & (1 << b)]
        words = "every bearing" if len(which) == len(bearings) > 1 else ", ".join(which)
        looks.append((f"unloaded at times: {words}", SETS[place]))
        codes[own == one] = place + 1
    looks.append(("other bearings unloaded", INK))
    panel = _put(_panel(data, f"bearings{f', {state}' * bool(state)}"), data, codes, looks)
    draw_borders(panel, data, flanks=False)
    return panel


def forces_picture(data: Dataset) -> Picture:
    """Greatest force on teeth and bearings over a parameter, up and down; what lifts off below."""
    name = str(data.attrs["parameter"])
    p = shown(name, data[name])
    dot = "circle" if p.size == 1 else ""
    along = Axis(axis_words(name, data[name]))
    force = Panel(Axis(), Axis("greatest force [N]", low=0.0))
    free = Panel(along, Axis("time without contact [%]", low=0.0))
    ways = (("up", ()), ("down", (3.0, 2.0)))
    rows = [("teeth", INK, data["greatest_mesh_force"].values, data["drive_free_share"].values)]
    rows += [
        (
            bearing,
            OKABE_ITO[b % len(OKABE_ITO)],
            data["greatest_bearing_force"].values[..., b],
            data["bearing_free_share"].values[..., b],
        )
        for b, bearing in enumerate(named(data, "bearing"))
    ]
    for words, colour, forces, shares in rows:
        for direction, (way, dash) in enumerate(ways):
            for start in range(data.sizes["start"]):
                label = f"{words}, {way}" if start == 0 else ""
                look = {"colour": colour, "dash": dash, "width": 1.3, "marker": dot}
                force.curve(p, forces[direction, start], label=label, **look)  # type: ignore[arg-type]
                free.curve(p, PERCENT(shares[direction, start]), **look)  # type: ignore[arg-type]
    if not np.nansum(data["drive_free_share"].values) + np.nansum(
        data["bearing_free_share"].values
    ):
        free.text(0.5, 0.5, "nothing loses contact", at="panel", colour=QUIET)
    return Picture(
        [[force], [free]], size=(WIDE, 6.0), share_x="column", above=0.2, heights=(2, 1), legend=4
    )
