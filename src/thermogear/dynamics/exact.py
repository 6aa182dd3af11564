"""Event-exact propagation: choose the sub-steps, prepare the affine maps, run them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from math import factorial, prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base import fourier
from thermogear.base.arrays import Floats, Whole
from thermogear.base.errors import InputError
from thermogear.dynamics.kernels.affine import BEHIND, add_harmonics, prepare
from thermogear.dynamics.kernels.batch import CARRIED, QUEUE
from thermogear.dynamics.kernels.crossing import SCRATCH
from thermogear.dynamics.kernels.exact import advance_exact
from thermogear.dynamics.kernels.sensitivity import prepare_moved, sensitivity
from thermogear.dynamics.tables import LaneTables, Pieces

Bytes = NDArray[np.uint8]

ORDER = 12
BLOCK = 128
_COUNTS = tuple(base * 2**k for k in range(11) for base in (32, 48))
_OF_TURN = np.array([base * 2**k for k in range(14) for base in (32, 40, 48, 56)])
MOST_OF_TURN = 1_300_000
"""Sub-steps of a turn at most: a lane's maps then take some 1.1 GB."""
ROOM = 2**18
"""Sub-steps of all lanes of a block at most: what their maps take bounds the memory."""


def _bounds(lanes: LaneTables, name: str) -> tuple[Floats, Floats]:
    """Per lane: a bound of |p| over the period and of |dp/dphi| (without the jumps)."""
    if lanes.by_fft:
        size, rate = (fourier.bound(getattr(lanes, name), order) for order in (0, 1))
    else:
        coefficients = np.abs(getattr(lanes, name))
        size = coefficients.sum(axis=1)
        rate = 2.0 * np.pi * coefficients @ np.arange(coefficients.shape[1])
    for lane, piece in enumerate(getattr(lanes, name + "_pieces")):
        if piece is not None:
            size[lane] += max(sum(abs(c) for c in row) for row in piece.coefficients)
            rate[lane] += max(
                sum(m * abs(c) for m, c in enumerate(row)) for row in piece.coefficients
            )
    return size, rate


@lru_cache(maxsize=64)
def _powers(width: int, order: int) -> Floats:
    """(q pi/N)^(order - 1) of every harmonic q and every allowed count N of sub-steps."""
    turn = np.pi / np.array(_COUNTS)
    return np.asarray((np.arange(width)[:, None] * turn) ** (order - 1))


def substeps(lanes: LaneTables, order: int = ORDER) -> Whole:
    """Sub-steps a period each lane needs so that a polynomial of ``order`` is exact.

    The tail of the series stays below a few units in the last place: h sqrt(k_max) <= 0.3 for
    half width h in time, and every harmonic q of the tables adds at most 2e-17 of the scale.
    """
    stiffest, _ = _bounds(lanes, "stiffness")
    strongest, _ = _bounds(lanes, "force")
    mean = np.array(
        [
            row[0].real + (0.0 if piece is None else piece.mean)
            for row, piece in zip(lanes.stiffness, lanes.stiffness_pieces, strict=True)
        ]
    )
    scale = lanes.half_backlash + strongest / mean
    counts = np.array(_COUNTS)
    if lanes.by_fft:
        counts = lanes.mesh_periods * _OF_TURN
    half = lanes.period[:, None] / (2.0 * counts)
    allowed = 2e-17 * factorial(order + 1)
    good = half * np.maximum(np.sqrt(stiffest), lanes.damping)[:, None] <= 0.3
    for name, size in (("stiffness", np.ones(len(lanes))), ("force", scale)):
        coefficients = getattr(lanes, name)
        if lanes.by_fft:
            bound = fourier.bound(coefficients, order - 1)[:, None]
            tail = bound / (2.0 * counts) ** (order - 1)
        else:
            # summed rank by rank: no sum may depend on the other lanes
            powers = _powers(coefficients.shape[1], order)
            tail = np.sum(np.abs(coefficients)[:, :, None] * powers, axis=1)
        good &= half**2 * tail <= allowed * size[:, None]
    needed = np.where(good.any(axis=1), counts[np.argmax(good, axis=1)], 0)
    turn, longest = lanes.mesh_periods, int(needed.max(initial=0))
    if turn > 1 and longest > MOST_OF_TURN:
        raise InputError(
            "mesh_periods", turn, allowed=f"up to {MOST_OF_TURN * turn // longest} at this speed",
            why=f"the exact motion over a turn takes {longest // turn} sub-steps of each of them",
            fix="take the mean tooth (--mean-tooth), or let the teeth of one gear alone differ",
        )  # fmt: skip
    if np.all(needed):
        return needed
    lane = int(np.argmin(needed))
    raise InputError(
        "frequency",
        2.0 * np.pi / lanes.period[lane],
        why=f"the exact maps would need more than {counts[-1]} sub-steps a period",
        fix="take a higher speed; in Python, method='rk4' takes any",
    )


@dataclass(frozen=True, kw_only=True)
class ExactMaps:
    """Affine maps of lanes that share their sub-steps; made by :func:`prepare_maps`."""

    steps: Floats
    curves: Floats
    half: Floats
    reach: Floats
    backlash: Floats
    marks: Bytes
    borders: Floats
    order: int

    @property
    def polys(self) -> Floats:
        """Coefficients of phi, psi, nu and of the free psi, nu (N, lane, 5, order + 1)."""
        width = self.order + 1
        return self.curves[:, :, : 5 * width].reshape(*self.curves.shape[:2], 5, width)

    def take(self, keep: Whole) -> ExactMaps:
        """The maps of some lanes, in the order of ``keep``."""
        if keep.size == self.backlash.size and np.array_equal(keep, np.arange(keep.size)):
            return self
        (steps,) = _aligned((self.steps.shape[0], -(-keep.size // 8), 11, 8))
        place = np.arange(keep.size)
        rows = self.steps[:, keep // 8, :, keep % 8]
        steps[:, place // 8, :, place % 8] = rows
        (curves,) = _aligned((self.curves.shape[0], keep.size, self.curves.shape[2]), of=np.empty)
        np.take(self.curves, keep, axis=1, out=curves, mode="clip")
        return replace(
            self,
            steps=steps,
            curves=curves,
            half=np.ascontiguousarray(self.half[:, keep]),
            reach=self.reach[keep],
            backlash=self.backlash[keep],
        )

    @property
    def marked(self) -> int:
        """Samples a period."""
        return int(self.marks.sum())


@dataclass(kw_only=True)
class State:
    """State of a group of lanes; advanced in place."""

    x: Floats
    y: Floats
    region: Whole
    tangent: Floats
    counts: Whole
    spent: Floats = field(repr=False)

    @classmethod
    def start(cls, *, x: Floats, y: Floats, backlash: Floats) -> State:
        """Lanes at (x, y); on an edge the velocity says which region comes next."""
        drive = (x > backlash) | ((x == backlash) & (y > 0.0))
        back = (x < -backlash) | ((x == -backlash) & (y < 0.0))
        tangent = np.zeros((4, x.size))
        tangent[0] = tangent[3] = 1.0
        return cls(
            x=np.array(x, dtype=float),
            y=np.array(y, dtype=float),
            region=drive.astype(np.int64) - back.astype(np.int64),
            tangent=tangent,
            counts=np.zeros((2, x.size), np.int64),
            spent=np.zeros((3, x.size)),
        )

    def fresh_tangent(self) -> None:
        """Set the tangent to the identity, counts and times to zero."""
        self.tangent[:] = 0.0
        self.tangent[0] = self.tangent[3] = 1.0
        self.counts[:] = 0
        self.spent[:] = 0.0


def _aligned(*shapes: tuple[int, ...], of: Callable[[int], Floats] = np.zeros) -> list[Floats]:
    """Zeros that start on a cache line: eight numbers then lie in one."""
    counts = [prod(shape) for shape in shapes]
    room = of(sum(counts) + 8 * len(counts) + 8)
    first = -(room.__array_interface__["data"][0] // 8) % 8
    found = []
    for shape, count in zip(shapes, counts, strict=True):
        part = room[first : first + count]
        found.append(part if len(shape) == 1 else part.reshape(shape))
        first += -(-count // 8) * 8
    return found


@lru_cache(maxsize=32)
def _turned(
    ranks: bytes, centres: bytes, half: bytes, order: int
) -> tuple[Floats, Floats, Floats, Floats, Whole]:
    """What a layout's harmonics have in common for all lanes, as ``add_harmonics`` reads it."""
    rank = np.frombuffer(ranks, np.int64)
    angle = 2.0 * np.pi * np.mod(rank[:, None] * np.frombuffer(centres), 1.0)
    widths, which = np.unique(np.frombuffer(half), return_inverse=True)
    reach = 2.0 * np.pi * rank * widths[:, None]
    parts = np.zeros((2, *reach.shape, order + 1))
    power = np.ones(reach.shape)
    for m in range(order + 1):
        power = power * reach / m if m > 0 else power
        parts[m % 2, :, :, m] = power if m % 4 in (0, 3) else -power
    return np.cos(angle), np.sin(angle), parts[0], parts[1], which.ravel()


def _by_fft(lanes: LaneTables, half: Floats) -> bool:
    """Whether the tables of ``lanes`` go by FFT: long ones on even sub-steps."""
    return bool(lanes.by_fft and np.ptp(half) < 1e-6 * half[0])


def _taylor(lanes: LaneTables, name: str, centres: Floats, half: Floats, order: int) -> Floats:
    """Coefficients in u about the centre of every sub-step: (sub-step, lane, order + 1)."""
    coefficients = getattr(lanes, name)
    pieces: tuple[Pieces | None, ...] = getattr(lanes, name + "_pieces")
    if _by_fft(lanes, half):
        return fourier.taylor(coefficients, count=centres.size, order=order)
    if len(lanes) == 1 and pieces[0] is None:
        return _of_one(coefficients.tobytes(), centres.tobytes(), half.tobytes(), order)
    out = _of_harmonics(coefficients, centres, half, order)
    done: dict[Pieces, Floats] = {}
    for lane, piece in enumerate(pieces):
        if piece is not None:
            if piece not in done:
                rows = [
                    piece.taylor(centre=float(c), half=float(h), order=order)
                    for c, h in zip(centres, half, strict=True)
                ]
                done[piece] = np.array(rows)
            out[:, lane, :] += done[piece]
    return out


@lru_cache(maxsize=32)
def _of_one(coefficients: bytes, centres: bytes, half: bytes, order: int) -> Floats:
    """The table of one lane, kept: along a parameter one of the two often stays as it is."""
    row = np.frombuffer(coefficients, complex)[None]
    return _of_harmonics(row, np.frombuffer(centres), np.frombuffer(half), order)


def _of_harmonics(
    coefficients: NDArray[np.complex128], centres: Floats, half: Floats, order: int
) -> Floats:
    out = np.zeros((centres.size, len(coefficients), order + 1))
    out[:, :, 0] = coefficients[:, 0].real
    ranks = 1 + np.flatnonzero(np.any(coefficients[:, 1:], axis=0))
    if ranks.size:
        add_harmonics(
            np.ascontiguousarray(coefficients[:, ranks].real.T),
            np.ascontiguousarray(coefficients[:, ranks].imag.T),
            *_turned(ranks.tobytes(), centres.tobytes(), half.tobytes(), order),
            out,
        )
    return out


def prepare_maps(lanes: LaneTables, borders: Floats, marks: Bytes, order: int = ORDER) -> ExactMaps:
    """The maps of ``lanes`` on the sub-steps between ``borders`` (phases from 0 to 1)."""
    widths = np.diff(borders)
    centres = borders[:-1] + 0.5 * widths
    half = 0.5 * widths[:, None] * lanes.period
    size, rate = _bounds(lanes, "force")
    reach = (rate / lanes.period + lanes.damping * size) * half.max(axis=0) ** 3
    width, room = order + 1, -(-(5 * (order + 1) + BEHIND) // 8) * 8
    # a group of eight lanes for one is as large as its curves, which have the same numbers
    slim = lanes.by_fft and len(lanes) == 1
    (steps,) = _aligned((0 if slim else centres.size, -(-len(lanes) // 8), 11, 8))
    (curves,) = _aligned((centres.size, len(lanes), room))
    work, tables, ends, table, turned = _aligned(
        (40 * width,), (16 * width,), (80,), (8 * room,), (64,)
    )
    prepare(
        lanes.damping,
        lanes.half_backlash,
        reach,
        half.ravel(),
        _taylor(lanes, "stiffness", centres, 0.5 * widths, order).ravel(),
        _taylor(lanes, "force", centres, 0.5 * widths, order).ravel(),
        steps.ravel(),
        curves.ravel(),
        work,
        tables,
        ends,
        table,
        turned,
        np.empty(16, np.int64),
    )
    return ExactMaps(
        steps=steps,
        curves=curves,
        half=half,
        reach=reach,
        backlash=lanes.half_backlash,
        marks=marks,
        borders=borders,
        order=order,
    )


def maps_moved(
    maps: ExactMaps,
    lanes: LaneTables,
    around: Sequence[tuple[float, LaneTables]],
    order: int = ORDER,
) -> tuple[Floats, Floats, float]:
    """Derivatives of the polynomials (N, 5, K + 1), half widths (N) and half backlash of one lane.

    ``maps`` are those of ``lanes``. The numbers of the equation change at the rate
    sum(weight * neighbour) over ``around``; how the maps change with them is exact.
    """
    width = np.diff(maps.borders)
    centres = maps.borders[:-1] + 0.5 * width

    def rate(name: str) -> float:
        return float(sum(weight * getattr(one, name)[0] for weight, one in around))

    def table(name: str) -> Floats:
        if any(getattr(one, name + "_pieces")[0] is not None for _, one in around):
            parts = [w * _taylor(one, name, centres, 0.5 * width, order) for w, one in around]
        else:
            moved = np.sum([w * getattr(one, name) for w, one in around], axis=0)
            if _by_fft(lanes, 0.5 * width):
                parts = [fourier.taylor(moved, count=centres.size, order=order)]
            else:
                parts = [_of_harmonics(moved, centres, 0.5 * width, order)]
        return np.asarray(np.sum(parts, axis=0)[:, 0])

    half = 0.5 * width * rate("period")
    polys = np.empty((centres.size, 5, order + 1))
    prepare_moved(
        float(lanes.damping[0]),
        rate("damping"),
        np.ascontiguousarray(maps.half[:, 0]),
        half,
        _taylor(lanes, "stiffness", centres, 0.5 * width, order)[:, 0],
        table("stiffness"),
        _taylor(lanes, "force", centres, 0.5 * width, order)[:, 0],
        table("force"),
        np.empty(5 * (order + 1)),
        np.empty(5 * (order + 1)),
        np.empty(20),
        polys,
    )
    return polys, half, rate("half_backlash")


def first_half(maps: ExactMaps) -> ExactMaps:
    """The maps of the first half period; InputError where no border lies at phase 1/2."""
    count = int(np.searchsorted(maps.borders, 0.5))
    if maps.borders[count] != 0.5:
        raise InputError("sub-steps", maps.borders.size - 1, allowed="a border at phase 1/2")
    return replace(
        maps,
        steps=maps.steps[:count],
        curves=maps.curves[:count],
        half=maps.half[:count],
        marks=maps.marks[:count],
        borders=maps.borders[: count + 1],
    )


def moved_by(
    maps: ExactMaps, *, rates: tuple[Floats, Floats, float], start: Floats, steps: int
) -> tuple[Floats, float]:
    """d(x, y)/dp after ``steps`` sub-steps of one lane, and the least distance of an extreme of x
    on the way from an edge of the backlash.

    ``rates``: derivatives of the polynomials (N, 5, K + 1), half widths (N) and half backlash by
    the parameter p. The start does not move. Exact for the path as it is: crossings stay at their
    phases, which the continuous force allows.
    """
    state = State.start(x=start[:1], y=start[1:], backlash=maps.backlash)
    found = np.empty(3)
    sensitivity(
        maps.polys[:, 0].ravel(),
        np.ascontiguousarray(maps.half[:, 0]),
        float(maps.backlash[0]),
        rates[0].ravel(),
        np.ascontiguousarray(rates[1]),
        float(rates[2]),
        np.asarray(start, dtype=float),
        int(state.region[0]),
        steps,
        np.empty(2 * (maps.order + 1) + SCRATCH),
        np.empty(12),
        found,
    )
    return found[:2], float(found[2])


@lru_cache(maxsize=64)
def _borders(count: int, jumps: tuple[float, ...], samples: int) -> tuple[Floats, Bytes]:
    """The borders of ``count`` sub-steps and of jumps, and which of them are sampled."""
    uniform = np.arange(count + 1) / count
    borders = np.unique(np.concatenate([uniform, jumps]))
    marks = np.zeros(borders.size - 1, np.uint8)
    if samples > 0:
        at = uniform[: -1 : count // samples]
        marks[np.searchsorted(borders, at)] = 1
    return borders, marks


def layouts(
    lanes: LaneTables, *, samples: int = 0, block: int = BLOCK, refine: int = 1
) -> Iterator[tuple[Whole, Floats, Bytes]]:
    """Blocks of lanes with equal sub-steps: their indices, the borders, the sampled borders.

    The sub-steps of a lane depend on that lane alone, so results do not depend on company.
    ``refine`` multiplies their number: another rounding of the same motion. Of a turn, whose maps
    are large, it adds a quarter each time.
    """
    needed = substeps(lanes)
    needed = needed * (3 + refine) // 4 if lanes.by_fft else needed * refine
    keys = [(int(needed[i]), lanes.jumps(i)) for i in range(len(lanes))]
    for key in sorted(set(keys)):
        count, jumps = key
        if samples > 0:
            count = -(-count // samples) * samples
        borders, marks = _borders(count, jumps, samples)
        index = np.array([i for i, k in enumerate(keys) if k == key])
        parts = -(-index.size // max(1, min(block, ROOM // count)))
        for part in range(parts):
            # every so many-th lane: neighbours are alike, and blocks should cost the same
            yield index[part::parts], borders, marks


def advance(
    maps: ExactMaps,
    state: State,
    periods: int,
    *,
    columns: int = 0,
    normalise: bool = False,
    sampled: bool = False,
) -> tuple[Floats, Floats, Floats]:
    """Run ``periods`` periods in place; sections (period, 2, lane), stretches, samples.

    ``columns`` tangent columns travel along; ``normalise`` rescales the first one every period
    and returns the logarithms as stretches (period, lane).
    """
    lanes = state.x.size
    sections = np.empty((periods, 2, lanes))
    stretch = np.zeros((periods if normalise else 0, lanes))
    samples = np.empty((periods * maps.marked if sampled else 0, 2, lanes))
    width, room = maps.order + 1, maps.curves.shape[2]
    carried, table, p, scratch = _aligned(
        (CARRIED * (-(-lanes // 8) * 8),), (8 * room,), (8 * width,), (2 * width + SCRATCH,)
    )
    # one layout for all: a kernel is compiled once
    owned: tuple[NDArray[Any], ...] = (
        state.x,
        state.y,
        state.region,
        state.tangent,
        state.counts,
        state.spent,
    )
    flat: list[NDArray[Any]] = [array.reshape(-1) for array in owned]
    x, y, region, tangent, counts, spent = flat
    advance_exact(
        maps.steps.ravel() if maps.steps.size else np.zeros(11 * 8),
        maps.curves.ravel(),
        width,
        maps.reach,
        maps.backlash,
        x,
        y,
        region,
        tangent,
        columns,
        normalise,
        sections.ravel(),
        stretch.ravel(),
        samples.ravel(),
        maps.marks,
        counts,
        spent,
        carried,
        table,
        p,
        scratch,
        np.empty(QUEUE + 16 + lanes, np.int64),
    )
    for array, done in zip(owned, flat, strict=True):
        if not array.flags.c_contiguous:
            array[...] = done.reshape(array.shape)
    return sections, stretch, samples
