"""The page of case against case, and its figures as CSV, from ``versus.nc`` alone."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from markupsafe import Markup

from thermogear.base.arrays import Dataset
from thermogear.base.display import PERCENT, display, in_words, percent
from thermogear.base.vocabulary import UNDEFORMED, label
from thermogear.results.result import Result
from thermogear.results.tables import csv_tables
from thermogear.views.columns import Column, Row, declared, in_full, key, rows_along
from thermogear.views.page import Block, Code, Page, Pictures, Section, Table, Text
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.curves import along_path
from thermogear.views.plots.motion import HALF_ORDERS
from thermogear.views.plots.spectrum import draw_lines, floor_of, over_orders
from thermogear.views.style import INK, OKABE_ITO, WIDE, chosen, names_of
from thermogear.views.tables import band, jam_words
from thermogear.views.typesetting import axis_label, field_name, operating_names, plain, prose

MOST_POINTS = 3
"""At most so many operating points are drawn."""

FIGURES = {
    "half_backlash": "half backlash b′",
    "jam_temperature": "jams at, housing as it is",
    "proportional_jam_temperature": "jams at, all in proportion",
    "mean_stiffness": "mean mesh stiffness",
    "thermal_stiffness_ratio": "its change by heat",
    "greatest_flash_temperature": "greatest flash",
    "natural_frequency": "natural frequency of the mean stiffness",
    "frequency_ratio": "frequency ratio",
    "label": "motion",
    "dte_peak_to_peak": "swing of the transmission error",
    "peak_to_peak_displacement": "swing of x",
}
"""Figures of a point in the order of the tables."""
VIBRATION = tuple(FIGURES)[6:]
"""Those of the second table: both together would not fit beside each other."""
JAMS = ("jam_temperature", "proportional_jam_temperature")
HOT_ALONE = (*JAMS, "thermal_stiffness_ratio", "greatest_flash_temperature")

CURVES = (
    ("friction_coefficient", "Friction coefficient", "By the law each case has chosen."),
    ("flash_temperature", "Flash temperature rise", "Of the skin alone, zero at the pitch point."),
    (
        "deformation_sum",
        "Growth of both flanks",
        "Along the line of action; without heat it is zero.",
    ),
    ("half_backlash_curve", "Half backlash over the mesh phase", "Below zero a pair is jammed."),
    ("mesh_stiffness", "Mesh stiffness over the mesh phase", "High where two pairs carry."),
)


KINDS = ("versus",)


def page(result: Result) -> Page:
    """What differs, key figures, curves over each other, the cases themselves."""
    data, rows = result.data.assign_attrs(result.attrs), result.rows("series")
    return Page(
        result,
        _summary(data),
        [_differences(data), _figures(data), *_series(rows), *_pictures(data), _cases(data)],
        numbers=lambda: {
            "cases": names_of(data, "case"),
            "differences": result.rows("differences"),
            "units": _numbers_there(data),
            "figures": _rows(data),
            "series": rows,
        },
        told=lambda: [Text(_summary(data)), *(b for one in _series(rows) for b in one.blocks)],
        tables=lambda: csv_tables({"figures": data}, "versus_"),
    )


def _summary(data: Dataset) -> str:
    has = data["present"].values.astype(bool)
    shared = int((has.any(axis=1).sum(axis=0) > 1).sum())
    fields = len(json.loads(data.attrs["differences"]))
    return (
        f"{data.sizes['case']} cases side by side. {fields} field{'s' * (fields != 1)} of the case "
        f"files differ; {shared} of {data.sizes['operating']} operating points stand in more than "
        "one case."
    )


def _value(row: Row, place: int) -> Markup:
    return prose(in_words(row["values"][place]))


def _differences(data: Dataset) -> Section:
    titles = names_of(data, "case")
    by_case = [Column(title, partial(_value, place=k)) for k, title in enumerate(titles)]
    fields = json.loads(data.attrs["differences"])
    blocks: list[Block] = [Text("The case files say the same; at most their titles differ.")]
    if fields:
        caption = "Fields of the case files that differ."
        columns = [Column("field", lambda row: field_name(row["field"])), *by_case]
        blocks = [declared(caption, columns, fields, names=len(columns), wordy=True)]
    return Section("differences", "What differs", blocks, folded=False)


def _figures(data: Dataset) -> Section:
    bundles = [str(name) for name in data["bundle"].values]
    blocks: list[Block] = []
    for b, bundle in enumerate(bundles):
        here = data.isel(bundle=b)
        if here["present"].values.any():
            for names in (tuple(n for n in FIGURES if n not in VIBRATION), VIBRATION):
                kept = [name for name in names if name in here and _any(here, name)]
                if kept:
                    blocks.append(_table(here, kept, f"Bundle {bundle}"))
    return Section("figures", "Key figures", blocks, folded=False)


CASES = (
    Column("operating point", lambda row: row["operating"] if row["rank"] == 1 else ""),
    Column(
        "case",
        lambda row: row["case"] if row["cases"] > 1 else f"{row['case']}, in this case only",
    ),
)


def _table(here: Dataset, names: Sequence[str], words: str) -> Table:
    """A row for each case, those of one operating point below each other."""
    there = here["present"]
    here = here.assign_coords(operating=_points(here)).assign(
        rank=there.cumsum("case"), cases=there.sum("case")
    )
    by_state = [
        rows_along(here.isel(state=s), "operating", "case") for s in range(here.sizes["state"])
    ]
    caption = f"{words}: cases below each other at every operating point"
    if len(by_state) > 1:
        alone = [FIGURES[name] for name in names if name in HOT_ALONE]
        caption += ", undeformed → hot" + (f"; hot alone: {', '.join(alone)}" if alone else "")
    return declared(
        f"{caption}.",
        [*CASES, *(_column(here, name) for name in names)],
        [
            row | {"states": (*more, row)}
            for *more, row in zip(*by_state, strict=True)
            if row["present"]
        ],
        names=2,
        marked=lambda row: any(state["status"] == "jammed" for state in row["states"]),
    )


def _any(here: Dataset, name: str) -> bool:
    values = here[name].values
    return bool((values != "").any() if values.dtype.kind in "UO" else not np.isnan(values).all())


def _column(here: Dataset, name: str) -> Column:
    """A figure of a point, undeformed → hot where it has both and they read differently."""
    words = FIGURES[name]
    if name in JAMS:
        return Column(words, lambda row: jam_words(name, row, row["states"][0]))
    if name == "thermal_stiffness_ratio":
        return Column(words, name, percent)
    if name == "label":
        return Column(words, lambda row: _both([row["label"] or "–" for row in row["states"]]))
    digits = 4 if name == "natural_frequency" else 3
    figure = Column(words, name, digits, display(name, str(here[name].attrs["units"])))
    if name in HOT_ALONE:
        return figure
    jams = name == "half_backlash"

    def both(row: Row) -> str:
        return _both(
            [
                "none" if jams and state["status"] == "jammed" else str(figure.cell(state))
                for state in row["states"]
            ]
        )

    return Column(figure.title, both)


def _both(texts: Sequence[str]) -> str:
    return texts[0] if len(set(texts)) == 1 else " → ".join(texts)


def _points(data: Dataset) -> list[str]:
    names = operating_names(data)
    twice = len(set(names)) < len(names)
    return [str(name) for name in data["point"].values] if twice else names


def _band(row: Row, name: str, scale: float = 1.0) -> str:
    return band(**{which: scale * row[f"{name}_{which}"] for which in ("low", "middle", "high")})


def _better(row: Row, name: str) -> str:
    """In how many parts a figure is less than in the first case, and what that decides."""
    if not row.get(f"{name}_pairs"):
        return "–" if f"{name}_pairs" not in row else "all alike"
    low, high = row[f"{name}_least_share"], row[f"{name}_greatest_share"]
    word = "better" if low > 0.5 else "worse" if high < 0.5 else "not decided"
    count = f"{row[f'{name}_better']} of {row[f'{name}_pairs']}"
    return f"{word}: less in {count} parts ({PERCENT(low):.0f} to {PERCENT(high):.0f} %)"


SERIES = (
    Column("operating point", "point"),
    Column("case", "case"),
    Column("dynamic factor", partial(_band, name="dynamic_factor")),
    Column("against the first case", partial(_better, name="dynamic_factor")),
    Column("parts that lose contact", lambda row: f"{row['parting']} of {row['parts']}"),
    Column("error of the turn [µm]", partial(_band, name="turn_error", scale=1e6)),
    Column("error that repeats with the mesh [µm]", partial(_band, name="mesh_error", scale=1e6)),
    Column("against the first case", partial(_better, name="mesh_error")),
)


def _series(rows: Sequence[Row]) -> list[Section]:
    """Cases that are answered as series, as such."""
    caption = (
        "Cases answered as series: the median of the parts and what 90 % of them have. Against the "
        "first case parts of one number and seed are compared; the ends of the share of all parts "
        "hold with 95 %, and decide where both are on one side of a half. Parts lose contact up to "
        "the own speed."
    )
    table = declared(caption, SERIES, rows, names=8)
    return [Section("series", "Series against series", [table], folded=False)] if rows else []


def _pictures(data: Dataset) -> list[Section]:
    """One section for each bundle; points that several cases share come before others."""
    found = []
    points = _points(data)
    for b, bundle in enumerate(data["bundle"].values):
        has = data["present"].isel(bundle=b).values
        count = has.sum(axis=0)
        shared = np.flatnonzero(count > 1)
        of = shared if shared.size else np.flatnonzero(count)
        pictures, before = Pictures(), list[int]()
        for o in (int(of[i]) for i in chosen(of.size, most=MOST_POINTS)):
            for name, heading, words in CURVES:
                repeats = any(_alike(data, name, b, o, p) for p in before)
                if repeats or not has_curve(data, name, bundle=b, operating=o):
                    continue
                pictures.add(
                    f"{name}-{b}-{o}", f"{heading}, {points[o]}", words, data, (name,),
                    lambda n=name, o=o, b=b: curve(data, n, bundle=b, operating=o),  # type: ignore[misc]
                )  # fmt: skip
            if has_curve(data, "line_amplitude", bundle=b, operating=o):
                pictures.add(
                    f"spectrum-{b}-{o}", f"Spectrum of the displacement, {points[o]}",
                    "Lines of one order stand side by side: they are set apart by "
                    f"{SHIFT:g} orders for each case, so that none hides another.",
                    data, ("line_amplitude",),
                    lambda o=o, b=b: spectrum(data, bundle=b, operating=o), wide=True,  # type: ignore[misc]
                )  # fmt: skip
            before.append(o)
        blocks = pictures.take()
        if not blocks:
            continue
        intro = (
            "A colour for each case; where curves coincide the first is the broadest. Hot is "
            "solid, undeformed dashed. A curve that is the same at a further operating point is "
            "drawn once."
        )
        found.append(Section(f"curves-{b}", f"Curves, {bundle}", [Text(intro), *blocks]))
    return found


def _alike(data: Dataset, name: str, bundle: int, one: int, other: int) -> bool:
    """Whether ``name`` is the same at both operating points, rounding aside."""
    if name not in data:
        return False
    values = data[name].isel(bundle=bundle)
    a, b = (values.isel(operating=o).values for o in (one, other))
    size = float(np.nanmax(np.abs(a))) if np.isfinite(a).any() else 0.0
    return bool(np.allclose(a, b, rtol=0.0, atol=1e-6 * size, equal_nan=True))


def _cases(data: Dataset) -> Section:
    blocks: list[Block] = []
    for title, text in zip(data["case"].values, json.loads(data.attrs["cases"]), strict=True):
        blocks += [Text(str(title), "title"), Code(str(text))]
    return Section("cases", "The cases", blocks)


# --- tables as files ----------------------------------------------------------------------


def _rows(data: Dataset) -> list[dict[str, Any]]:
    """The figures of every case, bundle, point and state that there are."""
    names = [*map(key, ("case", "bundle", "point", "state", "label", *_numbers_there(data)))]
    places = data.assign_coords(operating=data["point"].values)
    rows = rows_along(places, "case", "bundle", "operating", "state")
    return [in_full(names, row) for row in rows if row["present"]]


def _numbers_there(data: Dataset) -> dict[str, str]:
    """The stored figures that are numbers, with their units."""
    names = [name for name in FIGURES if name in data and name != "label"]
    return {name: str(data[name].attrs.get("units", "1")) for name in names}


# --- pictures -----------------------------------------------------------------------------------


DASHES: dict[str, tuple[float, ...]] = {UNDEFORMED: (4, 2), "hot": ()}
HIGHEST_ORDER = 8.0
SHIFT = 0.07
"""Lines of neighbouring cases in a spectrum stand so far apart [orders]."""


def has_curve(data: Dataset, name: str, *, bundle: int, operating: int) -> bool:
    """Whether any case has a curve ``name`` there that is not zero throughout."""
    if name not in data:
        return False
    values = data[name].isel(bundle=bundle, operating=operating).values
    return bool((np.isfinite(values) & (values != 0.0)).any())


def curve(data: Dataset, name: str, *, bundle: int, operating: int) -> Picture:
    """``name`` of every case and state over its own positions, at one bundle and point."""
    along = "path_position" if "path_place" in data[name].dims else "mesh_phase"
    unit = str(data[name].attrs["units"])
    here = data.isel(bundle=bundle, operating=operating)
    y = Axis(axis_label(name, None if len(axis_label(name)) < 40 else WORDS.get(name)))
    panel = (
        Panel(Axis(axis_label(along), low=0.0, high=float(int(np.nanmax(here[along])) + 1)), y)
        if along == "mesh_phase"
        else _path(data, y)
    )
    drawn: set[str] = set()
    count = data.sizes["case"]
    for c, colour in zip(range(count), OKABE_ITO, strict=False):
        # earlier cases are broader, so that a later one on the same curve does not hide them
        width = 1.3 + min(1.8, 3.0 / max(count - 1, 1)) * (count - 1 - c)
        x = display(along)(here[along].isel(case=c).values)
        for s, state in enumerate(str(one) for one in data["state"].values):
            values = here[name].isel(case=c, state=s).values
            if not (np.isfinite(values) & (values != 0.0)).any():
                continue
            drawn.add(state)
            dash = DASHES.get(state, ())
            panel.curve(x, display(name, unit)(values), colour=colour, dash=dash, width=width)
    y.low = min(0.0, panel.extent("y")[0])
    _entries(panel, data)
    for state in sorted(drawn) if len(drawn) > 1 else ():
        panel.curve([], [], colour=INK, dash=DASHES.get(state, ()), label=plain(state))
    return Picture([[panel]], legend=4)


WORDS = {
    "friction_coefficient": "friction coefficient",
    "flash_temperature": "flash temperature rise",
    "deformation_sum": "growth of both flanks",
    "half_backlash_curve": "half backlash",
    "mesh_stiffness": "mesh stiffness",
    "line_amplitude": "amplitude of displacement",
}
"""Words of an axis where the long name would not fit beside it."""


def spectrum(data: Dataset, *, bundle: int, operating: int) -> Picture:
    """Spectral lines of the displacement: a colour for each case, open undeformed and full hot."""
    here = data.isel(bundle=bundle, operating=operating)
    unit = str(data["line_amplitude"].attrs["units"])
    scale = display("line_amplitude", unit)
    count = data.sizes["case"]
    ends = [
        floor_of(
            scale(here["line_amplitude"].isel(case=c).values),
            order=here["order"].isel(case=c).values,
            highest=HIGHEST_ORDER,
        )
        for c in range(count)
        if np.isfinite(here["line_amplitude"].isel(case=c).values).any()
    ]
    panel = over_orders(
        HALF_ORDERS, axis_label("line_amplitude", WORDS["line_amplitude"], unit),
        floor=max(low for low, _ in ends), top=max(high for _, high in ends), highest=HIGHEST_ORDER,
    )  # fmt: skip
    drawn: set[str] = set()
    for c, colour in zip(range(count), OKABE_ITO, strict=False):
        order = here["order"].isel(case=c).values
        for s, state in enumerate(str(one) for one in data["state"].values):
            lines = here["line_amplitude"].isel(case=c, state=s).values
            if not np.isfinite(lines).any():
                continue
            drawn.add(state)
            # the line at zero goes before the shift could move it away from zero
            kept = np.isfinite(order) & (order > 0.0)
            shift = SHIFT * (c - 0.5 * (count - 1))
            draw_lines(
                panel, order=order[kept] + shift, amplitude=scale(lines[kept]), colour=colour,
                label="", filled=state != UNDEFORMED,
            )  # fmt: skip
    _entries(panel, data)
    for state in sorted(drawn) if len(drawn) > 1 else ():
        cold = state == UNDEFORMED
        panel.points([], [], size=6.4 if cold else 4.2, open=cold, colour=INK, label=plain(state))
    return Picture([[panel]], size=(WIDE, 3.6), legend=4)


def _entries(panel: Panel, data: Dataset) -> None:
    """An entry of the legend for each case in its colour."""
    for title, colour in zip(data["case"].values, OKABE_ITO, strict=False):
        panel.curve([], [], colour=colour, width=2.4, label=plain(title))


def _path(data: Dataset, y: Axis) -> Panel:
    """Over the path of contact, A..E marked where the cases share one."""
    points = json.loads(str(data.attrs.get("path_points", "[]")))
    x = Axis(axis_label("path_position"))
    alike = bool(points) and all(
        set(each) == set(points[0])
        and np.allclose(list(each.values()), list(points[0].values()), rtol=1e-9)
        for each in points
    )
    if not alike:
        return Panel(x, y)
    values = data["path_position"].values
    told = {"path_points": json.dumps(points[0])}
    one = label({}, {"path_position": np.sort(values[np.isfinite(values)])}, told)
    panel = along_path(one, y)
    panel.x.words = x.words
    return panel
