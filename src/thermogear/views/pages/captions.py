"""What the pictures of a gear pair show, in words: taken from the curves that are drawn."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Dataset
from thermogear.base.display import MILLIMETRE, PERCENT, number, span
from thermogear.views.plots.curves import hot_state
from thermogear.views.plots.path import BAND, own_law
from thermogear.views.style import chosen, names_of, path_points
from thermogear.views.typesetting import operating_names

NEAR = 0.02
"""Positions closer than this part of the path are the same place."""
PLACES = {
    "A": "at the start of contact A",
    "C": "at the pitch point C",
    "E": "at the end of contact E",
}


def hertz(data: Dataset, bundle: int, name: str) -> str:
    """Of pressure and half width of ``bundle`` along the path."""
    words = (
        f"Pressure and half width of the contact band, bundle {name}, hot. Both go with the root "
        "of the load that the pair carries."
    )
    if "edge_contact" in data and hot_state(data).isel(bundle=bundle)["edge_contact"].any():
        words += (
            " The pressure is left out where the corner of a tip carries: it is not valid there."
        )
    return words


def where(data: Dataset, name: str) -> str:
    """ "At <first operating point>. " where the picture could not stand for all of them."""
    values = data[name].transpose("operating", ...).values
    alike = np.allclose(values, values[:1], rtol=1e-4, atol=0.0, equal_nan=True)
    return "" if alike else f"At {operating_names(data)[0]}. "


def pitch_inside(data: Dataset) -> bool:
    """Whether the pitch point lies on the path of contact."""
    points = path_points(data)
    return "C" in points and points.get("A", np.inf) < points["C"] < points.get("E", -np.inf)


def place(data: Dataset, position: float) -> str:
    """A ``position`` [m] on the path by its letter, where one is near, else in millimetres."""
    points = path_points(data)
    s = data["path_position"].values
    for name, words in PLACES.items():
        if name in points and abs(position - points[name]) <= NEAR * np.ptp(s):
            return words
    return f"at {number(MILLIMETRE(position), 4)} mm"


def top_of(data: Dataset, values: NDArray[np.float64]) -> str:
    """Where the greatest of ``values`` along the path lies."""
    return place(data, float(data["path_position"].values[int(np.nanargmax(values))]))


def _sentence(parts: Mapping[str, str], start: str) -> str:
    """name -> words as one sentence, after ``start``; names only where the words differ."""
    if len(set(parts.values())) == 1:
        return f"{start}: {next(iter(parts.values()))}."
    return f"{start}: {'; '.join(f'{name} {words}' for name, words in parts.items())}."


def regimes(here: Dataset) -> str:
    """The lubrication regime of every drawn operating point by its film; "" if unknown.

    ``here`` has the axes operating and path_position alone. A film is nan where the heat does not
    settle, and infinite without load.
    """
    known = "regime" in here and "flag_meanings" in here["regime"].attrs
    if not known or "film_parameter" not in here:
        return ""
    film = here["film_parameter"].values
    drawn = [o for o in chosen(len(film)) if not np.isnan(film[o]).any()]
    if not drawn:
        return ""
    names, film = operating_names(here), film[drawn]
    if not np.isfinite(film).any():
        return "Without load the film has no limit."
    told = {names[o]: _regime_along(here.isel(operating=o)) for o in drawn}
    return _sentence(told, f"Lubrication by the film parameter, Λ = {span(film, 2)}")


def _regime_along(one: Dataset) -> str:
    """ "boundary throughout", or from where to where each regime reaches."""
    names = str(one["regime"].attrs["flag_meanings"]).split()
    index, s = one["regime"].values.astype(int), MILLIMETRE(one["path_position"].values)
    cuts = np.flatnonzero(np.diff(index)) + 1
    if not cuts.size:
        return f"{names[index[0]]} throughout"
    if cuts.size > 3:
        shares = [(name, float(np.mean(index == k))) for k, name in enumerate(names)]
        return ", ".join(f"{name} on {PERCENT(part):.0f} %" for name, part in shares if part)
    runs = [names[index[0]], *(names[index[c]] for c in cuts)]
    ends = [f" up to {number(0.5 * (s[c - 1] + s[c]), 4)} mm" for c in cuts] + [" to the end"]
    return ", ".join(run + end for run, end in zip(runs, ends, strict=True))


def kinematics(data: Dataset, fastest: int) -> str:
    """Of the rolling and sliding speeds."""
    words = f"At {operating_names(data)[fastest]}. "
    if not pitch_inside(data):
        return words + "The pitch point lies outside the path: the flanks slide all along."
    return words + (
        "Both flanks roll with the same speed at the pitch point C alone; sliding changes its "
        "sign there and is greatest at the ends of contact A and E."
    )


def load_share(data: Dataset) -> str:
    """Of the share of one tooth pair."""
    here = hot_state(data).isel(operating=0)
    if "line_load" in here and not np.any(here["line_load"].values > 0.0):
        return "Without load: the shares that a light one would have."
    words = "Where the share is 1 one pair carries everything; elsewhere several do."
    return f"{where(data, 'load_share')}{words}"


def friction(data: Dataset, bundle: int, bundles: Mapping[str, Any]) -> str:
    """Of the friction coefficient by the case's own law, lubricated and dry, and of the band."""
    here = hot_state(data).isel(bundle=bundle)
    name = names_of(data, "bundle")[bundle]
    own = own_law(here, "friction_coefficient")
    kelley = here["friction_coefficient_mixed"].values
    known = bool(np.isfinite(kelley).any())
    law = bundles.get(name, {}).get("friction", "another law")
    parts = [f"Lines: {law}, by which the case computes"] if own else []
    if known:
        line = "dotted: " if own else "Lubricated by "
        parts.append(f"{line}Benedict and Kelley's law")
    else:
        parts.append("Benedict and Kelley's law has no value for such rough flanks")
    words = [f"Bundle {name}, hot. {'; '.join(parts)}; dry, a constant."]
    if spread := band_words(here):
        words.append(spread)
    return " ".join([*words, regimes(here)]).strip()


def band_words(here: Dataset) -> str:
    """How far the laws within their range spread; nothing where that is not stored."""
    if not set(here.data_vars) >= BAND:
        return ""
    least = here["friction_coefficient_least"].values
    greatest = here["friction_coefficient_greatest"].values
    known = np.isfinite(least) & np.isfinite(greatest)
    if not known.any():
        return ""
    low, high = float(least[known].mean()), float(greatest[known].mean())
    words = (
        f"Shaded: the laws within their range, on the mean {number(low, 2)} to {number(high, 2)}"
    )
    if "friction_outside_range" in here and (here["friction_outside_range"].values == 1).any():
        words += "; the case's own law is outside its range in places"
    return f"{words}."


def flash(data: Dataset, name: str) -> str:
    """Of the flash temperature ``name`` over what the picture draws."""
    here = hot_state(data)[name].transpose("bundle", "operating", ...).values
    drawn = chosen(here.shape[1])
    told = {}
    for b, bundle in enumerate(names_of(data, "bundle")):
        values = here[b, drawn]
        if np.nanmax(values, initial=0.0) > 0.0:
            highest = np.nanmax(values, axis=0)
            told[bundle] = f"at most {number(float(np.nanmax(highest)))} K, {top_of(data, highest)}"
    words = _sentence(told, "Hot") + " " if told else "Nothing flashes. "
    zero = "Zero at the pitch point, where nothing slides. " if pitch_inside(data) else ""
    return f"{words}{zero}A rise of the skin alone."


def temperatures(data: Dataset, bundle: int) -> str:
    """Of body and contact temperatures."""
    bodies = hot_state(data).isel(bundle=bundle)[["pinion_body_temperature"]]
    words = f"Bundle {names_of(data, 'bundle')[bundle]}, hot. The body temperatures"
    at = where(bodies, "pinion_body_temperature").removesuffix(". ")
    words += f", drawn {at[:1].lower()}{at[1:]}," if at else ""
    words += " follow the steady field from bore to tip; the contact is hotter by the flash alone"
    return words + (", and as cool as the bodies at C." if pitch_inside(data) else ".")


def profile(factor: int, printed: bool, at: str) -> str:
    """Of one tooth, its hot displacement magnified."""
    words = f"{at}The displacement of the hot profile is drawn {factor} times larger than it is."
    if printed:
        words += (
            " As printed and as repaired lie close together: both carry the radial growth of "
            "body and tooth, and differ in the tooth's thickness."
        )
    return words


FOLLOWS = {
    "proportional": "shafts and housing keep their proportion to them",
    "follows": "the housing keeps its distance below the pinion's",
    "stays": "the housing stays at the temperature that the case gives it",
    "computed": "the housing's temperature follows from the heat balance",
}
"""How the housing goes along with the gears in a row of temperatures."""


def gap_over_temperature(row: Dataset, jams: Collection[str]) -> str:
    """Of the half backlash over the gears' temperature; ``jams`` by the ways that are drawn."""
    how = FOLLOWS.get(str(row.attrs.get("housing", "")))
    words = f"{where(row, 'half_backlash')}Points: both gears at that temperature"
    words += f"; {how}." if how else "."
    ways = {
        "jam_temperature": "Dotted: the gears alone get hotter and the housing stays as it is "
        "when they are hot",
        "proportional_jam_temperature": "Dash-dotted: shafts and housing rise on in proportion",
    }
    told = [text for name, text in ways.items() if name in jams]
    if told:
        words += f" {'. '.join(told)}; a cross marks where the pair jams."
    return words


def row_intro(row: Dataset, temperatures: str) -> str:
    """What goes along with the gears over a row of temperatures."""
    words = f"Both gears at {temperatures}"
    how = FOLLOWS.get(str(row.attrs.get("housing", "")))
    return f"{words}; {how}." if how else f"{words}."


def row_views(*, columns: int, most: int) -> str:
    """Of the four views of the motion over a row of temperatures."""
    words = "Columns: gear temperature"
    words += f", {most} of {columns}" if columns > most else ""
    return (
        f"{words}. From above: time history, phase plane, Poincaré section and spectrum. A single "
        "dot of the section is a motion of one mesh period."
    )


def stiffness(mesh: Dataset) -> str:
    """Of the mesh stiffness over the mesh phase."""
    words = f"{where(mesh, 'mean_stiffness')}Undeformed and hot, with their means. "
    ratio = float(mesh.attrs.get("contact_ratio", np.nan))
    if 1.0 < ratio < 2.0:
        words += "High where two pairs carry, low where one does. "
    if "mesh_periods" in mesh.attrs:
        words += (
            f"Over the turn of {mesh.attrs['mesh_periods']} mesh periods: where a tooth stands "
            "back its neighbours carry on."
        )
    return words.strip()


def path_intro(data: Dataset) -> str:
    """How the pictures along the path are to be read."""
    points = path_points(data)
    words = "Along the path of contact: A start, C pitch point, E end."
    if all(n in points for n in "BD") and points["B"] < points["D"]:
        words = "Along the path of contact: A start, B to D one pair alone, C pitch point, E end."
    several = data.sizes["operating"] > 1, data.sizes["bundle"] > 1
    told = ["colours are operating points"] * several[0] + ["line styles are bundles"] * several[1]
    said = ", ".join(told)
    return f"{words} {said[:1].upper()}{said[1:]}." if said else words
