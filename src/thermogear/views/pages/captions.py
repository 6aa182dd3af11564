"""What the pictures of a gear pair show, in words: taken from the curves that are drawn."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import span
from thermogear.views.plots.curves import hot_state
from thermogear.views.style import names_of
from thermogear.views.typesetting import operating_names


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


def regimes(here: Dataset) -> str:
    """The lubrication regimes by the film along the path; "" if unknown.

    A film is nan where the heat does not settle, and infinite without load.
    """
    known = "regime" in here and "flag_meanings" in here["regime"].attrs
    film = here["film_parameter"].values if known and "film_parameter" in here else np.array(np.nan)
    there = ~np.isnan(film)
    if not there.any():
        return ""
    names = str(here["regime"].attrs["flag_meanings"]).split()
    told = ", ".join(names[k] for k in np.unique(here["regime"].values[there].astype(int)))
    return f"Lubrication by the film parameter, Λ = {span(film[there], 2)}: {told}."


def kinematics(data: Dataset, fastest: int) -> str:
    """Of the rolling and sliding speeds."""
    return (
        f"At {operating_names(data)[fastest]}. Both flanks roll with the same speed at the pitch "
        "point C alone; where it lies outside the path they slide all along."
    )


def load_share(data: Dataset) -> str:
    """Of the share of one tooth pair."""
    return (
        f"{where(data, 'load_share')}Where the share is 1 one pair carries everything; elsewhere "
        "several do. Without load: the shares that a light one would have."
    )


def friction(data: Dataset, bundle: int, bundles: Mapping[str, Any]) -> str:
    """Of the friction coefficient by the case's own law, lubricated and dry."""
    name = names_of(data, "bundle")[bundle]
    law = bundles.get(name, {}).get("friction", "a law of its own")
    return (
        f"Bundle {name}, hot, which computes by {law}. Lubricated is Benedict and Kelley's law, "
        f"dry a constant. {regimes(hot_state(data).isel(bundle=bundle))}"
    ).strip()


FLASH = "Hot; a rise of the skin alone. It is zero at the pitch point, where nothing slides."


def temperatures(data: Dataset, bundle: int) -> str:
    """Of body and contact temperatures."""
    return (
        f"Bundle {names_of(data, 'bundle')[bundle]}, hot. The body temperatures, drawn at "
        f"{operating_names(data)[0]}, follow the steady field from bore to tip; the contact is "
        "hotter by the flash alone."
    )


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


def gap_over_temperature(row: Dataset) -> str:
    """Of the half backlash over the gears' temperature."""
    return (
        f"{where(row, 'half_backlash')}Points: both gears at that temperature. Dotted: the gears "
        "alone get hotter and the housing stays as it is when they are hot; dash-dotted: shafts "
        "and housing rise on in proportion; a cross marks where the pair jams."
    )


def row_intro(row: Dataset, temperatures: str) -> str:
    """What goes along with the gears over a row of temperatures."""
    words = f"Both gears at {temperatures}"
    how = FOLLOWS.get(str(row.attrs.get("housing", "")))
    return f"{words}; {how}." if how else f"{words}."


ROW_VIEWS = (
    "Columns: gear temperature. From above: time history, phase plane, Poincaré section and "
    "spectrum. A single dot of the section is a motion of one mesh period."
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


PATH = (
    "Along the path of contact: A start, C pitch point, E end; between B and D one pair alone. "
    "Colours are operating points, line styles are bundles."
)
