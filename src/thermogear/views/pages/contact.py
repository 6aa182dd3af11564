"""The page of the loaded contact over position, load and temperature."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from thermogear.base.display import (
    CELSIUS,
    MEGAPASCAL,
    MICROMETRE,
    MILLIMETRE,
    PERCENT,
    STIFFNESS,
    exactly,
    number,
)
from thermogear.results.result import Result
from thermogear.views.columns import Column, by_name, declared, key, rows_along, units
from thermogear.views.page import Page, Shown
from thermogear.views.pages import survey_captions as words
from thermogear.views.pages.survey import survey
from thermogear.views.plots import loaded
from thermogear.views.typesetting import prose

if TYPE_CHECKING:
    import xarray as xr

KINDS = ("contact",)


def page(result: Result) -> Page:
    """Loaded contact over position, load and temperature."""
    data, light, iso = (
        result.groups["contact"],
        result.groups["base_pitch"],
        result.groups["iso_6336"],
    )
    pitch = float(result.text("base_pitch_length"))
    points = {str(k): float(v) for k, v in result.table("path_points").items()}
    pictures = [
        Shown(
            "phase",
            "Stiffness and transmission error over a mesh period, hot",
            words.contact_phase(data),
            partial(loaded.over_phase, data),
            wide=True,
        ),
        Shown(
            "path",
            "Load share and pressure of one tooth pair",
            words.contact_path(data),
            partial(loaded.along_path, data, points),
            wide=True,
        ),
        Shown(
            "double_contact",
            "Double contact lost at light load",
            words.double_contact(light),
            partial(loaded.double_contact, light, pitch, "double_contact_length"),
        ),
        Shown(
            "uneven_stiffness",
            "Mean stiffness of unequally hot gears",
            words.uneven_stiffness(light),
            partial(loaded.double_contact, light, pitch, "mean_stiffness"),
        ),
        Shown(
            "uneven_error",
            "Transmission error of unequally hot gears",
            words.uneven_error(light),
            partial(loaded.double_contact, light, pitch, "peak_to_peak_error"),
        ),
        Shown(
            "iso",
            "Beside ISO 6336-1",
            "Method B knows neither bore nor rim, and lets the stiffness fall below 100 N/mm.",
            partial(loaded.iso, iso),
        ),
    ]
    error = data["transmission_error"]
    over_phase = data.assign(
        secant_stiffness=data["secant_stiffness"].mean("mesh_phase"),
        mean_error=error.mean("mesh_phase"),
        error_swing=error.max("mesh_phase") - error.min("mesh_phase"),
        wheel_corner=_corner_share(data, 1),
        pinion_corner=_corner_share(data, 2),
        contact_pressure=data["contact_pressure"].max(
            set(data["contact_pressure"].dims) - {"load", "temperature"}
        ),
    )
    table = declared(
        "Loaded contact by load and temperature. Edge contact: share of the mesh period in which "
        "the wheel's tip corner carries (before A) / the pinion's (beyond E). The Hertzian "
        "pressure is not valid on a corner; the greatest one is that of the flanks alone.",
        COLUMNS,
        rows_along(over_phase, "load", "temperature"),
        names=2,
    )
    against = declared(
        "Mean mesh stiffness, undeformed [10⁸ N/m].", AGAINST_ISO, rows_along(iso, "load")
    )
    summary = (
        f"{data.sizes['mesh_phase']} mesh positions, {words.several(data.sizes['load'], 'load')} "
        f"and {data.sizes['temperature']} temperatures; body "
        f"{result.text('body').replace('_', ' ')}."
    )
    every = data.assign(iso_6336_stiffness=iso["iso_stiffness"])
    return survey(
        result,
        summary,
        pictures,
        [against, table],
        numbers=lambda: {**by_name(every, IN_JSON), "units": units(IN_JSON, every)},
    )


COLUMNS = (
    Column("torque [N m]", "load", exactly),
    Column("temperature", lambda row: prose(row["temperature"])),
    Column("k tangent", "mean_stiffness"),
    Column("k secant", "secant_stiffness", 3, STIFFNESS),
    Column("δ mean", "mean_error", 3, MICROMETRE),
    Column("δ peak to peak", "error_swing", 3, MICROMETRE),
    Column("double contact", "double_contact_length", 3, MILLIMETRE),
    Column(
        "edge contact [%]",
        lambda row: " / ".join(
            number(PERCENT(row[f"{gear}_corner"]), 2) for gear in ("wheel", "pinion")
        ),
    ),
    Column("greatest pressure on the flanks", "contact_pressure", 3, MEGAPASCAL),
)
AGAINST_ISO = (
    Column("torque [N m]", "load", exactly),
    Column("loaded contact", lambda row: number(STIFFNESS(row["loaded_stiffness"]))),
    Column("ISO 6336-1 method B", lambda row: number(STIFFNESS(row["iso_stiffness"]))),
    Column(
        "difference",
        lambda row: row["iso_stiffness"] / row["loaded_stiffness"] - 1.0,
        "+.1f",
        PERCENT,
    ),
)


def _corner_share(data: xr.Dataset, bit: int) -> xr.DataArray:
    """Share of the mesh period in which the tip corner with this flag carries load."""
    carries = (data["edge_contact"].drop_attrs() & bit) > 0
    return carries.any("pair").mean("mesh_phase")


IN_JSON = (
    key("pinion_torque_Nm", "load"),
    key(
        "temperature_degC",
        lambda data: [
            name if np.isnan(given) else float(CELSIUS(given))
            for name, given in zip(
                data["temperature"].values.tolist(), data["gear_temperature"].values, strict=True
            )
        ],
    ),
    key("mean_stiffness"),
    key("double_contact_length_m", "double_contact_length"),
    key("edge_contact_share"),
    key("iso_6336_stiffness"),
)
