"""Orders over the speed of a run: their map, and their amplitudes at every step of the speed."""

from __future__ import annotations

from dataclasses import dataclass

from thermogear.base.arrays import Floats


@dataclass(frozen=True, kw_only=True)
class OrderMap:
    """``amplitude`` (row, order), peak in the file's unit, of the first channel, Hann window over
    ``turns``; of each run of orders the highest. ``order`` of the first shaft (of the mesh line
    where no shaft is known), ``speed`` (row) [rad/s], ``time`` (row) [s] in the stretch."""

    order: Floats
    speed: Floats
    time: Floats
    amplitude: Floats
    turns: int


@dataclass(frozen=True, kw_only=True)
class OrderSlices:
    """Amplitudes of orders over speed, of a run whose speed changes.

    ``channels``, ``names`` of the lines and their ``orders`` of the first shaft (of the mesh line
    where ``of_mesh``); over steps ``time`` [s], ``speed`` [rad/s] of what ``orders`` count and
    ``acceleration`` [rad/s^2] of it, ``frequency`` (order, step) [Hz]; ``reading`` (channel,
    order, step) peak amplitude in the file's unit, ``half_width`` of its 95 % interval, ``phase``
    [rad] against the angle, ``block`` the turns it is read over. ``si``: SI units in one of a
    channel's, nan where unknown; ``kinds`` of quantity, "" where unknown.
    """

    channels: tuple[str, ...]
    names: tuple[str, ...]
    orders: Floats
    of_mesh: bool
    time: Floats
    speed: Floats
    acceleration: Floats
    frequency: Floats
    reading: Floats
    half_width: Floats
    phase: Floats
    block: Floats
    si: Floats
    kinds: tuple[str, ...]
    map: OrderMap
