"""The sections of a gear pair's page, from friction to motion."""

from __future__ import annotations

import numpy as np
import xarray as xr

from thermogear.views import tables
from thermogear.views.page import Block, Pictures, Section, Text
from thermogear.views.plots import backlash, deformation, motion, path, stiffness, temperature
from thermogear.views.results import Results
from thermogear.views.style import chosen, names_of
from thermogear.views.words import celsius, jam_words, number, operating_names, span

MOST_SPEEDS = 3
"""Rows of a grid over temperature."""


def with_gap(data: xr.Dataset, mesh: xr.Dataset | None) -> xr.Dataset:
    """``data`` with the half backlash and the jam temperature of the same points beside it."""
    if mesh is None:
        return data
    names = [n for n in ("half_backlash", "jam_temperature") if n in mesh and n not in data]
    return data.assign({name: mesh[name] for name in names})


def friction(results: Results, pictures: Pictures) -> Section | None:
    """Contact, friction and flash temperature."""
    data = results.group("path")
    if data is None:
        return None
    first = names_of(data, "bundle")[0]
    speeds = ("pinion_rolling_velocity", "wheel_rolling_velocity", "sliding_velocity")
    pictures.add(
        "speeds", "Rolling and sliding",
        f"At {operating_names(data)[path.fastest(data)]}. Both flanks roll with the same speed at "
        "the pitch point C alone; sliding changes its "
        "sign there and is greatest at the ends of contact A and E.",
        data, (*speeds, "entrainment_velocity"), lambda: path.speeds(data),
    )  # fmt: skip
    pictures.add(
        "share", "Load share of one tooth pair",
        "One pair carries everything about the pitch point; towards A and E two pairs share the "
        "force, by their stiffnesses or in equal parts, as the bundle says.",
        data, ("load_share",), lambda: path.load_share(data),
    )  # fmt: skip
    pictures.add(
        "hertz", "Hertzian contact",
        f"Pressure and half width of the contact band, bundle {first}, hot. Both jump where the "
        "pair becomes alone.",
        data, ("hertz_pressure", "hertz_half_width"), lambda: path.hertz(data, 0),
    )  # fmt: skip
    pictures.add(
        "friction", "Friction coefficient, mixed against dry",
        f"Bundle {first}, hot. Mixed friction falls as the speed rises and peaks at the pitch "
        "point, where nothing slides and the law would diverge; dry friction is a constant.",
        data, ("friction_coefficient_mixed", "friction_coefficient_dry"),
        lambda: path.friction(data, 0),
    )  # fmt: skip
    for kind, words in (("mixed", "in mixed lubrication"), ("dry", "dry")):
        name = f"flash_temperature_{kind}"
        if name in data and not np.isfinite(data[name].values).any():
            continue
        highest = float(np.nanmax(data[name].values)) if name in data else 0.0
        pictures.add(
            f"flash-{kind}", f"Flash temperature, {words}",
            f"Zero at the pitch point, highest at the start of contact A; {number(highest)} K at "
            "most here. A rise of the skin alone, some tens of micrometres deep.",
            data, (name,), lambda kind=kind: path.flash(data, kind),  # type: ignore[misc]
        )  # fmt: skip
    intro = Text(
        "Along the path of contact: A start, B to D one pair alone, C pitch point, E end. "
        "Colours are operating points, line styles are bundles."
    )
    return _section("friction", "Friction and flash temperature", [intro], pictures)


def heat(results: Results, pictures: Pictures) -> Section | None:
    """Temperature of the bodies and what it does to the flanks."""
    data, profile = results.group("path"), results.group("profile")
    if data is not None:
        first = names_of(data, "bundle")[0]
        bodies = ("pinion_body_temperature", "wheel_body_temperature")
        pictures.add(
            "temperatures", "Contact and body temperature",
            f"Bundle {first}, hot. The body temperatures follow the steady field from bore to "
            "tip; the contact is hotter by the flash alone, and as cool as the bodies at C.",
            data, ("contact_temperature", *bodies), lambda: path.temperatures(data, 0),
        )  # fmt: skip
        deformed = ("pinion_deformation", "wheel_deformation", "deformation_sum")
        pictures.add(
            "growth", "Growth of both flanks",
            _growth_caption(data), data, deformed, lambda: deformation.growth(data),
        )  # fmt: skip
    if profile is not None:
        needs = tuple(f"{k}_{a}" for k in ("involute", "printed", "consistent") for a in "xy")
        for place, gear in enumerate(names_of(profile, "gear")):
            if not all(name in profile for name in needs):
                continue
            factor = deformation.magnification(profile, place)
            pictures.add(
                f"profile-{place}", f"Tooth of the {gear}, hot over cold",
                f"The displacement of the hot profile is drawn {factor} times larger than it is. "
                "As printed and as repaired lie close together: both carry the radial growth of "
                "body and tooth, and differ in the tooth's thickness.",
                profile, needs, lambda p=place: deformation.profile(profile, p),  # type: ignore[misc]
            )  # fmt: skip
            pictures.add(
                f"profile-growth-{place}", f"How far the {gear}'s hot flank stands off",
                "The same displacement in true size, measured along the normal of the involute.",
                profile, needs,
                lambda p=place: deformation.profile_growth(profile, p),  # type: ignore[misc]
            )  # fmt: skip
    intro = Text(
        "The body's temperature makes the flanks grow; the flash is too shallow to. Growth is "
        "counted along the line of action, relative to the tooth's own centre line, before the "
        "housing moves the axes apart."
    )
    return _section("heat", "Temperature and deformation", [intro], pictures)


def _growth_caption(data: xr.Dataset) -> str:
    total = (
        data["deformation_sum"].isel(state=-1, operating=0) if "deformation_sum" in data else None
    )
    words = "Where the pinion's flank grows least the wheel's grows most."
    if total is None:
        return words
    for place, name in enumerate(names_of(data, "bundle")):
        values = 1e6 * total.isel(bundle=place).values
        if np.isfinite(values).all():
            words += f" Sum in the {name} bundle: {span(values, 4)} µm."
    return words


def gap(results: Results, pictures: Pictures) -> Section | None:
    """Hot backlash and jam."""
    mesh, row = results.group("mesh"), results.group("temperature")
    blocks: list[Block] = []
    if mesh is not None:
        pictures.add(
            "gap-phase", "Half backlash over a mesh period",
            f"{_where(mesh, 'half_backlash')}Heat shifts the gap and hardly makes it breathe. "
            "Below zero the pair would be jammed; no motion is computed there.",
            mesh, ("half_backlash_curve",), lambda: backlash.over_phase(mesh),
        )  # fmt: skip
        blocks += _jam_texts(mesh) if "status" in mesh else []
    if row is not None:
        pictures.add(
            "gap-temperature", "Half backlash over the gears' temperature",
            "Points: the housing follows the gears, as the case states it. Dotted: the gears "
            "alone get hotter while the housing stays; the cross marks where the pair jams.",
            row, ("half_backlash", "cold_half_backlash"),
            lambda: backlash.over_temperature(row, mesh),
        )  # fmt: skip
    return _section("backlash", "Backlash", blocks, pictures)


def _where(data: xr.Dataset, name: str) -> str:
    """ "At <first operating point>. " where the picture could not stand for all of them."""
    values = data[name].transpose("operating", ...).values
    alike = np.allclose(values, values[:1], rtol=1e-4, atol=0.0, equal_nan=True)
    return "" if alike else f"At {operating_names(data)[0]}. "


def _jam_texts(data: xr.Dataset, end: str = "") -> list[Block]:
    """A sentence for every bundle and state that is jammed, with its temperature."""
    found: list[Block] = []
    names = operating_names(data)
    for b, bundle in enumerate(names_of(data, "bundle")):
        for s, state in enumerate(names_of(data, "state")):
            here = data.isel(bundle=b, state=s)
            stuck = [o for o in range(len(names)) if tables.is_jammed(here.isel(operating=o))]
            if stuck:
                where = ", ".join(names[o] for o in stuck)
                jam = np.nan
                if "jam_temperature" in here:
                    jam = float(here["jam_temperature"].isel(operating=stuck).min())
                found.append(Text(f"{bundle}, {state}, {where} — {jam_words(jam)}{end}.", "jam"))
    return found


def springs(results: Results, pictures: Pictures) -> Section | None:
    """Mesh stiffness, its parts, its figures."""
    mesh = results.group("mesh")
    if mesh is None:
        return None
    for place, name in enumerate(names_of(mesh, "bundle")):
        one = mesh.isel(operating=0, bundle=place)["mean_stiffness"].values
        change = 100.0 * (float(one[-1]) / float(one[0]) - 1.0)
        pictures.add(
            f"stiffness-{place}", f"Mesh stiffness, {name}",
            f"{_where(mesh, 'mean_stiffness')}High where two pairs carry, low where one does. Hot "
            f"against cold the mean changes by {change:+.1f} %.".replace("-", "−"),
            mesh, ("mesh_stiffness", "elastic_stiffness", "thermal_stiffness", "mean_stiffness"),
            lambda p=place: stiffness.over_phase(mesh, p),  # type: ignore[misc]
        )  # fmt: skip
    first = mesh.isel(operating=0) if "operating" in mesh.dims else mesh
    pictures.add(
        "stiffness-bars", "Mean and swing",
        f"{_where(mesh, 'mean_stiffness')}Cold beside hot. In the thesis heat adds a spring; "
        "consistently Young's modulus falls and with it the stiffness.",
        mesh, ("mean_stiffness", "peak_to_peak_stiffness"), lambda: stiffness.bars(mesh),
    )  # fmt: skip
    pictures.add(
        "stiffness-pair", "Stiffness of one tooth pair",
        "One pair alone along its path of contact, stiffest near the pitch point.",
        first, ("pair_stiffness",), lambda: stiffness.pair(first),
    )  # fmt: skip
    needs = ("pair_stiffness", "hertz_stiffness", "pinion_bending_stiffness")
    for place, name in enumerate(names_of(mesh, "bundle")):
        pictures.add(
            f"stiffness-parts-{place}", f"The springs that make a pair, {name}",
            "Hot, springs in series: the softest decide. A tooth bends most where it is loaded "
            "near its tip.",
            mesh, needs, lambda p=place: stiffness.parts(mesh, p),  # type: ignore[misc]
        )  # fmt: skip
    return _section("stiffness", "Mesh stiffness", [], pictures)


def vibration(results: Results, pictures: Pictures) -> Section | None:
    """Motion of every bundle and operating point, cold against hot."""
    found = results.group("motion")
    if found is None:
        return None
    data = with_gap(found, results.group("mesh"))
    blocks: list[Block] = [
        Text(
            "Displacement is drawn from the drive-side edge of each pair's own gap, x − b′: above "
            "0 the drive flanks touch. Open circles and blue are cold, full circles and orange "
            "are hot. The axes of the section are those of the phase plane."
        )
    ]
    names, bundles = operating_names(data), names_of(data, "bundle")
    needs = ("displacement", "velocity", "section_displacement", "line_amplitude", "label")
    kept = chosen(len(names))
    for b, bundle in enumerate(bundles):
        for o in kept:
            here = data.isel(bundle=b, operating=o)
            if all(n in data for n in needs) and motion.needed(data, b, o):
                pictures.add(
                    f"motion-{b}-{o}", f"{bundle}, {names[o]}", _motion_caption(here), data, needs,
                    lambda b=b, o=o: motion.four_panels(data, b, o), wide=True,  # type: ignore[misc]
                )  # fmt: skip
    if "status" in data:
        blocks += _jam_texts(data, "; there is no motion")
    if len(kept) < len(names):
        blocks.append(Text(f"{len(kept)} of {len(names)} operating points are drawn.", "note"))
    drawn = pictures.take()
    table = tables.motion_proofs(data, "state", names_of(data, "state"))
    return Section("motion", "Motion, cold and hot", [*blocks, *drawn, table])


def _motion_caption(here: xr.Dataset) -> str:
    parts = []
    for s, state in enumerate(names_of(here, "state")):
        one = here.isel(state=s)
        share = float(one["contact_loss_share"]) if "contact_loss_share" in one else np.nan
        if np.isfinite(share):
            lost = f"{100.0 * share:.1f} % of the time without drive-side contact"
            lost = "always in contact" if share < 1e-6 else lost
            parts.append(f"{state}: {motion.label_of(one)}, {lost}")
    return "; ".join(parts) + "." if parts else "Cold against hot."


def row(results: Results, pictures: Pictures) -> Section | None:
    """The gears at several temperatures."""
    data = results.group("temperature")
    if data is None:
        return None
    words = [celsius(float(t)) for t in data["gear_temperature"].values]
    speeds = chosen(data.sizes["operating"], MOST_SPEEDS)
    needs = ("displacement", "velocity", "section_displacement", "time", "label", "half_backlash")
    for b, bundle in enumerate(names_of(data, "bundle")):
        pictures.add(
            f"row-{b}", f"Phase plane and section over gear temperature, {bundle}",
            "Columns: gear temperature; rows: operating points. The dot is the Poincaré section; "
            "a single dot is a motion of one mesh period.",
            data, needs, lambda b=b: temperature.grid(data, b, speeds), wide=True,  # type: ignore[misc]
        )  # fmt: skip
    swing = "peak_to_peak_displacement"
    pictures.add(
        "row-swing", "Swing of the motion over temperature",
        "Peak to peak of the relative displacement at every gear temperature.",
        data, (swing,), lambda: temperature.over_temperature(data, swing),
    )  # fmt: skip
    blocks: list[Block] = [
        Text(
            f"Both gears at {', '.join(words)}; shafts and housing keep their distance below the "
            "addendum, as the case states it."
        )
    ]
    line = "half_order_amplitude"
    if all(n in data for n in (line, swing)) and temperature.worth_drawing(data, line):
        pictures.add(
            "row-half", "The line at half the mesh frequency",
            "A line that grows from nothing is a period doubling.",
            data, (line,), lambda: temperature.over_temperature(data, line),
        )  # fmt: skip
    elif line in data:
        blocks.append(
            Text(
                "No motion of this row has a line at half the mesh frequency: whatever stands "
                "there is rounding.",
                "note",
            )
        )
    drawn = pictures.take()
    table = tables.motion_proofs(data, "gear_temperature", words)
    return Section("temperature", "Gear temperature", [*blocks, *drawn, table])


def _section(name: str, title: str, blocks: list[Block], pictures: Pictures) -> Section | None:
    """A section with the pictures drawn for it; None where nothing was."""
    drawn = pictures.take()
    return Section(name, title, [*blocks, *drawn]) if drawn else None
