"""Tables of the page, from stored figures."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from markupsafe import Markup

from thermogear.base.arrays import Dataset
from thermogear.base.display import (
    KELVIN,
    MICROMETRE,
    PERCENT,
    celsius,
    exactly,
    number,
    percent,
    span,
)
from thermogear.base.vocabulary import DIMENSIONLESS, QUANTITIES, STATUS, STILL, told_labels
from thermogear.views.columns import Column, Row, declared, rows_along
from thermogear.views.page import Cell, Table
from thermogear.views.plots.rows import of_row, row_names, value_parts
from thermogear.views.typesetting import html_symbol, jam_at, prose

JAMMED = STATUS.index("jammed")
_UNITS = {"um": "µm", "1": "", "deg": "°", "degC": "°C", "N m": "N m", "kg m2": "kg m²",
          "kg m^2": "kg m²", "N/m^2": "N/m²", "N/m^2 | N/m": "N/m², N/m"}  # fmt: skip


def symbol(name: str) -> Markup:
    """The symbol of a stored quantity, for a heading of a column."""
    return html_symbol(QUANTITIES[name].symbol)


def unit_text(unit: object) -> str:
    """A unit as text from a case or a run, written as a reader expects it."""
    return _UNITS.get(str(unit), str(unit))


def is_jammed(one: Dataset) -> bool:
    """Whether a point's status says jammed."""
    return "status" in one and int(one["status"]) == JAMMED


def motion_word(row: Row) -> Cell:
    """The label of a point; where it is jammed, with its temperature."""
    if row.get("status") == "jammed":
        jam = row.get("jam_temperature", math.nan)
        at = f" at {celsius(jam)}" if math.isfinite(jam) else ""
        return Markup('<b class="jam">jammed{}</b>').format(at)
    return str(row.get("motion", "–"))


def labelled(data: Dataset) -> Dataset:
    """``data`` with the words of its labels, as a reader sees them, under ``motion``."""
    if "label" not in data:
        return data
    return data.assign(motion=(data["label"].dims, told_labels(data)))


def is_settled(row: Row) -> bool:
    """Whether heat and loaded contact of a point are known, jammed or not."""
    return row.get("status") == "jammed" or row.get("status") not in STILL


def jam_words(name: str, hot: Row, cold: Row) -> str:
    """The words of the jam temperature ``name`` of a point, its undeformed state beside it."""
    stuck = cold.get("status") == "jammed"
    return jam_at(float(hot.get(name, math.nan)), without_heat=stuck, known=is_settled(hot))


def _jam(name: str) -> Callable[[Row], str]:
    """The words of a jam temperature of a point that has its undeformed state in its row."""
    return lambda row: jam_words(name, row, row["cold"])


def _change(row: Row) -> str:
    return percent(row["mean_stiffness"] / row["cold"]["mean_stiffness"] - 1.0)


def _gap(row: Row) -> Cell:
    """The mean over a mesh period, and the least where it reads differently."""
    if row.get("status") == "jammed":
        return "none"
    mean, least = (Column("", name).cell(row) for name in ("half_backlash", "least_half_backlash"))
    return mean if least in (mean, "–") else f"{mean} (least {least})"


STIFF = Column("", "mean_stiffness")
KEY_RESULTS = (
    Column("bundle", "bundle"),
    Column("operating point", "operating"),
    Column("b′ undeformed → hot [µm]", lambda row: f"{_gap(row['cold'])} → {_gap(row)}"),
    Column("jams at, housing as it is", _jam("jam_temperature")),
    Column("jams at, all in proportion", _jam("proportional_jam_temperature")),
    Column(
        "mean k undeformed → hot [10⁸ N/m]",
        lambda row: f"{STIFF.cell(row['cold'])} → {STIFF.cell(row)}",
    ),
    Column("change", _change),
    Column("Δk hot", "peak_to_peak_stiffness"),
    Column(
        Markup("f<sub>n</sub> of undeformed mean k [Hz]"),
        lambda row: row["cold"].get("natural_frequency"),
        4,
    ),
    Column(Markup("ω<sub>h</sub> undeformed"), lambda row: row["cold"].get("frequency_ratio")),
    Column("flash", "greatest_flash_temperature", 3, KELVIN),
    Column(
        "motion undeformed → hot",
        lambda row: Markup("{} → {}").format(motion_word(row["cold"]), motion_word(row)),
    ),
    Column("swing of the transmission error, hot", "dte_peak_to_peak"),
)


def band(*, low: float, middle: float, high: float) -> str:
    """Median and band of 90 % of parts, in no more figures than the band bears."""
    digits = 3 if high - low < 0.1 * middle else 2
    return f"{number(middle, digits)} ({number(low, digits)} to {number(high, digits)})"


OF_SERIES = (
    Column("dynamic factor of the series", "of_series"),
    Column("parts that lose contact", "parting"),
)


def _of_series(series: Dataset) -> dict[tuple[float, float], Row]:
    """The cells of the columns :data:`OF_SERIES` by speed and torque."""
    found: dict[tuple[float, float], Row] = {}
    for place in range(series.sizes["operating"]):
        here = series.isel(operating=place, damping=0)
        speed = float(here["own_speed"])
        own = np.argmin(np.abs(here["pinion_speed"].values - speed))
        parts = np.isfinite(here["own_dynamic_factor"].values).sum()
        parted = (here["contact_loss_onset"].values <= speed * (1.0 + 1e-9)).sum()
        low, middle, high = here["dynamic_factor"].values[:, own]
        found[speed, float(here["pinion_torque"])] = {
            "of_series": band(low=low, middle=middle, high=high),
            "parting": f"{parted} of {parts}",
        }
    return found


def key_results(mesh: Dataset, motion: Dataset | None, series: Dataset | None = None) -> Table:
    """Undeformed and hot side by side, a row for every bundle and operating point.

    Beside the first bundle, of one part, what the ``series`` has at each point that it answers.
    """
    if motion is not None:
        moved = labelled(motion)
        mesh = mesh.assign({n: moved[n] for n in ("motion", "dte_peak_to_peak") if n in moved})
    cold, hot = (rows_along(mesh.isel(state=end), "bundle", "operating") for end in (0, -1))
    beside = {} if series is None else _of_series(series)
    for row in hot[: mesh.sizes["operating"]]:
        row |= beside.get((row["pinion_speed"], row["pinion_torque"]), {})
    more = (
        " The dynamic factor of the series is its median and what 90 % of parts have; parts lose "
        "contact up to the speed of the point; all else is of the one part that is run."
    )
    return declared(
        "Undeformed and hot differ in the growth of gears and housing alone. b′ is the mean "
        "over a mesh period, Δk the peak to peak mesh stiffness, flash the highest rise along the "
        "path, swing the peak to peak movement of one base circle against the other."
        + more
        * bool(beside),
        (*KEY_RESULTS, *(OF_SERIES if beside else ())),
        [row | {"cold": undeformed} for row, undeformed in zip(hot, cold, strict=True)],
        names=2,
        marked=lambda row: "jammed" in (row.get("status"), row["cold"].get("status")),
    )


def _reason(row: Row) -> Cell:
    reason = prose(row.get("label_reason", ""))
    if not row.get("multiplier_imag", 0.0) > 0.0:
        return reason
    real, imag = (number(row[f"multiplier_{part}"], 4) for part in ("real", "imag"))
    return Markup("{}, pair {} ± {} i").format(reason, real, imag)


def _half_order(row: Row) -> float | str | None:
    """The half-order line; nothing but rounding is written as none."""
    line: float | None = row.get("half_order_amplitude")
    swing = row.get("peak_to_peak_displacement", math.nan)
    return "none" if line is not None and line <= 1e-9 * swing else line


PROOF = Column("proof", _reason)
CONTACT = (
    Column("out of contact", "contact_loss_share", lambda part: f"{PERCENT(max(part, 0.0)):.1f} %"),
    Column("back-side hits per period", "back_impacts", ".3g"),
)


def motion_proofs(motion: Dataset, axis: str, words: Sequence[str]) -> Table:
    """Every motion with its label, what proves it, and the figures of contact."""
    data = labelled(motion).assign_coords({axis: list(words)})
    columns = (
        Column("bundle", "bundle"),
        Column("state" if axis == "state" else "gear temperature", lambda row: row[axis]),
        Column("operating point", "operating"),
        Column("motion", motion_word),
        PROOF,
        Column("swing of x", "peak_to_peak_displacement"),
        Column("half-order line", _half_order, 3, MICROMETRE),
        *CONTACT,
    )
    return declared(
        "Every motion, and why it carries its label.",
        columns,
        rows_along(data, "bundle", axis, "operating"),
        names=5,
        marked=lambda row: row.get("status") == "jammed" or row["label"] == "undecided",
    )


def _agrees(row: Row) -> bool:
    """Whether a motion is what was expected, where anything was."""
    return not row["expected"] or row["label"] in row["expected"].split(" or ")


EXPECTED = (
    Column("expected", lambda row: row["expected"] or "–"),
    Column("agrees", lambda row: ("yes" if _agrees(row) else "no") if row["expected"] else "–"),
)


def row_table(points: Dataset, row: str) -> Table:
    """The points of one row: found against expected, with the proof."""
    data = labelled(of_row(points, row))
    parts = [value_parts(data.isel(point=i)) for i in range(data.sizes["point"])]
    swept = [Markup("{} = {}{}").format(html_symbol(mark), *rest) for mark, *rest in parts]
    rows = [row | {"swept": one} for row, one in zip(rows_along(data, "point"), swept, strict=True)]
    expects = any(row.get("expected") for row in rows)
    columns = (
        Column("value", "swept"),
        Column("motion", "motion"),
        *(EXPECTED if expects else ()),
        PROOF,
        Column("half-order line |X|", _half_order),
        *CONTACT,
    )
    return declared(
        f"Row {row}.",
        columns,
        rows,
        names=5 if expects else 3,
        marked=lambda row: expects and not _agrees(row),
    )


def _spans(data: Dataset, digits: int) -> dict[str, str]:
    return {n: span(data[n].values, digits) for n in DIMENSIONLESS if n in data}


def numbers_beside(points: Dataset | None, mesh: Dataset | None, name: str) -> Table:
    """The dimensionless numbers of a base set, and those of the rig beside them."""
    rows: list[Row] = []
    if points is not None:
        rows += [
            {"set": f"{name}, row {row}", **_spans(of_row(points, row), 4)}
            for row in row_names(points)
        ]
    if mesh is not None:
        rows += [
            {"set": f"this rig, {bundle}, {state}", **_spans(mesh.isel(bundle=b, state=s), 3)}
            for b, bundle in enumerate(mesh["bundle"].values)
            for s, state in enumerate(mesh["state"].values)
        ]
    columns = [Column("set", "set"), *(Column(symbol(n), n) for n in DIMENSIONLESS)]
    return declared("Dimensionless numbers side by side.", columns, rows)


def _choice(row: Row, bundle: str, meanings: Mapping[str, Any]) -> Cell:
    """What a bundle chooses, with what it means where that is known."""
    value: str = row[bundle]
    meant = meanings.get(row["field"], {})
    name = value.partition("(")[0]  # a law may show its parameters
    if name not in meant:
        return value
    return Markup("<b>{}</b><br/><small>{}</small>").format(value, prose(meant[name]))


def choices(bundles: Mapping[str, Any], meanings: Mapping[str, Any]) -> Table:
    """The choices of every bundle; rows in which they differ are marked."""
    fields = dict.fromkeys(field for chosen in bundles.values() for field in chosen)
    rows = [
        {"field": field, **{name: str(chosen.get(field, "–")) for name, chosen in bundles.items()}}
        for field in fields
    ]
    columns = [
        Column("choice", lambda row: row["field"].replace("_", " ")),
        *(Column(name, partial(_choice, bundle=name, meanings=meanings)) for name in bundles),
    ]
    return declared(
        "The choices of each bundle; marked rows differ.",
        columns,
        rows,
        names=len(columns),
        marked=lambda row: len({row[name] for name in bundles}) > 1,
        wordy=True,
    )


def _maybe(value: object) -> str:
    return exactly(float(value), 4) if isinstance(value, int | float) else ""


ERRATA = (
    Column("no.", lambda row: str(row.get("number", ""))),
    Column("printed", lambda row: prose(row.get("printed", ""))),
    Column("what is wrong", lambda row: prose(row.get("problem", ""))),
    Column("as printed", lambda row: _maybe(row.get("value_as_printed"))),
    Column("repaired", lambda row: _maybe(row.get("value_repaired"))),
    Column(
        "unit",
        lambda row: (
            unit_text(row.get("unit", ""))
            if _maybe(row.get("value_as_printed")) + _maybe(row.get("value_repaired"))
            else ""
        ),
    ),
)


def errata(rows: Iterable[Row]) -> Table:
    """What is printed wrongly, with its value beside the repaired one."""
    caption = "Printed formulas evaluated in SI, for this pair; none of them feeds a result."
    return declared(caption, ERRATA, rows, names=3, wordy=True)


FACTS = (
    Column("group", "shown_group"),
    Column("quantity", lambda row: str(row.get("name", ""))),
    Column(
        "value",
        lambda row: exactly(row["value"]) if isinstance(row["value"], float) else str(row["value"]),
    ),
    Column("unit", lambda row: unit_text(row.get("unit", ""))),
)


def facts(rows: Sequence[Row]) -> Table:
    """Single figures in groups, each named once."""
    before = [None, *(row["group"] for row in rows)]
    named = [
        {**row, "shown_group": "" if row["group"] == last else row["group"]}
        for row, last in zip(rows, before, strict=False)
    ]
    return declared("Derived from the case, or read off the results.", FACTS, named, names=2)
