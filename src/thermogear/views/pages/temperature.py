"""The page of the closed loop of friction and heat over speed and torque."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from thermogear.base.display import CELSIUS, KELVIN, exactly, number
from thermogear.base.vocabulary import STATUS
from thermogear.results.result import Result
from thermogear.views.columns import Column, Row, by_name, declared, key, reaches, rows_along, units
from thermogear.views.page import Page, Shown, Table
from thermogear.views.pages import survey_captions as words
from thermogear.views.pages.survey import OPERATING, survey
from thermogear.views.plots import thermal_map
from thermogear.views.style import names_of
from thermogear.views.tables import is_settled
from thermogear.views.typesetting import prose

if TYPE_CHECKING:
    import xarray as xr

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
                words.thermal_map(data, thermal_map.SAFE),
                partial(thermal_map.thermal_map, data),
                wide=True,
            )
        )
    rows = result.rows("verdicts")
    told = [reaches("Over all operating points.", REACH, data)]
    if rows:
        told.append(_conclusion_table(rows))
    status = data["status"].values
    count = {word: int((status == place).sum()) for place, word in enumerate(STATUS)}
    summary = (
        f"{words.several(status.size, 'operating point')} of the closed loop of friction and heat "
        f"in {float(result.text('seconds')):.2f} s: "
        + ", ".join(f"{n} {word.replace('_', ' ')}" for word, n in count.items() if n)
        + f". Iterations at most {int(data['iterations'].max())}."
        + ("" if over else words.one_point(data))
    )
    return survey(
        result,
        summary,
        pictures,
        [_corner_table(data), _estimate_table(data), *told],
        numbers=lambda: {
            "seconds": float(result.text("seconds")),
            "points": status.size,
            **by_name(data, IN_JSON),
            "units": units(IN_JSON, data),
            "conclusion": rows,
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


CONCLUSION = (
    Column("claim", "claim"),
    Column("found", lambda row: prose(row["found"])),
    Column("verdict", "verdict"),
)


def _conclusion_table(rows: Sequence[Row]) -> Table:
    return declared(
        "The thesis's first conclusion, checked over the map. Rank correlations with speed and "
        "torque are means over the lines of the grid.",
        CONCLUSION,
        rows,
        names=3,
        marked=lambda row: row["verdict"] != "holds",
        wordy=True,
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


def _with_nodes(data: xr.Dataset) -> xr.Dataset:
    """The same with the temperature of every node and each estimate as a variable."""
    of_nodes = {n: data["node_temperature"].sel(node=n, drop=True) for n in names_of(data, "node")}
    estimates = {
        n: data["body_estimate"].sel(estimate=n, drop=True) for n in names_of(data, "estimate")
    }
    return data.assign(of_nodes | estimates)


def _at_corners(data: xr.Dataset) -> list[dict[str, Any]]:
    """Corners and middle of the grid."""
    chosen = {
        name: sorted({0, data.sizes[name] // 2, data.sizes[name] - 1})
        for name in ("pinion_speed", "pinion_torque")
    }
    return rows_along(data.isel(chosen), *chosen)


def _corner_table(data: xr.Dataset) -> Table:
    caption = ("The operating point.", "Ends and middle.", "Corners and middle of the map.")
    return declared(caption[len(words.running(data))], CORNERS, _at_corners(data), names=3)


def _teeth(row: Row) -> float:
    """Mean temperature [K] of both gears' teeth."""
    return float(row["pinion_tooth"] + row["wheel_tooth"]) / 2.0


def _estimate(row: Row, name: str) -> str:
    """An estimate of the body's temperature and its difference to the heat balance."""
    difference = row[name] - _teeth(row)
    apart = f" ({difference:+.1f})" if np.isfinite(difference) else ""
    return f"{Column('', name, 3, CELSIUS).cell(row)}{apart}".replace("-", "−")


def _estimate_table(data: xr.Dataset) -> Table:
    names = names_of(data, "estimate")
    columns = [
        *POINT,
        Column("heat balance", lambda row: number(float(CELSIUS(_teeth(row))))),
        *(Column(name, partial(_estimate, name=name)) for name in names),
    ]
    return declared(
        "Body temperature [°C]: mean of both gears' teeth by the heat balance, and the estimates "
        "of the ISO reports at the same oil temperature (difference to the heat balance in K).",
        columns,
        _at_corners(data),
        names=2,
    )
