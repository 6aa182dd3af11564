"""The branches behind an orbit diagram: every short orbit it shows, continued over its range."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.bifurcations import (
    BIRTH,
    FLIP,
    FOLD,
    GRAZING,
    PITCHFORK,
    TORUS,
    Bifurcation,
)
from thermogear.analysis.continuation import GAP, Branch, continuation
from thermogear.analysis.family import Family, dimension_of, lanes_and_status, model_at
from thermogear.analysis.orbits import Orbit, shoot
from thermogear.analysis.settle import PERIODIC
from thermogear.base.arrays import Dataset, Floats
from thermogear.base.errors import ConvergenceError
from thermogear.dynamics.lanes import Lanes
from thermogear.dynamics.plane import plane_of
from thermogear.dynamics.return_map import return_map

KINDS = (FOLD, FLIP, GRAZING, BIRTH, PITCHFORK, TORUS)
"""Meaning of the codes 0, 1, ... of ``bifurcation_kind``."""
MOST_BRANCHES = 24
MOST_POINTS = 600
JUMP = 0.2  # half backlashes
NEAR = 0.5


@dataclass(frozen=True)
class _Line:
    """Both arms of a branch as one line."""

    period: int
    values: Floats
    states: Floats
    multipliers: NDArray[np.complex128]
    bifurcations: tuple[Bifurcation, ...]
    cut: tuple[str, ...]
    """Why an arm ends although the branch goes on."""


def with_branches(data: Dataset, family: Family, parameter: str, most_period: int) -> Dataset:
    """Add the branches of all periodic motions of up to ``most_period`` periods to a diagram."""
    lines: list[_Line] = []
    lost: list[str] = []
    for period, value, state in _seeds(data, family, parameter, most_period):
        if len(lines) >= MOST_BRANCHES:
            lost.append(f"more than {MOST_BRANCHES} branches: the rest is not followed")
            break
        orbit = shoot(return_map(model_at(family, value)), state, period)
        if orbit is None or any(_on(line, orbit, value, family) for line in lines):
            continue
        try:
            lines.append(_line(orbit, value, family, parameter, data[parameter].values))
            lost += [f"branch of period {period} from {value:.6g}: {w}" for w in lines[-1].cut]
        except ConvergenceError as error:
            lost.append(str(error))
    data.attrs["branch_notes"] = "; ".join(lost)
    return _stored(data, lines, family)


def with_branches_of_states(data: Dataset, found: Mapping[int, Dataset], units: str) -> Dataset:
    """Add the branches of several diagrams to one, by the ``state`` each was found in.

    ``found`` of :func:`with_branches`, its parameter in ``units``; ``branch_state`` and
    ``bifurcation_state`` tell whose each is.
    """
    if not found:
        return data
    parts = [
        part.assign({
            f"{name}_state": ((name,), np.full(part.sizes.get(name, 0), state, np.int32))
            for name in ("branch", "bifurcation")
        })
        for state, part in found.items()
    ]  # fmt: skip
    longest = max(part.sizes.get("branch_point", 1) for part in parts)
    for name, first in parts[0].data_vars.items():
        if str(name).startswith(("branch_", "bifurcation_")):
            rows = [part[name].values for part in parts]
            if "branch_point" in first.dims:
                rows = [
                    np.pad(row, ((0, 0), (0, longest - row.shape[1])), constant_values=np.nan)
                    for row in rows
                ]
            data[str(name)] = (first.dims, np.concatenate(rows), first.attrs)
    for name in ("branch_value", "bifurcation_value"):
        data[name].attrs["units"] = units
    notes = [str(part.attrs.get("branch_notes", "")) for part in parts]
    data.attrs["branch_notes"] = "; ".join(n for n in notes if n)
    return data


def _seeds(
    data: Dataset, family: Family, parameter: str, most_period: int
) -> Iterator[tuple[int, float, Floats]]:
    """One orbit out of every stretch of a sweep on which period and place run on."""
    values = data[parameter].values
    longer = dimension_of(family) != 2
    unit = np.ones((values.size, 2))
    if not longer:
        lanes, _ = lanes_and_status(family, values[:, None])
        unit = (
            lanes.unit
            if isinstance(lanes, Lanes)
            else np.array([m.unit for m in map(return_map, lanes)])
        )
    for n in range(1, most_period + 1):
        for direction in range(data.sizes["direction"]):
            for start in range(data.sizes["start"]):
                here = data.isel(direction=direction, start=start)
                mine = (here["label"].values == PERIODIC) & (here["period"].values == n)
                state = np.stack([here["section_x"].values, here["section_v"].values], axis=-1)
                last = here["end"].values if longer else state[:, -1]
                run: list[int] = []
                for i in range(values.size + 1):
                    joined = i < values.size and bool(mine[i])
                    if joined and run:
                        # the same orbit may be stored from another of its points on
                        gaps = np.max(np.abs(state[run[-1], -n:] - state[i, -1]) / unit[i], axis=1)
                        joined = bool(gaps.min() < JUMP)
                    if run and not joined:
                        middle = run[len(run) // 2]
                        yield n, float(values[middle]), last[middle]
                        run = []
                    if i < values.size and bool(mine[i]):
                        run.append(i)


def _on(line: _Line, orbit: Orbit, value: float, family: Family) -> bool:
    """Whether ``orbit`` at ``value`` lies on the line: Newton from it leads there."""
    if line.period != orbit.period:
        return False
    section = return_map(model_at(family, value))
    below, above = line.values[:-1], line.values[1:]
    for i in np.flatnonzero((below - value) * (above - value) <= 0.0):
        span = above[i] - below[i]
        weight = 0.0 if span == 0.0 else (value - below[i]) / span
        guess = line.states[i] + weight * (line.states[i + 1] - line.states[i])
        if float(section.distance(orbit.points, guess).min()) > NEAR:
            continue
        found = shoot(section, guess, orbit.period)
        if found is not None and float(section.distance(orbit.points, found.state).min()) < 1e-6:
            return True
    return False


def _line(orbit: Orbit, value: float, family: Family, parameter: str, values: Floats) -> _Line:
    """Both arms from ``value`` to the ends of the range."""

    def single(at: float) -> object:
        return model_at(family, at)

    arms = [
        continuation(orbit, parameter, end, family=single, start=value, most_points=MOST_POINTS)
        for end in (float(values[0]), float(values[-1]))
        if end != value
    ]
    if len(arms) == 1:
        only = arms[0]
        return _Line(
            orbit.period,
            only.values,
            only.states,
            only.multipliers,
            only.bifurcations,
            _cut(only),
        )
    low, high = arms
    return _Line(
        orbit.period,
        np.concatenate([low.values[::-1], high.values[1:]]),
        np.concatenate([low.states[::-1], high.states[1:]]),
        np.concatenate([low.multipliers[::-1], high.multipliers[1:]]),
        tuple(reversed(low.bifurcations)) + high.bifurcations,
        _cut(low) + _cut(high),
    )


def _cut(arm: Branch) -> tuple[str, ...]:
    return (arm.ended,) if arm.ended.startswith((GAP, str(MOST_POINTS))) else ()


def _stored(data: Dataset, lines: list[_Line], family: Family) -> Dataset:
    longest = max([1, *(line.values.size for line in lines)])
    shape = (len(lines), longest)
    value, x, v = (np.full(shape, np.nan) for _ in range(3))
    size = np.full(shape, np.nan)
    for n, line in enumerate(lines):
        count = line.values.size
        value[n, :count] = line.values
        x[n, :count], v[n, :count] = _shown(line.states, line.values, family).T
        size[n, :count] = np.max(np.abs(line.multipliers), axis=1)
    dims = ("branch", "branch_point")
    words = {"units": "1"}
    data["branch_value"] = (dims, value, words | {"long_name": "parameter along the branch"})
    data["branch_x"] = (dims, x, words | {"long_name": "displacement at phase 0"})
    data["branch_v"] = (dims, v, words | {"long_name": "velocity at phase 0"})
    data["branch_multiplier"] = (
        dims,
        size,
        words | {"long_name": "modulus of the largest Floquet multiplier; stable below 1"},
    )
    data["branch_period"] = (
        ("branch",),
        np.array([line.period for line in lines], np.int32),
        words | {"long_name": "mesh periods of the orbit"},
    )
    return _with_bifurcations(data, lines, family)


def _shown(states: Floats, values: Floats, family: Family) -> Floats:
    """(x, v) (point, 2) of ``states`` (point, d), each at its value of the parameter."""
    if dimension_of(family) == 2 or not len(states):
        return states.reshape(-1, 2)
    pairs = zip(states, values, strict=True)
    return np.array([plane_of(model_at(family, float(at))).of(one) for one, at in pairs])


def _with_bifurcations(data: Dataset, lines: list[_Line], family: Family) -> Dataset:
    """The bifurcations of all branches, each once, in order of the parameter."""
    rows: list[tuple[float, Bifurcation, int]] = []
    for n, line in enumerate(lines):
        for one in line.bifurcations:
            scale = max(abs(one.value), 1e-3)
            if not any(
                other.kind == one.kind
                and other.period == one.period
                and abs(value - one.value) < 1e-7 * scale
                for value, other, _ in rows
            ):
                rows.append((one.value, one, n))
    rows.sort(key=lambda row: (row[0], row[1].kind, row[1].period))
    dims = ("bifurcation",)
    found = [row[1] for row in rows]
    data["bifurcation_value"] = (
        dims, np.array([row[0] for row in rows], float),
        {"long_name": "parameter at the bifurcation", "units": "1"},
    )  # fmt: skip
    data["bifurcation_kind"] = (
        dims,
        np.array([KINDS.index(b.kind) for b in found], np.int8),
        {
            "long_name": "kind of bifurcation",
            "flag_values": np.arange(len(KINDS), dtype=np.int8),
            "flag_meanings": " ".join(kind.replace(" ", "_") for kind in KINDS),
        },
    )
    data.attrs["bifurcation_notes"] = json.dumps([b.note for b in found])
    data["bifurcation_period"] = (dims, np.array([b.period for b in found], np.int32))
    data["bifurcation_branch"] = (dims, np.array([row[2] for row in rows], np.int32))
    state = np.array([b.state for b in found], float).reshape(-1, dimension_of(family))
    state = _shown(state, np.array([b.value for b in found]), family)
    data["bifurcation_x"] = (dims, state[:, 0], {"units": "1"})
    data["bifurcation_v"] = (dims, state[:, 1], {"units": "1"})
    return data
