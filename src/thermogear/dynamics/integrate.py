"""simulate: a clearance oscillator over many mesh periods, as a labelled dataset."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear import __version__
from thermogear.base.arrays import Dataset, Floats
from thermogear.base.bounds import whole
from thermogear.base.errors import InputError, require_choice
from thermogear.base.period import turns
from thermogear.dynamics import adaptive, exact
from thermogear.dynamics.blocks import Pace, Progress, run_blocks
from thermogear.dynamics.kernels.rk4 import advance_rk4
from thermogear.dynamics.lanes import Lanes
from thermogear.dynamics.models import ClearanceModel, PairModel
from thermogear.dynamics.outcome import DIVERGED, Result, dataset
from thermogear.dynamics.pair import angle_attributes, four_of, with_angles

METHODS = {
    "exact": "event-exact affine maps",
    "rk4": "classical Runge-Kutta, fixed steps",
    "adaptive": "scipy DOP853 with events at the backlash edges",
}
RK4_BLOCK = 64


def _choose(model: object, method: str) -> tuple[str, str]:
    """The method and why it was taken."""
    require_choice("method", method, ["auto", *METHODS])
    if method != "auto":
        if method == "exact" and not isinstance(model, ClearanceModel):
            raise InputError(
                "method",
                "'exact'",
                why="the exact maps need a piecewise-linear force and coefficients of time alone",
                fix="use method='adaptive'",
            )
        return method, "asked for"
    if not isinstance(model, ClearanceModel):
        return "adaptive", "coefficients may depend on the state: neither maps nor tables apply"
    try:
        exact.substeps(model.lanes())
    except InputError as error:
        return "rk4", f"{error.why}"
    return "exact", "piecewise-linear force, stiffness and force are functions of time alone"


def _exact_block(
    lanes: Lanes,
    index: NDArray[np.int64],
    borders: Floats,
    marks: NDArray[np.uint8],
    start: Floats,
    discard: int,
    result: Result,
    pace: Pace,
) -> None:
    mine = lanes.take(index)
    maps = exact.prepare_maps(mine, borders, marks)
    state = exact.State.start(x=start[index, 0], y=start[index, 1], backlash=mine.half_backlash)
    for _, count in pace.chunks(discard, lanes=index.size):
        exact.advance(maps, state, count)
    state.fresh_tangent()
    result.sections[index, 0, 0] = state.x
    result.sections[index, 1, 0] = state.y
    periods = result.sections.shape[2] - 1
    wanted = maps.marked
    for first, count in pace.chunks(periods, lanes=index.size):
        sections, _, samples = exact.advance(maps, state, count, sampled=wanted > 0)
        result.sections[index, :, first + 1 : first + 1 + count] = sections.transpose(2, 1, 0)
        if wanted:
            part = slice(first * wanted, (first + count) * wanted)
            result.samples[index, :, part] = samples.transpose(2, 1, 0)
    result.losses[index], result.impacts[index] = state.counts
    if periods:
        result.shares[index] = (state.spent / (periods * mine.period)).T
    result.substeps[index] = borders.size - 1


def _rk4_block(
    lanes: Lanes,
    index: NDArray[np.int64],
    run: _Run,
    start: Floats,
    result: Result,
    pace: Pace,
) -> None:
    steps, samples = run.steps, run.samples
    precision: type[np.floating] = np.float64 if run.precision == "float64" else np.float32
    mine = lanes.take(index)
    phase = np.arange(2 * steps) / (2 * steps)
    stiffness = np.ascontiguousarray(mine.values("stiffness", phase), precision)
    force = np.ascontiguousarray(mine.values("force", phase), precision)
    damping = mine.damping.astype(precision)
    backlash = mine.half_backlash.astype(precision)
    step = (mine.period / steps).astype(precision)
    x = start[index, 0].astype(precision)
    v = start[index, 1].astype(precision)
    none = np.empty((0, 2, index.size), precision)
    stride = steps // samples if samples else 1
    for _, count in pace.chunks(run.discard, lanes=index.size):
        sections = np.empty((count, 2, index.size), precision)
        advance_rk4(stiffness, force, damping, backlash, step, x, v, sections, none, stride)
    result.sections[index, 0, 0] = x
    result.sections[index, 1, 0] = v
    periods = result.sections.shape[2] - 1
    for first, count in pace.chunks(periods, lanes=index.size):
        sections = np.empty((count, 2, index.size), precision)
        path = np.empty((count * samples, 2, index.size), precision) if samples else none
        advance_rk4(stiffness, force, damping, backlash, step, x, v, sections, path, stride)
        result.sections[index, :, first + 1 : first + 1 + count] = sections.transpose(2, 1, 0)
        if samples:
            part = slice(first * samples, (first + count) * samples)
            result.samples[index, :, part] = path.transpose(2, 1, 0)
    result.substeps[index] = steps


def _adaptive_lane(
    lanes: Lanes,
    lane: int,
    run: _Run,
    start: Floats,
    result: Result,
    pace: Pace,
) -> None:
    samples = run.samples
    one = lanes.take(lane)
    backlash = float(one.half_backlash[0])
    periods = result.sections.shape[2] - 1
    y = np.array(start[lane], dtype=float)
    total = run.discard + periods
    rate = adaptive.lane_rate(one)
    gap = adaptive.Gap(lambda _, y: float(y[0]), lambda _, y: float(y[1]), backlash)
    result.sections[lane, :, 0] = y
    for turn in range(total):
        for _ in pace.chunks(1, lanes=1):
            kept = turn - run.discard
            sections, path, _crossings = adaptive.follow(
                rate,
                gap,
                float(one.period[0]),
                y,
                periods=1,
                samples=samples if kept >= 0 else 0,
                jumps=one.jumps(0),
                rtol=run.tolerances[0],
                atol=run.tolerances[1] * backlash,
            )
            y = sections[-1]
            if not np.all(np.abs(y[0]) <= 1e6 * backlash):
                return
            if kept >= -1:
                result.sections[lane, :, kept + 1] = y
            if kept >= 0 and samples:
                result.samples[lane, :, kept * samples : (kept + 1) * samples] = path.T


def simulate(
    model: object,
    *,
    periods: int = 64,
    discard: int = 0,
    steps_per_period: int = 256,
    samples_per_period: int = 64,
    initial_state: ArrayLike = (0.0, 0.0),
    method: str = "auto",
    precision: str = "float64",
    threads: int | None = None,
    progress: Progress | None = None,
    rtol: float = 1e-12,
    atol: float = 1e-14,
) -> Dataset:
    """Run ``model`` for ``discard`` + ``periods`` mesh periods from phase 0.

    Where the tables of ``model`` repeat after a turn of many mesh periods, both counts are rounded
    up to whole turns; samples, steps and phases are of the mesh period all the same.
    ``model``: :class:`TorsionalModel`, :class:`DeadZoneModel` (lanes side by side),
    :class:`PairModel`, or anything with ``derivative(t, y)`` and
    ``period``: of two states they are x and x'; of more each is stored by its name in the model's
    ``states`` (else y1, y2, ...), x and x' too where it has ``displacement(t, state)``.
    ``initial_state`` (x, x') for all lanes, or an array (lane, 2); for the pair (x, x') or
    (theta1, theta2, theta1', theta2'). ``samples_per_period`` (0: none) uniform samples of the
    kept periods, the first of each at phase 0. ``method``: "exact", "rk4" (with
    ``steps_per_period``, ``precision`` "float64" or "float32"), "adaptive" (``rtol``, ``atol``
    in half backlashes), or "auto", which records its reason.

    Returns a dataset over ``point`` (lane), ``section`` (start of every kept period and the end
    of the last) and ``sample``: section_x, section_v, x, v, time, status (a lane with
    |x| > 1e6 b or a non-finite state is "diverged", its later values NaN, the rest goes on),
    and, from the exact maps, contact losses, back-side impacts and time shares. Results do not
    depend on ``threads`` or on which lanes run together, to the last bit.

    Raises InputError for a non-finite start, counts out of range, an unknown method, and
    ``steps_per_period`` that is not a multiple of ``samples_per_period``.

    >>> from thermogear import TorsionalModel
    >>> model = TorsionalModel(
    ...     damping_ratio=0.05, frequency=0.7, stiffness_amplitude=0.1,
    ...     mean_force=0.1, force_amplitude=0.05,
    ... )
    >>> run = simulate(model, periods=4, discard=200)
    >>> run.x.shape
    (1, 256)
    """
    run = _Run.of(
        model,
        method,
        periods=whole("periods", periods, least=1),
        discard=whole("discard", discard, least=0),
        steps=whole("steps_per_period", steps_per_period, least=4),
        samples=whole("samples_per_period", samples_per_period, least=0),
        precision=precision,
        tolerances=(rtol, atol),
    )
    start = np.asarray(initial_state, dtype=float)
    if not np.all(np.isfinite(start)):
        raise InputError("initial_state", start.tolist(), allowed="finite numbers")
    if not isinstance(model, ClearanceModel):
        data = _free(model, start, run)
    elif isinstance(model, PairModel):
        state = four_of(start, model)
        if run.method == "adaptive":
            data = _both_rotations(model, state, run)
        else:
            x0, v0 = model.displacement(0.0, state)
            data = _batch(model.lanes(), np.array([float(x0), float(v0)]), run, threads, progress)
            data = with_angles(data, model, state)
    else:
        data = _batch(model.lanes(), start, run, threads, progress)
    _give_units(data, si=isinstance(model, PairModel))
    data.attrs.update(run.settings)
    data.attrs.update(
        {
            "method": run.method,
            "method_long_name": METHODS[run.method],
            "method_reason": run.reason,
            "model": type(model).__name__,
            "thermogear_version": __version__,
        }
    )
    return data


@dataclass(frozen=True, kw_only=True)
class _Run:
    """How a model is run: counts, the method and why it was taken, precision, tolerances.

    ``periods`` and ``discard`` count periods of the model, each ``mesh_periods``, and ``steps`` and
    ``samples`` are those of one of them.
    """

    periods: int
    discard: int
    steps: int
    samples: int
    precision: str
    tolerances: tuple[float, float]
    method: str
    reason: str
    mesh_periods: int = 1

    @classmethod
    def of(cls, model: object, method: str, **asked: Any) -> _Run:
        """What was ``asked`` for, with the method chosen; refuses what does not go together."""
        chosen, reason = _choose(model, method)
        of = int(getattr(model, "mesh_periods", 1))
        counts = {name: turns(asked[name], of=of) for name in ("periods", "discard")}
        counts |= {name: asked[name] * of for name in ("steps", "samples")}
        run = cls(method=chosen, reason=reason, mesh_periods=of, **(asked | counts))
        if chosen == "rk4" and run.samples and run.steps % run.samples:
            raise InputError(
                "samples_per_period",
                asked["samples"],
                allowed=f"a divisor of steps_per_period = {asked['steps']}",
            )
        if run.precision not in ("float64", "float32"):
            raise InputError("precision", repr(run.precision), allowed="'float64' | 'float32'")
        if run.precision == "float32" and isinstance(model, PairModel):
            raise InputError(
                "precision", repr(run.precision), allowed="'float64' for models in SI units"
            )
        return run

    @property
    def counts(self) -> dict[str, int]:
        """What every method needs."""
        return {"periods": self.periods, "discard": self.discard, "samples": self.samples}

    @property
    def settings(self) -> dict[str, object]:
        """What is stored of them."""
        of = self.mesh_periods
        found: dict[str, object] = {"discard": self.discard * of, "periods": self.periods * of}
        if self.method == "rk4":
            found |= {"steps_per_period": self.steps // of, "precision": self.precision}
        if self.method == "adaptive":
            found |= {"rtol": self.tolerances[0], "atol": self.tolerances[1]}
        return found


def _batch(
    lanes: Lanes, start: Floats, run: _Run, threads: int | None, progress: Progress | None
) -> Dataset:
    """Lanes side by side, in blocks on threads."""
    try:
        starts = np.broadcast_to(start, (len(lanes), 2))
    except ValueError:
        raise InputError(
            "initial_state", f"shape {start.shape}", allowed=f"(2,) or ({len(lanes)}, 2)"
        ) from None
    result = Result(lanes=len(lanes), periods=run.periods, samples=run.samples)
    work: list[Callable[[Pace], None]]
    if run.method == "exact":
        work = [
            partial(_exact_block, lanes, index, borders, marks, starts, run.discard, result)
            for index, borders, marks in exact.layouts(lanes, samples=run.samples)
        ]
    elif run.method == "rk4":
        firsts = range(0, len(lanes), RK4_BLOCK)
        blocks = [np.arange(n, min(n + RK4_BLOCK, len(lanes))) for n in firsts]
        work = [partial(_rk4_block, lanes, index, run, starts, result) for index in blocks]
    else:
        work = [
            partial(_adaptive_lane, lanes, lane, run, starts, result) for lane in range(len(lanes))
        ]
    run_blocks(work, len(lanes) * (run.periods + run.discard), threads=threads, progress=progress)
    return dataset(result, period=lanes.period, **run.counts, mesh_periods=run.mesh_periods)


def _give_units(data: Dataset, *, si: bool) -> None:
    """Units of displacement, velocity and time: SI or pure numbers."""
    for name, unit in (("x", "m"), ("v", "m/s"), ("time", "s")):
        for variable in {name, f"section_{name}"} & data.variables.keys():
            data[variable].attrs["units"] = unit if si else "1"


def _free(model: object, start: Floats, run: _Run) -> Dataset:
    """Any model with ``derivative`` and ``period``: x, x' of two states, else each by its name.

    The names are the model's ``states``, or y1, y2, ...; x and x' of more than two states come from
    the model's ``displacement(t, state)``, where it has one.
    """
    derivative = getattr(model, "derivative", None)
    period = getattr(model, "period", None)
    if derivative is None or period is None:
        raise InputError("model", type(model).__name__, allowed="derivative(t, y) and period")
    if start.ndim != 1:
        raise InputError("initial_state", f"shape {start.shape}", allowed="one state")
    relative = getattr(model, "displacement", None) if start.size != 2 else _first_two
    backlash = getattr(model, "half_backlash", None)
    gap = None
    if backlash is not None and relative is not None:
        gap = adaptive.Gap(
            lambda t, y: float(relative(t, y)[0]), lambda t, y: float(relative(t, y)[1]),
            float(backlash),
        )  # fmt: skip
    sections, path, _ = adaptive.follow(
        lambda t, y, _region: np.asarray(derivative(t, y), dtype=float),
        gap,
        float(period),
        start,
        periods=run.discard + run.periods,
        samples=run.samples,
        rtol=run.tolerances[0],
        atol=run.tolerances[1],
    )
    sections, path = sections[run.discard :], path[run.discard * run.samples :]
    result = Result(lanes=1, periods=run.periods, samples=run.samples)
    if relative is not None:
        within = np.tile(np.arange(run.samples) / max(run.samples, 1), run.periods)
        result.samples[0] = np.stack(relative(within * float(period), path.T))
        result.sections[0] = np.stack(relative(np.zeros(run.periods + 1), sections.T))
    data = dataset(
        result, period=np.array([float(period)]), **run.counts, mesh_periods=run.mesh_periods
    )
    if start.size == 2:
        return data
    data = _with_states(data, model, sections=sections, path=path)
    return data if relative is not None else data.drop_vars(["x", "v", "section_x", "section_v"])


def _both_rotations(model: PairModel, start: Floats, run: _Run) -> Dataset:
    """Two gears integrated as they are: four states, the tolerance that of their rotations."""
    rtol, atol = run.tolerances
    scaled = atol * model.half_backlash / max(model.base_radii)
    data = _free(model, start, replace(run, tolerances=(rtol, scaled)))
    for name in model.states:
        for part in ("", "section_"):
            data[part + name].attrs = angle_attributes(name)
    return data


def _with_states(data: Dataset, model: object, *, sections: Floats, path: Floats) -> Dataset:
    """``data`` with each state of ``model`` by its name: (point, sample) and (point, section)."""
    count = sections.shape[-1]
    names = [str(name) for name in getattr(model, "states", ())]
    if len(names) != count:
        names = [f"y{place + 1}" for place in range(count)]
    for place, name in enumerate(names):
        words = {"long_name": f"state {name} of the model"}
        data[name] = (("point", "sample"), path[None, :, place], words)
        data[f"section_{name}"] = (("point", "section"), sections[None, :, place], words)
    good = bool(np.isfinite(sections).all())
    data["status"] = ("point", np.array([0 if good else DIVERGED], np.int8), data["status"].attrs)
    return data


def _first_two(_t: ArrayLike, y: Floats) -> tuple[Floats, Floats]:
    return y[0], y[1]
