"""The section of a run that shows its drive train in motion."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.display import (
    MICROMETRE,
    MILLIMETRE_PER_SECOND,
    NEWTON,
    PERCENT,
    number,
    shared,
)
from thermogear.results.result import Result
from thermogear.views.columns import OF_STATE, Column, Row, declared, rows_along
from thermogear.views.moving import Dial
from thermogear.views.page import Block, Pictures, Section, Table, Text
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.shafts import empty, in_rows
from thermogear.views.plots.spectrum import draw_lines, floor_of, over_orders
from thermogear.views.style import (
    ABOVE,
    BETWEEN,
    BOTTOM,
    INK,
    LEFT,
    QUIET,
    RIGHT,
    STATES,
    TOP,
    WIDE,
    names_of,
)
from thermogear.views.tables import labelled
from thermogear.views.typesetting import operating_names

CAPTION = (
    "Settled motion with clearance in the teeth and in the bearings. Flanks: force of the drive "
    "flanks, 0 where they part. Section: one dot for each mesh period; one dot in all means that "
    "every tooth pair sees the same. Lines are peak values."
)
ORBITS = (
    "Above: where each journal is in its outer ring, seen along the shafts. Inside the dashed "
    "circle, as wide across as the radial internal clearance of that state of heat, nothing holds "
    "it; what reaches beyond is the contact's deflection. Of rolling elements the free space is "
    "the polygon around the circle, a side for each element. A preloaded bearing has none. The "
    "arrow is the mean force on the ring. Below: the same paths, each about its mean, enlarged; "
    "the arrow is the way it goes, the dot its place at mesh phase 0, which the dial turns on."
)
FORCES = (
    "Amount of the force on each bearing's ring, damping not in it. Dashed: the amount of the "
    "mean force, as a vector."
)
ORDERS = (
    "Lines of the force on each bearing, the larger of x and y, peak values. Whole orders come "
    "from every tooth alike, halves from a motion that repeats after two mesh periods, what lies "
    "beside them from the shafts or from a second base frequency. Dash-dotted, where cages turn: "
    "the order at which rolling elements pass a point of the outer ring, and its double."
)
TORUS = (
    "The motion never returns: it has two base frequencies, and its sections fill a closed curve, "
    "or a few that they visit in turn, where the torus began at an orbit of so many periods. "
    "A second frequency is known but for whole multiples of the "
    "mesh's and for its sign: the one below half the mesh frequency is told."
)
FRAMES = 16
"""Moments of a mesh period."""
FEW = 2
"""Up to so many operating points the bearings of each are shown."""
SOUND = (
    "Lines of the housing's acceleration, the larger of x and y: what a sensor on the housing sees "
    "of the mesh and of both shafts."
)


def section(result: Result, pictures: Pictures) -> Section | None:
    """Forces, sections and lines of every operating point; None where nothing moved."""
    data = result.group("train_motion")
    if data is None:
        return None
    names = operating_names(data)
    closer = _closer(data)
    for o, name in enumerate(names):
        here = data.isel(operating=o)
        if np.isnan(here["mesh_force"].values).all():
            continue
        pictures.add(
            f"train-motion-{o}", f"The train in motion, {name}", CAPTION, data,
            ("mesh_force", "mesh_force_line", "bearing_force_line"),
            partial(four_panels, data, o), wide=True,
        )  # fmt: skip
        if o in closer:
            _of_bearings(data, o, name, pictures)
        if turning(data, o):
            pictures.add(
                f"train-torus-{o}", f"Section of the torus, {name}", TORUS, data,
                ("torus_deflection", "second_frequency"), partial(torus_section, data, o),
                wide=True,
            )  # fmt: skip
        if np.isfinite(here["housing_line"].values).any():
            pictures.add(
                f"train-sound-{o}", f"Acceleration of the housing, {name}", SOUND, data,
                ("housing_line",), partial(sound, data, o), wide=True,
            )  # fmt: skip
    blocks: list[Block] = [*pictures.take()]
    if closer and len(closer) < len(names):
        told = f"Bearings are shown at {names[closer[0]]}, where one carries most."
        blocks.append(Text(told, "note"))
    blocks += _tables(data)
    worst = float(np.nanmax(data["reduction_error"].values, initial=0.0))
    size = int(data["coordinates"].values.max())
    if size:
        blocks.append(
            Text(
                f"{size} coordinates of the reduced train change its 12 lowest natural "
                f"frequencies by at most {PERCENT(worst):.2g} %.",
                "note",
            )
        )
    return Section("train-motion", "The drive train in motion", blocks)


def _closer(data: Dataset) -> list[int]:
    """Operating points whose bearings are shown: all of a few, of more the hardest on them."""
    count = data.sizes["operating"]
    if count <= FEW:
        return list(range(count))
    force = data["greatest_bearing_force"].max(["state", "bearing"]).values
    return [] if np.isnan(force).all() else [int(np.nanargmax(force))]


def _of_bearings(data: Dataset, place: int, name: str, pictures: Pictures) -> None:
    """Orbits with a dial of the phase, forces over time and over order."""
    path = ("journal_path", "mean_bearing_load")
    phases = [f"{f / FRAMES:.3f}" for f in range(FRAMES)]
    turned = Dial("mesh phase", phases, [""] * FRAMES, 0, partial(_frame, data, place))
    pictures.add(
        f"bearing-orbits-{place}", f"Journals in their bearings, {name}", ORBITS, data, path,
        partial(_frame, data, place, 0), wide=True, dial=turned,
    )  # fmt: skip
    pictures.add(
        f"bearing-force-{place}", f"Force on each bearing over time, {name}", FORCES, data, path,
        partial(bearing_force_time, data, place), wide=True,
    )  # fmt: skip
    pictures.add(
        f"bearing-orders-{place}", f"Force on each bearing over order, {name}", ORDERS, data, path,
        partial(bearing_force_order, data, place), wide=True,
    )  # fmt: skip


def _frame(data: Dataset, place: int, frame: int) -> Picture:
    phase = data["phase"].values
    sample = round(frame / FRAMES / float(phase[1] - phase[0]))
    return bearing_orbits(data, place, sample=sample)


def _multiplier(row: Row) -> str | None:
    """Its figures that finer steps confirm; of a result stored without them the first four."""
    size = row["multiplier_modulus"]
    error = row.get("multiplier_error", 5e-5 * size)
    return shared(size, error=error) if np.isfinite(size) else None


FLANKS = (
    *OF_STATE,
    Column("motion", "motion"),
    Column("mean force", "mean_mesh_force", ".0f", NEWTON),
    Column("greatest force", "greatest_mesh_force", ".0f", NEWTON),
    Column("over that at rest", "train_dynamic_factor", ".3f"),
    Column("contact losses per mesh period", "losses_per_period", ".2f"),
    Column("back-side impacts", "back_impacts_per_period", ".2f"),
    Column("largest multiplier", _multiplier),
)
RINGS = (
    *OF_STATE,
    Column("bearing", "bearing"),
    Column("mean force", "mean_bearing_force", ".0f", NEWTON),
    Column("greatest force", "greatest_bearing_force", ".0f", NEWTON),
)
PATHS = (
    Column("radial internal clearance", "clearance", ".1f", MICROMETRE),
    Column("carries load [% of time]", lambda row: PERCENT(row["bearing_contact_share"]), ".1f"),
    Column("contact losses per mesh period", "bearing_contact_losses", ".2f"),
)
PASSED = (
    Column("ball pass [order of the mesh]", "ball_pass_order", ".5f"),
    Column("its line", "ball_pass_line", ".3g", NEWTON),
)


OF_CAGES = (
    *OF_STATE,
    Column("cages on by, of a pitch", "cage", ".2f"),
    Column("motion", "cage_label"),
    Column("greatest force of the flanks", "cage_mesh_force", ".0f", NEWTON),
    Column("greatest on a bearing", "cage_bearing_force", ".0f", NEWTON),
)
CAGE_WORDS = (
    "The same with the cages elsewhere: 0 is as drawn. Cages that turn pass through all positions, "
    "so that what differs here is no property of the machine."
)


def _tables(data: Dataset) -> list[Table]:
    """Flanks and bearings in motion; of bearings stored without their paths the forces alone."""
    columns: tuple[Column, ...] = RINGS
    if "journal_path" in data:
        columns += PATHS
        data = data.assign(clearance=data["radial_internal_clearance"])
    if np.isfinite(data.get("ball_pass_order", np.nan)).any():
        columns += PASSED
    caption = "The bearings in motion; a clearance below zero is a preload, a spring has none."
    flanks = rows_along(labelled(data), "state", "operating")
    rings = rows_along(data, "state", "operating", "bearing")
    tables = [
        declared("Flanks of the drive train.", FLANKS, flanks, names=3),
        declared(caption, columns, rings, names=3),
    ]
    if "cage_label" in data:
        hardest = data.assign(cage_bearing_force=data["cage_bearing_force"].max("bearing"))
        cages = rows_along(hardest, "state", "operating", "cage")
        tables.append(declared(CAGE_WORDS, OF_CAGES, cages, names=3))
    return tables


def told(result: Result) -> list[Table]:
    """What the terminal tells of the drive train's motion."""
    data = result.group("train_motion")
    return [] if data is None else _tables(data)


# --- pictures -----------------------------------------------------------------------------------


HIGHEST = 12.0
MANY = 128
"""Sections from which their dots are small."""


def four_panels(data: Dataset, operating: int) -> Picture:
    """Mesh force over time and order, section, largest bearing lines of one operating point."""
    here = data.isel(operating=operating)
    phase = here["phase"].values
    teeth = Panel(Axis("time [mesh periods]"), Axis("force of the flanks [N]"), "Flanks")
    plane = Panel(
        Axis("approach along the drive flank [µm]"), Axis("its rate [mm/s]"), "Section, once a mesh"
    )
    states = names_of(here, "state")
    for s, state in enumerate(states):
        one = here.isel(state=s)
        colour = STATES.get(state, INK)
        teeth.curve(phase, one["mesh_force"].values, colour=colour, label=f"drive, {state}")
        if np.nanmax(one["back_force"].values, initial=0.0) > 0.0:
            teeth.curve(
                phase, -one["back_force"].values, colour=colour, dash=(3.0, 2.0),
                label=f"back, {state}",
            )  # fmt: skip
        places = one["section_deflection"].values
        many = np.isfinite(places).sum() > MANY
        plane.points(
            MICROMETRE(places),
            MILLIMETRE_PER_SECOND(one["section_rate"].values),
            colour=colour,
            open=s == 0 and not many,
            size=2.4 if many else 6.4 if s == 0 else 4.2,
            label=state,
        )
    order = here["line_order"].values
    mesh = _lines(here, order, here["mesh_force_line"].values, "line of the flanks' force [N]")
    mesh.title = "Lines of the drive flanks' force"
    felt = _lines(
        here, order, here["bearing_force_line"].values.max(axis=1), "line of bearing force [N]"
    )
    felt.title = "Largest line of any bearing"
    return Picture([[teeth, mesh], [plane, felt]], size=(WIDE, 6.6), legend=4)


def _lines(
    here: Dataset,
    order: Floats,
    amplitude: Floats,
    words: str,
    ends: tuple[float, float] | None = None,
) -> Panel:
    """A spectrum (state, order) over orders of the mesh frequency, up between its own ``ends``."""
    floor, top = ends or floor_of(amplitude, order=order, highest=HIGHEST)
    panel = over_orders(
        "order of the mesh frequency [–]", words, floor=floor, top=top, highest=HIGHEST
    )
    for s, state in enumerate(names_of(here, "state")):
        draw_lines(
            panel, order=order, amplitude=amplitude[s], colour=STATES.get(state, INK), label=state,
            filled=s > 0,
        )  # fmt: skip
    return panel


def sound(data: Dataset, operating: int) -> Picture:
    """Lines of the housing's acceleration at one operating point."""
    here = data.isel(operating=operating)
    order, lines = here["line_order"].values, here["housing_line"].values
    panel = _lines(here, order, lines, "acceleration of the housing [m/s²]")
    return Picture([[panel]], size=(WIDE, 3.4))


ACROSS = 4
"""Bearings side by side in the picture of their orbits."""
BESIDE = 2
"""Panels side by side in those of their forces."""
ROOM = 1.35
"""Half the width of a panel over the greatest displacement in it."""
ROUND = np.linspace(0.0, 2.0 * np.pi, 121)
DASH = (4.0, 3.0)
BETWEEN_SAMPLES = 4
"""Points of a drawn orbit for every sample."""


def bearing_orbits(data: Dataset, operating: int, *, sample: int = 0) -> Picture:
    """Every journal in its clearance, above to scale, below about its mean place alone [um].

    A dot below shows where it is at that ``sample`` of the record.
    """
    here = data.isel(operating=operating)
    rows: list[list[Panel]] = []
    places = range(here.sizes["bearing"])
    for first in range(0, len(places), ACROSS):
        some = places[first : first + ACROSS]
        rows.append([_in_clearance(here, b) for b in some])
        rows.append([_about_mean(here, b, sample) for b in some])
    wide = max(len(row) for row in rows)
    for row in rows:
        row.extend(empty(row[0]) for _ in range(wide - len(row)))
    each = (WIDE - LEFT - RIGHT - BETWEEN * (ACROSS - 1)) / ACROSS
    size = (
        LEFT + RIGHT + wide * each + BETWEEN * (wide - 1),
        TOP + BOTTOM + each * len(rows) + ABOVE * (len(rows) - 1),
    )
    return Picture(rows, size=size, legend=4)


def _axes(words: str, half: float) -> tuple[Axis, Axis]:
    """x and y of one scale, from -``half`` to ``half``."""
    x, y = (Axis(f"{c}{words} [µm]", low=-half, high=half, most=5) for c in "xy")
    return x, y


def _in_clearance(here: Dataset, bearing: int) -> Panel:
    """Clearance circles, orbits and the direction of the load of one bearing."""
    states = names_of(here, "state")
    path = MICROMETRE(here["journal_path"].values[:, bearing])
    free = 0.5 * MICROMETRE(here["radial_internal_clearance"].values[:, bearing])
    far = float(np.nanmax(np.hypot(path[:, 0], path[:, 1]), initial=0.0))
    most = max(far, float(np.nanmax(free, initial=0.0))) or 1.0
    panel = Panel(*_axes("", ROOM * most), names_of(here, "bearing")[bearing], equal=True)
    for s, state in enumerate(states):
        colour = STATES.get(state, INK)
        if free[s] > 0.0:
            panel.curve(
                free[s] * np.cos(ROUND), free[s] * np.sin(ROUND), colour=colour, width=1.1,
                dash=DASH, label=f"clearance, {state}",
            )  # fmt: skip
        x, y = _smooth(_once(path[s], here, s))
        panel.curve(x, y, colour=colour, width=1.4, label=f"journal, {state}")
    panel.points(
        [0.0], [0.0], colour=QUIET, marker="plus", size=4.0, label="centre of the outer ring"
    )
    _load(panel, here["mean_bearing_load"].values[-1, bearing], ROOM * most, states[-1])
    _said(panel, _bound(free, states), here["mean_bearing_load"].values[-1, bearing])
    return panel


def _bound(free: Floats, states: Sequence[str]) -> str:
    """What is said of a bearing without a free circle."""
    if np.isnan(free).all():
        return "a linear spring"
    return "\n".join(
        f"{state}: preload {-gap:.1f} µm"
        for gap, state in zip(free, states, strict=True)
        if gap < 0.0
    )


def _said(panel: Panel, words: str, load: Floats) -> None:
    """``words`` at the rim that the journal is pushed to, where no arrow is."""
    low = bool(load[1] <= 0.0)
    if words:
        panel.text(
            0.03, 0.015 if low else 0.985, words, at="panel", across="left",
            up="bottom" if low else "top", size=7.4, colour=QUIET,
        )  # fmt: skip


def _once(path: Floats, here: Dataset, state: int) -> Floats:
    """The part of ``path`` (2, sample) after which it comes again, closed; else all of it."""
    phase, name = here["phase"].values, str(here["label"].values[state])
    number = name.removeprefix("period-")
    if name == number or int(here.attrs.get("cycle", 1)) > 1:
        return path
    count = int(number) * round(1.0 / float(phase[1] - phase[0]))
    return path if count > phase.size else path[:, [*range(count), 0]]


def _smooth(path: Floats) -> Floats:
    """``path`` (2, sample) with cubics between the samples, sloped as their neighbours lie."""
    slope = np.gradient(path, axis=1)
    t = np.arange(BETWEEN_SAMPLES) / BETWEEN_SAMPLES
    one, other = path[:, :-1, None], path[:, 1:, None]
    rise, fall = slope[:, :-1, None], slope[:, 1:, None]
    found = (
        one * (1.0 + 2.0 * t) * (1.0 - t) ** 2 + other * t**2 * (3.0 - 2.0 * t)
        + rise * t * (1.0 - t) ** 2 - fall * t**2 * (1.0 - t)
    ).reshape(2, -1)  # fmt: skip
    return np.hstack([found, path[:, -1:]])


def _load(panel: Panel, load: Floats, half: float, state: str) -> None:
    """An arrow from the rim towards the centre, the way the journal is pushed, and its force."""
    size = float(np.hypot(*load))
    if not size > 0.0:
        return
    way = load / size
    tail, tip = -0.92 * half * way, -0.62 * half * way
    panel.curve(
        [tail[0], tip[0]], [tail[1], tip[1]], colour=INK, width=1.4, label=f"mean load, {state}"
    )
    _head(panel, tip, way, 0.1 * half, INK)
    low, left = bool(tail[1] < 0.0), bool(tail[0] > 0.0)
    panel.text(
        0.03 if left else 0.97, 0.015 if low else 0.985, f"{number(size)} N", at="panel",
        across="left" if left else "right", up="bottom" if low else "top", size=8.0,
    )  # fmt: skip


def _head(panel: Panel, tip: Floats, way: Floats, size: float, colour: str) -> None:
    """Both barbs of an arrow that ends at ``tip`` and points along ``way``."""
    side = np.array([-way[1], way[0]])
    barbs = [tip - size * (way + 0.5 * side), tip, tip - size * (way - 0.5 * side)]
    x, y = np.transpose(barbs)
    panel.curve(x, y, colour=colour, width=1.4)


def _about_mean(here: Dataset, bearing: int, sample: int) -> Panel:
    """The orbits alone, each less its mean place; a dot at ``sample``, an arrow along the way."""
    path = MICROMETRE(here["journal_path"].values[:, bearing])
    path = path - path.mean(axis=2, keepdims=True)
    far = float(np.nanmax(np.hypot(path[:, 0], path[:, 1]), initial=0.0))
    half = 1.2 * far or 1.0
    panel = Panel(*_axes(" − mean", half), equal=True)
    for s, state in enumerate(names_of(here, "state")):
        colour = STATES.get(state, INK)
        if not np.isfinite(path[s]).all():
            continue
        x, y = _smooth(_once(path[s], here, s))
        panel.curve(x, y, colour=colour, width=1.1)
        now = path[s, :, sample]
        panel.points(
            [now[0]], [now[1]], colour=colour, size=5.5, edge="white", edge_width=0.6, order=3.0
        )
        steps = np.diff([x, y], axis=1)
        longs = np.hypot(*steps)
        fast = int(longs.argmax())
        if longs[fast] > 0.0:
            tip = np.array([x[fast + 1], y[fast + 1]])
            _head(panel, tip, steps[:, fast] / longs[fast], 0.12 * half, colour)
    return panel


def bearing_force_time(data: Dataset, operating: int) -> Picture:
    """Amount of the force on every bearing over the mesh periods, undeformed and hot."""
    here = data.isel(operating=operating)
    phase, force = here["phase"].values, here["bearing_force"].values
    panels = []
    for b, name in enumerate(names_of(here, "bearing")):
        panel = Panel(Axis("time [mesh periods]"), Axis("force on the bearing [N]"), name)
        for s, state in enumerate(names_of(here, "state")):
            colour = STATES.get(state, INK)
            panel.curve(phase, force[s, b], colour=colour, label=state)
            mean = float(here["mean_bearing_force"].values[s, b])
            if np.isfinite(mean):
                panel.line(
                    y=mean,
                    colour=colour,
                    width=0.9,
                    dash=DASH,
                    label=f"amount of the mean, {state}",
                )
        panels.append(panel)
    rows = in_rows(panels, BESIDE)
    return Picture(rows, size=(WIDE, 2.4 * len(rows) + 0.3), legend=4)


def bearing_force_order(data: Dataset, operating: int) -> Picture:
    """Lines of the force on every bearing over orders of the mesh frequency."""
    here = data.isel(operating=operating)
    order, lines = here["line_order"].values, here["bearing_force_line"].values
    ends = floor_of(lines, order=order, highest=HIGHEST)
    panels = []
    for b, name in enumerate(names_of(here, "bearing")):
        panel = _lines(here, order, lines[:, b], "line of the force [N]", ends)
        panel.title = name
        own = float(here["ball_pass_order"].values[b]) if "ball_pass_order" in here else np.nan
        if np.isfinite(own):
            panel.title = f"{name}, ball pass at {own:.4f}"
            for m in (1, 2):
                panel.line(x=m * own, colour=INK, width=0.8, dash=(5, 2, 1, 2), order=0.5)
        panels.append(panel)
    rows = in_rows(panels, BESIDE)
    return Picture(rows, size=(WIDE, 2.6 * len(rows) + 0.3), legend=4)


def turning(data: Dataset, operating: int) -> list[int]:
    """Places of the states whose motion at this operating point lies on a torus."""
    found = data["label"].values[:, operating]
    return [s for s, name in enumerate(found) if str(name) == "quasi-periodic"]


def torus_section(data: Dataset, operating: int) -> Picture:
    """Sections of a quasi-periodic motion on their closed curves."""
    here = data.isel(operating=operating)
    mesh = float(here["mesh_frequency"])
    panels = []
    for s in turning(data, operating):
        one = here.isel(state=s)
        second, state = float(one["second_frequency"]) * mesh, names_of(here, "state")[s]
        panel = Panel(
            Axis("approach along the drive flank [µm]", margin=0.1),
            Axis("its rate [mm/s]", margin=0.1),
            f"{state}: mesh {mesh:.1f} Hz, second base frequency {second:.1f} Hz",
        )
        panel.points(
            MICROMETRE(one["section_deflection"].values),
            MILLIMETRE_PER_SECOND(one["section_rate"].values),
            colour=STATES.get(state, INK), size=4.5,
        )  # fmt: skip
        panel.curve(
            MICROMETRE(one["torus_deflection"].values),
            MILLIMETRE_PER_SECOND(one["torus_rate"].values),
            colour=INK, width=0.8, order=2.5, label="closed curve through the sections",
        )  # fmt: skip
        panels.append(panel)
    return Picture([panels], size=(WIDE if len(panels) > 1 else 6.4, 4.0))
