"""The order map of a run whose speed changes: amplitude over order and time, for a picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import signal

Floats = NDArray[np.float64]

_TURNS = 12  # of one row's window
_ROWS, _COLUMNS = 160, 480


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


def order_map(
    straight: list[Floats],
    *,
    turns: Floats,
    per_turn: int,
    rate: float,
    unit: float,
    highest: float,
) -> OrderMap:
    """The map of the first of the records in angle, up to 1.3 times the ``highest`` order.

    ``per_turn`` samples per turn; ``turns`` at each sample of the stretch, ``rate`` [samples/s];
    ``unit``: orders told in one order of ``turns``.
    """
    values = straight[0]
    while per_turn % 2 == 0 and per_turn / 2 >= 3.4 * 1.3 * highest:
        values = signal.resample_poly(values, 1, 2, window=("kaiser", 10.0))
        per_turn //= 2
    whole = values.size // per_turn
    window_turns = max(2, min(_TURNS, whole // 4))
    count = window_turns * per_turn
    last = values.size - count
    starts = np.unique(np.linspace(0, max(0, last), min(_ROWS, max(1, whole))).astype(int))
    weight = np.hanning(count + 1)[:-1]
    rows = []
    for begin in starts:
        part = values[begin : begin + count]
        rows.append(np.abs(np.fft.rfft((part - part.mean()) * weight)) * 2.0 / weight.sum())
    table = np.stack(rows)
    top = min(table.shape[1], int(1.3 * highest * window_turns) + 1)
    run = max(1, -(-top // _COLUMNS))
    columns = top // run
    table = table[:, : columns * run].reshape(table.shape[0], columns, run).max(axis=-1)
    order = (np.arange(columns) * run + 0.5 * (run - 1)) / window_turns
    middle = np.ceil(turns[0]) + (starts + 0.5 * count) / per_turn
    grid = np.arange(turns.size)
    sample = np.interp(middle, turns, grid)
    ahead, back = (np.interp(middle + s, turns, grid) for s in (0.5, -0.5))
    return OrderMap(
        order=order * unit,
        speed=2.0 * np.pi * rate / np.maximum(ahead - back, 1e-9) / unit,
        time=sample / rate,
        amplitude=table,
        turns=window_turns,
    )
