"""Pictures of the thesis's report that no run has: diagrams with flips, grids, the test table."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.views.style import (
    COLD,
    FAINT,
    HOT,
    INK,
    MIXED,
    QUIET,
    SINGLE,
    WIDE,
    legend_below,
    picture,
    ramp,
)

Floats = NDArray[np.float64]

AXES = {
    "zeta": "damping ratio $ζ$",
    "omega": "excitation frequency $ω_{h}$",
    "epsilon": "stiffness amplitude $ε$",
}
HEATS = {
    "none": ("without heat", COLD),
    "thesis": ("heat as in the thesis", HOT),
    "consistent": ("heat by E(T)", MIXED),
}
_CELLS = 700.0


def diagram(diagrams: Mapping[str, xr.Dataset], flips: xr.Dataset, row: str) -> Figure:
    """Sections over one parameter, a panel for each kind of heat, located flips as lines."""
    shown = [heat for heat in HEATS if f"{row}/{heat}" in diagrams]
    figure, axes = picture(1, len(shown), (WIDE, 3.5), sharey=True, between=0.3)
    figure.set_dpi(200)
    for axis, heat in zip(axes[0], shown, strict=True):
        words, colour = HEATS[heat]
        data = diagrams[f"{row}/{heat}"]
        parameter = str(data.attrs["parameter"])
        x, y = _points(data, parameter)
        axis.plot(x, y, linestyle="none", marker=".", markersize=0.9, color=colour, rasterized=True)
        axis.set_xlim(float(data[parameter].min()), float(data[parameter].max()))
        for value in flips["value"].sel(row=row, heat=heat).values:
            if axis.get_xlim()[0] <= value <= axis.get_xlim()[1]:
                axis.axvline(value, color=QUIET, linewidth=0.7, linestyle=(0, (4, 3)), zorder=0.5)
        axis.set_title(words)
        axis.set_xlabel(AXES[row])
        axis.xaxis.set_major_locator(MaxNLocator(5, prune="both"))
        axis.grid(visible=False)
    axes[0, 0].set_ylabel("X on the section [half backlashes]")
    return figure


def _points(data: xr.Dataset, parameter: str) -> tuple[Floats, Floats]:
    """Points of both directions that a reader can tell apart."""
    y = data["section_x"].transpose(..., parameter, "section").values
    x = np.broadcast_to(data[parameter].values[:, None], y.shape)
    flat = np.stack([x.ravel(), y.ravel()])
    flat = flat[:, np.isfinite(flat).all(axis=0)]
    span = float(np.ptp(flat[1])) or 1.0
    cells = np.stack([flat[0], np.round(flat[1] / span * _CELLS)])
    _, first = np.unique(cells, axis=1, return_index=True)
    return flat[0, first], flat[1, first]


def over_grid(data: xr.Dataset, name: str, unit: str, scale: float = 1.0) -> Figure:
    """One quantity over speed, a curve per torque: temperatures given beside the heat balance."""
    figure, axes = picture(1, 2, (WIDE, 3.3), sharey=True, between=0.3)
    rpm = data["speed"].values / RPM
    torques = data["torque"].values
    titles = {"given": "gear temperature given", "balance": "gear temperature from the balance"}
    for axis, thermal in zip(axes[0], titles, strict=True):
        here = data.sel(thermal=thermal)
        for place, colour in enumerate(ramp(len(torques))):
            for kind, style in (("_mixed", "-"), ("_dry", (0, (5, 2))), ("", "-")):
                if name + kind in here:
                    words = {"_mixed": "mixed, ", "_dry": "dry, "}.get(kind, "")
                    axis.plot(
                        rpm,
                        scale * here[name + kind].values[:, place],
                        color=colour,
                        linestyle=style,
                        label=f"{words}{torques[place]:.0f} N m",
                    )
        axis.set_title(titles[thermal])
        axis.set_xlabel("pinion speed $n_{1}$ [rpm]")
    axes[0, 0].set_ylabel(unit)
    axes[0, 0].set_ylim(bottom=0.0)
    legend_below(figure, axes[0, 0], 5)
    return figure


def warming(data: xr.Dataset) -> Figure:
    """The largest Floquet multiplier over temperature, and where it reaches the border."""
    figure, axes = picture()
    axis = axes[0, 0]
    celsius = data["temperature"].values - ZERO_CELSIUS
    for row, colour in (("thesis", HOT), ("consistent", MIXED)):
        modulus = data["multiplier"].sel(row=row).values
        flip = float(data["flip"].sel(row=row)) - ZERO_CELSIUS
        x, y = celsius, modulus
        if np.isfinite(flip):
            place = int(np.searchsorted(celsius, flip))
            x, y = np.insert(celsius, place, flip), np.insert(modulus, place, 1.0)
            axis.axvline(flip, color=QUIET, linewidth=0.9, linestyle=(0, (4, 3)))
            axis.annotate(
                f"flip at {flip:.1f} °C", (flip, 0.5), xycoords=("data", "axes fraction"),
                xytext=(4, 0), textcoords="offset points", color=QUIET, fontsize=8.5,
            )  # fmt: skip
        axis.plot(x, y, color=colour, label=HEATS[row][0])
        axis.plot(celsius, modulus, linestyle="none", marker="o", color=colour)
    axis.axhline(1.0, color=FAINT, linewidth=1.2)
    axis.set_xlabel("gear temperature $T$ [°C]")
    axis.set_ylabel("largest Floquet multiplier, modulus [–]")
    legend_below(figure, axis, 2)
    return figure


def experiment(data: xr.Dataset) -> Figure:
    """Errors of the displacement, printed and recomputed, beside the validation uncertainty."""
    figure, axes = picture(size=(SINGLE[0] + 0.6, SINGLE[1]))
    axis = axes[0, 0]
    here = data.isel(entry=np.flatnonzero(data["quantity"].values == "displacement"))
    rpm = here["speed"].values / RPM
    place = np.arange(rpm.size)
    uncertainty = here["u_val"].values
    axis.bar(
        place, uncertainty, 0.86, color=FAINT, label="validation uncertainty u_val", zorder=0.6
    )
    for shift, name, colour in ((-0.2, "with", HOT), (0.2, "without", COLD)):
        axis.bar(
            place + shift, here[f"{name}_error"].values, 0.36, color=colour,
            label=f"{name} heat, recomputed",
        )  # fmt: skip
        axis.plot(
            place + shift, [float(v) for v in here[f"{name}_printed"].values],
            linestyle="none", marker="_", markersize=14, color=INK, label="as printed",
        )  # fmt: skip
    axis.set_xticks(place, [f"{v:.0f} rpm" for v in rpm])
    axis.set_ylabel("error of the displacement [%]")
    axis.grid(visible=False, axis="x")
    legend_below(figure, axis, 2)
    return figure


def sensitivity(data: xr.Dataset) -> Figure:
    """Total indices as a map: a row for every result, a column for every input."""
    outputs = [str(v) for v in data["output_words"].values]
    inputs = [str(v) for v in data["input_words"].values]
    figure, axes = picture(size=(WIDE, 0.36 * len(outputs) + 2.5), left=3.1, top=0.2)
    axis = axes[0, 0]
    total = np.clip(data["total"].values, 0.0, None)
    axis.imshow(total, cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
    for r in range(len(outputs)):
        for c in range(len(inputs)):
            _cell(axis, r, c, float(total[r, c]), float(data["total_conf"].values[r, c]))
    axis.set_xticks(range(len(inputs)), inputs, rotation=35, ha="right")
    axis.set_yticks(range(len(outputs)), outputs)
    axis.grid(visible=False)
    figure.subplots_adjust(bottom=1.45 / figure.get_size_inches()[1])
    return figure


def _cell(axis: Axes, row: int, column: int, value: float, spread: float) -> None:
    if value - spread <= 0.01:
        return
    colour = "#ffffff" if value > 0.6 else INK
    axis.text(
        column, row, f"{100 * value:.0f}±{100 * spread:.0f}", ha="center", va="center",
        fontsize=7.4, color=colour,
    )  # fmt: skip
