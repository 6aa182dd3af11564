"""Tables of the page, from stored figures."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup

from thermogear.base.display import celsius, display, exactly, number, percent, span
from thermogear.base.vocabulary import DIMENSIONLESS, QUANTITIES, STATUS, is_known
from thermogear.views.page import Cell, Table
from thermogear.views.plots.rows import of_row, row_names, value_parts
from thermogear.views.typesetting import html_symbol, jam_at, label_text, operating_names, prose

if TYPE_CHECKING:
    import xarray as xr

JAMMED = STATUS.index("jammed")
_UNITS = {"um": "µm", "1": "", "deg": "°", "degC": "°C", "N m": "N m", "kg m2": "kg m²",
          "kg m^2": "kg m²", "N/m^2": "N/m²", "N/m^2 | N/m": "N/m², N/m"}  # fmt: skip


def symbol(name: str) -> Markup:
    """The symbol of a stored quantity, for a heading of a column."""
    return html_symbol(QUANTITIES[name].symbol)


def unit_text(unit: object) -> str:
    """A unit as text from a case or a run, written as a reader expects it."""
    return _UNITS.get(str(unit), str(unit))


def value_of(data: xr.Dataset, name: str, digits: int = 3) -> str:
    """One stored figure in display units, a dash where it is absent or not finite."""
    if name not in data:
        return "–"
    unit = str(data[name].attrs.get("units", QUANTITIES[name].unit if name in QUANTITIES else "1"))
    known = name if name in QUANTITIES else "displacement"
    return number(float(display(known, unit)(data[name].item())), digits)


def is_jammed(one: xr.Dataset) -> bool:
    """Whether a point's status says jammed."""
    return "status" in one and int(one["status"]) == JAMMED


def motion_word(one: xr.Dataset) -> Cell:
    """The label of a point; where it is jammed, with its temperature."""
    if is_jammed(one):
        jam = float(one["jam_temperature"]) if "jam_temperature" in one else math.nan
        at = f" at {celsius(jam)}" if math.isfinite(jam) else ""
        return Markup('<b class="jam">jammed{}</b>').format(at)
    return label_text(one) if "label" in one else "–"


def key_results(mesh: xr.Dataset, path: xr.Dataset | None, motion: xr.Dataset | None) -> Table:
    """Undeformed and hot side by side, a row for every bundle and operating point."""
    head: list[Cell] = [
        "bundle", "operating point",
        Markup("b′ undeformed → hot [µm]"),
        "jams at, housing as it is", "jams at, all in proportion",
        Markup("mean k undeformed → hot [10⁸ N/m]"), "change",
        "Δk hot [10⁸ N/m]", Markup("f<sub>n</sub> of undeformed mean k [Hz]"),
        Markup("ω<sub>h</sub> undeformed"),
        "flash [K]", Markup("motion undeformed → hot"), "swing of the transmission error, hot [µm]",
    ]  # fmt: skip
    rows: list[list[Cell]] = []
    marked: set[int] = set()
    for b, bundle in enumerate(mesh["bundle"].values):
        for o, name in enumerate(operating_names(mesh)):
            points = mesh.isel(bundle=b, operating=o)
            cold, hot = points.isel(state=0), points.isel(state=-1)
            moved = None if motion is None else motion.isel(bundle=b, operating=o)
            flash = "–"
            if path is not None and "flash_temperature" in path:
                here = path["flash_temperature"].isel(bundle=b, operating=o, state=-1)
                top = here.values[np.isfinite(here.values)]
                flash = number(float(top.max())) if top.size else "–"
            if is_jammed(hot) or is_jammed(cold):
                marked.add(len(rows))
            k = [float(one["mean_stiffness"]) for one in (cold, hot)]
            rows.append([
                str(bundle), name,
                f"{_gap(cold)} → {_gap(hot)}",
                *(
                    jam_at(
                        float(hot.get(name, np.nan)), without_heat=is_jammed(cold),
                        known=bool(is_known(int(hot["status"]))),
                    )
                    for name in ("jam_temperature", "proportional_jam_temperature")
                ),
                f"{number(k[0] * 1e-8)} → {number(k[1] * 1e-8)}", percent(k[1] / k[0] - 1.0),
                value_of(hot, "peak_to_peak_stiffness"), value_of(cold, "natural_frequency", 4),
                value_of(cold, "frequency_ratio"), flash,
                Markup("{} → {}").format(_state_word(cold, moved, 0), _state_word(hot, moved, -1)),
                "–" if moved is None else value_of(moved.isel(state=-1), "dte_peak_to_peak"),
            ])  # fmt: skip
    caption = (
        "Undeformed and hot differ in the growth of gears and housing alone. b′ is the mean "
        "over a mesh period, Δk the peak to peak mesh stiffness, flash the highest rise along the "
        "path, swing the peak to peak movement of one base circle against the other."
    )
    return Table(caption, head, rows, names=2, marked=frozenset(marked))


def _gap(one: xr.Dataset) -> str:
    """The mean over a mesh period, and the least where it reads differently."""
    if is_jammed(one):
        return "none"
    mean, least = (value_of(one, name) for name in ("half_backlash", "least_half_backlash"))
    return mean if least in (mean, "–") else f"{mean} (least {least})"


def _state_word(figures: xr.Dataset, motion: xr.Dataset | None, state: int) -> Cell:
    if is_jammed(figures):
        return motion_word(figures)
    return "–" if motion is None else motion_word(motion.isel(state=state))


def motion_proofs(motion: xr.Dataset, axis: str, words: Sequence[str]) -> Table:
    """Every motion with its label, what proves it, and the figures of contact."""
    head: list[Cell] = [
        "bundle", "state" if axis == "state" else "gear temperature", "operating point",
        "motion", "proof", "swing of x [µm]", "half-order line [µm]", "out of contact",
        "back-side hits per period",
    ]  # fmt: skip
    rows: list[list[Cell]] = []
    marked: set[int] = set()
    for b, bundle in enumerate(motion["bundle"].values):
        for a, word in enumerate(words):
            for o, name in enumerate(operating_names(motion)):
                one = motion.isel({"bundle": b, axis: a, "operating": o})
                if is_jammed(one) or str(one["label"].item()) == "undecided":
                    marked.add(len(rows))
                rows.append([
                    str(bundle), word, name, motion_word(one), _reason(one),
                    value_of(one, "peak_to_peak_displacement"), _half_order(one),
                    _share(one), _impacts(one),
                ])  # fmt: skip
    caption = "Every motion, and why it carries its label."
    return Table(caption, head, rows, names=5, marked=frozenset(marked))


def _reason(one: xr.Dataset) -> Cell:
    said = prose(one["label_reason"].item()) if "label_reason" in one else Markup("")
    if "multiplier_imag" not in one or not float(one["multiplier_imag"]) > 0.0:
        return said
    real, imag = (number(float(one[f"multiplier_{part}"]), 4) for part in ("real", "imag"))
    return Markup("{}, pair {} ± {} i").format(said, real, imag)


def _half_order(one: xr.Dataset) -> str:
    """The half-order line; nothing but rounding is written as none."""
    if "half_order_amplitude" not in one:
        return "–"
    line = float(one["half_order_amplitude"])
    swing = math.nan
    if "peak_to_peak_displacement" in one:
        swing = float(one["peak_to_peak_displacement"])
    if math.isfinite(swing) and line <= 1e-9 * swing:
        return "none"
    return value_of(one, "half_order_amplitude")


def _share(one: xr.Dataset) -> str:
    if "contact_loss_share" not in one:
        return "–"
    share = float(one["contact_loss_share"])
    return f"{100.0 * max(share, 0.0):.1f} %" if math.isfinite(share) else "–"


def _impacts(one: xr.Dataset) -> str:
    if "back_impacts" not in one:
        return "–"
    hits = float(one["back_impacts"])
    return f"{hits:.3g}" if math.isfinite(hits) else "–"


def row_table(points: xr.Dataset, row: str) -> Table:
    """The points of one row: found against expected, with the proof."""
    data = of_row(points, row)
    expects = "expected" in data and any(str(e) for e in data["expected"].values)
    head: list[Cell] = ["value", "motion"]
    head += ["expected", "agrees"] if expects else []
    head += ["proof", "half-order line |X|", "out of contact", "back-side hits per period"]
    rows: list[list[Cell]] = []
    marked: set[int] = set()
    for i in range(data.sizes["point"]):
        one = data.isel(point=i)
        mark, value, unit = value_parts(one)
        found = str(one["label"].item())
        line: list[Cell] = [
            Markup("{} = {}{}").format(html_symbol(mark), value, unit), label_text(one)
        ]  # fmt: skip
        if expects:
            wanted = str(one["expected"].item())
            agrees = found in wanted.split(" or ") if wanted else True
            line += [wanted or "–", ("yes" if agrees else "no") if wanted else "–"]
            if not agrees:
                marked.add(i)
        rows.append([*line, _reason(one), _half_order(one), _share(one), _impacts(one)])
    names = 5 if expects else 3
    return Table(f"Row {row}.", head, rows, names=names, marked=frozenset(marked))


def numbers_beside(points: xr.Dataset | None, mesh: xr.Dataset | None, name: str) -> Table:
    """The dimensionless numbers of a base set, and those of the rig beside them."""
    head: list[Cell] = ["set", *(symbol(n) for n in DIMENSIONLESS)]
    rows: list[list[Cell]] = []
    if points is not None:
        for row in row_names(points):
            data = of_row(points, row)
            cells = [span(data[n].values, 4) if n in data else "–" for n in DIMENSIONLESS]
            rows.append([f"{name}, row {row}", *cells])
    if mesh is not None:
        for b, bundle in enumerate(mesh["bundle"].values):
            for s, state in enumerate(mesh["state"].values):
                here = mesh.isel(bundle=b, state=s)
                cells = [span(here[n].values, 3) if n in here else "–" for n in DIMENSIONLESS]
                rows.append([f"this rig, {bundle}, {state}", *cells])
    return Table("Dimensionless numbers side by side.", head, rows)


def choices(bundles: Mapping[str, Any], meanings: Mapping[str, Any]) -> Table:
    """The choices of every bundle; rows in which they differ are marked."""
    names = list(bundles)
    fields: dict[str, None] = {}
    for table in bundles.values():
        fields |= dict.fromkeys(table if isinstance(table, Mapping) else {})
    rows: list[list[Cell]] = []
    marked: set[int] = set()
    for field in fields:
        values = [str(bundles[name].get(field, "–")) for name in names]
        if len(set(values)) > 1:
            marked.add(len(rows))
        known = meanings.get(field, {})
        meant = known if isinstance(known, Mapping) else {}
        names_of = [value.partition("(")[0] for value in values]  # a law may show its parameters
        cells: list[Cell] = [
            Markup("<b>{}</b><br/><small>{}</small>").format(value, prose(meant[name]))
            if name in meant
            else value
            for value, name in zip(values, names_of, strict=True)
        ]
        rows.append([field.replace("_", " "), *cells])
    caption = "The choices of each bundle; marked rows differ."
    return Table(caption, ["choice", *names], rows, len(names) + 1, frozenset(marked), wordy=True)


def errata(rows: Iterable[Mapping[str, Any]]) -> Table:
    """What is printed wrongly, with its value beside the repaired one."""
    head: list[Cell] = ["no.", "printed", "what is wrong", "as printed", "repaired", "unit"]
    lines: list[list[Cell]] = []
    for row in rows:
        both = [_maybe(row.get("value_as_printed")), _maybe(row.get("value_repaired"))]
        shows = both != ["", ""]
        lines.append([
            str(row.get("number", "")), prose(row.get("printed", "")),
            prose(row.get("problem", "")), *both, unit_text(row.get("unit", "")) if shows else "",
        ])  # fmt: skip
    caption = "Printed formulas evaluated in SI, for this pair; none of them feeds a result."
    return Table(caption, head, lines, names=3, wordy=True)


def _maybe(value: object) -> str:
    return exactly(float(value), 4) if isinstance(value, int | float) else ""


def facts(rows: Iterable[Mapping[str, Any]]) -> Table:
    """Single figures in groups."""
    lines: list[list[Cell]] = []
    before = None
    for row in rows:
        group = str(row.get("group", ""))
        value = row.get("value", "")
        text = exactly(float(value), 6) if isinstance(value, float) else str(value)
        shown = group if group != before else ""
        before = group
        lines.append([shown, str(row.get("name", "")), text, unit_text(row.get("unit", ""))])
    return Table(
        "Derived from the case, or read off the results.",
        ["group", "quantity", "value", "unit"],
        lines,
        names=2,
    )


def words(caption: str, head: Sequence[str], rows: Iterable[Sequence[object]]) -> Table:
    """A table of texts."""
    lines = [[cell if isinstance(cell, Markup) else str(cell) for cell in row] for row in rows]
    return Table(caption, list(head), lines, names=len(head), wordy=True)
