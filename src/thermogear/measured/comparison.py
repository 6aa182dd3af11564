"""Measured lines against simulated ones: errors, uncertainties, verdicts, what the lines imply.

Verdicts follow ASME V&V 20 (:mod:`thermogear.measured.verdicts`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from thermogear.base.errors import InputError
from thermogear.base.units import RPM, STANDARD_GRAVITY
from thermogear.base.vocabulary import label
from thermogear.measured.published import (
    LineTable,
    Printed,
    SpeedLine,
    allowed,
    rounded_error,
    unstated_processing,
)
from thermogear.measured.reduction import Measurement
from thermogear.measured.verdicts import Heat, Row, heat_of, verdict
from thermogear.results.result import Notice, Result, now

_IMPLAUSIBLE_G = 50.0
_DEEPEST_SUBHARMONIC = 16
_ROUNDING = 1e-4
"""Relative: how far printed frequencies and speeds are off by their own digits."""
UNCERTAINTIES = ("u_num", "u_input", "u_data", "u_val")


@dataclass(frozen=True, kw_only=True)
class Implied:
    """What a measured line says if taken at its word."""

    speed: float
    acceleration_g: float
    shaft_speed: float | None
    offset_hertz: float | None
    offset_bins: float | None


@dataclass(frozen=True)
class Comparison:
    """Rows for every speed, what the lines imply, and what should be known before believing.

    ``agreement``: how many lines of each model lie within u_val, in words, where that is told.
    """

    measured: str
    models: tuple[str, ...]
    rows: tuple[Row, ...]
    implied: tuple[Implied, ...]
    notices: tuple[Notice, ...]
    agreement: str = ""

    @property
    def conclusion(self) -> str:
        """One sentence on the displacements, or on the accelerations where these are compared."""
        compared = [row for row in self.rows if row.quantity != "frequency"]
        verdicts = [row.verdict.partition("; ")[0] for row in compared]
        if len(self.models) < 2:
            return "one model: its errors stand beside u_val, no other to be better than"
        counts = {v: verdicts.count(v) for v in dict.fromkeys(verdicts)}
        kind = compared[0].quantity if compared else "displacement"
        said = f"of {len(verdicts)} {kind}s: " + ", ".join(
            f"{verdict} {count} times" for verdict, count in counts.items()
        )
        heat = ". ".join(one.words for one in self.heat)
        return "; ".join(one for one in (heat, said, self.agreement) if one)

    @property
    def heat(self) -> tuple[Heat, ...]:
        """Of every bundle that is computed without heat and with it, whether heat is nearer."""
        return heat_of(self.rows, self.models)

    def row(self, speed: float, quantity: str) -> Row:
        """The row of a quantity at the speed [rad/s] nearest to ``speed``."""
        rows = [row for row in self.rows if row.quantity == quantity]
        if not rows:
            raise InputError("quantity", repr(quantity), allowed="frequency or displacement")
        return min(rows, key=lambda row: abs(row.speed - speed))


ANOTHER_SPEED = 0.05
"""Share of a speed: a mesh line further off is of another speed, as LineTable.near has it."""


def table_of(found: Measurement, speed: float | None = None) -> LineTable:
    """The mesh line of a measurement (its clearest channel) as a table."""
    lines = [line for line in found.lines if line.name in ("mesh x 1", "line x 1")]
    lines = [line for line in lines if np.isfinite(line.displacement)]
    withheld = next((line.withheld for line in found.lines if line.withheld), "")
    if not lines and withheld:
        raise InputError(
            "measured",
            found.record.source,
            why=f"its lines are withheld: {withheld}",
            fix="read another channel by --channel, or another piece of the record",
        )
    if not lines:
        raise InputError(
            "measured",
            found.record.source,
            why="it gives no displacement: rate or unit is unknown, or no mesh line was found",
            fix="--rate, --unit",
        )
    line = max(lines, key=lambda item: item.prominence)
    nominal = speed if speed is not None else line.shaft_speed
    teeth = found.teeth or found.given[0]
    if not np.isfinite(nominal):
        why = "no tooth number is known" if teeth is None else "the record does not decide it"
        raise InputError("speed", "none", why=why, fix="--speed" if teeth else "--teeth or --speed")
    implied = 2.0 * np.pi * line.frequency / teeth if teeth else nominal
    if abs(implied - nominal) > ANOTHER_SPEED * nominal:
        raise InputError(
            "speed",
            f"{nominal / RPM:.6g} rpm",
            why=f"the mesh line of {found.record.source}, {line.frequency:.6g} Hz, is that of "
            f"{implied / RPM:.6g} rpm and {teeth} teeth",
            fix="leave the speed out, or state other teeth",
        )
    return LineTable(
        f"{found.record.source}, {line.channel}",
        (
            SpeedLine(
                speed=nominal,
                frequency=line.frequency,
                displacement=line.displacement,
                uncertainty=line.uncertainty,
            ),
        ),
        found.teeth,
        found.record.source,
        (found.record.rate or 1.0) / found.samples,
        processing_stated=True,
    )


def compared(
    models: Mapping[str, LineTable],
    printed: Printed,
    *,
    u_data: float | None,
    u_num: float,
    u_input: Mapping[float, float] | None = None,
    said: Sequence[Notice] = (),
) -> Comparison:
    """Models against measured lines, each within 5 % of a measured speed.

    Standard uncertainties, relative: ``u_data`` of the measurement (None: as the table states it),
    ``u_num`` of the simulation and ``u_input`` by speed [rad/s], both relative to the simulated
    line; ``said``: notices that come first.
    Raises InputError when no speed is common to both sides.
    """
    table = printed.measured
    names = tuple(models)
    if not names:
        raise InputError("simulated", "nothing", allowed="at least one model", fix="name a case")
    rows: list[Row] = []
    notices, wrong = list(said), list[float]()
    highest = max(line.frequency for line in table.lines)
    for number, line in enumerate(table.lines):
        found = [models[name].near(line.speed) for name in names]
        if any(item is None for item in found):
            notices.append(Notice.of("speed_not_simulated", speed=line.speed))
            continue
        simulated = [item for item in found if item is not None]
        u_d, told = _data_uncertainty(line, table, highest, u_data)
        notices += [told] if told is not None and told not in notices else []
        of_inputs = u_input or {line.speed: 0.0}
        entered = of_inputs[min(of_inputs, key=lambda speed: abs(speed - line.speed))]
        swing, turns = (
            Row(
                speed=line.speed,
                quantity=quantity,
                measured=getattr(line, quantity),
                simulated=tuple(getattr(one, quantity) for one in simulated),
                printed=_printed(printed, names, quantity, number),
                record=line.record,
            )
            for quantity in ("displacement", "frequency")
        )
        # both are known relative to what is simulated
        ratio = max(swing.simulated) / swing.measured
        swing = replace(
            swing, u_num=ratio * u_num, u_input=ratio * entered, u_data=u_d,
            computed=u_input is not None,
        )  # fmt: skip
        rows += [
            replace(
                turns,
                u_data=(table.bin_width or 0.0) / np.sqrt(12.0) / line.frequency,
                verdict=_frequency_verdict(simulated, line, table, names, wrong),
            ),
            replace(swing, verdict=verdict(swing, names)),
        ]
    if not rows:
        raise InputError(
            "speeds",
            ", ".join(f"{line.speed / RPM:.0f} rpm" for line in table.lines),
            why="none of them is simulated",
            fix="give the case one of them within 5 %: --set 'operating.speed=... rpm'",
        )
    implied = tuple(_implied(line, table) for line in table.lines)
    notices += _misprints(rows, names)
    notices += [Notice.of("frequency_impossible", speeds=wrong)] if wrong else []
    notices += _doubts(implied)
    return Comparison(table.name, names, tuple(rows), implied, tuple(notices))


def _data_uncertainty(
    line: SpeedLine, table: LineTable, highest: float, given: float | None
) -> tuple[float, Notice | None]:
    if given is not None:
        return float(given), None
    if line.uncertainty is not None:
        return line.uncertainty, None
    if table.processing_stated:
        return 0.0, Notice.of("uncertainty_not_stated")
    parts = unstated_processing(line.frequency, highest=highest)
    size = float(np.sqrt(sum(part**2 for part in parts.values())))
    return size, Notice.of("processing_not_stated")


def _frequency_verdict(
    simulated: Sequence[SpeedLine],
    line: SpeedLine,
    table: LineTable,
    names: Sequence[str],
    wrong: list[float],
) -> str:
    """A model forced at the mesh frequency answers at j/n of it and nowhere else; the speed goes
    to ``wrong`` where one does not.

    A speed is known no better than the measured line shows it: by how far that line is off j/n of
    the speed stated for it, and by half a line of its spectrum.
    """
    teeth = table.teeth
    if teeth is None:
        return "no tooth number: nothing to tell"
    known = max(_ROUNDING, _off(line, teeth), 0.5 * (table.bin_width or 0.0) / line.frequency)
    models = zip(names, simulated, strict=True)
    impossible = {name: item for name, item in models if _off(item, teeth) > known}
    if impossible:
        which = ", ".join(f"{name} ({item.frequency:g} Hz)" for name, item in impossible.items())
        wrong.append(line.speed)
        forced = teeth * line.speed / (2.0 * np.pi)
        return (
            f"impossible: {which} is no line j/n of the {forced:.3f} Hz that "
            f"forces the model, known to {100.0 * known:.2g} %"
        )
    if len({item.frequency for item in simulated}) == 1:
        return "the same by construction: the speed sets it"
    return "set by the speed, not by the model"


def _off(line: SpeedLine, teeth: int) -> float:
    """How far a line is off the nearest j/n of the mesh frequency of its own speed, relative."""
    ratio = 2.0 * np.pi * line.frequency / (teeth * line.speed)
    nearest = Fraction(ratio).limit_denominator(_DEEPEST_SUBHARMONIC)
    return abs(float(nearest) / ratio - 1.0)


def _printed(printed: Printed, names: Sequence[str], quantity: str, number: int) -> tuple[str, ...]:
    found = tuple(printed.errors.get((name, quantity, number), "") for name in names)
    return found if any(found) else ()


def _misprinted(row: Row) -> dict[int, tuple[float, float]]:
    """Place of a model whose printed error its entries cannot give -> the errors [%] they can."""
    found = {}
    for place, (simulated, text) in enumerate(zip(row.simulated, row.printed, strict=False)):
        low, high = rounded_error(simulated=simulated, measured=row.measured, quantity=row.quantity)
        if text and not allowed(text, low=low, high=high):
            found[place] = low, high
    return found


def _misprints(rows: Sequence[Row], names: Sequence[str]) -> list[Notice]:
    return [
        Notice.of(
            "printed_error_wrong",
            speed=row.speed,
            quantity=row.quantity,
            model=names[place],
            printed=float(row.printed[place]) / 100.0,
            error=abs(row.errors[place]),
            least=low / 100.0,
            greatest=high / 100.0,
        )
        for row in rows
        for place, (low, high) in _misprinted(row).items()
    ]


def _implied(line: SpeedLine, table: LineTable) -> Implied:
    shaft, offset, bins = None, None, None
    if table.teeth is not None:
        shaft = line.shaft_speed(table.teeth)
        offset = line.frequency - table.teeth * line.speed / (2.0 * np.pi)
        bins = offset / table.bin_width if table.bin_width else None
    return Implied(
        speed=line.speed,
        acceleration_g=line.acceleration_g,
        shaft_speed=shaft,
        offset_hertz=offset,
        offset_bins=bins,
    )


def _doubts(implied: Sequence[Implied]) -> list[Notice]:
    large = [item for item in implied if item.acceleration_g > _IMPLAUSIBLE_G]
    implausible = Notice.of(
        "acceleration_implausible",
        accelerations=[item.acceleration_g * STANDARD_GRAVITY for item in large],
        speeds=[item.speed for item in large],
    )
    return [*([implausible] if large else []), Notice.of("housing_is_not_mesh")]


def result_of(found: Comparison) -> Result:
    """The comparison as labelled datasets, ready to store and to draw."""

    def column(rows: Sequence[object], name: str) -> Any:
        found = [getattr(row, name) for row in rows]
        return [float("nan") if value is None else value for value in found]

    rows, implied = found.rows, found.implied
    values: dict[str, tuple[tuple[str, ...], Any]] = {
        "measured_value": (("row",), column(rows, "measured")),
        "simulated_value": (("row", "model"), column(rows, "simulated")),
        "comparison_error": (("row", "model"), column(rows, "errors")),
        **{name: (("row",), column(rows, name)) for name in UNCERTAINTIES},
        "pinion_speed": (("row",), column(rows, "speed")),
    }
    table = label(values).assign_coords(
        model=list(found.models),
        quantity=("row", column(rows, "quantity")),
        where=("row", column(rows, "where")),
        record=("row", column(rows, "record")),
        verdict=("row", column(rows, "verdict")),
    )
    if any(row.printed for row in rows):
        table = table.assign_coords(
            printed=(("row", "model"), [row.printed or [""] * len(found.models) for row in rows]),
            misprinted=("row", [int(bool(_misprinted(row))) for row in rows]),
        )
    said = label(
        {
            "pinion_speed": (("speed",), column(implied, "speed")),
            "implied_acceleration": (
                ("speed",),
                np.multiply(column(implied, "acceleration_g"), STANDARD_GRAVITY),
            ),
            "implied_shaft_speed": (("speed",), column(implied, "shaft_speed")),
            "mesh_line_offset": (("speed",), column(implied, "offset_hertz")),
            "line_bin_offset": (("speed",), column(implied, "offset_bins")),
        }
    )
    return Result.of(
        "comparison",
        f"Models {' and '.join(found.models)} against {found.measured}",
        {"comparison": table, "implied": said},
        found.notices,
        conclusion=found.conclusion[:1].upper() + found.conclusion[1:] + ".",
        figures=figures(found),
        created=now(),
    )


def figures(found: Comparison) -> dict[str, Any]:
    """The comparison as plain figures, in SI units."""
    told = (
        "speed",
        "quantity",
        "measured",
        "simulated",
        "errors",
        *UNCERTAINTIES,
        "verdict",
        "printed",
        "where",
        "record",
    )
    rows = [{name: getattr(row, name) for name in told} for row in found.rows]
    return {
        "measured": found.measured,
        "models": list(found.models),
        "conclusion": found.conclusion,
        "heat": [vars(one) for one in found.heat],
        "rows": rows,
        "implied": [vars(item) for item in found.implied],
        "notices": [notice.as_dict() for notice in found.notices],
    }
