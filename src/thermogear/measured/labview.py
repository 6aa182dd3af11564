"""What the header of a LabVIEW file (LVM) states of its channels: step, start, count, dimension."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from thermogear.base.cells import NUMBER
from thermogear.measured.contract import UNSTATED
from thermogear.measured.traps import TimeBase, is_time_name, step_base

_PRINTED = 6
"""Decimals from which a step without an exponent is taken as rounded to them, as "%f" does."""


@dataclass(frozen=True)
class Wave:
    """A channel as the header has it: ``step`` (Delta_X) and ``start`` (X0) [s], ``count``
    (Samples) and ``unit`` (Y_Unit_Label) as written."""

    step: str = ""
    start: str = ""
    count: str = ""
    unit: str = ""

    def base(self, channel: str) -> TimeBase:
        """The time base of the ``channel``; one without a rate where the step gives none.

        >>> Wave("1.0E-4").base("a").rate, Wave("0").base("a").rate
        (10000.0, None)
        """
        if not self.step:
            return UNSTATED
        decimals = len(re.split("[.,]", self.step)[-1]) if re.search("[.,]", self.step) else 0
        rounded = decimals >= _PRINTED and "e" not in self.step.lower()
        return step_base(
            _number(self.step),
            channel=channel,
            start=_number(self.start),
            origin="Delta_X",
            half_width=0.5 * 10.0**-decimals if rounded else 0.0,
        )


@dataclass(frozen=True)
class Waves:
    """The channels of a LabVIEW header in the file's order; ``dimension`` of their X axis."""

    waves: tuple[Wave, ...]
    dimension: str = "Time"
    columns: dict[int, Wave] = field(default_factory=dict)

    @property
    def axis(self) -> str:
        """What the X axis counts.

        >>> Waves(()).axis, Waves((), "Frequency").axis
        ('time', 'frequency')
        """
        if is_time_name(self.dimension):
            return "time"
        return "frequency" if "freq" in self.dimension.lower() else self.dimension

    def samples(self, column: int) -> tuple[int, int]:
        """Samples of a block, and of those the samples of the channel in a column or behind that X
        column; 0 where the header does not say."""
        most = int(max(_number(wave.count) for wave in self.waves))
        wave = self.columns.get(column, self.columns.get(column + 1))
        return most, most if wave is None else int(_number(wave.count))

    def placed(self, columns: int) -> Waves:
        """The same with the wave of each of the table's ``columns``: behind one X column, each
        behind its own, or without any.

        >>> sorted(Waves((Wave(), Wave())).placed(4).columns)
        [1, 3]
        """
        count = len(self.waves)
        places = {count + 1: (1, 1), 2 * count: (1, 2), count: (0, 1)}
        first, by = places.get(columns, (0, 0))
        found = {first + by * i: wave for i, wave in enumerate(self.waves) if by}
        return Waves(self.waves, self.dimension, found)

    def own_time(self, column: int) -> int:
        """The X column of a channel's column: the first, or the one before where each has its own.

        >>> two = (Wave(), Wave())
        >>> Waves(two).placed(3).own_time(2), Waves(two).placed(4).own_time(3)
        (0, 2)
        """
        own = len(self.columns) > 1 and column - 1 not in self.columns
        return column - 1 if own else 0


def waves_of(above: Sequence[str], separator: str | None) -> Waves | None:
    """What the lines ``above`` a table say where they are a LabVIEW header with its channels.

    >>> waves_of(["X_Columns\\tNo", "Delta_X\\t0,001\\t0,001\\t"], "\\t").waves[0].base("a").rate
    1000.0
    """
    rows: dict[str, list[str]] = {}
    for line in above:
        key, *cells = (cell.strip().strip('"').strip() for cell in line.split(separator or "\t"))
        rows[key] = [cell for cell in cells if cell]
    count = len(rows.get("Delta_X") or rows.get("Y_Unit_Label") or ())
    if not count:
        return None
    facts = (
        cells if len(cells := rows.get(key, [])) == count else [""] * count
        for key in ("Delta_X", "X0", "Samples", "Y_Unit_Label")
    )
    dimensions = rows.get("X_Dimension") or ["Time"]
    odd = next((one for one in dimensions if not is_time_name(one)), dimensions[0])
    return Waves(tuple(map(Wave, *facts)), odd)


def _number(text: str) -> float:
    """A number with a point or a comma; 0 where it is none."""
    plain = text.replace(",", ".")
    return float(plain) if NUMBER.match(plain) else 0.0
