"""Rows of the dimensionless equation: history, phase plane and section, spectrum, half order."""

from __future__ import annotations

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import CELSIUS
from thermogear.base.vocabulary import QUANTITIES
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.motion import HISTORY, label_of, periods_to_draw, thinned
from thermogear.views.plots.spectrum import draw_lines, floor_of, over_orders
from thermogear.views.style import COLD, FAINT, HOT, INK
from thermogear.views.typesetting import math_symbol, plain

HIGHEST_ORDER = 4.0
DENSE = 6000
"""Curves of more points than this are stored as pixels inside the picture."""
MOST_COLUMNS = 6
"""A row longer than this is thinned: ends stay."""

NAMES = {"frequency": "frequency_ratio", "thermal_stiffness": "thermal_stiffness_ratio",
         "half_backlash": "half_backlash_ratio"}  # fmt: skip
"""Parameters of a case file whose stored name differs."""


def row_names(points: Dataset) -> list[str]:
    """The rows in the order in which they are stored."""
    return list(dict.fromkeys(str(name) for name in points["row"].values))


def of_row(points: Dataset, row: str) -> Dataset:
    """The points of one row."""
    return points.isel(point=np.flatnonzero(points["row"].values.astype(str) == row))


def value_text(one: Dataset) -> str:
    """The swept parameter of one point with its value, for a title or a table."""
    symbol, value, unit = value_parts(one)
    return f"{math_symbol(symbol)} = {value}{unit}"


def value_parts(one: Dataset) -> tuple[str, str, str]:
    """(symbol, value, unit with a space) of the swept parameter."""
    parameter, value = str(one["parameter"].item()), float(one["value"])
    if _is_temperature(one):
        return "T", f"{float(CELSIUS(value)):.4g}", " °C"
    name = NAMES.get(parameter, parameter)
    symbol = QUANTITIES[name].symbol if name in QUANTITIES else plain(parameter)
    return symbol, f"{value:.4g}".replace("-", "−"), ""


def _is_temperature(data: Dataset) -> bool:
    return str(np.ravel(data["parameter"].values)[0]) == "temperature"


def panels(points: Dataset, row: str) -> Picture:
    """One row: time history, orbit with its Poincare section, and spectrum of every point."""
    data = of_row(points, row)
    count = data.sizes["point"]
    kept = sorted({round(i) for i in np.linspace(0, count - 1, min(count, MOST_COLUMNS))})
    width = max(4.9, (2.5 if len(kept) < 5 else 2.2) * len(kept))
    order = data["order"].values
    floor, top = floor_of(data["line_amplitude"].values, order=order, highest=HIGHEST_ORDER)
    first: list[Panel] = []
    above, below = [], []
    for column, place in enumerate(kept):
        one = data.isel(point=place)
        speed, height = ("velocity ", "amplitude ") if column == 0 else ("", "")
        history = Panel(
            Axis("time [mesh periods]", most=4, small=True, margin=0.01),
            Axis("displacement X [–]" if column == 0 else "X [–]", most=4, small=True),
            f"{value_text(one)}\n{label_of(one)}",
        )
        upper = Panel(
            Axis("displacement X [–]", most=4, small=True),
            Axis(f"{speed}Ẋ [–]", most=4, small=True),
        )
        lower = over_orders(
            "mesh order [–]", f"{height}|X| [–]", floor=floor, top=top, highest=HIGHEST_ORDER
        )
        lower.x.small = lower.y.small = True
        if np.isfinite(one["scaled_displacement"].values).all():
            _history(history, one)
            _orbit(upper, one)
            amplitude = one["line_amplitude"].values
            draw_lines(lower, order=order, amplitude=amplitude, colour=INK, label="")
        else:
            history.note(label_of(one))
            upper.note(label_of(one))
        first.append(history)
        above.append(upper)
        below.append(lower)
    heights = [upper.extent("y") for upper in above]
    for upper in above:
        upper.y.low = 1.1 * min(low for low, _ in heights)
        upper.y.high = 1.1 * max(high for _, high in heights)
    return Picture(
        [first, above, below], size=(width, 7.4), top=0.44, left=0.8, between=0.76, above=0.62,
        heights=(2, 3, 3),
    )  # fmt: skip


def _history(panel: Panel, one: Dataset) -> None:
    """X over the last mesh periods that are stored, at least two whole orbits where it has one."""
    x, samples = one["scaled_displacement"].values, _samples_per_period(one)
    label = str(one["label"].item())
    shown = 2 * periods_to_draw(label, samples_per_period=samples, stored=x.size)
    shown = min(x.size, max(HISTORY * samples + 1, shown))
    panel.curve(np.arange(shown) / samples, x[:shown], colour=COLD, width=0.9)


def _orbit(panel: Panel, one: Dataset) -> None:
    """The orbit with its section, over the gap in which no teeth touch."""
    x, v = one["scaled_displacement"].values, one["scaled_velocity"].values
    samples = _samples_per_period(one)
    x, v = (
        part[: periods_to_draw(str(one["label"].item()), samples_per_period=samples, stored=x.size)]
        for part in (x, v)
    )
    panel.curve(x, v, colour=COLD, width=0.8, opacity=0.8, label="orbit", pixels=x.size > DENSE)
    section = thinned(
        x=one["section_displacement"].values,
        y=one["section_velocity"].values,
        scale=(float(np.ptp(x)), float(np.ptp(v))),
    )
    panel.points(
        *section, size=3.8, colour=HOT, edge="white", edge_width=0.3, label="Poincaré section"
    )
    edge = float(one["half_backlash_ratio"])
    low, high = float(x.min()), float(x.max())
    pad = 0.06 * (high - low) or 1.0
    panel.x.low, panel.x.high = low - pad, high + pad
    panel.span(x=(-edge, edge), colour=FAINT, opacity=0.45, order=0.0, label="gap, no contact")


def _samples_per_period(one: Dataset) -> int:
    if "phase" not in one or one["phase"].size < 2:
        return int(one.sizes["sample"])
    step = float(one["phase"].values[1] - one["phase"].values[0])
    return max(1, round(1.0 / step)) if step > 0.0 else int(one.sizes["sample"])
