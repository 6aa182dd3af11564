"""The page of the loaded contact over position, load and temperature."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from thermogear.base.display import CELSIUS, exactly, number
from thermogear.results.result import Result
from thermogear.views.page import Page, Shown, Table
from thermogear.views.pages import survey_captions as words
from thermogear.views.pages.survey import (
    digits,
    survey,
    table_of,
)
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
    states = [str(n) for n in data["temperature"].values]
    rows = []
    for load in range(data.sizes["load"]):
        for t, state in enumerate(states):
            here = data.isel(load=load, temperature=t)
            error = here["transmission_error"].values
            rows.append(
                [
                    exactly(float(here["load"])),
                    prose(state),
                    number(1e-8 * float(here["mean_stiffness"])),
                    number(1e-8 * float(here["secant_stiffness"].mean())),
                    number(1e6 * float(error.mean())),
                    number(1e6 * float(np.ptp(error))),
                    number(1e3 * float(here["double_contact_length"])),
                    " / ".join(number(100.0 * share, 2) for share in _corner_shares(here)),
                    number(1e-6 * float(here["contact_pressure"].max())),
                ]
            )
    table = Table(
        "Loaded contact by load and temperature. Edge contact: share of the mesh period in which "
        "the wheel's tip corner carries (before A) / the pinion's (beyond E). The Hertzian "
        "pressure is not valid on a corner; the greatest one is that of the flanks alone.",
        [
            "torque [N m]", "temperature", "k tangent [10⁸ N/m]", "k secant [10⁸ N/m]",
            "δ mean [µm]", "δ peak to peak [µm]", "double contact [mm]",
            "edge contact [%]", "greatest pressure on the flanks [MPa]",
        ],
        rows,
        names=2,
    )  # fmt: skip
    against = Table(
        "Mean mesh stiffness, undeformed [10⁸ N/m].",
        ["torque [N m]", "loaded contact", "ISO 6336-1 method B", "difference [%]"],
        [
            [
                exactly(float(torque)),
                number(1e-8 * float(own)),
                number(1e-8 * float(standard)),
                f"{100.0 * (float(standard) / float(own) - 1.0):+.1f}".replace("-", "−"),
            ]
            for torque, own, standard in zip(
                iso["load"].values,
                iso["loaded_stiffness"].values,
                iso["iso_stiffness"].values,
                strict=True,
            )
        ],
    )
    summary = (
        f"{data.sizes['mesh_phase']} mesh positions, {words.several(data.sizes['load'], 'load')} "
        f"and {len(states)} temperatures; body {result.text('body').replace('_', ' ')}."
    )
    return survey(result, summary, pictures, [against, table], numbers=_numbers, lines=_lines)


def _corner_shares(data: xr.Dataset) -> list[float]:
    """Shares of the mesh period with the wheel's and the pinion's tip corner loaded."""
    flags = data["edge_contact"].values
    return [float((flags & bit > 0).any(axis=-1).mean()) for bit in (1, 2)]


def _numbers(result: Result) -> dict[str, Any]:
    data, iso = result.groups["contact"], result.groups["iso_6336"]
    return {
        "pinion_torque_Nm": [float(v) for v in data["load"].values],
        "temperature_degC": [
            name if np.isnan(given) else float(CELSIUS(given))
            for name, given in zip(
                data["temperature"].values.tolist(), data["gear_temperature"].values, strict=True
            )
        ],
        "mean_stiffness": table_of(data["mean_stiffness"]),
        "double_contact_length_m": table_of(data["double_contact_length"]),
        "edge_contact_share": table_of(data["edge_contact_share"]),
        "iso_6336_stiffness": [float(v) for v in iso["iso_stiffness"].values],
    }


def _lines(result: Result) -> list[str]:
    found = _numbers(result)
    head = f"{'N m':>10} {'k undeformed':>14} {'k hot':>12} {'ISO 6336':>12}   [1e8 N/m]"
    lines = [f"{head}  {'edge undeformed':>15} {'hot':>6}   [% of the period]"]
    for place, torque in enumerate(found["pinion_torque_Nm"]):
        springs = [found["mean_stiffness"][t][place] for t in (0, 1)]
        springs.append(found["iso_6336_stiffness"][place])
        cells = [digits(1e-8 * k) for k in springs]
        edges = [found["edge_contact_share"][t][place] for t in (0, 1)]
        shares = [f"{100.0 * s:.1f}" if s == s else "-" for s in edges]
        lines.append(
            f"{torque:>10.4g} {cells[0]:>14} {cells[1]:>12} {cells[2]:>12}"
            f"{shares[0]:>23} {shares[1]:>6}"
        )
    return lines
