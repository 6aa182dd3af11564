"""Acceleration and displacement of lines that were measured as another quantity of motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.measured.lines import MeasuredLine
from thermogear.measured.record import Channel
from thermogear.measured.units import kind_of


def quantities(amplitude: Floats, *, omega: Floats, kind: str) -> tuple[Floats, Floats]:
    """Acceleration and displacement of lines of a known kind of quantity, else nan."""
    power = {"acceleration": 0, "velocity": 1, "displacement": 2}.get(kind)
    if power is None:
        return np.full_like(amplitude, np.nan), np.full_like(amplitude, np.nan)
    return amplitude * omega**power, amplitude * omega ** (power - 2)


def of_velocity(line: MeasuredLine, channel: Channel) -> MeasuredLine:
    """A line of a velocity with its acceleration and displacement; any other line as it is."""
    known = channel.unit is not None and not channel.needs_scale
    if not known or channel.unit is None or kind_of(channel.unit) != "velocity":
        return line
    omega = 2.0 * np.pi * line.frequency
    speed = line.reading * channel.si_factor
    return replace(line, acceleration=speed * omega, displacement=speed / omega)
