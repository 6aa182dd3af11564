"""The event-exact return map of one mass with clearance, alone and many side by side."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats, Whole
from thermogear.base.errors import InputError
from thermogear.dynamics import exact
from thermogear.dynamics.blocks import Pace, run_blocks
from thermogear.dynamics.bundle import Prepared, Visits
from thermogear.dynamics.extremes import WATCHED, Extremes, extremes_of
from thermogear.dynamics.return_map import StateMap, Visit
from thermogear.dynamics.tables import LaneTables


def exact_bundles(lanes: LaneTables, refine: int = 1) -> Iterator[Prepared]:
    """Blocks of lanes with equal sub-steps, and how the maps of each are prepared."""
    for index, borders, marks in exact.layouts(lanes, refine=refine):
        yield index, partial(_prepared, lanes, index, borders, marks)


def _prepared(
    lanes: LaneTables, index: Whole, borders: Floats, marks: NDArray[np.uint8]
) -> ExactBundle:
    mine = lanes.take(index)
    maps = exact.prepare_maps(mine, borders, marks)
    return ExactBundle(maps, period=mine.period, damping=mine.damping, mesh_period=mine.mesh_period)


class ExactBundle:
    """The return maps of lanes that share their sub-steps; a state is (x, x')."""

    def __init__(
        self, maps: exact.ExactMaps, *, period: Floats, damping: Floats, mesh_period: Floats
    ) -> None:
        self.maps = maps
        self.period = period
        self.damping = damping
        self.mesh_period = mesh_period

    def __len__(self) -> int:
        return int(self.period.size)

    @property
    def backlash(self) -> Floats:
        """Half backlash of every lane."""
        return self.maps.backlash

    @property
    def unit(self) -> Floats:
        """Scales of (x, x') for distances: b and 2 pi b over the mesh period, (lane, 2)."""
        b = self.maps.backlash
        return np.stack([b, 2.0 * np.pi * b / self.mesh_period], axis=1)

    def determinant(self, periods: int) -> Floats:
        """det D P^n = exp(-c T n) of every trajectory: (lane,)."""
        return np.asarray(np.exp(-(self.damping * self.period) * periods))

    def take(self, index: Whole) -> ExactBundle:
        """The maps of some lanes, in the order of ``index``."""
        return ExactBundle(
            self.maps.take(index),
            period=self.period[index],
            damping=self.damping[index],
            mesh_period=self.mesh_period[index],
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
        """Give every lane a tangent ``direction`` (lane, 2), else (1, 2 pi over a mesh period)."""
        inner = self._inner
        inner.fresh_tangent()
        if direction is None:
            inner.tangent[2] = 2.0 * np.pi / self.bundle.mesh_period
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


Rates = tuple[Floats, Floats, float]


def _lanes(model: object) -> LaneTables:
    found: LaneTables = model if isinstance(model, LaneTables) else model.lanes()  # type: ignore[attr-defined]
    return found


class ExactMap(StateMap):
    """P: (x, x') at phase 0 to (x, x') one period later, of one lane, by event-exact maps."""

    def __init__(self, lanes: LaneTables, samples: int = 0) -> None:
        if len(lanes) != 1:
            raise InputError("model", f"{len(lanes)} lanes", allowed="one lane")
        self.lanes, self._samples = lanes, samples
        self.period = float(lanes.period[0])
        self.backlash = float(lanes.half_backlash[0])
        self.unit = lanes.unit[0]

    @cached_property
    def maps(self) -> exact.ExactMaps:
        """Made when first asked for: those of a turn are large."""
        ((_, borders, marks),) = exact.layouts(self.lanes, samples=self._samples)
        return exact.prepare_maps(self.lanes, borders, marks)

    def determinant(self, periods: int) -> float:
        """det D P^n = exp(-c n T) of every trajectory."""
        return float(np.exp(-self.lanes.damping[0] * self.period * periods))

    def flow(self, start: Floats, halves: int) -> tuple[Floats, Floats]:
        """State (2,) and Jacobian (2, 2) ``halves`` half periods later.

        An odd number needs a border of the sub-steps at phase 1/2, as every uniform layout has.
        """
        state = exact.State.start(
            x=np.array([start[0]]), y=np.array([start[1]]), backlash=self.lanes.half_backlash
        )
        if halves > 1:
            exact.advance(self.maps, state, halves // 2, columns=2)
        if halves % 2:
            exact.advance(exact.first_half(self.maps), state, 1, columns=2)
        return np.array([state.x[0], state.y[0]]), state.tangent[:, 0].reshape(2, 2)

    def rates(self, around: Sequence[tuple[float, object]]) -> Rates:
        """Derivatives of the affine maps where the numbers change at sum(weight * model)."""
        lanes = [(weight, _lanes(model)) for weight, model in around]
        return exact.maps_moved(self.maps, self.lanes, lanes)

    def moved(self, start: Floats, halves: int, rates: Rates) -> tuple[Floats, float]:
        """d(x, x')/dp (2,) after ``halves`` half periods, crossings staying at their phases.

        And how near an extreme of x comes to an edge of the backlash, in half backlashes.
        """
        count = self.maps.half.shape[0]
        middle = int(np.searchsorted(self.maps.borders, 0.5)) if halves % 2 else 0
        steps = (halves // 2) * count + middle
        found, margin = exact.moved_by(self.maps, rates=rates, start=start, steps=steps)
        return found, margin / self.backlash

    @cached_property
    def _watched(self) -> tuple[ExactMap, Floats]:
        """The same map with samples, and stiffness and force (samples, 2) at them."""
        count = WATCHED * self.lanes.mesh_periods
        phases = np.arange(count) / count
        tables = [self.lanes.values(name, phases)[:, 0] for name in ("stiffness", "force")]
        return ExactMap(self.lanes, count), np.stack(tables, axis=1)

    def extremes(self, start: Floats, periods: int) -> Extremes:
        """Extremes of the depths of both flanks along the closed orbit from ``start``."""
        section, tables = self._watched
        x, v = section.visit(start, periods, sampled=True).samples.T
        b, step = self.backlash, self.period / len(tables)
        stiffness, force = np.tile(tables, (periods, 1)).T
        bend = force - self.lanes.damping[0] * v - stiffness * (x - np.clip(x, -b, b))
        motion = np.stack([x, step * v, step**2 * bend])[..., None] / b

        def depths(displacement: Floats, _: Floats) -> Floats:
            return np.concatenate([displacement, -displacement], axis=-1) - 1.0

        return extremes_of(motion, depths, periods=periods)

    def carry(self, start: Floats, periods: int) -> Floats:
        """The states (periods, 2) after 1, 2, ... periods from ``start``."""
        state = exact.State.start(
            x=np.array([start[0]]), y=np.array([start[1]]), backlash=self.lanes.half_backlash
        )
        sections, _, _ = exact.advance(self.maps, state, periods)
        return np.asarray(sections[:, :, 0])

    def visit(self, start: Floats, periods: int = 1, *, sampled: bool = False) -> Visit:
        """Run ``periods`` periods from ``start`` with the variational equations."""
        state = exact.State.start(
            x=np.array([start[0]]), y=np.array([start[1]]), backlash=self.lanes.half_backlash
        )
        sections, _, samples = exact.advance(self.maps, state, periods, columns=2, sampled=sampled)
        return Visit(
            points=np.vstack([np.asarray(start, dtype=float)[None], sections[:, :, 0]]),
            jacobian=state.tangent[:, 0].reshape(2, 2),
            contact_losses=int(state.counts[0, 0]),
            back_impacts=int(state.counts[1, 0]),
            shares=state.spent[:, 0] / (periods * self.period),
            samples=samples[:, :, 0],
        )


class Ensemble:
    """Many lanes running side by side, with the last stretch of their sections kept.

    ``parting``: one tangent travels along every lane; :attr:`level` is ln|D P^n e| over the last
    :meth:`run` and :attr:`top` the largest it was on the way.
    """

    def __init__(
        self,
        lanes: LaneTables,
        start: Floats,
        *,
        threads: int | None = None,
        refine: int = 1,
        parting: bool = False,
    ) -> None:
        self.lanes = lanes
        self.threads = threads
        self.elapsed = 0
        self.parting = parting
        self.level = np.zeros(len(lanes))
        self.top = np.zeros(len(lanes))
        self._blocks = list(exact.layouts(lanes, refine=refine))
        self._states = [
            exact.State.start(
                x=start[index, 0], y=start[index, 1], backlash=lanes.half_backlash[index]
            )
            for index, _, _ in self._blocks
        ]

    @property
    def state(self) -> Floats:
        """Present (x, x') of every lane: (lane, 2)."""
        out = np.empty((len(self.lanes), 2))
        for (index, _, _), state in zip(self._blocks, self._states, strict=True):
            out[index, 0], out[index, 1] = state.x, state.y
        return out

    def run(self, periods: int, *, keep: int = 0) -> Floats:
        """Advance; the last ``keep`` sections as (lane, keep, 2)."""
        kept = np.full((len(self.lanes), keep, 2), np.nan)
        self.level[:] = 0.0
        self.top[:] = 0.0

        def block(number: int, pace: Pace) -> None:
            # prepared anew: it costs some thirty periods and spares the memory of all blocks
            index, borders, marks = self._blocks[number]
            maps = exact.prepare_maps(self.lanes.take(index), borders, marks)
            state = self._states[number]
            if self.parting:
                turn = 2.0 * np.pi / self.lanes.mesh_period[index]
                state.tangent[0] = 1.0 / np.hypot(1.0, turn)
                state.tangent[2] = turn / np.hypot(1.0, turn)
            for first, count in pace.chunks(periods, lanes=index.size):
                sections, stretch, _ = exact.advance(
                    maps, state, count, columns=int(self.parting), normalise=self.parting
                )
                if self.parting:
                    levels = np.cumsum(np.vstack([self.level[index], stretch]), axis=0)
                    self.level[index] = levels[-1]
                    self.top[index] = np.fmax(self.top[index], np.max(levels, axis=0))
                wanted = first + count - (periods - keep)
                if wanted > 0:
                    part = sections[-min(wanted, count) :].transpose(2, 0, 1)
                    kept[index, wanted - part.shape[1] : wanted] = part

        jobs = [partial(block, number) for number in range(len(self._blocks))]
        run_blocks(jobs, len(self.lanes) * periods, threads=self.threads)
        self.elapsed += periods
        return kept
