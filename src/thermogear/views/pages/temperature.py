"""The page of the closed loop of friction and heat over speed and torque."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.display import CELSIUS, KELVIN, MICROMETRE, PERCENT, SPEED, exactly
from thermogear.base.vocabulary import STATUS, is_known
from thermogear.results.result import Result
from thermogear.views.columns import Column, by_name, declared, key, reaches, rows_along, units
from thermogear.views.page import Page, Shown, Table
from thermogear.views.pages import survey_captions as words
from thermogear.views.pages.survey import OPERATING, survey
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import INK, OKABE_ITO, WIDE, names_of, scale
from thermogear.views.tables import is_settled
from thermogear.views.typesetting import jam_at

KINDS = ("temperature",)


def page(result: Result) -> Page:
    """The closed loop over speed and torque."""
    data = _with_nodes(result.groups["map"])
    pictures = []
    over = words.running(data)
    if over:
        pictures.append(
            Shown(
                "map",
                f"Everything hot over {' and '.join(over)}",
                words.thermal_map(data, SAFE),
                partial(thermal_map, data),
                wide=True,
            )
        )
    told = [reaches("Over all operating points.", REACH, data)]
    status = data["status"].values
    count = {word: int((status == place).sum()) for place, word in enumerate(STATUS)}
    summary = (
        f"{words.several(status.size, 'operating point')} of the closed loop of friction and heat "
        f"in {float(result.text('seconds')):.2f} s: "
        + ", ".join(f"{n} {word.replace('_', ' ')}" for word, n in count.items() if n)
        + f". Iterations at most {int(data['iterations'].max())}."
    )
    return survey(
        result,
        summary,
        pictures,
        [_corner_table(data), *told],
        numbers=lambda: {
            "seconds": float(result.text("seconds")),
            "points": status.size,
            **by_name(data, IN_JSON),
            "units": units(IN_JSON, data),
        },
        told=told,
    )


REACH = (
    Column("teeth", lambda data: np.stack([data["pinion_tooth"], data["wheel_tooth"]]), 3, CELSIUS),
    Column("greatest flash temperature", "greatest_flash", 3, KELVIN, "greatest_flash"),
    Column("least half backlash", "least_half_backlash"),
    Column("scuffing margin", "scuffing_margin", 3, KELVIN, "scuffing_margin"),
    Column("least film parameter", "least_film_parameter", key="least_film_parameter"),
    Column("mean friction coefficient", "mean_friction", key="mean_friction"),
)
IN_JSON = (
    *OPERATING,
    key("status"),
    key("iterations"),
    key("pinion_tooth_K", "pinion_tooth"),
    key("oil_K", "oil"),
    key("least_half_backlash"),
    key("residual"),
    *REACH,
)


POINT = (Column("speed", "pinion_speed", exactly), Column("torque", "pinion_torque", exactly))
CORNERS = (
    *POINT,
    Column("status", lambda row: row["status"].replace("_", " ")),
    Column("oil", "oil", 3, CELSIUS),
    Column("pinion teeth", "pinion_tooth", 3, CELSIUS),
    Column("wheel teeth", "wheel_tooth", 3, CELSIUS),
    Column("housing", "housing", 3, CELSIUS),
    Column("flash", "greatest_flash", 3, KELVIN),
    Column("Λ least", "least_film_parameter"),
    Column("b′ least", "least_half_backlash"),
    Column("scuffing margin", "scuffing_margin", 3, KELVIN),
    Column("iterations", "iterations"),
    Column(
        "residual",
        lambda row: row["residual"] if is_settled(row) else None,
        2,
        KELVIN,
    ),
)


def _with_nodes(data: Dataset) -> Dataset:
    """The same with the temperature of every node as a variable."""
    names = names_of(data, "node")
    return data.assign({n: data["node_temperature"].sel(node=n, drop=True) for n in names})


def _at_corners(data: Dataset) -> list[dict[str, Any]]:
    """Corners and middle of the grid."""
    chosen = {
        name: sorted({0, data.sizes[name] // 2, data.sizes[name] - 1})
        for name in ("pinion_speed", "pinion_torque")
    }
    return rows_along(data.isel(chosen), *chosen)


def _corner_table(data: Dataset) -> Table:
    caption = ("The operating point.", "Ends and middle.", "Corners and middle of the map.")
    return declared(caption[len(words.running(data))], CORNERS, _at_corners(data), names=3)


# --- pictures -----------------------------------------------------------------------------------


AXES = ("pinion speed [rpm]", "pinion torque [N m]")
SAFE = 50.0
"""Scuffing margin [K] that is advised at least."""


def thermal_map(data: Dataset) -> Picture:
    """Regime, flash, body temperature, backlash left, scuffing margin and friction: six maps.

    Points without a steady state are white; where the oil leaves its viscosity line the map is
    hatched. Where only one of speed and torque runs there are six lines over it instead.
    """
    settled = is_known(data["status"].values)

    def kept(values: Floats) -> Floats:
        return np.where(settled, values, np.nan)

    share = kept(PERCENT(data["regime_share"].isel(regime_name=0).values))
    boundary = _panel(data, share, "boundary lubrication [% of path]", "Reds", (0, 100))
    film = kept(data["least_film_parameter"].values)
    levels = _nice(film, 3)
    _lines(boundary, data, film, levels, [f"Λ = {level:.2g}" for level in levels])
    greatest = kept(data["greatest_flash"].values)
    flash = _panel(data, greatest, "greatest flash temperature [K]", "YlOrRd")
    teeth = kept(CELSIUS(data["node_temperature"].sel(node="pinion_tooth").values))
    body = _panel(data, teeth, "pinion teeth, body temperature [°C]", "YlOrRd")
    tempering = np.where(data["tempered"].values == 1, 1.0, 0.0)
    if 0.0 < tempering.mean() < 1.0:
        _lines(body, data, tempering, [0.5], ["tempered"])
    gap = kept(MICROMETRE(data["least_half_backlash"].values))
    left = _panel(data, gap, "half backlash left [µm]", "viridis")
    if min(gap.shape) > 1:
        _jam(left, data, gap)
    values, words = kept(data["scuffing_margin"].values), "scuffing margin [K]"
    if np.isfinite(values).any() or not settled.any():
        # red is always below 0 K and the deepest green the greatest margin
        known = values[np.isfinite(values)]
        ends = (float(np.min(known, initial=-SAFE)), float(np.max(known, initial=2.0 * SAFE)))
        margin = _panel(data, values, words, "RdYlGn", ends)
        if min(values.shape) < 2:
            for level in (0.0, SAFE):
                margin.line(y=level, colour=INK, width=0.9, dash=(2, 2))
        _lines(margin, data, values, [0.0, SAFE], ["0 K", f"{SAFE:.0f} K"])
    else:
        why = "no scuffing margin: the load stage of the oil is not known"
        margin = _panel(data, values, words, "RdYlGn", empty=why)
    mean = kept(data["mean_friction"].values)
    friction = _panel(data, mean, "mean friction coefficient [–]", "PuBu")
    panels = [[boundary, flash, body], [left, margin, friction]]
    outside = (data["within_oil_range"].values == 0) & settled
    if outside.any() and min(outside.shape) > 1:
        for panel in (*panels[0], *panels[1]):
            panel.hatch(*_grid(data), outside.T)
    return Picture(panels, size=(WIDE, 6.6), between=0.96, above=0.95, right=0.5)


def _grid(data: Dataset) -> tuple[Floats, Floats]:
    return SPEED(data["pinion_speed"].values), data["pinion_torque"].values


def _panel(
    data: Dataset,
    values: Floats,
    title: str,
    colours: str,
    ends: tuple[float, float] | None = None,
    empty: str = "no point has a steady state",
) -> Panel:
    """Filled contours over speed and torque; a grid of one line is drawn as that line.

    Without a value the axes stand as in the other panels, with the words ``empty``.
    """
    speed, torque = _grid(data)
    line = min(values.shape) < 2
    along, words = (speed, AXES[0]) if speed.size >= torque.size else (torque, AXES[1])
    panel = Panel(Axis(words), Axis(title)) if line else Panel(Axis(AXES[0]), Axis(AXES[1]), title)
    if not np.isfinite(values).any():
        panel.note(empty)
        for axis, of in ((panel.x, along),) if line else ((panel.x, speed), (panel.y, torque)):
            axis.low, axis.high = float(of.min()), float(of.max())
    elif line:
        panel.curve(along, values.ravel(), marker="circle", size=3.5, colour=OKABE_ITO[1])
    else:
        low, high = ends or (float(np.nanmin(values)), float(np.nanmax(values)))
        if high - low < 1e-9 * max(abs(high), 1e-12):
            high = low + max(abs(low), 1.0) * 1e-3
        levels = np.linspace(low, high, 13)
        panel.field(speed, torque, values.T, levels=levels, colours=scale(colours), words=title)
    return panel


def _nice(values: Floats, count: int) -> list[float]:
    """A few levels in geometric steps that lie inside ``values``."""
    known = values[np.isfinite(values) & (values > 0.0)]
    if not known.size or known.max() <= 1.02 * known.min():
        return []
    steps = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
    inside = [s for s in steps if known.min() < s < known.max()]
    return inside[-count:]


def _lines(
    panel: Panel, data: Dataset, values: Floats, levels: Sequence[float], words: Sequence[str]
) -> None:
    """Named contour lines, where they exist."""
    known = values[np.isfinite(values)]
    inside = {
        level: name
        for level, name in zip(levels, words, strict=True)
        if known.size and known.min() < level < known.max()
    }
    if inside and min(values.shape) > 1:
        panel.contours(*_grid(data), values.T, levels=list(inside), words=list(inside.values()))


def _jam(panel: Panel, data: Dataset, left: Floats) -> None:
    """The border where the backlash is used up, or that there is none."""
    known = left[np.isfinite(left)]
    if known.size and known.min() <= 0.0:
        _lines(panel, data, left, [0.0], ["jam"])
        return
    jam = data["jam_temperature"].values
    finite = jam[np.isfinite(jam) & np.isfinite(left)]
    words = "no point jams"
    if finite.size:
        words += f"; pinion teeth\nwould at {jam_at(float(finite.min()))}, housing as it is"
    panel.text(0.03, 0.04, words, at="panel", across="left", up="baseline", size=7.5, box=True)
