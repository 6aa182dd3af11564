"""Diagrams, maps and basins of a case: its words become plans, two states become one table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from thermogear.analysis.basins import BasinPlan, basin_plan
from thermogear.analysis.branches import KINDS
from thermogear.analysis.diagram import BRANCH_PERIOD, DiagramPlan, diagram_plan
from thermogear.analysis.family import Family, ModelFamily
from thermogear.analysis.maps import MapPlan, map_plan
from thermogear.base.errors import InputError, nearest
from thermogear.base.excitation import Periodic
from thermogear.case.allowed import dimensionless_reader, read_value, require_numbers
from thermogear.case.case import Case, DimensionlessCase, GearCase
from thermogear.case.family import GearFamily, GearPoints, Tabulated, read_word, word
from thermogear.case.schema import PARAMETERS, DimensionlessFile
from thermogear.case.source import overridden, tables
from thermogear.dynamics.models import DeadZoneModel, TorsionalModel

Floats = NDArray[np.float64]

SHORT = {
    "zeta": "damping_ratio",
    "omega": "frequency",
    "omega_h": "frequency",
    "epsilon": "stiffness_amplitude",
    "eps": "stiffness_amplitude",
    "F_m": "mean_force",
    "F_h": "force_amplitude",
    "b": "half_backlash",
    "b_prime": "half_backlash",
    "eps_T": "thermal_stiffness",
    "epsilon_T": "thermal_stiffness",
}
"""Names a command line may use for the dimensionless numbers."""


def base_model(
    case: DimensionlessCase, changes: Mapping[str, float] | None = None
) -> TorsionalModel:
    """The base set of a dimensionless case, with some numbers changed."""
    read = DimensionlessFile.model_validate(overridden(tables("case", case.text), case.overrides))
    values: dict[str, float] = {}
    for name in PARAMETERS:
        given = getattr(read.base, name)
        if len(given) != 1 and name not in (changes or {}):
            raise InputError(
                f"base.{name}",
                f"{len(given)} entries",
                allowed="one",
                why="a base set is one point",
            )
        values[name] = float(given[0])
    values |= changes or {}
    require_numbers(values)
    return TorsionalModel(**values)


def dimensionless_name(name: str) -> str:
    """The full name of a dimensionless number."""
    full = SHORT.get(name, name)
    if full not in PARAMETERS:
        raise InputError("parameter", repr(name), fix=nearest(name, [*PARAMETERS, *SHORT]))
    return full


def parse_axis(case: Case, text: str) -> tuple[str, Floats]:
    """NAME=FROM:TO:COUNT or NAME=A,B,C in the units a person writes, as name and SI values.

    Gear values carry their unit as in a case file (``20 mm:30 mm:3``); those that have a name of
    their own may leave it out.
    """
    name, sign, rest = text.partition("=")
    gears = isinstance(case, GearCase)
    example = "rpm=200:12000:120" if gears else "zeta=0.10:0.18:200"
    parts = rest.split(":") if ":" in rest else rest.split(",")
    number = parts.pop() if ":" in rest else ""
    # nine digits count more points than any machine computes
    counted = len(parts) == 2 and number.isdecimal() and len(number) < 9 and int(number) > 0
    if not sign or (":" in rest and not counted):
        raise InputError(
            "over", repr(text), allowed="NAME=FROM:TO:COUNT or NAME=A,B,C", fix=f"as {example}"
        )
    if gears:
        full = word(name)
        ends = [read_word(full, part) for part in parts]
    else:
        full = dimensionless_name(name)
        ends = [read_value(full, dimensionless_reader(full), part) for part in parts]
    return full, np.linspace(ends[0], ends[1], int(number)) if counted else np.array(ends)


def parse_axes(case: Case, texts: Sequence[str]) -> dict[str, Floats]:
    """Every axis of the command line, as :func:`parse_axis`; each parameter once."""
    found: dict[str, Floats] = {}
    for text in texts:
        name, values = parse_axis(case, text)
        if name in found:
            raise InputError("over", f"{name} twice", allowed="each parameter once")
        found[name] = values
    return found


def family_of_case(
    case: Case,
    axes: Mapping[str, Floats],
    *,
    bundle: str = "",
    state: str | float = "hot",
    changes: Mapping[str, float] | None = None,
) -> Family:
    """The family of models behind a case of either kind, over ``axes`` that it can have."""
    names = tuple(axes)
    if isinstance(case, GearCase):
        gears = GearFamily(case, names, bundle, state)
        gears.require(axes)
        return gears
    if isinstance(case, DimensionlessCase):
        model = base_model(case, changes)
        require_numbers({n: getattr(model, n) for n in PARAMETERS} | dict(axes))
        return ModelFamily(model, names)
    raise InputError("case", type(case).__name__, allowed="GearCase or DimensionlessCase")


def case_diagram(
    case: Case,
    name: str,
    values: Floats,
    *,
    bundle: str = "",
    state: str | float = "hot",
    changes: Mapping[str, float] | None = None,
    branch_period: int = BRANCH_PERIOD,
    starts: tuple[tuple[float, float], ...] = (),
) -> DiagramPlan:
    """The orbit diagram of a case over one parameter.

    Over a gear parameter the tables are computed at ``values`` and run straight between them,
    which is where bifurcations are located.
    """
    family = family_of_case(case, {name: values}, bundle=bundle, state=state, changes=changes)
    axis = np.sort(values)
    if isinstance(family, GearFamily) and axis.size > 1:
        family = Tabulated.of(family, axis)
    begin = starts or (case.simulation.initial_state,)
    return diagram_plan(family, name, axis, starts=begin, branch_period=branch_period)


def case_map(
    case: Case,
    axes: Mapping[str, Floats],
    *,
    bundle: str = "",
    state: str | float = "hot",
    changes: Mapping[str, float] | None = None,
    refine: bool = True,
) -> MapPlan:
    """The map of regimes of a case over two parameters."""
    family = family_of_case(case, axes, bundle=bundle, state=state, changes=changes)
    return map_plan(family, axes, initial_state=case.simulation.initial_state, refine=refine)


def case_basins(
    case: Case,
    *,
    x: Floats,
    v: Floats,
    bundle: str = "",
    state: str | float = "hot",
    changes: Mapping[str, float] | None = None,
) -> BasinPlan:
    """The basins of a case at its base set, or at its first speed and torque."""
    if isinstance(case, GearCase):
        points = GearFamily(case, ("pinion_speed",), bundle, state)(np.array([[case.speeds[0]]]))
        if points.status[0] != 0:
            raise InputError("case", "jammed", why="a jammed pair has no motion")
        return basin_plan(gear_point_model(points), x=x, v=v)
    if isinstance(case, DimensionlessCase):
        return basin_plan(base_model(case, changes), x=x, v=v)
    raise InputError("case", type(case).__name__, allowed="GearCase or DimensionlessCase")


def gear_point_model(points: GearPoints) -> DeadZoneModel:
    """The dimensionless model of the first of ``points``."""
    lane = points.flat
    stiffness, force = lane.stiffness[0], lane.force[0]
    return DeadZoneModel(
        damping_ratio=0.5 * float(lane.damping[0]),
        frequency=2.0 * np.pi / float(lane.period[0]),
        stiffness=Periodic(float(stiffness[0].real), tuple(stiffness[1:])),
        force=Periodic(float(force[0].real), tuple(force[1:])),
        half_backlash=float(lane.half_backlash[0]),
    )


def _nearest_pairs(
    first: list[float], second: list[float]
) -> list[tuple[float | None, float | None]]:
    """Both lists paired with the least total distance, in ascending order; the rest alone."""
    distance = np.abs(np.subtract.outer(first, second))
    rows, columns = linear_sum_assignment(distance)
    found: list[tuple[float | None, float | None]] = [
        (first[i], second[j]) for i, j in zip(rows, columns, strict=True)
    ]
    found += [(value, None) for i, value in enumerate(first) if i not in rows]
    found += [(None, value) for j, value in enumerate(second) if j not in columns]
    return sorted(found, key=lambda pair: next(v for v in pair if v is not None))


def moved_points(one: xr.Dataset, other: xr.Dataset) -> list[dict[str, Any]]:
    """Bifurcations of two diagrams side by side: kind, period, both values, what moved.

    Within each kind and period the pairs are those that move the least in all; one that the
    other diagram lacks has None there.
    """

    def sorted_values(data: xr.Dataset, kind: int, period: int) -> list[float]:
        chosen = (data["bifurcation_kind"].values == kind) & (
            data["bifurcation_period"].values == period
        )
        return sorted(map(float, data["bifurcation_value"].values[chosen]))

    pairs = {
        (int(k), int(n))
        for data in (one, other)
        for k, n in zip(
            data["bifurcation_kind"].values, data["bifurcation_period"].values, strict=True
        )
    }
    rows: list[dict[str, Any]] = []
    for kind, period in sorted(pairs, key=lambda p: (p[1], p[0])):
        first, second = sorted_values(one, kind, period), sorted_values(other, kind, period)
        for a, b in _nearest_pairs(first, second):
            rows.append(
                {
                    "kind": KINDS[kind],
                    "period": period,
                    "one": a,
                    "other": b,
                    "moved": None if a is None or b is None else b - a,
                }
            )
    return rows
