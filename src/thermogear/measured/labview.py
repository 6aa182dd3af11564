"""What the header of a LabVIEW file (LVM) states of its channels: step, start and dimension."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from thermogear.base.cells import NUMBER
from thermogear.measured.record import Notice
from thermogear.measured.traps import is_possible_rate, is_time_name
from thermogear.signals.stamps import usual_rate

_PRINTED = 6
"""Decimals from which a step without an exponent is taken as rounded to them, as "%f" does."""
_SAME = 1e-6  # of a step: steps and starts nearer than this are the same


@dataclass(frozen=True)
class Wave:
    """A channel as the header has it: ``step`` (Delta_X) and ``start`` (X0) [s] as written."""

    step: str = ""
    start: str = ""

    @property
    def seconds(self) -> float | None:
        """The step [s]; None where it gives no rate.

        >>> Wave("1.0E-4").seconds, Wave("0").seconds
        (0.0001, None)
        """
        value = _number(self.step)
        return value if value > 0.0 and is_possible_rate(1.0 / value) else None


@dataclass(frozen=True, kw_only=True)
class Stated:
    """The rate [1/s] that a header states: None where it states none or several; half width of its
    interval, what it rests on, ``start`` [s]; ``several``: no time column speaks for all."""

    rate: float | None = None
    half_width: float = 0.0
    note: str = ""
    start: float = 0.0
    several: bool = False
    notices: tuple[Notice, ...] = ()


@dataclass(frozen=True)
class Waves:
    """The channels of a LabVIEW header in the file's order; ``dimension`` of their X axis."""

    waves: tuple[Wave, ...]
    dimension: str = "Time"
    columns: dict[int, Wave] = field(default_factory=dict)

    @property
    def of_time(self) -> bool:
        """Whether the X axis is time.

        >>> Waves(()).of_time, Waves((), "Frequency").of_time
        (True, False)
        """
        return is_time_name(self.dimension)

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

    def stated(self, names: dict[int, str]) -> Stated:
        """The rate of the channels in the columns ``names``, or why there is none.

        >>> waves = Waves((Wave("1e-4"), Wave("1e-3"))).placed(3)
        >>> round(waves.stated({1: "a"}).rate), waves.stated({1: "a", 2: "b"}).rate
        (10000, None)
        """
        own = {names[i]: self.columns[i] for i in names if i in self.columns}
        steps = {name: wave.seconds for name, wave in own.items() if wave.step}
        if not steps:
            return Stated()
        if not self.of_time:
            return Stated(notices=(Notice.of("step_is_no_time", dimension=self.dimension),))
        wrong = next((name for name, step in steps.items() if step is None), None)
        if wrong is not None:
            told = Notice.of("step_gives_no_rate", channel=wrong, step=_number(own[wrong].step))
            return Stated(notices=(told,))
        known = [step for step in steps.values() if step is not None]
        if max(known) - min(known) > _SAME * min(known):
            told = Notice.of(
                "steps_differ", channels=list(steps), rates=[1.0 / one for one in known]
            )
            return Stated(several=True, notices=(told,))
        return _one(next(iter(own.values())), _starts(own, known[0]))


def waves_of(above: Sequence[str], separator: str | None) -> Waves | None:
    """What the lines ``above`` a table say where they are a LabVIEW header with its channels.

    >>> waves_of(["X_Columns\\tNo", "Delta_X\\t0,001\\t0,001\\t"], "\\t").waves[0].seconds
    0.001
    """
    found: dict[str, list[str]] = {}
    for line in above:
        key, *cells = (cell.strip().strip('"').strip() for cell in line.split(separator or "\t"))
        found[key] = [cell for cell in cells if cell]
    if "Delta_X" not in found:
        return None
    steps = found["Delta_X"]
    starts = found.get("X0", [])
    starts = starts if len(starts) == len(steps) else [""] * len(steps)
    dimensions = found.get("X_Dimension") or ["Time"]
    odd = next((one for one in dimensions if not is_time_name(one)), dimensions[0])
    return Waves(tuple(map(Wave, steps, starts)), odd)


def _number(text: str) -> float:
    """A number with a point or a comma; 0 where it is none."""
    plain = text.replace(",", ".")
    return float(plain) if NUMBER.match(plain) else 0.0


def _starts(own: dict[str, Wave], step: float) -> tuple[float, tuple[Notice, ...]]:
    """The first start [s], and a word where the channels do not start together."""
    starts = [_number(wave.start) for wave in own.values()]
    apart = max(starts) - min(starts)
    if apart <= max(_SAME * step, 1e-12 * max(map(abs, starts))):
        return starts[0], ()
    return starts[0], (Notice.of("channels_start_apart", time=apart),)


def _one(wave: Wave, start: tuple[float, tuple[Notice, ...]]) -> Stated:
    """The rate by one step, with what its last decimal leaves open."""
    step = wave.seconds or 1.0
    rate, half, note = 1.0 / step, 0.0, ""
    decimals = len(re.split("[.,]", wave.step)[-1]) if re.search("[.,]", wave.step) else 0
    if decimals >= _PRINTED and "e" not in wave.step.lower():
        off = 0.5 * 10.0**-decimals
        low, high = 1.0 / (step + off), 1.0 / max(step - off, 0.1 * step)
        usual = usual_rate(low, high=high)
        rate = rate if usual is None else usual
        half = max(high - rate, rate - low) if usual is None else 0.0
        note = f"{wave.step} s is rounded: +- {max(high - rate, rate - low):.2g} samples/s"
        note += "" if usual is None else ", the usual rate there is taken"
    return Stated(rate=rate, half_width=half, note=note, start=start[0], notices=start[1])
