"""Along the path of contact: kinematics, load, Hertzian contact, friction, flash temperature."""

from __future__ import annotations

import numpy as np

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.display import display
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.curves import (
    along_path,
    axis_of,
    distinct,
    draw_by_both,
    draw_by_bundle,
    draw_by_operating,
    hot_state,
)
from thermogear.views.style import DRY, FAINT, HOT, INK, OKABE_ITO, chosen
from thermogear.views.typesetting import axis_label, math_symbol, shown

S = "path_position"
FLASHES = {
    "flash_temperature_mixed": "lubricated",
    "flash_temperature_dry": "dry",
    "flash_temperature": "own law",
}
"""Stored flash temperatures, and what they are called: the film says which regime it is."""
SPEEDS: dict[str, tuple[str, str, tuple[float, ...]]] = {
    "pinion_rolling_velocity": ("pinion flank v_1", OKABE_ITO[2], ()),
    "wheel_rolling_velocity": ("wheel flank v_2", OKABE_ITO[3], ()),
    "entrainment_velocity": ("entrainment v_e", OKABE_ITO[5], (5, 2)),
    "sliding_velocity": ("sliding v_s", INK, ()),
}
"""Words, colour and line of each speed."""


def speeds(data: Dataset) -> Picture:
    """Rolling speeds of both flanks, sliding and entrainment at the fastest operating point."""
    panel, x = along_path(data, Axis("speed along the flank v [m/s]")), shown(data, S)
    here = data.isel(operating=fastest(data))
    for name, (words, colour, dash) in SPEEDS.items():
        panel.curve(x, shown(here, name), colour=colour, dash=dash, label=math_symbol(words))
    panel.line(y=0.0, colour=INK, width=0.7, order=0.6)
    return Picture([[panel]], legend=2)


def fastest(data: Dataset) -> int:
    """The operating point of the greatest pinion speed."""
    return int(np.argmax(np.abs(data["pinion_speed"].values)))


def load_share(data: Dataset) -> Picture:
    """Share of the normal force that one tooth pair carries, for every bundle."""
    panel = along_path(data, axis_of("load_share", "load share of one pair", low=0.0, high=1.08))
    draw_by_bundle(panel, hot_state(data), "load_share", shown(data, S), colour=HOT)
    return Picture([[panel]])


def hertz(data: Dataset, bundle: int) -> Picture:
    """Hertzian pressure and half width of one bundle along the path, one curve per load."""
    here = hot_state(data).isel(bundle=bundle)
    above = along_path(data, axis_of("hertz_pressure", "Hertzian pressure", low=0.0))
    below = along_path(data, axis_of("hertz_half_width", "half width", low=0.0), letters=False)
    above.x.words = axis_label(S, "")
    label = f"hot{', all operating points' if here.sizes['operating'] > 1 else ''}"
    for panel, name in ((above, "hertz_pressure"), (below, "hertz_half_width")):
        draw_by_operating(panel, here, name, shown(data, S), colour=HOT, label=label)
    return Picture([[above], [below]], size=(4.9, 4.4), share_x="column", above=0.45)


def own_law(data: Dataset, name: str) -> bool:
    """Whether ``name`` by the case's own law is neither its lubricated nor its dry curve."""
    if not all(n in data for n in (name, f"{name}_mixed", f"{name}_dry")):
        return False
    others = [data[f"{name}_{kind}"].values for kind in ("mixed", "dry")]
    return all(distinct([data[name].values, other]) for other in others)


def friction(data: Dataset, bundle: int) -> Picture:
    """Friction coefficient by the case's own law, lubricated and dry, for every operating point.

    Shaded behind it what the laws within their range span.
    """
    name, x = "friction_coefficient", shown(data, S)
    panel = along_path(data, axis_of(name, "friction coefficient", low=0.0))
    here = hot_state(data).isel(bundle=bundle)
    if set(here.data_vars) >= BAND:
        _band(panel, here, x)
    own = own_law(here, name)
    if own:
        draw_by_operating(panel, here, name, x, "own law")
    words, dash = ("Benedict and Kelley", (1, 1.5)) if own else ("lubricated", ())
    draw_by_operating(panel, here, f"{name}_mixed", x, words, dash=dash)
    draw_by_operating(panel, here, f"{name}_dry", x, "dry", colour=DRY, dash=(6, 2, 1, 2))
    return Picture([[panel]], legend=2)


BAND = {"friction_coefficient_least", "friction_coefficient_greatest"}
"""Stored when the laws within their range are: what they span."""


def _band(panel: Panel, here: Dataset, x: Floats) -> None:
    """The span of the laws within their range, over all operating points that are drawn."""
    places = chosen(here.sizes["operating"])
    least = shown(here, "friction_coefficient_least")[places]
    greatest = shown(here, "friction_coefficient_greatest")[places]
    known = np.isfinite(least).any(axis=0) & np.isfinite(greatest).any(axis=0)
    if np.any(known):
        low = np.min(least, axis=0, where=np.isfinite(least), initial=np.inf)
        high = np.max(greatest, axis=0, where=np.isfinite(greatest), initial=0.0)
        low, high = np.where(known, low, np.nan), np.where(known, high, np.nan)
        panel.band(x, low=low, high=high, colour=FAINT, label="laws in their range")


def flash(data: Dataset, name: str) -> Picture:
    """Flash temperature rise ``name`` of :data:`FLASHES`: speeds by colour, bundles by line."""
    words = f"flash temperature rise, {FLASHES[name]}"
    panel = along_path(data, axis_of("flash_temperature", words, low=0.0))
    draw_by_both(panel, hot_state(data), name, shown(data, S), thin=1.2)
    return Picture([[panel]], legend=2)


def temperatures(data: Dataset, bundle: int) -> Picture:
    """Body temperature of both flanks and the contact temperature above it."""
    unit = display("contact_temperature").unit
    panel = along_path(data, Axis(f"temperature {math_symbol('T')} [{unit}]"))
    x, here = shown(data, S), hot_state(data).isel(bundle=bundle)
    draw_by_operating(panel, here, "contact_temperature", x, "contact")
    for name, colour in (("pinion", OKABE_ITO[2]), ("wheel", OKABE_ITO[3])):
        values = shown(here.isel(operating=0), f"{name}_body_temperature")
        panel.curve(x, values, colour=colour, dash=(4, 1.5), label=f"{name} body")
    return Picture([[panel]], legend=2)
