"""Long work as chunks that are computed apart from each other and put together.

A plan says what is stored, how it is cut, and computes one chunk. In memory :func:`gather` runs
it on threads; a store can keep the same chunks on disk. A chunk depends on the plan's inputs
(and on the one chunk it needs) alone, so the result does not depend on who computes it, when.
"""

from __future__ import annotations

import math
import os
import threading
from collections import Counter
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, field
from itertools import product
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Dataset

Arrays = dict[str, NDArray[Any]]
Key = tuple[int, ...]
Alive = Callable[[], None]
Progress = Callable[[int, int], None]
"""Called as ``progress(chunks done, chunks)``."""


Coordinate: TypeAlias = "tuple[tuple[str, ...], ArrayLike, dict[str, Any]]"
"""Dimensions, values and attributes of an axis."""


@dataclass(frozen=True)
class Variable:
    """A stored array: its ``dims``, numpy ``dtype``, ``fill`` and attributes."""

    dims: tuple[str, ...]
    dtype: str
    fill: float | int
    attributes: Mapping[str, Any] = field(default_factory=dict)


def real(dims: tuple[str, ...], words: str, units: str, *inner: str) -> Variable:
    """A stored number over ``dims`` and ``inner`` ones, nan where none was computed."""
    about = {"long_name": words, "units": units}
    return Variable((*dims, *inner), "float64", float("nan"), about)


def axis_coordinates(
    names: Sequence[str], units: Sequence[str], axes: Sequence[ArrayLike]
) -> dict[str, Coordinate]:
    """The axes of a grid as coordinates of their own names."""
    return {
        name: ((name,), np.array(values), {"units": unit})
        for name, unit, values in zip(names, units, axes, strict=True)
    }


class Stopped(Exception):
    """The work was asked to end; what is finished stays."""


def keep_going() -> None:
    """Nobody asks to stop."""


class Plan(Protocol):
    """Work cut into chunks; every variable has all cut dimensions."""

    @property
    def kind(self) -> str:
        """Its name."""

    @property
    def sizes(self) -> dict[str, int]:
        """Of the dimensions."""

    @property
    def cuts(self) -> dict[str, int]:
        """The chunk length along the dimensions that are cut."""

    def inputs(self) -> dict[str, Any]:
        """What defines it, as plain numbers and texts."""

    def variables(self) -> dict[str, Variable]:
        """What is stored."""

    def coordinates(self) -> dict[str, Coordinate]:
        """The axes of what is stored."""

    def needs(self, key: Key) -> Key | None:
        """The chunk that must be there first."""

    def compute(self, key: Key, before: Arrays | None, alive: Alive) -> Arrays:
        """The arrays of a chunk; ``before``: those of the chunk it needs."""

    def finish(self, data: Dataset) -> Dataset:
        """Add what follows from the whole."""

    def pilot(self, share: float, *, turn: int) -> float:
        """Do about a ``share`` of the work, spread over it, at least one point of it.

        Returns what share it was. Each ``turn`` 0, 1, 2, ... takes other points.
        """


def keys_of(plan: Plan) -> list[Key]:
    """All chunks, the last cut running fastest."""
    counts = [-(-plan.sizes[name] // length) for name, length in plan.cuts.items()]
    return list(product(*(range(count) for count in counts)))


def ranges_of(plan: Plan, key: Key) -> dict[str, slice]:
    """The stretch of every cut dimension that a chunk covers."""
    sizes = plan.sizes
    return {
        name: slice(place * length, min((place + 1) * length, sizes[name]))
        for place, (name, length) in zip(key, plan.cuts.items(), strict=True)
    }


def region_of(plan: Plan, key: Key, variable: Variable) -> tuple[slice, ...]:
    """Where a chunk's array lies inside the whole variable."""
    ranges, sizes = ranges_of(plan, key), plan.sizes
    return tuple(ranges.get(name, slice(0, sizes[name])) for name in variable.dims)


def checked(plan: Plan, key: Key, arrays: Arrays) -> Arrays:
    """The chunk's arrays in their stored types and shapes."""
    found: Arrays = {}
    for name, blank in empty_arrays(plan, key).items():
        values = np.ascontiguousarray(arrays[name], dtype=blank.dtype)
        if values.shape != blank.shape:
            raise ValueError(f"{name} of chunk {key}: shape {values.shape}, expected {blank.shape}")
        found[name] = values
    return found


def empty_arrays(plan: Plan, key: Key | None = None) -> Arrays:
    """Arrays of the whole, or of one chunk, filled with the fill values."""
    sizes = dict(plan.sizes)
    if key is not None:
        sizes |= {n: part.stop - part.start for n, part in ranges_of(plan, key).items()}
    return {
        name: np.full([sizes[d] for d in v.dims], v.fill, np.dtype(v.dtype))
        for name, v in plan.variables().items()
    }


def before_along(plan: Plan, key: Key, name: str) -> Key | None:
    """The chunk before ``key`` along the axis ``name``, its last; behind it on the way down.

    The axis in front of it is that of the direction, 0 up.
    """
    place = key[-1] - 1 if key[-2] == 0 else key[-1] + 1
    return (*key[:-1], place) if 0 <= place < -(-plan.sizes[name] // plan.cuts[name]) else None


def dataset_of(plan: Plan, arrays: Arrays) -> Dataset:
    """The finished, labelled result."""
    import xarray as xr

    variables = plan.variables()
    data = xr.Dataset(
        {n: xr.Variable(v.dims, arrays[n], dict(v.attributes)) for n, v in variables.items()},
        {n: xr.Variable(d, np.asarray(x), dict(a)) for n, (d, x, a) in plan.coordinates().items()},
    )
    data.attrs["kind"] = plan.kind
    return plan.finish(data)


def bytes_of(plan: Plan) -> int:
    """Size of all variables, as a whole Python integer."""
    sizes = plan.sizes
    return sum(
        np.dtype(one.dtype).itemsize * math.prod(int(sizes[name]) for name in one.dims)
        for one in plan.variables().values()
    )


class Queue:
    """The ``wanted`` chunks of a plan, each handed out once the chunk that it needs is there."""

    def __init__(self, plan: Plan, wanted: Sequence[Key]) -> None:
        self._plan = plan
        self._waiting, self._missing = list(wanted), set(wanted)

    def __len__(self) -> int:
        return len(self._waiting)

    def take(self, most: int) -> Iterator[tuple[Key, Key | None]]:
        """Up to ``most`` chunks that can be computed now, each with the one it needs."""
        for key in list(self._waiting):
            if most <= 0:
                return
            need = self._plan.needs(key)
            if need not in self._missing:
                most -= 1
                self._waiting.remove(key)
                yield key, need

    def there(self, key: Key) -> None:
        """A chunk is computed: those that need it can be."""
        self._missing.discard(key)


def computed(
    plan: Plan,
    wanted: list[Key],
    load: Callable[[Key], Arrays],
    *,
    threads: int | None = None,
    alive: Alive = keep_going,
) -> Generator[tuple[Key, Arrays], None, None]:
    """Compute the ``wanted`` chunks on threads; yields each as it is ready.

    ``load`` gives a chunk that is already there, for chunks that need it. Closing the iterator
    ends the work at the next pause of every thread, and so does ``alive`` when it raises.
    """
    stop = threading.Event()

    def going() -> None:
        if stop.is_set():
            raise Stopped
        alive()

    count = max(1, threads or os.cpu_count() or 1)
    waiting = Queue(plan, wanted)
    kept: dict[Key, Arrays] = {}
    heirs = Counter(need for key in wanted if (need := plan.needs(key)) is not None)

    def inherited(need: Key) -> Arrays:
        """A chunk for one of those that need it, kept for the others."""
        heirs[need] -= 1
        found = kept[need] if need in kept else load(need)
        if not heirs[need]:
            kept.pop(need, None)
        return found

    with ThreadPoolExecutor(count) as pool:
        running: dict[Future[Arrays], Key] = {}
        try:
            while waiting or running:
                for key, need in waiting.take(count - len(running)):
                    before = None if need is None else inherited(need)
                    running[pool.submit(plan.compute, key, before, going)] = key
                ended, _ = wait(running, timeout=0.2, return_when=FIRST_COMPLETED)
                for future in ended:
                    key = running.pop(future)
                    arrays = checked(plan, key, future.result())
                    waiting.there(key)
                    if heirs[key]:
                        kept[key] = arrays
                    yield key, arrays
        finally:
            stop.set()
            for future in running:
                future.cancel()


def gather(
    plan: Plan,
    *,
    threads: int | None = None,
    progress: Progress | None = None,
    alive: Alive = keep_going,
) -> Dataset:
    """Compute the whole plan in memory; ``alive`` raises to end the work."""
    whole = empty_arrays(plan)
    keys = keys_of(plan)
    variables = plan.variables()

    def load(key: Key) -> Arrays:
        return {n: whole[n][region_of(plan, key, v)] for n, v in variables.items()}

    chunks = computed(plan, keys, load, threads=threads, alive=alive)
    for done, (key, arrays) in enumerate(chunks, start=1):
        for name, variable in variables.items():
            whole[name][region_of(plan, key, variable)] = arrays[name]
        if progress is not None:
            progress(done, len(keys))
    return dataset_of(plan, whole)


@dataclass(frozen=True, eq=False)
class Slice:
    """A part of a plan's result: ``arrays`` as stored, at the places ``where`` of each dimension
    that is cut. A ``preview`` is of a coarser plan, and the slices that follow replace it.
    """

    where: Mapping[str, NDArray[np.int64]]
    arrays: Arrays
    preview: bool = False


def slices(
    plan: Plan,
    *,
    coarse: int = 0,
    threads: int | None = None,
    alive: Alive = keep_going,
) -> Generator[Slice, None, None]:
    """The result of ``plan`` part by part, as soon as each is there.

    Together the slices are what the whole plan gives, to the last bit; a run-up's come in the order
    in which it passes the speeds. ``coarse`` > 1: first the whole of every so many-th value, marked
    as preview, where the plan can be thinned. ``alive`` is called often and raises to end the
    work, as closing the generator does.
    """
    # ``thinned``: the plan of every so many-th value, the last included, and which these are
    thinned = getattr(plan, "thinned", None)
    if coarse > 1 and thinned is not None:
        thin, places = thinned(coarse)
        for one in slices(thin, threads=threads, alive=alive):
            where = {
                name: some[one.where[name]] if name in one.where else some
                for name, some in places.items()
            }
            yield Slice(where, one.arrays, preview=True)
    nothing: dict[Key, Arrays] = {}
    keys = keys_of(plan)
    for key, arrays in computed(plan, keys, nothing.__getitem__, threads=threads, alive=alive):
        ranges = ranges_of(plan, key)
        yield Slice({name: np.arange(r.start, r.stop) for name, r in ranges.items()}, arrays)


def spread(count: int, *, some: int, turn: float = 0) -> NDArray[np.int64]:
    """About ``some`` places of ``count``, in the middle of equal stretches, moved on each ``turn``.

    The golden ratio moves them, so that places of many turns fill the stretches evenly.
    """
    some = min(max(some, 1), count)
    move = (0.5 + 0.5 * (math.sqrt(5.0) - 1.0) * turn) % 1.0
    return np.unique(((np.arange(some) + move) * count / some).astype(int))


def stretches(values: Sequence[float], *, count: int, turn: int) -> tuple[float, ...]:
    """About ``count`` of ``values``, at least one, in fours of neighbours spread over them."""
    length = min(max(count, 1), len(values), 4)
    places = spread(len(values) - length + 1, some=max(count, 1) // length, turn=turn)
    return tuple(values[i] for i in np.unique(places[:, None] + np.arange(length)))


def every(count: int, *, step: int) -> NDArray[np.int64]:
    """Every ``step``-th place of ``count``, the last included."""
    return np.unique(np.append(np.arange(0, count, step), count - 1))
