"""Rates at which the noise of a record swells, held against those of rolling bearings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermogear.signals.envelope import envelope_rates

CHANCE = 1e-3
"""How often noise may have a rate as clear for one to be told."""
SLIP = 0.02
"""By how much a bearing's rates may be off those of rolling alone: 1 to 2 % are usual (Randall and
Antoni 2011, Mech. Syst. Signal Process. 25, 485-520)."""
MOST = 5
"""Rates that are told."""

_LONGEST = 1 << 18  # samples
_WHOLE = 0.01  # turns
SIDES = np.arange(-2.0, 3.0)
"""Turns beside its rate at which the lines of an inner race are looked for."""
PARTS = ("outer race", "inner race", "rolling element", "cage")


@dataclass(frozen=True, kw_only=True)
class BearingRates:
    """Rates of a rolling bearing's defects in orders of its shaft, without slip: elements over the
    ``outer`` race and the ``inner`` race, twice the spin of an ``element``, ``cage``.

    >>> BearingRates.of("6205", elements=9, ratio=7.938 / 38.5).outer.__round__(3)
    3.572
    """

    name: str
    outer: float
    inner: float
    element: float
    cage: float

    @classmethod
    def of(
        cls, name: str, *, elements: int, ratio: float, contact_angle: float = 0.0
    ) -> BearingRates:
        """Of Z ``elements`` and g = D_w cos a/d_m (``ratio``), a the ``contact_angle`` [rad].

        Z (1 - g)/2, Z (1 + g)/2, cos a (1 - g^2)/g, (1 - g)/2; the outer ring is at rest.
        """
        return cls(
            name=name,
            outer=0.5 * elements * (1.0 - ratio),
            inner=0.5 * elements * (1.0 + ratio),
            element=float(np.cos(contact_angle)) * (1.0 - ratio**2) / ratio,
            cage=0.5 * (1.0 - ratio),
        )

    def order(self, part: str) -> float:
        """The order of a part's defect, of those in ``PARTS``."""
        orders = self.outer, self.inner, self.element, self.cage
        return dict(zip(PARTS, orders, strict=True))[part]


@dataclass(frozen=True, kw_only=True)
class Swelling:
    """A rate [cycles/sample, and Hz or None] at which the noise of a channel between ``low`` and
    ``high`` [cycles/sample] swells; ``order`` of the first shaft (None: unknown), ``powers`` of its
    harmonics over those of noise, ``chance`` that noise alone has one as clear."""

    channel: str
    position: float
    frequency: float | None
    order: float | None
    low: float
    high: float
    powers: tuple[float, ...]
    chance: float

    @property
    def words(self) -> str:
        """In words."""
        scale = 1.0 if self.frequency is None else self.frequency / self.position
        unit = "cycles/sample" if self.frequency is None else "Hz"
        powers = ", ".join(f"{p:.0f}" for p in self.powers)
        between = (
            f"what is no line between {scale * self.low:.4g} and {scale * self.high:.4g} {unit} "
            f"in {self.channel} swells at {scale * self.position:.5g} {unit} "
            f"(envelope line, harmonics {powers} times noise)"
        )
        if self.order is None:
            return f"{between}: impacts of a bearing or of a shaft, or a load that swings"
        return f"{between}: {self.order:.3f} of the first shaft"


@dataclass(frozen=True, kw_only=True)
class Defect:
    """A rate of a ``bearing`` at which a record swells: ``part``, its order ``expected`` without
    slip and ``order`` found, ``side_lines``: whether lines a turn of the shaft beside it show it;
    ``chance`` that rates at any place of those told hit as near."""

    bearing: str
    part: str
    expected: float
    order: float
    side_lines: bool = False
    chance: float

    @property
    def words(self) -> str:
        """In words."""
        by = ", with lines a turn of the shaft beside it" if self.side_lines else ""
        return (
            f"{self.order:.3f} of the shaft is within {100 * SLIP:g} % of the {self.part} of "
            f"{self.bearing}, {self.expected:.3f}{by}; by chance in {100 * self.chance:.2g} %"
        )


def swellings_of(
    channels: Sequence[str], table: NDArray[np.float64], rate: float | None, shaft: float | None
) -> tuple[Swelling, ...]:
    """The clearest rates of the channel whose envelope has the clearest; none where chance may
    explain it.

    ``table`` (channel, sample), ``rate`` [samples/s], ``shaft`` [turns/sample] or None.
    """
    share = CHANCE / len(channels)
    clear = [
        (name, [line for line in envelope_rates(values[:_LONGEST], MOST) if line.chance < share])
        for name, values in zip(channels, table, strict=True)
    ]
    name, rates = min(clear, key=lambda pair: min([1.0, *(line.chance for line in pair[1])]))
    return tuple(
        Swelling(
            channel=name,
            position=line.rate,
            frequency=None if rate is None else line.rate * rate,
            order=None if shaft is None else line.rate / shaft,
            low=line.band[0],
            high=line.band[1],
            powers=line.powers,
            chance=line.chance,
        )
        for line in rates
    )


def defects_of(
    swellings: Sequence[Swelling], bearings: Sequence[BearingRates]
) -> tuple[Defect, ...]:
    """Rates of ``bearings`` that ``swellings`` hit within 2 %, the least likely by chance first.

    The ``chance`` is that of m rates anywhere, in the logarithm, between the lowest and the highest
    order of the bearings (a tenth more to both sides): 1 - (1 - p)^m, where p is the share that
    the windows of all rates of all bearings cover. The load on an inner race goes round with the
    shaft: its rate shows in lines one or two turns beside it as well. Two lines whole turns apart,
    within 0.01 of one, are such by a chance of 0.02 a pair, times the share that the windows
    of the inner races cover at their places and one and two turns beside. Left out is a hit that
    chance explains in half of all records.

    >>> bearing = BearingRates.of("6205", elements=9, ratio=7.938 / 38.5)
    >>> seen = [Swelling(channel="a", position=0.01, frequency=None, order=order, low=0.1, high=0.2,
    ...                  powers=(9.0,), chance=1e-6) for order in (3.40, 4.40)]
    >>> [(hit.part, hit.side_lines) for hit in defects_of(seen, [bearing])]
    [('inner race', True)]
    """
    orders = np.array([rate.order for rate in swellings if rate.order is not None])
    if not bearings or not orders.size:
        return ()
    rates = [(bearing.name, part, bearing.order(part)) for bearing in bearings for part in PARTS]
    ends = min(rate for *_, rate in rates) / 1.1, max(rate for *_, rate in rates) * 1.1
    grid = np.geomspace(*ends, 10_000)
    covered = float(np.mean(np.any([_hits(grid, rate) for *_, rate in rates], axis=0)))
    chance = 1.0 - (1.0 - covered) ** orders.size
    defects = [
        Defect(bearing=bearing, part=part, expected=rate, order=float(order), chance=chance)
        for bearing, part, rate in rates
        for order in orders[_hits(orders, rate)][:1]
    ]
    turning = [bearing.order("inner race") for bearing in bearings]
    windows = np.any([_hits(grid, rate, SIDES) for rate in turning], axis=0)
    distance = orders[:, None] - orders[None, :]
    whole = (np.abs(distance - np.rint(distance)) < _WHOLE) & (np.rint(distance) != 0.0)
    paired = orders[whole.any(axis=0) & (np.abs(orders - np.rint(orders)) > _WHOLE)]
    pairs = orders.size * (orders.size - 1) / 2.0
    chance = min(1.0, pairs * 2.0 * _WHOLE * float(np.mean(windows)))
    for named, rate in zip(bearings, turning, strict=True):
        for order in paired[_hits(paired, rate, SIDES)][:1]:
            place = min(order + SIDES, key=lambda side: abs(side - rate))
            defects.append(
                Defect(
                    bearing=named.name,
                    part="inner race",
                    expected=rate,
                    order=float(place),
                    side_lines=True,
                    chance=chance,
                )
            )
    likely = (defect for defect in defects if defect.chance <= 0.5)
    return tuple(sorted(likely, key=lambda defect: defect.chance))


def _hits(
    orders: NDArray[np.float64], rate: float, sides: NDArray[np.float64] | float = 0.0
) -> NDArray[np.bool_]:
    """Which orders are within the slip of a rate, or as near a number of turns (``sides``) off."""
    off = np.add.outer(orders, np.atleast_1d(sides)) / rate - 1.0
    return np.asarray(np.any(np.abs(off) <= SLIP, axis=-1))
