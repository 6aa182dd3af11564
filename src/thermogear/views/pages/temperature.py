"""The page of the closed loop of friction and heat over speed and torque."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from thermogear.base.display import exactly, number, reach
from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.base.vocabulary import STATUS, is_known
from thermogear.results.result import Result
from thermogear.views.page import Page, Shown, Table
from thermogear.views.pages import survey_captions as words
from thermogear.views.pages.survey import (
    survey,
    table_of,
)
from thermogear.views.plots import thermal_map
from thermogear.views.typesetting import prose

if TYPE_CHECKING:
    import xarray as xr

KINDS = ("temperature",)


def page(result: Result) -> Page:
    """The closed loop over speed and torque."""
    data = result.groups["map"]
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
    tables = [_corner_table(data), _estimate_table(data)]
    rows = result.rows("verdicts")
    if rows:
        tables.append(_conclusion_table(rows))
    status = data["status"].values
    count = {word: int((status == place).sum()) for place, word in enumerate(STATUS)}
    summary = (
        f"{words.several(status.size, 'operating point')} of the closed loop of friction and heat "
        f"in {float(result.text('seconds')):.2f} s: "
        + ", ".join(f"{n} {word.replace('_', ' ')}" for word, n in count.items() if n)
        + f". Iterations at most {int(data['iterations'].max())}."
        + ("" if over else words.one_point(data))
    )
    return survey(result, summary, pictures, tables, numbers=_numbers, lines=_lines)


def _conclusion_table(rows: Sequence[Mapping[str, str]]) -> Table:
    return Table(
        "The thesis's first conclusion, checked over the map. Rank correlations with speed and "
        "torque are means over the lines of the grid.",
        ["claim", "found", "verdict"],
        [[row["claim"], prose(row["found"]), row["verdict"]] for row in rows],
        names=3,
        marked=frozenset(i for i, row in enumerate(rows) if row["verdict"] != "holds"),
        wordy=True,
    )


def _chosen(data: xr.Dataset) -> list[tuple[int, int]]:
    """Corners and middle of the grid."""
    speeds, torques = data.sizes["pinion_speed"], data.sizes["pinion_torque"]
    at_s = sorted({0, speeds // 2, speeds - 1})
    at_t = sorted({0, torques // 2, torques - 1})
    return [(i, j) for i in at_s for j in at_t]


def _point_name(data: xr.Dataset, i: int, j: int) -> list[str]:
    speed = float(data["pinion_speed"][i]) / RPM
    return [exactly(speed), exactly(float(data["pinion_torque"][j]))]


def _degrees(kelvin: float) -> str:
    return number(kelvin - ZERO_CELSIUS, 3) if np.isfinite(kelvin) else "–"


def _corner_table(data: xr.Dataset) -> Table:
    head = [
        "speed [rpm]", "torque [N m]", "status", "oil [°C]", "pinion teeth [°C]",
        "wheel teeth [°C]", "housing [°C]", "flash [K]", "Λ least", "b′ least [µm]",
        "scuffing margin [K]", "iterations", "residual [K]",
    ]  # fmt: skip
    rows = []
    for i, j in _chosen(data):
        here = data.isel(pinion_speed=i, pinion_torque=j)
        node = here["node_temperature"]
        settled = is_known(int(here["status"]))
        rows.append(
            [
                *_point_name(data, i, j),
                STATUS[int(here["status"])].replace("_", " "),
                *(
                    _degrees(float(node.sel(node=name)))
                    for name in ("oil", "pinion_tooth", "wheel_tooth", "housing")
                ),
                number(float(here["greatest_flash"])),
                number(float(here["least_film_parameter"])),
                number(1e6 * float(here["least_half_backlash"])),
                number(float(here["scuffing_margin"])),
                str(int(here["iterations"])),
                number(float(here["residual"]), 2) if settled else "–",
            ]
        )
    caption = ("The operating point.", "Ends and middle.", "Corners and middle of the map.")
    return Table(caption[len(words.running(data))], head, rows, names=3)


def _estimate_table(data: xr.Dataset) -> Table:
    names = [str(n) for n in data["estimate"].values]
    rows = []
    for i, j in _chosen(data):
        here = data.isel(pinion_speed=i, pinion_torque=j)
        teeth = here["node_temperature"].sel(node=["pinion_tooth", "wheel_tooth"]).values
        cells = []
        for value in here["body_estimate"].values:
            difference = float(value) - float(np.mean(teeth))
            apart = f" ({difference:+.1f})" if np.isfinite(difference) else ""
            cells.append(f"{_degrees(float(value))}{apart}".replace("-", "−"))
        rows.append([*_point_name(data, i, j), _degrees(float(np.mean(teeth))), *cells])
    return Table(
        "Body temperature [°C]: mean of both gears' teeth by the heat balance, and the estimates "
        "of the ISO reports at the same oil temperature (difference to the heat balance in K).",
        ["speed [rpm]", "torque [N m]", "heat balance", *names],
        rows,
        names=2,
    )


def _numbers(result: Result) -> dict[str, Any]:
    data = result.groups["map"]
    names = (
        "greatest_flash",
        "least_half_backlash",
        "scuffing_margin",
        "least_film_parameter",
        "mean_friction",
        "residual",
    )
    return {
        "seconds": float(result.text("seconds")),
        "points": int(data["status"].size),
        "pinion_speed_rpm": [float(v) / RPM for v in data["pinion_speed"].values],
        "pinion_torque_Nm": [float(v) for v in data["pinion_torque"].values],
        "status": data["status"].values.tolist(),
        "iterations": data["iterations"].values.tolist(),
        "pinion_tooth_K": table_of(data["node_temperature"].sel(node="pinion_tooth")),
        "oil_K": table_of(data["node_temperature"].sel(node="oil")),
        **{name: table_of(data[name]) for name in names},
        "conclusion": result.rows("verdicts"),
    }


def _lines(result: Result) -> list[str]:
    data = result.groups["map"]
    teeth = data["node_temperature"].sel(node=["pinion_tooth", "wheel_tooth"]).values
    figures = {
        "teeth [degC]": teeth - ZERO_CELSIUS,
        "greatest flash temperature [K]": data["greatest_flash"].values,
        "least half backlash [um]": 1e6 * data["least_half_backlash"].values,
        "scuffing margin [K]": data["scuffing_margin"].values,
        "least film parameter": data["least_film_parameter"].values,
        "mean friction coefficient": data["mean_friction"].values,
    }
    told = [f"{one['claim']}: {one['verdict']} ({one['found']})" for one in result.rows("verdicts")]
    return [f"{name:<32} {reach(values)}" for name, values in figures.items()] + told
