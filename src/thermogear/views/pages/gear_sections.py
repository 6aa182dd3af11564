"""The sections of a gear pair's page, from friction to motion."""

from __future__ import annotations

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import MICROMETRE, MILLIMETRE, PERCENT, celsius
from thermogear.results.result import Result
from thermogear.views import tables
from thermogear.views.columns import Column, declared, rows_along
from thermogear.views.page import Block, Pictures, Section, Table, Text
from thermogear.views.pages import captions
from thermogear.views.plots import (
    backlash,
    deformation,
    flanks,
    motion,
    path,
    stiffness,
    temperature,
)
from thermogear.views.style import chosen, names_of
from thermogear.views.typesetting import jam_words, operating_names

FIGURES = ("profile_slope", "profile_form", "profile_total")


def measured(results: Result, pictures: Pictures) -> Section | None:
    """Traces, fit and what acts of each gear that was measured; None where none was."""
    found: list[Block] = []
    for gear in ("pinion", "wheel"):
        data = results.group(f"flanks/{gear}")
        if data is None:
            continue
        pictures.add(
            f"flanks-{gear}", f"Measured flanks of the {gear}", caption(data), data,
            flanks.NEEDS, lambda data=data: flanks.traces(data),  # type: ignore[misc]
            wide=len(flanks.sides(data)) > 1,
        )  # fmt: skip
        found += pictures.take()
        if all(name in data for name in FIGURES):
            found.append(table(data, gear))
    return Section("flanks", "Measured flanks", found) if found else None


def first(results: Result) -> list[tuple[str]]:
    """The pictures that a page shows unasked: those of each gear that was measured."""
    gears = ("pinion", "wheel")
    return [(f"flanks-{gear}",) for gear in gears if results.group(f"flanks/{gear}") is not None]


def caption(data: Dataset) -> str:
    """What the picture shows and what of it the mesh feels."""
    sides = flanks.sides(data)
    cut = ", ".join(f"{MILLIMETRE(float(data[f'{side}_cutoff'])):.2g} mm" for side in sides)
    scatter = ", ".join(f"{MICROMETRE(float(data[f'{side}_scatter'])):.2g} µm" for side in sides)
    return (
        f"Read from {data.attrs.get('files', 'a chart')}; {' and '.join(sides)} flank. "
        f"What acts is the mean of the teeth below a cut-off of {cut} along the roll path: shorter "
        "waves cannot be told from noise. It is zero at the pitch circle and constant beyond the "
        f"evaluated range, at most {MICROMETRE(flanks.peak(data)):.2g} µm peak to peak. Scatter "
        f"between the teeth, which no mesh period holds: {scatter}."
    )


COLUMNS = (
    Column("trace", "trace_name"),
    Column("f_Hα", "profile_slope", ".2f", MICROMETRE),
    Column("f_fα", "profile_form", ".2f", MICROMETRE),
    Column("F_α", "profile_total", ".2f", MICROMETRE),
    Column("class", lambda row: str(row["iso_class"] or "none")),
)


def table(data: Dataset, gear: str) -> Table:
    """Slope, form and total deviation of each trace with its class."""
    words = (
        f"Each trace of the {gear} over the evaluated range, and the class of ISO 1328-1:2013 that "
        "all three figures keep."
    )
    return declared(words, COLUMNS, rows_along(data, *map(str, data["iso_class"].dims)))


MOST_SPEEDS = 3
"""Operating points whose motion is drawn over temperature."""


def with_gap(data: Dataset, mesh: Dataset | None) -> Dataset:
    """``data`` with the half backlash and the jam temperature of the same points beside it."""
    if mesh is None:
        return data
    wanted = ("half_backlash", "jam_temperature")
    names = [n for n in wanted if n in mesh and n not in data]
    return data.assign({name: mesh[name] for name in names})


def friction(results: Result, pictures: Pictures) -> Section | None:
    """Contact, friction and flash temperature."""
    data = results.group("path")
    if data is None:
        return None
    first = names_of(data, "bundle")[0]
    speeds = ("pinion_rolling_velocity", "wheel_rolling_velocity", "sliding_velocity")
    pictures.add(
        "speeds", "Rolling and sliding", captions.kinematics(data, path.fastest(data)),
        data, (*speeds, "entrainment_velocity"), lambda: path.speeds(data),
    )  # fmt: skip
    if "load_share" in data:
        pictures.add(
            "share", "Load share of one tooth pair",
            captions.load_share(data), data, ("load_share",), lambda: path.load_share(data),
        )  # fmt: skip
    pictures.add(
        "hertz", "Hertzian contact",
        captions.hertz(data, 0, first),
        data, ("hertz_pressure", "hertz_half_width"), lambda: path.hertz(data, 0),
    )  # fmt: skip
    needs = ("friction_coefficient_mixed", "friction_coefficient_dry")
    if all(name in data for name in needs):
        more = (n for n in ("friction_coefficient", *sorted(path.BAND)) if n in data)
        pictures.add(
            "friction", "Friction coefficient, lubricated against dry",
            captions.friction(data, 0, results.table("bundles")), data, (*needs, *more),
            lambda: path.friction(data, 0),
        )  # fmt: skip
    for name, words in path.FLASHES.items():
        if name not in data or not np.isfinite(data[name].values).any():
            continue
        kind = name.removeprefix("flash_temperature").removeprefix("_")
        if not kind and not path.own_law(data, name):
            continue
        pictures.add(
            f"flash-{kind or 'own'}", f"Flash temperature, {words}", captions.FLASH,
            data, (name,), lambda name=name: path.flash(data, name),  # type: ignore[misc]
        )  # fmt: skip
    intro = Text(captions.PATH)
    return _section("friction", "Friction and flash temperature", [intro], pictures)


def heat(results: Result, pictures: Pictures) -> Section | None:
    """Temperature of the bodies and what it does to the flanks."""
    data, profile = results.group("path"), results.group("profile")
    bodies = ("pinion_body_temperature", "wheel_body_temperature")
    if data is not None:
        if all(name in data for name in bodies):
            pictures.add(
                "temperatures", "Contact and body temperature", captions.temperatures(data, 0),
                data, ("contact_temperature", *bodies), lambda: path.temperatures(data, 0),
            )  # fmt: skip
        deformed = ("pinion_deformation", "wheel_deformation", "deformation_sum")
        if all(name in data for name in deformed):
            pictures.add(
                "growth", "Growth of both flanks",
                f"{captions.where(data, deformed[-1])}The sum is taken from the backlash.",
                data, deformed,
                lambda: deformation.growth(data),
            )  # fmt: skip
    if profile is not None:
        kinds = ("involute", *deformation.hot_profiles(profile))
        needs = tuple(f"{k}_{a}" for k in kinds for a in "xy")
        at = captions.where(data, bodies[0]) if data is not None and bodies[0] in data else ""
        for place, gear in enumerate(names_of(profile, "gear")):
            if not all(name in profile for name in needs):
                continue
            factor = deformation.magnification(profile, place)
            pictures.add(
                f"profile-{place}", f"Tooth of the {gear}, hot over cold",
                captions.profile(factor, "printed" in kinds, at),
                profile, needs, lambda p=place: deformation.profile(profile, p),  # type: ignore[misc]
            )  # fmt: skip
    intro = Text(
        "The body's temperature makes the flanks grow; the flash is too shallow to. Growth is "
        "counted along the line of action, relative to the tooth's own centre line, before the "
        "housing moves the axes apart."
    )
    return _section("heat", "Temperature and deformation", [intro], pictures)


def gap(results: Result, pictures: Pictures) -> Section | None:
    """Hot backlash and jam."""
    mesh, row = results.group("mesh"), results.group("temperature")
    blocks: list[Block] = []
    if mesh is not None:
        if "half_backlash_curve" in mesh:
            pictures.add(
                "gap-phase", "Half backlash over the mesh phase",
                f"{captions.where(mesh, 'half_backlash')}Below zero a pair is jammed; no motion is "
                "computed there.",
                mesh, ("half_backlash_curve",), lambda: backlash.over_phase(mesh),
            )  # fmt: skip
        blocks += _jam_texts(mesh) if "status" in mesh else []
    if row is not None and "half_backlash" in row:
        pictures.add(
            "gap-temperature", "Half backlash over the gears' temperature",
            captions.gap_over_temperature(row),
            row, ("half_backlash", "cold_half_backlash"),
            lambda: backlash.over_temperature(row, mesh),
        )  # fmt: skip
    return _section("backlash", "Backlash", blocks, pictures)


def _jam_texts(data: Dataset, end: str = "") -> list[Block]:
    """A sentence for every bundle and state that is jammed, with its temperature."""
    found: list[Block] = []
    names = operating_names(data)
    for b, bundle in enumerate(names_of(data, "bundle")):
        for s, state in enumerate(names_of(data, "state")):
            here = data.isel(bundle=b, state=s)
            stuck = [o for o in range(len(names)) if tables.is_jammed(here.isel(operating=o))]
            if stuck:
                where = ", ".join(names[o] for o in stuck)
                jam = (
                    float(here["jam_temperature"].isel(operating=stuck).min())
                    if "jam_temperature" in here
                    else np.nan
                )
                found.append(Text(f"{bundle}, {state}, {where} — {jam_words(jam)}{end}.", "jam"))
    return found


def springs(results: Result, pictures: Pictures) -> Section | None:
    """Mesh stiffness, its parts, its figures."""
    mesh = results.group("mesh")
    if mesh is None:
        return None
    for place, name in enumerate(names_of(mesh, "bundle")):
        pictures.add(
            f"stiffness-{place}", f"Mesh stiffness, {name}", captions.stiffness(mesh),
            mesh, ("mesh_stiffness", "elastic_stiffness", "thermal_stiffness", "mean_stiffness"),
            lambda p=place: stiffness.over_phase(mesh, p),  # type: ignore[misc]
        )  # fmt: skip
    first = mesh.isel(operating=0) if "operating" in mesh.dims else mesh
    if "pair_stiffness" in mesh:
        pictures.add(
            "stiffness-pair", "Stiffness of one tooth pair",
            f"{captions.where(mesh, 'pair_stiffness')}One pair alone along its path of contact.",
            first, ("pair_stiffness",), lambda: stiffness.pair(first),
        )  # fmt: skip
    needs = ("pair_stiffness", "hertz_stiffness")
    for place, name in enumerate(names_of(mesh, "bundle")):
        pictures.add(
            f"stiffness-parts-{place}", f"The springs that make a pair, {name}",
            "Hot, springs in series: the softest decide. A tooth bends most where it is loaded "
            "near its tip.",
            mesh, needs, lambda p=place: stiffness.parts(mesh, p),  # type: ignore[misc]
        )  # fmt: skip
    return _section("stiffness", "Mesh stiffness", [], pictures)


def vibration(results: Result, pictures: Pictures) -> Section | None:
    """Motion of every bundle and operating point, undeformed against hot."""
    found = results.group("motion")
    if found is None:
        return None
    data = with_gap(found, results.group("mesh"))
    blocks: list[Block] = [
        Text(
            "Displacement is drawn from the drive-side edge of each pair's own gap, x − b′: above "
            "0 the drive flanks touch. Open circles and blue are undeformed, full circles and "
            "orange are hot. The axes of the section are those of the phase plane."
        )
    ]
    names, bundles = operating_names(data), names_of(data, "bundle")
    needs = ("displacement", "velocity", "section_displacement", "line_amplitude", "label")
    kept = chosen(len(names))
    for b, bundle in enumerate(bundles):
        for o in kept:
            here = data.isel(bundle=b, operating=o)
            if all(n in data for n in needs) and motion.needed(data, bundle=b, operating=o):
                pictures.add(
                    f"motion-{b}-{o}", f"{bundle}, {names[o]}", _motion_caption(here), data, needs,
                    lambda b=b, o=o: motion.four_panels(data, bundle=b, operating=o), wide=True,  # type: ignore[misc]
                )  # fmt: skip
    if "status" in data:
        blocks += _jam_texts(data, "; there is no motion")
    if len(kept) < len(names):
        blocks.append(Text(f"{len(kept)} of {len(names)} operating points are drawn.", "note"))
    drawn = pictures.take()
    table = tables.motion_proofs(data, "state", names_of(data, "state"))
    return Section("motion", "Motion, undeformed and hot", [*blocks, *drawn, table])


def _motion_caption(here: Dataset) -> str:
    parts = []
    for s, state in enumerate(names_of(here, "state")):
        one = here.isel(state=s)
        share = float(one["contact_loss_share"]) if "contact_loss_share" in one else np.nan
        if np.isfinite(share):
            lost = f"{PERCENT(share):.1f} % of the time without drive-side contact"
            lost = "always in contact" if share < 1e-6 else lost
            parts.append(f"{state}: {motion.label_of(one)}, {lost}")
    of = int(here.attrs.get("mesh_periods", 1))
    turn = (
        f" The motion repeats after turns of {of} mesh periods: lines of the shafts and side lines "
        f"of the mesh stand every 1/{of} of an order."
    )
    return ("; ".join(parts) + "." if parts else "Undeformed against hot.") + turn * (of > 1)


def row(results: Result, pictures: Pictures) -> Section | None:
    """The gears at several temperatures."""
    data = results.group("temperature")
    if data is None:
        return None
    words = [celsius(float(t)) for t in data["gear_temperature"].values]
    speeds = chosen(data.sizes["operating"], most=MOST_SPEEDS)
    needs = (
        "displacement", "velocity", "section_displacement", "line_amplitude", "time", "label",
        "half_backlash",
    )  # fmt: skip
    names = operating_names(data)
    for b, bundle in enumerate(names_of(data, "bundle")):
        for o in speeds:
            pictures.add(
                f"row-{b}-{o}", f"Motion over gear temperature, {bundle}, {names[o]}",
                captions.ROW_VIEWS, data, needs,
                lambda b=b, o=o: temperature.views(data, bundle=b, operating=o),  # type: ignore[misc]
                wide=True,
            )  # fmt: skip
    blocks: list[Block] = [Text(captions.row_intro(data, ", ".join(words)))]
    drawn = pictures.take()
    table = tables.motion_proofs(data, "gear_temperature", words)
    return Section("temperature", "Gear temperature", [*blocks, *drawn, table])


def _section(name: str, title: str, blocks: list[Block], pictures: Pictures) -> Section | None:
    """A section with the pictures drawn for it; None where nothing was."""
    drawn = pictures.take()
    return Section(name, title, [*blocks, *drawn]) if drawn else None
