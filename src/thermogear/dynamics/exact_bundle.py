"""Lanes of one mass with clearance side by side, on their event-exact maps."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray

from thermogear.dynamics import exact
from thermogear.dynamics.bundle import Prepared, Visits
from thermogear.dynamics.tables import LaneTables

Floats = NDArray[np.float64]
Whole = NDArray[np.int64]


def exact_bundles(lanes: LaneTables, refine: int = 1) -> Iterator[Prepared]:
    """Blocks of lanes with equal sub-steps, and how the maps of each are prepared."""
    for index, borders, marks in exact.layouts(lanes, refine=refine):
        yield index, partial(_prepared, lanes, index, borders, marks)


def _prepared(
    lanes: LaneTables, index: Whole, borders: Floats, marks: NDArray[np.uint8]
) -> ExactBundle:
    mine = lanes.take(index)
    return ExactBundle(
        exact.prepare_maps(mine, borders, marks), period=mine.period, damping=mine.damping
    )


class ExactBundle:
    """The return maps of lanes that share their sub-steps; a state is (x, x')."""

    def __init__(self, maps: exact.ExactMaps, *, period: Floats, damping: Floats) -> None:
        self.maps = maps
        self.period = period
        self.damping = damping

    def __len__(self) -> int:
        return int(self.period.size)

    @property
    def backlash(self) -> Floats:
        """Half backlash of every lane."""
        return self.maps.backlash

    @property
    def unit(self) -> Floats:
        """Scales of (x, x') for distances: b and 2 pi b/T, (lane, 2)."""
        b = self.maps.backlash
        return np.stack([b, 2.0 * np.pi * b / self.period], axis=1)

    def determinant(self, periods: int) -> Floats:
        """det D P^n = exp(-c T n) of every trajectory: (lane,)."""
        return np.asarray(np.exp(-(self.damping * self.period) * periods))

    def take(self, index: Whole) -> ExactBundle:
        """The maps of some lanes, in the order of ``index``."""
        return ExactBundle(
            self.maps.take(index), period=self.period[index], damping=self.damping[index]
        )

    def crowd(self, start: Floats) -> ExactCrowd:
        """States at ``start`` (lane, 2), phase 0."""
        return ExactCrowd(
            self,
            exact.State.start(x=start[:, 0], y=start[:, 1], backlash=self.maps.backlash),
        )

    def visit(self, start: Floats, periods: int) -> Visits:
        """Run ``periods`` periods from ``start`` (lane, 2) with the variational equations."""
        state = exact.State.start(x=start[:, 0], y=start[:, 1], backlash=self.maps.backlash)
        sections, _, _ = exact.advance(self.maps, state, periods, columns=2)
        return Visits(
            points=np.concatenate([start[:, None, :], sections.transpose(2, 0, 1)], axis=1),
            jacobian=state.tangent.T.reshape(-1, 2, 2).copy(),
            losses=state.counts[0].copy(),
            impacts=state.counts[1].copy(),
            spent=state.spent.T.copy(),
        )


class ExactCrowd:
    """States (x, x') on their way, with the regions they are in."""

    def __init__(self, bundle: ExactBundle, inner: exact.State) -> None:
        self.bundle = bundle
        self._inner = inner

    @property
    def state(self) -> Floats:
        """Present (x, x') of every lane: (lane, 2)."""
        return np.stack([self._inner.x, self._inner.y], axis=1)

    def run(self, periods: int) -> Floats:
        """Advance; the sections (period, 2, lane)."""
        return exact.advance(self.bundle.maps, self._inner, periods)[0]

    def aim(self, direction: Floats | None = None) -> None:
        """Give every lane a tangent ``direction`` (lane, 2), else (1, 2 pi/T)."""
        inner = self._inner
        inner.fresh_tangent()
        if direction is None:
            inner.tangent[2] = 2.0 * np.pi / self.bundle.period
        else:
            inner.tangent[0], inner.tangent[2] = direction[:, 0], direction[:, 1]

    def stretch(self, periods: int) -> tuple[Floats, Floats]:
        """Advance with the tangents: the sections (period, 2, lane), growths (period, lane)."""
        sections, growth, _ = exact.advance(
            self.bundle.maps, self._inner, periods, columns=1, normalise=True
        )
        return sections, growth

    def take(self, index: Whole) -> ExactCrowd:
        """Go on with some lanes only."""
        old = self._inner
        kept = exact.State(
            x=old.x[index],
            y=old.y[index],
            region=old.region[index],
            tangent=np.ascontiguousarray(old.tangent[:, index]),
            counts=np.ascontiguousarray(old.counts[:, index]),
            spent=np.ascontiguousarray(old.spent[:, index]),
        )
        return ExactCrowd(self.bundle.take(index), kept)

    def seat(self, seats: Whole, start: Floats) -> None:
        """Put new states ``start`` (seat, 2) in the place of some."""
        inner = self._inner
        begin = exact.State.start(
            x=start[:, 0], y=start[:, 1], backlash=self.bundle.backlash[seats]
        )
        inner.x[seats], inner.y[seats] = begin.x, begin.y
        inner.region[seats] = begin.region
