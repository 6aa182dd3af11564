"""Pictures of diagrams, maps, basins, sweeps and run-ups, from their stored datasets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.display import CELSIUS, KILONEWTON, MICROMETRE, PERCENT, Display
from thermogear.base.vocabulary import ASSUMED, STATUS, of_turn
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.parameters import axis_words, shown
from thermogear.views.plots.spectrum import MESH_ORDERS, SHAFT_ORDERS, shaft_orders
from thermogear.views.style import (
    COLD,
    FAINT,
    HOT,
    INK,
    MIXED,
    OKABE_ITO,
    QUIET,
    WIDE,
    scale,
)

Rows = Sequence[Mapping[str, Any]]
DIVERGED = STATUS.index("diverged")

CLASSES = (
    ("period 1", "#0072B2"),
    ("period 2", "#56B4E9"),
    ("period 3", "#009E73"),
    ("period 4", "#B3DE69"),
    ("period 5", "#CC79A7"),
    ("period 6", "#F0E442"),
    ("period 7, 8", "#E69F00"),
    ("longer", "#8a5a2b"),
    ("chaotic, estimate", "#D55E00"),
    ("undecided", "#999999"),
    ("diverged", "#22303c"),
    ("jammed", "#ffffff"),
    ("not converged", "#e4e4e4"),
    ("heat not settled", "#f6dcd2"),
    ("impossible", "#d9e2ea"),
)
KINDS = ("fold", "period doubling", "grazing", "period halving", "pitchfork", "torus")
DRAWN = ("fold", "period doubling", "pitchfork", "torus")
MARKS = ("square", "diamond", "upright", "thin diamond", "plus", "circle")


def classes_of(data: Dataset) -> NDArray[np.int64]:
    """Numbers into :data:`CLASSES` from stored label and period."""
    label, period = data["label"].values, data["period"].values
    periodic = label == 1
    long, longer = periodic & (period > 6), periodic & (period > 8)
    return np.select(
        [label > 3, label == 3, label == 2, longer, long, periodic],
        [label.astype(np.int64) + 7, 10, 8, 7, 6, np.clip(period, 1, 6) - 1],
        default=9,
    )


def class_words(data: Dataset) -> list[str]:
    """The names of :data:`CLASSES`, with periods of a turn where that is what repeats itself."""
    turn = of_turn(data.attrs.get("mesh_periods", 1))
    return [name + turn * name.startswith("period") for name, _ in CLASSES]


def edges(values: Floats) -> Floats:
    """Cell borders about sample places."""
    if values.size == 1:
        half = 0.5 * max(abs(float(values[0])), 1.0) * 1e-3
        return np.array([values[0] - half, values[0] + half])
    middle = 0.5 * (values[1:] + values[:-1])
    return np.concatenate(
        [[values[0] - (middle[0] - values[0])], middle, [2 * values[-1] - middle[-1]]]
    )


FEW = 24
"""Up to so many values the sections are drawn as large dots."""


def _dot(values: Floats) -> str:
    """The marker of a line: a line of one value would not be seen."""
    return "circle" if values.size == 1 else ""


def _parameter(data: Dataset) -> str:
    return str(data.attrs["parameter"])


def _along(data: Dataset, name: str) -> Axis:
    return Axis(axis_words(name, data[name]))


def orbit_diagram_picture(data: Dataset) -> Picture:
    """Sections over the parameter, up and down, with branches and bifurcations; exponent below."""
    name = _parameter(data)
    top = Panel(Axis(), Axis("X at phase 0 [–]"))
    low = Panel(_along(data, name), Axis("exponent λ₁ [–]"))
    ways = ((COLD, "up", ()), (HOT, "down", (3, 2)))
    for direction, (colour, word, dash) in enumerate(ways):
        here = data.isel(direction=direction)
        _sections(top, low, here, colour=colour, label=word, opacity=0.8, dash=dash)
    _branches(top, data, name)
    return _above_exponent(top, low)


def _sections(
    top: Panel, low: Panel, data: Dataset, *, colour: str, label: str, opacity: float,
    dash: tuple[float, ...] = (),
) -> None:  # fmt: skip
    """Sections into ``top`` and exponents into ``low``, those of all starts and ways alike."""
    name = _parameter(data)
    p = shown(name, data[name])
    x = data["section_x"].values
    top.points(
        np.broadcast_to(p[:, None], x.shape).ravel(), x.ravel(), colour=colour, marker="dot",
        edge_width=0.0, opacity=opacity, size=1.6 if p.size > FEW else 8.0, pixels=True,
    )  # fmt: skip
    top.points([], [], marker="dot", colour=colour, label=label)
    for row in data["lyapunov"].values.reshape(-1, p.size):
        low.curve(p, row, colour=colour, dash=dash, width=0.8, marker=_dot(p))


def _above_exponent(top: Panel, low: Panel) -> Picture:
    low.line(y=0.0, colour=INK, width=0.8)
    return Picture(
        [[top], [low]], size=(WIDE, 6.0), share_x="column", above=0.15, heights=(3, 1), legend=6
    )


def over_each_other(each: Sequence[Dataset], states: Sequence[str]) -> Picture:
    """Orbit diagrams over each other, a colour for each state, up and down alike."""
    name = _parameter(each[0])
    top = Panel(Axis(), Axis("X at phase 0 [–]"))
    low = Panel(_along(each[0], name), Axis("exponent λ₁ [–]"))
    for here, words, colour in zip(each, states, (COLD, HOT, MIXED), strict=False):
        _sections(top, low, here, colour=colour, label=words, opacity=0.5)
        _branches(top, here, name, colour)
    return _above_exponent(top, low)


def _branches(panel: Panel, data: Dataset, name: str, colour: str = "") -> None:
    """Branches with their bifurcations; those of an overlay in the ``colour`` of their state."""
    if "branch_value" not in data:
        return
    value, x = shown(name, data["branch_value"]), data["branch_x"].values
    stable = data["branch_multiplier"].values < 1.0
    looks: tuple[tuple[NDArray[np.bool_], str, tuple[float, ...], str], ...] = (
        (stable, colour or INK, (), "stable branch"),
        (~stable, colour or QUIET, (4, 2), "unstable branch"),
    )  # fmt: skip
    for kept, ink, dash, words in looks:
        for row in range(value.shape[0]):
            along = np.where(kept[row], value[row], np.nan)
            panel.curve(along, x[row], colour=ink, width=0.7, dash=dash, order=3)
        if (kept & np.isfinite(value)).any():
            panel.curve([], [], colour=INK if colour else ink, width=0.9, dash=dash, label=words)
    at = shown(name, data["bifurcation_value"])
    for kind in map(KINDS.index, DRAWN):
        chosen = data["bifurcation_kind"].values == kind
        if chosen.any():
            up = data["bifurcation_x"].values[chosen]
            panel.points(
                at[chosen], up, marker=MARKS[kind], colour=colour or OKABE_ITO[3], size=4,
                label=KINDS[kind], order=4,
            )  # fmt: skip


def hatch_assumed(panel: Panel, data: Dataset) -> None:
    """Hatch the cells of a map over two parameters that were not computed."""
    assumed = data["status"].values.T == ASSUMED
    if assumed.any():
        # a hatch runs between places: each cell is given at both its borders
        across, up = (
            np.repeat(edges(shown(str(n), data[n])), 2)[1:-1] for n in data["label"].dims[-2:]
        )
        panel.hatch(across, up, np.repeat(np.repeat(assumed, 2, axis=0), 2, axis=1))


def _over_two(data: Dataset) -> tuple[Panel, tuple[Floats, Floats]]:
    """An empty panel over the first two axes of a grid, and the borders of its cells."""
    one, two = (str(name) for name in data["label"].dims[:2])
    borders = edges(shown(one, data[one])), edges(shown(two, data[two]))
    return Panel(_along(data, one), _along(data, two)), borders


def regimes(data: Dataset) -> Panel:
    panel, borders = _over_two(data)
    colours = [colour for _, colour in CLASSES]
    panel.field(*borders, classes_of(data).T, colours=colours, classes=class_words(data))
    hatch_assumed(panel, data)
    return panel


def basins_picture(data: Dataset) -> Picture:
    """Which attractor each start ends on, with the attractors' sections."""
    x, y = edges(data["x"].values), edges(data["v"].values)
    panel = Panel(
        Axis("displacement X at phase 0 [–]", low=x[0], high=x[-1]),
        Axis("velocity X′ at phase 0 [–]", low=y[0], high=y[-1]),
    )
    shades, names = scale("tab20"), []
    colours = [shades[n % 20] for n in range(data.sizes["attractor_number"])]
    for n in range(len(colours)):
        period = int(data["attractor_period"].values[n])
        kind = f"period {period}" if period else "chaotic, estimate"
        names.append(f"{kind}: {PERCENT(float(data['fraction'].values[n])):.3g} %")
    none = np.where(data["status"].values == DIVERGED, 0, 1)
    codes = np.where(np.isnan(data["attractor"].values), none, data["attractor"].values + 2)
    panel.field(
        x, y, codes.T, colours=[INK, "#bbbbbb", *colours],
        classes=["diverged", "undecided", *names],
    )  # fmt: skip
    for n, colour in enumerate(colours):
        at = data["attractor_x"].values[n], data["attractor_v"].values[n]
        panel.points(*at, colour=colour, edge="white", size=5, order=3, label=names[n])
    return Picture([[panel]], size=(7.4, 7.4), legend=4)


def _state_words(data: Dataset, state: int) -> str:
    return f"{CELSIUS(float(data['gear_temperature'].values[state])):.4g} °C"


def run_up_picture(data: Dataset) -> Picture:
    """Transmission error, mesh force and dynamic factor over speed, up and down, by state.

    Of a case in series the band of its parts behind the dynamic factor, and below who parts.
    """
    n = shown("pinion_speed", data["pinion_speed"])
    count = data.sizes["state"]
    colours = [COLD, HOT, *OKABE_ITO[2:]]
    panels = []
    for name, words, factor in (
        ("dte_peak_to_peak", "transmission error, p-p [µm]", MICROMETRE),
        ("mesh_force_max", "greatest mesh force [kN]", KILONEWTON),
        ("dynamic_factor", "dynamic factor $K_{v}$ [–]", Display("–")),
    ):
        panel = Panel(Axis(), Axis(words))
        for state in range(count):
            colour = colours[state % len(colours)]
            for direction, (dash, word) in enumerate((((), "up"), ((3, 2), "down"))):
                panel.curve(
                    n, factor(data[name].values[state, direction]), colour=colour, dash=dash,
                    width=1.2, marker=_dot(n), label=f"{_state_words(data, state)} {word}",
                )  # fmt: skip
            if "bifurcation_kind" in data:
                fold = (data["bifurcation_kind"].values == 0) & (
                    data["bifurcation_state"].values == state
                )
                for value in shown("pinion_speed", data["bifurcation_value"][fold]):
                    panel.line(x=float(value), colour=colour, width=0.7, opacity=0.6)
        panels.append([panel])
    if "series_parting_share" in data:
        panels.append([_series(panels[-1][0], data, n, colours)])
    panels[-1][0].x = _along(data, "pinion_speed")
    size = WIDE, 8.0 * len(panels) / 3
    return Picture(panels, size=size, above=0.15, share_x="column", legend=4)


def _series(factor: Panel, data: Dataset, n: Floats, colours: Sequence[str]) -> Panel:
    """The panel of who parts; the band of the parts of a series is put behind the ``factor``.

    At the first damping; dotted the second, the least one.
    """
    parting = Panel(Axis(), Axis("pairs that part [%]", low=0.0))
    dampings = data["damping_ratio"].values
    for state in range(data.sizes["state"]):
        colour, words = colours[state % len(colours)], _state_words(data, state)
        low, middle, bad, high = data["series_dynamic_factor"].values[state]
        share = PERCENT(data["series_parting_share"].values[state])
        factor.band(
            n, low=low[0], high=high[0], colour=colour, opacity=0.15, label=f"{words} 90 % of pairs"
        )
        factor.curve(
            n, middle[0], colour=colour, width=0.8, dash=(6, 2), label=f"{words} median pair"
        )
        parting.curve(n, share[0], colour=colour, width=1.2)
        if dampings.size > 1:
            factor.curve(
                n, bad[1], colour=colour, dash=(1, 2), width=1.2,
                label=f"{words} one in ten, damping {dampings[1]:.2g}",
            )  # fmt: skip
            parting.curve(n, share[1], colour=colour, dash=(1, 2), width=1.2)
    return parting


def waterfall_picture(data: Dataset) -> Picture:
    """Lines of the transmission error over speed and order, running up, one panel a state.

    Over a turn the orders of the mesh with their side lines, and below those of the slower shaft
    that fills it.
    """
    speeds = edges(shown("pinion_speed", data["pinion_speed"]))
    lines = MICROMETRE(data["dte_line"].values[:, 0])
    known = lines[np.isfinite(lines) & (lines > 0.0)]
    top = float(known.max()) if known.size else 1.0
    lines = np.clip(np.nan_to_num(lines, nan=1e-4 * top), 1e-4 * top, None)
    rows = []
    for words, factor, highest in _order_axes(data):
        kept = data["order"].values * factor <= highest
        # a row of the picture shows the greatest of the lines in it
        first = np.arange(0, kept.sum(), -(-int(kept.sum()) // ROWS))
        order = edges(data["order"].values[kept] * factor)[[*first, -1]]
        row = []
        for state in range(data.sizes["state"]):
            panel = Panel(_along(data, "pinion_speed"), Axis(), _state_words(data, state))
            panel.field(
                speeds, order, np.maximum.reduceat(lines[state][:, kept], first, axis=1).T,
                low=1e-4 * top, high=top, log=True, colours=scale("magma"),
                words="line of the transmission error [µm]",
            )  # fmt: skip
            row.append(panel)
        row[0].y.words = words
        rows.append(row)
    return Picture(rows, size=(WIDE, 4.2 * len(rows)), share_y="row")


ROWS = 400
"""Rows of a field of lines."""


def _order_axes(data: Dataset) -> list[tuple[str, float, float]]:
    """Words, orders for one of the mesh and highest order of each row of a waterfall."""
    mesh = "order of the mesh frequency [–]"
    of = int(data.attrs.get("mesh_periods", 1))
    if of == 1:
        return [(mesh, 1.0, np.inf)]
    words, factor = shaft_orders(data)
    return [(mesh, 1.0, MESH_ORDERS), (words, factor, SHAFT_ORDERS)]


def sweep_picture(data: Dataset) -> Picture:
    """Dynamic factor and regime over the first one or two axes of a sweep.

    Of a case in series its median and band too, over two axes the factor that one part in ten
    exceeds.
    """
    dims = [str(d) for d in data["label"].dims]
    here = data.isel(dict.fromkeys(dims[2:], 0))
    error, factor = "transmission error, p-p [µm]", "dynamic factor $K_{v}$ [–]"
    series = "series_parts" in here
    if len(dims) == 1:
        p = shown(dims[0], here[dims[0]].values)
        static = [("static_error", "static error, p-p [µm]", MICROMETRE)] * series
        panels = []
        for name, words, unit in (
            ("dte_peak_to_peak", error, MICROMETRE), ("dynamic_factor", factor, Display("–")),
            *static,
        ):  # fmt: skip
            panel = Panel(Axis(), Axis(words))
            panel.curve(p, unit(here[name].values), colour=COLD, marker=_dot(p), label="one pair")
            if series and f"series_{name}_low" in here:
                low, middle, high = (
                    unit(here[f"series_{name}_{which}"].values)
                    for which in ("low", "median", "high")
                )
                panel.band(p, low=low, high=high, colour=INK, opacity=0.15, label="90 % of pairs")
                panel.curve(p, middle, colour=INK, dash=(6, 2), marker=_dot(p), label="median pair")
            panels.append([panel])
        panels[-1][0].x = _along(here, dims[0])
        return Picture(panels, size=(WIDE, 2.7 * len(panels)), above=0.15, share_x="column")
    name = "series_dynamic_factor_bad" if series else "dynamic_factor"
    panel, borders = _over_two(here)
    panel.background = FAINT
    panel.field(
        *borders, here[name].values.T, colours=scale("viridis"),
        words="dynamic factor that one pair in ten exceeds [–]" if series else factor,
    )  # fmt: skip
    return Picture([[regimes(here), panel]], size=(WIDE, 4.6), legend=6)
