"""The figures of a diagram, map, basin, sweep or run-up as JSON and a terminal want them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.display import CELSIUS, MICROMETRE
from thermogear.base.vocabulary import ASSUMED, FASTER_RULE
from thermogear.results.result import Result
from thermogear.views.page import notice_lines
from thermogear.views.pages.findings import ways_apart
from thermogear.views.pages.lost_words import lost_line, lost_rows
from thermogear.views.plots.lost_contact import has_lost
from thermogear.views.plots.parameters import shown

if TYPE_CHECKING:
    import xarray as xr

JUMPS_AT = ("fold", "subcritical period doubling")


def words_of(flags: xr.DataArray) -> NDArray[np.str_]:
    """The words of a flag variable, in its shape."""
    meanings = np.array([w.replace("_", " ") for w in flags.attrs["flag_meanings"].split()])
    return np.asarray(meanings[flags.values.astype(int)])


def _labels(result: Result) -> dict[str, Any]:
    data = result.data
    told = words_of(data["label"]).astype("U16")
    periodic = told == "periodic"
    told[periodic] = np.char.add("period-", data["period"].values[periodic].astype(str))
    assumed = data["status"].values == ASSUMED
    found: dict[str, Any] = {
        "points": int(data["label"].size),
        "labels": dict(Counter(sorted(told[~assumed].tolist())).most_common()),
        "assumed": dict(Counter(sorted(told[assumed].tolist())).most_common()),
        "rule": FASTER_RULE,
    }
    for name in ("total_periods", "full_periods", "computed_points"):
        if name in data.attrs:
            found[name] = int(data.attrs[name])
    if has_lost(data):
        found["lost_contact"] = lost_rows(data)
    return found


def _bifurcations(data: xr.Dataset, name: str) -> list[dict[str, Any]]:
    if "bifurcation_kind" not in data:
        return []
    kinds = words_of(data["bifurcation_kind"])
    rows = []
    for i in range(data.sizes["bifurcation"]):
        row: dict[str, Any] = {
            "kind": str(kinds[i]),
            "period": int(data["bifurcation_period"].values[i]),
            "value": float(shown(name, data["bifurcation_value"][i])),
        }
        if "bifurcation_state" in data:
            row["gears_degC"] = _degrees(data, int(data["bifurcation_state"].values[i]))
        rows.append(row)
    return rows


def _degrees(data: xr.Dataset, state: int) -> float:
    return round(CELSIUS(float(data["gear_temperature"].values[state])), 6)


def _diagram(result: Result) -> dict[str, Any]:
    parameter = result.text("parameter")
    return {
        **_labels(result),
        "parameter": parameter,
        "ways_apart": shown(parameter, result.data[parameter])[ways_apart(result.data)].tolist(),
        "bifurcations": _bifurcations(result.data, parameter),
    }


def _basins(result: Result) -> dict[str, Any]:
    data = result.data
    rows = [
        {
            "period": int(data["attractor_period"].values[i]),
            "x": float(data["attractor_x"].values[i, 0]),
            "v": float(data["attractor_v"].values[i, 0]),
            "count": int(data["count"].values[i]),
            "fraction": float(data["fraction"].values[i]),
            "border_distance": float(data["border_distance"].values[i]),
        }
        for i in range(data.sizes["attractor_number"])
    ]
    figures = {
        name: float(data.attrs[name])
        for name in ("basin_entropy", "boundary_basin_entropy", "unassigned")
    }
    points = int(data["attractor"].size)
    return {"points": points, "attractors": rows, **figures, "rule": FASTER_RULE}


def _run_up(result: Result) -> dict[str, Any]:
    data = result.data

    def rpm(name: str, place: int) -> float:
        return float(shown("pinion_speed", data[name][place]))

    jumps = [
        {
            "gears_degC": _degrees(data, int(data["jump_state"].values[i])),
            "direction": "up" if int(data["jump_direction"].values[i]) > 0 else "down",
            "from_rpm": rpm("jump_from", i),
            "to_rpm": rpm("jump_to", i),
            "at": JUMPS_AT[int(data["jump_kind"].values[i])],
            "fold_rpm": rpm("jump_fold", i),
            "return_rpm": rpm("jump_return", i),
            "into_period": int(data["jump_into"].values[i]),
            "before_um": MICROMETRE(float(data["jump_before"].values[i])),
            "after_um": MICROMETRE(float(data["jump_after"].values[i])),
        }
        for i in range(data.sizes["jump"])
    ]
    return {
        **_labels(result),
        "jumps": jumps,
        "bifurcations": _bifurcations(data, "pinion_speed"),
    }


NUMBERS: dict[str, Callable[[Result], dict[str, Any]]] = {
    "diagram": _diagram,
    "map": _labels,
    "basins": _basins,
    "sweep": _labels,
    "run-up": _run_up,
}


def numbers(result: Result) -> dict[str, Any]:
    """The figures of a stored result, JSON-ready."""
    found = {"kind": result.kind, **NUMBERS[result.kind](result)}
    seconds = result.text("seconds")
    return found | ({"seconds": float(seconds)} if seconds else {})


TABLES = ("bifurcations", "jumps", "attractors")
"""Figures that a terminal shows as the page's tables."""


def lines(result: Result) -> list[str]:
    """The other figures as a terminal shows them."""
    told = numbers(result)
    assumed = told.pop("assumed", {})
    found = []
    for name, value in told.items():
        if name == "labels":
            tail = {k: f" computed, {assumed.get(k, 0)} assumed" * bool(assumed) for k in value}
            found.append(f"labels: {', '.join(f'{k} {n}{tail[k]}' for k, n in value.items())}")
        elif name == "lost_contact":
            found += [f"- {lost_line(row)}" for row in value] or ["- nothing loses contact"]
        elif name == "ways_apart":
            at = ", ".join(f"{place:.9g}" for place in value)
            found += [f"two motions, up and down, at {at}"] * bool(value)
        elif name not in TABLES:
            found.append(f"{name}: {value}")
    return [*found, *notice_lines(result)]
