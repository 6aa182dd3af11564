"""Tables of published lines: the thesis's section 5.2 as data, and tables from files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from thermogear.base.cells import NUMBER, cells_of
from thermogear.base.errors import InputError
from thermogear.base.files import decoded
from thermogear.base.units import RPM, STANDARD_GRAVITY, half_digit
from thermogear.measured.traps import split_unit
from thermogear.measured.units import factor_of, kind_of
from thermogear.signals.integration import trapezoid_factor
from thermogear.signals.windows import Window


@dataclass(frozen=True, kw_only=True)
class SpeedLine:
    """The main line at one speed: ``speed`` [rad/s] of the pinion (nominal), ``frequency`` [Hz],
    ``displacement`` [m] peak; ``uncertainty`` relative standard uncertainty, None: not stated;
    ``record`` that it is of, among several.

    >>> line = SpeedLine(speed=100.0, frequency=400.0, displacement=3e-6)
    >>> line.displacement
    3e-06
    """

    speed: float
    frequency: float
    displacement: float
    uncertainty: float | None = None
    record: str = ""

    def __post_init__(self) -> None:
        values = {
            "speed": self.speed,
            "frequency": self.frequency,
            "displacement": self.displacement,
        }
        for name, value in values.items():
            if not (np.isfinite(value) and value > 0):
                raise InputError(f"line.{name}", value, allowed="> 0")

    @property
    def acceleration_g(self) -> float:
        """Acceleration that the line implies, (2 pi f)^2 x [standard gravities]."""
        return self.displacement * (2.0 * np.pi * self.frequency) ** 2 / STANDARD_GRAVITY

    def shaft_speed(self, teeth: int) -> float:
        """Pinion speed [rad/s] if the line is the mesh line: 2 pi f/z."""
        return 2.0 * np.pi * self.frequency / teeth


@dataclass(frozen=True)
class LineTable:
    """Lines at several speeds from one source; ``bin_width`` [Hz] of the spectra, if stated."""

    name: str
    lines: tuple[SpeedLine, ...]
    teeth: int | None = None
    source: str = ""
    bin_width: float | None = None
    processing_stated: bool = False

    def __post_init__(self) -> None:
        if not self.lines:
            raise InputError("table", self.name, why="it holds no line")

    def near(self, speed: float) -> SpeedLine | None:
        """The line of the nearest speed, None when none lies within 5 %."""
        best = min(self.lines, key=lambda line: abs(line.speed - speed))
        return best if abs(best.speed - speed) <= 0.05 * speed else None


def together(tables: Sequence[LineTable]) -> LineTable:
    """The lines of several tables as one; of their spectra the widest bin counts."""
    return LineTable(
        f"{len(tables)} records",
        tuple(replace(line, record=one.name) for one in tables for line in one.lines),
        tables[0].teeth,
        ", ".join(one.source for one in tables),
        max((one.bin_width for one in tables if one.bin_width), default=None),
        all(one.processing_stated for one in tables),
    )


@dataclass(frozen=True)
class Printed:
    """A published comparison: measured lines, models, and the errors [%] as printed.

    ``errors``: (model, quantity, speed number) -> (printed text).
    """

    measured: LineTable
    models: Mapping[str, LineTable]
    errors: Mapping[tuple[str, str, int], str] = field(default_factory=dict)


def rounded_error(*, simulated: float, measured: float, quantity: str) -> tuple[float, float]:
    """The least and the greatest error |simulated/measured - 1| [%] that two printed entries allow.

    Both are rounded to the digits printed, a "frequency" in Hz and a "displacement" in um;
    here they are in SI.
    """
    scale = {"frequency": 1.0, "displacement": 1e6}[quantity]
    ends = [
        (value - half_digit(f"{value:g}"), value + half_digit(f"{value:g}"))
        for value in (scale * simulated, scale * measured)
    ]
    errors = [100.0 * (s / m - 1.0) for s in ends[0] for m in ends[1]]
    least = 0.0 if min(errors) < 0.0 < max(errors) else min(map(abs, errors))
    return least, max(map(abs, errors))


def allowed(printed: str, *, low: float, high: float) -> bool:
    """Whether a ``printed`` figure, rounded itself, can stand for a value within low..high."""
    return low - half_digit(printed) <= float(printed) <= high + half_digit(printed)


def _table(name: str, rows: tuple[tuple[float, float, float], ...]) -> LineTable:
    lines = tuple(SpeedLine(speed=n * RPM, frequency=f, displacement=x * 1e-6) for n, f, x in rows)
    return LineTable(name, lines, 25, "thesis, section 5.2")


THESIS_5_2 = Printed(
    measured=_table(
        "experiment", ((1000, 419.7, 10.4), (2000, 832.58, 19.3), (3000, 1251.6, 48.5))
    ),
    models={
        "with heat": _table("with heat", ((1000, 413, 8.7), (2000, 826, 15.9), (3000, 1248, 41.0))),
        "without heat": _table(
            "without heat", ((1000, 411, 8.17), (2000, 823, 15.15), (3000, 1245, 39.6))
        ),
    },
    errors={
        ("with heat", "frequency", 0): "1.60",
        ("without heat", "frequency", 0): "2.07",
        ("with heat", "displacement", 0): "16.3",
        ("without heat", "displacement", 0): "21.4",
        ("with heat", "frequency", 1): "0.79",
        ("without heat", "frequency", 1): "1.15",
        ("with heat", "displacement", 1): "17.6",
        ("without heat", "displacement", 1): "18.5",
        ("with heat", "frequency", 2): "0.29",
        ("without heat", "frequency", 2): "0.53",
        ("with heat", "displacement", 2): "15.4",
        ("without heat", "displacement", 2): "18.4",
    },
)

PUBLISHED: dict[str, Printed] = {"thesis-5.2": THESIS_5_2}


def unstated_processing(frequency: float, *, highest: float) -> dict[str, float]:
    """Relative standard uncertainties of a line whose processing is not stated.

    A loss anywhere between 0 and L, all alike likely, has the standard deviation L/sqrt(12).
    "window": L = the Hann window's scalloping, 15.1 %. "integration": L = what two trapezoidal
    sums lose at the lowest rate that still resolves the ``highest`` line [Hz] of the test, 2.56
    times it; 0 for a processing that does not use sums cannot be told apart.

    >>> found = unstated_processing(500.0, highest=5000.0)
    >>> list(found)
    ['window', 'integration']
    """
    window = Window("hann").scalloping / np.sqrt(12.0)
    loss = 1.0 - float(trapezoid_factor(frequency, rate=2.56 * highest))
    return {"window": float(window), "integration": float(loss / np.sqrt(12.0))}


def is_table(path: str | Path) -> bool:
    """Whether a file is a table of lines (its first row says so) and not a record."""
    path = Path(path)
    if not path.is_file():
        return False
    with path.open("rb") as file:
        head = decoded(file.read(400), "replace").lower()
    first = head.splitlines()[0] if head else ""
    return all(name in first for name in ("speed", "frequency", "displacement"))


def read_lines(path: Path, teeth: int | None = None) -> LineTable:
    """A table of lines from a CSV: speed [rpm], frequency [Hz], displacement [um], and if known
    uncertainty [%]; the first row names the columns with their units."""
    text = decoded(path.read_bytes(), "replace")
    rows = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    if len(rows) < 2:
        raise InputError("table", path.name, why="it needs a row of names and one of numbers")
    separator = next((c for c in ";\t," if c in rows[0]), None)
    names = [cell.lower().replace("[%]", "").strip() for cell in cells_of(rows[0], separator)]
    columns = {split_unit(name)[0]: (i, split_unit(name)[1]) for i, name in enumerate(names)}
    for name in ("speed", "frequency", "displacement"):
        if name not in columns:
            raise InputError(
                "table",
                ", ".join(columns),
                why=f"no column {name!r}",
                fix="speed [rpm], frequency [Hz], displacement [um]",
            )
        said = columns[name][1]
        if said is None or kind_of(said) != name:
            raise InputError(f"table.{name}", said or "no unit", fix=f"state it: {name} [...]")
    lines = []
    for number, row in enumerate(rows[1:], start=2):
        cells = cells_of(row, separator)
        if len(cells) != len(names) or not all(map(NUMBER.match, cells)):
            raise InputError("table", f"row {number}", allowed=f"{len(names)} numbers")
        values = {
            name: float(cells[i]) * (factor_of(said) if said else 1.0)
            for name, (i, said) in columns.items()
        }
        lines.append(
            SpeedLine(
                speed=values["speed"] * 2.0 * np.pi,
                frequency=values["frequency"],
                displacement=values["displacement"],
                uncertainty=values["uncertainty"] / 100.0 if "uncertainty" in values else None,
            )
        )
    return LineTable(path.stem, tuple(lines), teeth, path.name)
