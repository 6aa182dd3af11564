"""What the page of each gear survey holds: words, tables, and pictures still to be drawn."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.base.vocabulary import STATUS
from thermogear.views import captions
from thermogear.views import survey_captions as words
from thermogear.views.page import Table
from thermogear.views.plots import laws, loaded, relief, thermal_map
from thermogear.views.survey_parts import Drawn, Groups, Survey
from thermogear.views.warm_up_section import warm_up
from thermogear.views.words import exactly, number, operating_names, prose

MOST_PICTURES = 4
"""Operating points that get a picture of their own."""


def friction(texts: Mapping[str, Any], groups: Groups) -> Survey:
    """All friction laws with their ranges."""
    data = groups["laws"]
    rows = json.loads(texts["laws"])
    means = frozenset(row["law"] for row in rows if "mean of the mesh" in row["regime"])
    names = operating_names(data)
    pictures = [
        Drawn(
            f"laws_{place + 1}",
            f"Friction laws at {names[place]}",
            words.laws(data, place, means),
            partial(laws.laws, data, place, means),
            wide=True,
        )
        for place in range(min(len(names), MOST_PICTURES))
    ]
    pictures.append(
        Drawn(
            "film",
            "Film parameter along the path",
            "Least film thickness over the combined rms roughness; below 1 boundary, from 3 on a "
            f"full film. {captions.regimes(data)}".strip(),
            partial(laws.film, data),
        )
    )
    mean = data["mean_friction"].values
    share = 100.0 * data["outside_range"].mean("path_position").values
    table = Table(
        "Every law: regime it is made for, range its source gives, mean by sliding power.",
        ["law", "regime", "range", "source", *names],
        [
            [
                row["law"],
                row["regime"],
                row["range"] or "none given",
                row["source"],
                *(
                    number(float(mean[i, o])) + (" (outside)" if share[i, o] > 0.0 else "")
                    for o in range(len(names))
                ),
            ]
            for i, row in enumerate(rows)
        ],
        names=4,
        marked=frozenset(i for i, row in enumerate(rows) if row["law"] == data.attrs["chosen"]),
        wordy=True,
    )
    regimes = Table(
        "Share of the path in each regime [%].",
        ["operating point", *(str(n) for n in data["regime_name"].values)],
        [
            [name, *(f"{100.0 * float(v):.1f}" for v in data["regime_share"].values[o])]
            for o, name in enumerate(names)
        ],
    )
    summary = (
        f"{len(rows)} laws at {words.several(len(names), 'operating point')}; the case computes "
        f"with {data.attrs['chosen']} (marked)."
    )
    if len(names) > MOST_PICTURES:
        summary += f" The first {MOST_PICTURES} points have a picture of their own."
    return Survey(summary, pictures, [table, regimes])


def temperature(texts: Mapping[str, Any], groups: Groups) -> Survey:
    """The closed loop over speed and torque."""
    data = groups["map"]
    pictures = []
    over = words.running(data)
    if over:
        pictures.append(
            Drawn(
                "map",
                f"Everything hot over {' and '.join(over)}",
                words.thermal_map(data, thermal_map.SAFE),
                partial(thermal_map.thermal_map, data),
                wide=True,
            )
        )
    tables = [_corner_table(data), _estimate_table(data)]
    rows = json.loads(texts["verdicts"])
    if rows:
        tables.append(_conclusion_table(rows))
    status = data["status"].values
    count = {word: int((status == place).sum()) for place, word in enumerate(STATUS)}
    summary = (
        f"{words.several(status.size, 'operating point')} of the closed loop of friction and heat "
        f"in {float(texts['seconds']):.2f} s: "
        + ", ".join(f"{n} {word.replace('_', ' ')}" for word, n in count.items() if n)
        + f". Iterations at most {int(data['iterations'].max())}."
        + ("" if over else words.one_point(data))
    )
    return Survey(summary, pictures, tables)


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
        settled = int(here["status"]) != STATUS.index("not_converged")
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
            cells.append(f"{_degrees(float(value))} ({difference:+.1f})".replace("-", "−"))
        rows.append([*_point_name(data, i, j), _degrees(float(np.mean(teeth))), *cells])
    return Table(
        "Body temperature [°C]: mean of both gears' teeth by the heat balance, and the estimates "
        "of the ISO reports at the same oil temperature (difference to the heat balance in K).",
        ["speed [rpm]", "torque [N m]", "heat balance", *names],
        rows,
        names=2,
    )


def tip_relief(texts: Mapping[str, Any], groups: Groups) -> Survey:
    """The relief found, beside the unrelieved pair."""
    torque = float(texts["torque"])
    before, after = 1e6 * float(texts["unrelieved"]), 1e6 * float(texts["relieved"])
    hot = [float(texts[f"{gear}_addendum"]) - ZERO_CELSIUS for gear in ("pinion", "wheel")]
    summary = (
        f"Made for {exactly(torque)} N m with teeth at {hot[0]:.0f} °C (pinion) and "
        f"{hot[1]:.0f} °C (wheel): the transmission error goes from {before:.2f} to {after:.2f} "
        f"um peak to peak, by {int(texts['evaluations'])} evaluations of the mesh period."
    )
    pictures = [
        Drawn(
            "error",
            "Transmission error over a mesh period",
            words.relief_error(groups["error"]),
            partial(relief.error, groups["error"]),
        ),
        Drawn(
            "stiffness",
            "Tangent stiffness over a mesh period",
            words.relief_stiffness(groups["error"]),
            partial(relief.stiffness, groups["error"]),
        ),
        Drawn(
            "loads",
            "What the relief does at other loads",
            words.relief_loads(groups["loads"]),
            partial(relief.over_load, groups["loads"], torque),
        ),
    ]
    rows = [
        [gear, f"{1e6 * r['amount_m']:.3f}", f"{1e3 * r['length_m']:.4f}", r["shape"]]
        for gear, r in json.loads(texts["reliefs"]).items()
    ]
    table = Table(
        "Tip relief; lengths along the line of action.",
        ["gear", "amount [µm]", "length [mm]", "shape"],
        [[row[0], row[1], row[2], row[3]] for row in rows],
    )
    return Survey(summary, pictures, [table], str(texts["paste"]))


def contact(texts: Mapping[str, Any], groups: Groups) -> Survey:
    """Loaded contact over position, load and temperature."""
    data, light, iso = groups["contact"], groups["base_pitch"], groups["iso_6336"]
    pitch = float(texts["base_pitch_length"])
    points = {str(k): float(v) for k, v in json.loads(texts["path_points"]).items()}
    pictures = [
        Drawn(
            "phase",
            "Stiffness and transmission error over a mesh period, hot",
            words.contact_phase(data),
            partial(loaded.over_phase, data),
            wide=True,
        ),
        Drawn(
            "path",
            "Load share and pressure of one tooth pair",
            words.contact_path(data),
            partial(loaded.along_path, data, points),
            wide=True,
        ),
        Drawn(
            "double_contact",
            "Double contact lost at light load",
            words.double_contact(light),
            partial(loaded.double_contact, light, pitch, "double_contact_length"),
        ),
        Drawn(
            "uneven_stiffness",
            "Mean stiffness of unequally hot gears",
            words.uneven_stiffness(light),
            partial(loaded.double_contact, light, pitch, "mean_stiffness"),
        ),
        Drawn(
            "uneven_error",
            "Transmission error of unequally hot gears",
            words.uneven_error(light),
            partial(loaded.double_contact, light, pitch, "peak_to_peak_error"),
        ),
        Drawn(
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
        f"and {len(states)} temperatures; body {str(texts['body']).replace('_', ' ')}."
    )
    return Survey(summary, pictures, [against, table])


def _corner_shares(data: xr.Dataset) -> list[float]:
    """Shares of the mesh period with the wheel's and the pinion's tip corner loaded."""
    flags = data["edge_contact"].values
    return [float((flags & bit > 0).any(axis=-1).mean()) for bit in (1, 2)]


SURVEYS: dict[str, Callable[[Mapping[str, Any], Groups], Survey]] = {
    "friction": friction,
    "temperature": temperature,
    "relief": tip_relief,
    "contact": contact,
    "warmup": warm_up,
}
"""Kind of a stored survey -> what its page holds."""

__all__ = ["SURVEYS", "Drawn", "Survey"]
