"""The tables of a measured record, and of models against one, for page and terminal alike."""

from __future__ import annotations

from functools import partial

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import GRAVITY, MICROMETRE, PERCENT, Display, number
from thermogear.results.result import Result
from thermogear.views.columns import PLAIN, Column, Row, declared, rows_along
from thermogear.views.page import Table
from thermogear.views.typesetting import html_symbol, prose

UNCERTAINTY = Column(html_symbol("u_D"), "line_uncertainty", 4, PERCENT)
QUANTITY = {
    "displacement": ("displacement [µm]", MICROMETRE),
    "frequency": ("frequency [Hz]", PLAIN),
    "acceleration": ("acceleration [m/s²]", PLAIN),
}
"""Compared quantities: words with the unit, and how their numbers are shown."""


def line_table(result: Result, most: int | None = None) -> Table | None:
    """Every line of a record, or the ``most`` prominent ones; None without lines."""
    data = result.group("lines")
    if data is None:
        return None
    strongest = np.sort(np.argsort(-data["line_prominence"].values)[:most])
    rows = rows_along(data, "line")
    columns = (
        Column("channel", "channel"),
        Column("line", "name"),
        Column("order", "line_order", ".3f"),
        Column("cycles/sample", "line_position", ".6f"),
        Column("f", "line_frequency", 8),
        Column("±", "line_frequency_half_width", 2),
        Column("reading", "line_reading", 4, Display(result.text("unit") or "file's")),
        Column("a", "line_acceleration", 4, GRAVITY),
        Column("x", "line_displacement", 4),
        UNCERTAINTY,
        Column("±", "line_half_width", 3, PERCENT),
        Column("over floor", "line_prominence", 4),
        Column("off bin", "line_bin_offset", 4),
    )
    return declared(
        prose(
            "Peak amplitudes over the record (root mean square of a line's own amplitude); u_D: "
            "relative standard uncertainty; ±: half width of the 95 % interval. – : the record "
            "does not tell."
        ),
        columns,
        [rows[place] for place in strongest],
        names=2,
    )


def _value(row: Row, name: str) -> str:
    """A value in the unit of what the row compares."""
    _, shown = QUANTITY[row["quantity"]]
    return number(shown(row[name]), 5)


def _error(row: Row, name: str) -> str:
    """The error of a model, after that which is printed where one is."""
    printed = row.get(f"printed {name}", "")
    return f"{printed} | {PERCENT(row[f'error {name}']):+.2f}".removeprefix(" | ").replace("-", "−")


def comparison_table(data: Dataset) -> Table:
    """Measured and simulated values with the errors of every model and their uncertainties."""
    models = [str(name) for name in data["model"].values]
    has_printed = "printed" in data.coords
    parts = {"value": "simulated_value", "error": "comparison_error"}
    parts |= {"printed": "printed"} if has_printed else {}
    per_model = {
        f"{word} {name}": data[stored].isel(model=place, drop=True).reset_coords(drop=True)
        for word, stored in parts.items()
        for place, name in enumerate(models)
    }
    several = (Column("record", "record"), Column("channel: place, axis; line", "where"))
    beside = [
        column
        for column in several
        if column.value in data.coords and any(data[str(column.value)].values)
    ]
    columns = [
        *beside,
        Column("speed", "pinion_speed", 4),
        Column("quantity", lambda row: QUANTITY[row["quantity"]][0]),
        Column("verdict", lambda row: row["verdict"] or "–"),
        Column("measured", partial(_value, name="measured_value")),
        *(Column(name, partial(_value, name=f"value {name}")) for name in models),
        *(
            Column(
                f"error {name} [%]{', printed | recomputed' * has_printed}",
                partial(_error, name=name),
            )
            for name in models
        ),
        *(
            Column(html_symbol(words), name, ".2f", PERCENT)
            for words, name in (
                ("u_num", "u_num"), ("u_input", "u_input"), ("u_D", "u_data"), ("u_val", "u_val"),
            )
        ),
    ]  # fmt: skip
    misprinted = has_printed and bool(data["misprinted"].values.any())
    wrong = " Marked: a printed error that its entries cannot give, however they were rounded."
    return declared(
        f"Error: (simulated − measured)/measured.{wrong * misprinted}",
        columns,
        rows_along(data.assign(per_model), "row"),
        names=3 + len(beside),
        marked=lambda row: bool(row.get("misprinted", False)),
    )


IMPLIED = (
    Column("speed", "pinion_speed", 4),
    Column("implied a", "implied_acceleration", ".1f", GRAVITY),
    Column("implied speed", "implied_shaft_speed", ".1f"),
    Column("off mesh", "mesh_line_offset", ".2f"),
    Column("off mesh [bins]", "line_bin_offset", ".2f"),
)


def implied_table(implied: Dataset) -> Table:
    """Acceleration, speed and distance from the mesh line that measured lines imply."""
    return declared(
        "What the measured lines imply.", IMPLIED, rows_along(implied, "speed"), names=0
    )


GAIN = (
    Column("bundle", lambda row: row["bundle"] or "–"),
    Column("nearer", "verdict"),
    Column("with heat nearer in", lambda row: f"{row['nearer']} of {row['rows']}"),
    Column("mean gain", "gain", "+.2f", PERCENT),
    Column("mean u_val", "u_val", "+.2f", PERCENT),
)


def comparison_tables(result: Result) -> list[Table]:
    """What heat gains, every comparison, what the lines imply: as far as they are there."""
    heat = result.table("figures").get("heat", ())
    caption = "Gain: |E without heat| − |E with heat|, over all."
    tables = [declared(caption, GAIN, heat, names=2)] if heat else []
    for name, table in (("comparison", comparison_table), ("implied", implied_table)):
        data = result.group(name)
        tables += [table(data)] if data is not None else []
    return tables
