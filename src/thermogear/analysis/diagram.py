"""Orbit diagrams: the settled motion over a parameter, up and down, from several starts.

Every value starts from the state in which the value before it ended, whatever the chunks; the
branches behind the picture, unstable parts included, come from continuation.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.analysis.branches import with_branches
from thermogear.analysis.family import (
    Family,
    axis_values,
    dimension_of,
    family_for,
    lanes_and_status,
    taken,
    watched_arrays,
    watched_axes,
    watched_variables,
)
from thermogear.analysis.outcome import (
    begun,
    drawn,
    outcome_arrays,
    outcome_variables,
    require_free,
    settle_with_status,
)
from thermogear.analysis.settle import Rule
from thermogear.base.arrays import Dataset
from thermogear.base.errors import InputError
from thermogear.base.plan import (
    Alive,
    Arrays,
    Key,
    Progress,
    Variable,
    before_along,
    empty_arrays,
    every,
    gather,
    keep_going,
    ranges_of,
    stretches,
)

DIRECTIONS = (1, -1)
"""Up and down."""
DIAGRAM_RULE = Rule(first=128, cap=8192, settled=1e-6, chaos_periods=1000)
BLOCK = 32
BRANCHES = 900
"""Values whose settling takes as long as all branches, about: measured on gears and numbers."""
KEEP = 64
BRANCH_PERIOD = 4
"""Branches are followed for orbits of up to so many periods."""


@dataclass(frozen=True, kw_only=True)
class DiagramPlan:
    """An orbit diagram; see :func:`orbit_diagram`."""

    family: Family
    values: tuple[float, ...]
    starts: tuple[tuple[float, ...], ...] = ((0.0, 0.0),)
    rule: Rule = DIAGRAM_RULE
    keep: int = KEEP
    block: int = BLOCK
    branch_period: int = BRANCH_PERIOD
    kind: str = "diagram"

    def __post_init__(self) -> None:
        if len(self.family.names) != 1:
            raise InputError("parameter", list(self.family.names), allowed="one parameter")
        require_free(self.family.names, self.variables())
        for name, least in (("keep", 1), ("block", 1), ("branch_period", 0)):
            if getattr(self, name) < least:
                raise InputError(name, getattr(self, name), allowed=f">= {least}")

    @property
    def parameter(self) -> str:
        return self.family.names[0]

    @property
    def dimension(self) -> int:
        return dimension_of(self.family)

    @property
    def sizes(self) -> dict[str, int]:
        longer = {} if self.dimension == 2 else {"coordinate": self.dimension}
        return {
            "direction": len(DIRECTIONS),
            "start": len(self.starts),
            self.parameter: len(self.values),
            "section": self.keep,
            **longer,
            **{n: len(np.asarray(v)) for n, (_, v, _) in watched_axes(self.family).items()},
        }

    @property
    def cuts(self) -> dict[str, int]:
        return {"direction": 1, self.parameter: min(self.block, len(self.values))}

    def inputs(self) -> dict[str, Any]:
        return {
            "model": self.family.inputs(),
            "parameter": self.parameter,
            "values": list(self.values),
            "starts": [list(s) for s in self.starts],
            "rule": asdict(self.rule),
            "keep": self.keep,
            "block": self.block,
            "branch_period": self.branch_period,
        }

    def variables(self) -> dict[str, Variable]:
        dims = ("direction", "start", self.parameter)
        nan = float("nan")
        found = outcome_variables(dims)
        for name, words in (("x", "displacement"), ("v", "velocity")):
            found[f"section_{name}"] = Variable(
                (*dims, "section"),
                "float64",
                nan,
                {"long_name": f"Poincare section: {words}", "units": "1"},
            )
            found[f"end_{name}"] = Variable(
                dims, "float64", nan, {"long_name": f"{words} carried on", "units": "1"}
            )
        if self.dimension != 2:
            words = "state carried on, in the model's units"
            found["end"] = Variable((*dims, "coordinate"), "float64", nan, {"long_name": words})
        return found | watched_variables(self.family, dims)

    def coordinates(self) -> dict[str, tuple[tuple[str, ...], ArrayLike, dict[str, Any]]]:
        name, unit = self.parameter, self.family.units[0]
        return {
            "direction": (
                ("direction",),
                np.array(DIRECTIONS, np.int8),
                {"long_name": "direction of the sweep: 1 up, -1 down"},
            ),
            "start_x": (("start",), np.array([s[0] for s in self.starts]), {"units": "1"}),
            "start_v": (
                ("start",),
                np.array([(*s, np.nan)[1] for s in self.starts]),
                {"units": "1"},
            ),
            name: ((name,), np.array(self.values), {"units": unit}),
            **watched_axes(self.family),
        }

    def needs(self, key: Key) -> Key | None:
        return before_along(self, key, self.parameter)

    def pilot(self, share: float, *, turn: int) -> float:
        """Settle about a ``share`` of the values, in fours of neighbours; what share it was.

        The branches count as :data:`BRANCHES` values.
        """
        whole = 2 * len(self.values) + BRANCHES * (self.branch_period > 0)
        chosen = stretches(self.values, count=round(share * whole), turn=turn)
        small = replace(self, values=chosen, block=len(chosen), branch_period=0)
        small.compute((turn % len(DIRECTIONS), 0), None, keep_going)
        return len(chosen) / whole

    def thinned(self, step: int) -> tuple[DiagramPlan, Mapping[str, NDArray[np.int64]]]:
        """The diagram of every ``step``-th value, in one chunk a direction."""
        some = every(len(self.values), step=step)
        values = tuple(self.values[i] for i in some)
        whole = np.arange(len(DIRECTIONS))
        thin = replace(self, values=values, block=len(values), branch_period=0)
        return thin, {"direction": whole, self.parameter: some}

    def compute(self, key: Key, before: Arrays | None, alive: Alive) -> Arrays:
        up = key[0] == 0
        values = np.array(self.values)[ranges_of(self, key)[self.parameter]]
        order = np.arange(values.size) if up else np.arange(values.size)[::-1]
        state = np.array(self.starts)
        if before is not None:
            last = -1 if up else 0
            state = (
                before["end"][0, :, last]
                if self.dimension != 2
                else np.stack([before[f"end_{n}"][0, :, last] for n in "xv"], axis=1)
            )
        count = len(self.starts)
        found = empty_arrays(self, key)
        lanes, status = lanes_and_status(self.family, values[:, None])
        for place in order:
            same = np.full(count, place)
            here = taken(lanes, same)
            state = begun(state, here, self.dimension)
            settled = settle_with_status(here, status[same], state, self.rule, self.keep, alive)
            for name, row in outcome_arrays(settled, status[same], here).items():
                found[name][0, :, place] = row
            at = np.full((count, 1), values[place])
            for name, row in watched_arrays(self.family, at, settled).items():
                found[name][0, :, place] = row
            sections = drawn(settled.sections, here)
            for axis, name in enumerate("xv"):
                found[f"section_{name}"][0, :, place] = sections[:, :, axis]
            # a motion that left for infinity hands on the state it began with
            whole = np.asarray(np.isfinite(settled.state).all(axis=1))
            state = np.where(whole[:, None], settled.state, state)
            found["end_x"][0, :, place], found["end_v"][0, :, place] = drawn(state, here).T
            if self.dimension != 2:
                found["end"][0, :, place] = state
        return found

    def finish(self, data: Dataset) -> Dataset:
        data.attrs |= {
            "parameter": self.parameter,
            "total_periods": int(data["used_periods"].sum()),
        }
        data["back_side_matters"] = (
            (self.parameter,),
            np.asarray((data["back_impacts"].values > 0).any(axis=(0, 1)), np.int8),
            {"long_name": "1: an orbit hits the back side, so the half backlash has an effect"},
        )
        if self.branch_period > 0 and len(self.values) > 1:
            return with_branches(data, self.family, self.parameter, self.branch_period)
        return data


def orbit_diagram(
    model: object,
    parameter: str,
    values: ArrayLike,
    *,
    starts: ArrayLike | Sequence[tuple[float, float]] = ((0.0, 0.0),),
    rule: Rule = DIAGRAM_RULE,
    keep: int = KEEP,
    block: int = BLOCK,
    branch_period: int = BRANCH_PERIOD,
    threads: int | None = None,
    progress: Progress | None = None,
    alive: Alive = keep_going,
) -> Dataset:
    """The settled motion over ``values`` of a ``parameter``, up and down, from every start.

    ``model`` has one lane, or a return map of any dimension, and a number field ``parameter``, or
    is a family of it. At the first value of a direction the ``starts`` are taken: (x, x') in the
    units of the model, of longer states in their plane
    (:func:`~thermogear.dynamics.plane.plane_of`), or whole states; from then
    on the state in which the last value ended; chunks of ``block`` values hand it on, so they
    change nothing. ``keep`` sections are stored of each point (on the orbit itself where it is
    periodic), with label, period, largest multiplier and Lyapunov exponent. Orbits of up to
    ``branch_period`` periods (0: none) are continued through the whole range, stable and
    unstable: ``branch_...`` over (branch, branch_point), and the bifurcations located on them,
    ``bifurcation_...``. ``alive`` is called between rounds and raises to end the work.

    >>> model = TorsionalModel(
    ...     damping_ratio=0.05, frequency=0.5, stiffness_amplitude=0.0,
    ...     mean_force=0.1, force_amplitude=0.05,
    ... )
    >>> diagram = orbit_diagram(model, "frequency", [0.40, 0.41])
    >>> diagram.period.values.ravel().tolist()
    [1, 1, 1, 1]
    """
    return gather(
        diagram_plan(
            model,
            parameter,
            values,
            starts=starts,
            rule=rule,
            keep=keep,
            block=block,
            branch_period=branch_period,
        ),
        threads=threads,
        progress=progress,
        alive=alive,
    )


def diagram_plan(
    model: object,
    parameter: str,
    values: ArrayLike,
    *,
    starts: ArrayLike | Sequence[tuple[float, float]] = ((0.0, 0.0),),
    rule: Rule = DIAGRAM_RULE,
    keep: int = KEEP,
    block: int = BLOCK,
    branch_period: int = BRANCH_PERIOD,
) -> DiagramPlan:
    """The plan of :func:`orbit_diagram`."""
    axis = np.sort(axis_values(parameter, values))
    begin = np.atleast_2d(np.asarray(starts, dtype=float))
    family = family_for(model, (parameter,))
    if begin.shape[1] not in (2, dimension_of(family)) or not np.all(np.isfinite(begin)):
        raise InputError("starts", f"shape {begin.shape}", allowed="finite pairs (x, x')")
    return DiagramPlan(
        family=family,
        values=tuple(axis.tolist()),
        starts=tuple(map(tuple, begin.tolist())),
        rule=rule,
        keep=keep,
        block=block,
        branch_period=branch_period,
    )
