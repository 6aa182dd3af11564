"""Impacts that slip: the rate at which what is no line swells, in hertz and orders where known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermogear.signals.envelope import envelope_rate

CHANCE = 1e-3
"""How often noise may have a rate as clear for one to be told."""

_LONGEST = 1 << 19  # samples


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
        said = (
            f"what is no line between {scale * self.low:.4g} and {scale * self.high:.4g} {unit} "
            f"in {self.channel} swells at {scale * self.position:.5g} {unit} "
            f"(envelope line, harmonics {powers} times noise)"
        )
        if self.order is None:
            return f"{said}: impacts of a bearing or of a shaft, or a load that swings"
        return f"{said}: {self.order:.3f} of the first shaft"


def swelling_of(
    channels: Sequence[str], table: NDArray[np.float64], rate: float | None, shaft: float | None
) -> Swelling | None:
    """The clearest rate of the channels' envelopes; None where chance may explain it.

    ``table`` (channel, sample), ``rate`` [samples/s], ``shaft`` [turns/sample] or None.
    """
    found = [
        (name, one)
        for name, values in zip(channels, table, strict=True)
        if (one := envelope_rate(values[:_LONGEST])) is not None
    ]
    if not found:
        return None
    name, best = min(found, key=lambda pair: (pair[1].chance, -sum(pair[1].powers)))
    if best.chance * len(found) >= CHANCE:
        return None
    return Swelling(
        channel=name,
        position=best.rate,
        frequency=None if rate is None else best.rate * rate,
        order=None if shaft is None else best.rate / shaft,
        low=best.band[0],
        high=best.band[1],
        powers=best.powers,
        chance=best.chance,
    )
