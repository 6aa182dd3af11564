"""Along the path of contact: kinematics, load, Hertzian contact, friction, flash temperature."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from thermogear.views.plots.curves import distinct, draw_by_bundle, draw_by_operating, hot_state
from thermogear.views.style import (
    DRY,
    FAINT,
    HOT,
    INK,
    OKABE_ITO,
    bundle_line,
    chosen,
    legend_below,
    mark_path,
    name_axes,
    names_of,
    picture,
    ramp,
)
from thermogear.views.words import (
    axis_label,
    display,
    math_symbol,
    operating_names,
    plain,
    shown,
)

Floats = NDArray[np.float64]

S = "path_position"
FLASHES = {
    "flash_temperature_mixed": "lubricated",
    "flash_temperature_dry": "dry",
    "flash_temperature": "own law",
}
"""Stored flash temperatures, and what they are called: the film says which regime it is."""


def speeds(data: xr.Dataset) -> Figure:
    """Rolling speeds of both flanks, sliding and entrainment at the fastest operating point."""
    figure, axes = picture()
    axis, x = axes[0, 0], shown(data, S)
    here = data.isel(operating=fastest(data))
    lines = {
        "pinion_rolling_velocity": ("pinion flank", OKABE_ITO[2], "-"),
        "wheel_rolling_velocity": ("wheel flank", OKABE_ITO[3], "-"),
        "entrainment_velocity": ("entrainment", OKABE_ITO[5], (0, (5, 2))),
        "sliding_velocity": ("sliding", INK, "-"),
    }
    for name, (words, colour, style) in lines.items():
        axis.plot(
            x,
            shown(here, name),
            color=colour,
            linestyle=style,
            label=f"{words} {math_symbol(_symbol(name))}",
        )
    axis.axhline(0.0, color=INK, linewidth=0.7, zorder=0.6)
    axis.set_ylabel("speed along the flank v [m/s]")
    mark_path(axis, data)
    legend_below(figure, axis, 2)
    return figure


def fastest(data: xr.Dataset) -> int:
    """The operating point of the greatest pinion speed."""
    return int(np.argmax(np.abs(data["pinion_speed"].values)))


def _symbol(name: str) -> str:
    return {
        "pinion_rolling_velocity": "v_1",
        "wheel_rolling_velocity": "v_2",
        "entrainment_velocity": "v_e",
        "sliding_velocity": "v_s",
    }[name]


def load_share(data: xr.Dataset) -> Figure:
    """Share of the normal force that one tooth pair carries, for every bundle."""
    figure, axes = picture()
    axis = axes[0, 0]
    draw_by_bundle(axis, hot_state(data), "load_share", shown(data, S), HOT)
    name_axes(axis, S, "load_share", y_words="load share of one pair")
    axis.set_ylim(0.0, 1.08)
    mark_path(axis, data)
    legend_below(figure, axis)
    return figure


def hertz(data: xr.Dataset, bundle: int) -> Figure:
    """Hertzian pressure and half width of one bundle along the path, one curve per load."""
    figure, axes = picture(2, 1, (4.9, 4.4), sharex=True, above=0.45)
    here = hot_state(data).isel(bundle=bundle)
    for axis, name in zip(axes[:, 0], ("hertz_pressure", "hertz_half_width"), strict=True):
        every = ", all operating points" if here.sizes["operating"] > 1 else ""
        draw_by_operating(axis, here, name, shown(data, S), HOT, label=f"hot{every}")
        axis.set_ylim(bottom=0.0)
        mark_path(axis, data)
    axes[0, 0].set_ylabel(axis_label("hertz_pressure", "Hertzian pressure"))
    axes[1, 0].set_ylabel(axis_label("hertz_half_width", "half width"))
    for text in axes[1, 0].texts:
        text.set_visible(False)
    axes[0, 0].set_xlabel(axis_label(S, ""), labelpad=1.0)
    legend_below(figure, axes[0, 0])
    return figure


def own_law(data: xr.Dataset, name: str) -> bool:
    """Whether ``name`` by the case's own law is neither its lubricated nor its dry curve."""
    if not all(n in data for n in (name, f"{name}_mixed", f"{name}_dry")):
        return False
    others = [data[f"{name}_{kind}"].values for kind in ("mixed", "dry")]
    return all(distinct([data[name].values, other]) for other in others)


def friction(data: xr.Dataset, bundle: int) -> Figure:
    """Friction coefficient by the case's own law, lubricated and dry, for every operating point.

    Shaded behind it what the laws within their range span.
    """
    figure, axes = picture()
    axis, x = axes[0, 0], shown(data, S)
    here = hot_state(data).isel(bundle=bundle)
    if set(here.data_vars) >= BAND:
        _band(axis, here, x)
    dotted = (0, (1, 1.5))
    own = own_law(here, "friction_coefficient")
    if own:
        draw_by_operating(axis, here, "friction_coefficient", x, label="own law")
    draw_by_operating(
        axis,
        here,
        "friction_coefficient_mixed",
        x,
        label="Benedict and Kelley" if own else "lubricated",
        linestyle=dotted if own else "-",
    )
    draw_by_operating(
        axis, here, "friction_coefficient_dry", x, DRY, label="dry", linestyle=(0, (6, 2, 1, 2))
    )
    name_axes(axis, S, "friction_coefficient", y_words="friction coefficient")
    axis.set_ylim(bottom=0.0)
    mark_path(axis, data)
    legend_below(figure, axis, 2)
    return figure


BAND = {"friction_coefficient_least", "friction_coefficient_greatest"}
"""Stored when the laws within their range are: what they span."""


def _band(axis: Axes, here: xr.Dataset, x: Floats) -> None:
    """The span of the laws within their range, over all operating points that are drawn."""
    places = chosen(here.sizes["operating"])
    least = shown(here, "friction_coefficient_least")[places]
    greatest = shown(here, "friction_coefficient_greatest")[places]
    known = np.isfinite(least).any(axis=0) & np.isfinite(greatest).any(axis=0)
    if np.any(known):
        low = np.min(least, axis=0, where=np.isfinite(least), initial=np.inf)
        high = np.max(greatest, axis=0, where=np.isfinite(greatest), initial=0.0)
        axis.fill_between(
            x,
            low,
            high,
            where=list(np.ravel(known)),
            color=FAINT,
            linewidth=0.0,
            label="laws in their range",
        )


def flash(data: xr.Dataset, name: str) -> Figure:
    """Flash temperature rise ``name`` of :data:`FLASHES`: speeds by colour, bundles by line."""
    figure, axes = picture()
    axis, x = axes[0, 0], shown(data, S)
    here = hot_state(data)
    bundles, names = names_of(here, "bundle"), operating_names(here)
    places = chosen(here.sizes["operating"])
    for place, bundle in enumerate(bundles):
        values = shown(here.isel(bundle=place), name)
        for i, colour in zip(places, ramp(len(places)), strict=True):
            if np.isfinite(values[i]).any():
                axis.plot(
                    x,
                    values[i],
                    color=colour,
                    linestyle=bundle_line(bundles, place),
                    linewidth=1.7 if place == 0 else 1.2,
                    label=plain(f"{names[i]}, {bundle}"),
                )
    name_axes(axis, S, "flash_temperature", y_words=f"flash temperature rise, {FLASHES[name]}")
    axis.set_ylim(bottom=0.0)
    mark_path(axis, data)
    legend_below(figure, axis, 2)
    return figure


def temperatures(data: xr.Dataset, bundle: int) -> Figure:
    """Body temperature of both flanks and the contact temperature above it."""
    figure, axes = picture()
    axis, x = axes[0, 0], shown(data, S)
    here = hot_state(data).isel(bundle=bundle)
    draw_by_operating(axis, here, "contact_temperature", x, label="contact")
    bodies = {
        "pinion_body_temperature": ("pinion body", OKABE_ITO[2]),
        "wheel_body_temperature": ("wheel body", OKABE_ITO[3]),
    }
    first = here.isel(operating=0)
    for name, (words, colour) in bodies.items():
        axis.plot(x, shown(first, name), color=colour, linestyle=(0, (4, 1.5)), label=words)
    unit = display("contact_temperature").unit
    axis.set_ylabel(f"temperature {math_symbol('T')} [{unit}]")
    mark_path(axis, data)
    legend_below(figure, axis, 2)
    return figure
