"""What one looks at while turning a dial: small datasets of one operating point, at once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import ThermogearError
from thermogear.base.plan import Alive, Arrays, every, keep_going, region_of, slices
from thermogear.base.vocabulary import STATES, STATUS, attributes, label
from thermogear.case.case import GearCase
from thermogear.case.dials import drawing, parts_of
from thermogear.case.family import GearFamily
from thermogear.case.one_point import OnePoint, of_case
from thermogear.case.points import excitations
from thermogear.case.thermal_state import HOT, StateLike, ThermalState
from thermogear.dynamics.integrate import simulate
from thermogear.mesh.excite import EXCITES
from thermogear.mesh.thermal import HotPair
from thermogear.study.dial import stops
from thermogear.study.orbit import settled, told_orbit
from thermogear.study.run_up import RunUpPlan, run_up_plan
from thermogear.study.series import BAND, Series, Spread, series_motion

if TYPE_CHECKING:
    import xarray as xr

    from thermogear.results.result import Result


MESH = ("mesh_stiffness", "mean_stiffness", "half_backlash", "jam_temperature",
        "proportional_jam_temperature")  # fmt: skip
CLOUD, SAMPLES, SHOWN = 400, 64, 6
"""Mesh periods of the section of a motion that does not close, samples a period, periods drawn."""
COARSE = 8
"""Every so many-th speed of a run-up is looked at first."""
FIRST, HEATED, BLOCK = 2, 8, 24
"""Speeds computed together: at first, where a heat balance is solved for them, and then."""


def mesh(case: GearCase, alive: Alive = keep_going) -> xr.Dataset:
    """Mesh stiffness over a mesh period and the half backlash, undeformed and hot.

    Of the first operating point under the first model: ``mesh_stiffness`` (state, mesh_phase),
    its mean, the half backlash and both jam temperatures (state); SI. ``status`` of each state.
    """
    found: list[dict[str, NDArray[Any]]] = [
        GearFamily(case, (), "", ThermalState.of(state), alive).quasi_static(np.empty((1, 0)), MESH)
        for state in STATES
    ]
    variables: dict[str, Any] = {
        name: (
            ("state", "mesh_phase")[: found[0][name].ndim],
            np.concatenate([f[name] for f in found]),
        )
        for name in (*MESH, "status")
    }
    positions = found[0]["mesh_stiffness"].shape[-1]
    phase = np.arange(positions) * case.period.mesh_periods / positions
    data = label(variables, {"mesh_phase": phase})
    return data.assign_coords(state=list(STATES)).assign_attrs(_at(case))


def gap(case: GearCase, alive: Alive = keep_going) -> xr.Dataset | None:
    """Half backlash over the temperature of both gears, from drawn to past the jam.

    ``half_backlash`` (gear_temperature) [m], the others as ``temperatures.follow`` says; None where
    the heat of the operating point did not settle. ``jam_temperature`` is that of the gears alone.
    """
    model = case.models[0]
    if not HOT.settled(case, model):
        return None
    hot = float(np.ravel(case.operating_of(model).temperatures.pinion_addendum)[0])
    points = GearFamily(case, ("gear_temperature",), alive=alive)
    here = GearFamily(case, (), alive=alive).quasi_static(np.empty((1, 0)), ("jam_temperature",))
    jam = float(here["jam_temperature"][0])
    temperatures = stops(reference=case.stated.temperatures.reference, hot=hot, jam=jam)
    found = points.quasi_static(temperatures[:, None], ("half_backlash",))
    by = ("gear_temperature",)
    data = label({"half_backlash": (by, found["half_backlash"]), "status": (by, found["status"])})
    data = data.assign_coords(gear_temperature=temperatures)
    data["gear_temperature"].attrs = attributes("gear_temperature")
    return data.assign_attrs(_at(case), jam_temperature=jam, hot_temperature=hot)


def _at(case: GearCase) -> dict[str, float]:
    return {"pinion_speed": float(case.speeds[0]), "pinion_torque": float(case.torques[0])}


@dataclass(frozen=True, eq=False)
class Motion:
    """A settled motion: ``data`` to draw, ``words`` of its label with its proof.

    ``orbit`` is the result that ``thermogear orbit`` prints, None where no orbit closes.
    """

    data: xr.Dataset
    words: str
    orbit: Result | None = None


def point_of(case: GearCase, start: tuple[float, float] | None = None) -> OnePoint:
    """The first operating point of ``case``, hot, its motion begun at ``start`` (X, X')."""
    return of_case(case, operating=1, start=start)


def motion(point: OnePoint) -> Motion:
    """What the motion of ``point`` settles on: one closed orbit, or the cloud of its section.

    ``data`` is that of :func:`~thermogear.study.orbit.orbit_results`; of a motion that does not
    close: ``displacement`` and ``velocity`` (sample) of some mesh periods and the section of many.
    """
    proof = settled(point)
    words = f"{proof}: {proof.reason}" if proof.reason else str(proof)
    if proof.orbit is not None:
        result = told_orbit(point, proof.orbit, proof)
        data = result.group("orbit")
        assert data is not None
        return Motion(data, words, result)
    points = point.points
    data = simulate(
        points, periods=CLOUD, discard=max(point.simulation.discard, 200),
        samples_per_period=SAMPLES, initial_state=point.simulation.initial_state, method="exact",
    )  # fmt: skip
    length = float(points.length[0])
    speed = length * float(points.rate[0])
    period = 2.0 * np.pi / float(points.mesh_frequency[0])
    kept = SHOWN * SAMPLES
    variables = {
        "time": (("sample",), np.arange(kept) / SAMPLES * period),
        "displacement": (("sample",), data["x"].values[0, -kept:] * length),
        "velocity": (("sample",), data["v"].values[0, -kept:] * speed),
        "section_displacement": (("section",), data["section_x"].values[0, 1:] * length),
        "section_velocity": (("section",), data["section_v"].values[0, 1:] * speed),
        "half_backlash": ((), float(points.flat.half_backlash[0]) * length),
    }
    return Motion(label(variables), words)


# --- a series -----------------------------------------------------------------------------


SOME = 16
"""Parts of a series that are followed at once."""
SPEEDS = 45
"""Speeds at which a series is followed."""


def series(
    case: GearCase, speeds: NDArray[np.float64], alive: Alive = keep_going
) -> Iterator[xr.Dataset]:
    """Dynamic factor of the pairs of a class between the ends of ``speeds`` [rad/s], some first.

    At the first operating point, hot, and the first damping of the case, which is the series or a
    part of it: ``dynamic_factor`` (part, speed), of more parts each time, its quantiles ``band``
    (quantile, speed), and the figure of each part at the own speed, ``own_dynamic_factor``.
    Attributes: ``parts`` of the series, ``own_speed`` [rad/s], ``shown``, the part that the case is
    (-1: the series).
    """
    model, mean = case.models[0], case.mean_tooth()
    HOT.require_settled(case, model)
    at = HOT.operating(case, model).part(slice(1))
    hot = HotPair(case.pair, replace(at, housing=case.housing), model)
    excited = excitations(mean, HOT.quantities(mean, model, EXCITES)).take(np.zeros(1, int))
    own = float(case.speeds[0])
    grid = np.unique(np.append(np.linspace(speeds[0], speeds[-1], SPEEDS), own))
    rows: list[NDArray[np.float64]] = []
    whole = Series.of(case, parts_of(case))
    for first in range(0, len(whole.parts), SOME):
        alive()
        some = whole.some(slice(first, first + SOME)).mesh(hot)
        motion = series_motion(some, excited, grid, np.array(case.dampings[:1]))
        rows.extend(motion.dynamic_factor[0])
        factor = np.array(rows)
        spread = [Spread.of(values) for values in factor.T]
        band = [
            [getattr(one, which).value for one in spread] for which in ("low", "middle", "high")
        ]
        yield label(
            {
                "dynamic_factor": (("part", "speed"), factor, "1", "dynamic factor of each pair"),
                "band": (("quantile", "speed"), band, "1", "quantiles of it"),
                "own_dynamic_factor": (("part",), factor[:, np.searchsorted(grid, own)], "1", ""),
            },
            {
                "pinion_speed": ("speed", grid, "rad/s", "pinion speed"),
                "quantile": ("quantile", np.array(BAND), "1", "share of pairs"),
            },
            {"parts": len(whole.parts), "own_speed": own, "shown": drawing(case)},
        )


# --- run-ups ------------------------------------------------------------------------------


@dataclass(eq=False)
class LiveRunUp:
    """A run-up as far as it has come: the arrays of its ``plan``, nan where nothing is yet.

    ``data`` shares them. ``done`` of ``total`` speeds, both ways; a ``preview`` holds every so
    many-th speed.
    """

    plan: RunUpPlan
    preview: bool
    done: int = 0
    arrays: Arrays = field(default_factory=dict)

    @property
    def total(self) -> int:
        return 2 * len(self.plan.speeds)

    @cached_property
    def length(self) -> float:
        """What one of the stored displacements is [m]."""
        return float(self.plan.family(0)(np.array([[self.plan.speeds[0]]])).length[0])

    @property
    def data(self) -> xr.Dataset:
        """As stored by ``thermogear runup``, without what only a whole run-up tells."""
        import xarray as xr

        plan = self.plan
        variables = {
            name: xr.Variable(v.dims, self.arrays[name], dict(v.attributes))
            for name, v in plan.variables().items()
        }
        own = {
            n: xr.Variable(d, np.asarray(x), dict(a)) for n, (d, x, a) in plan.coordinates().items()
        }
        told = {"preview": int(self.preview), "done": self.done, "length": self.length}
        return xr.Dataset(variables, own, told)


def run_ups(
    case: GearCase, speeds: NDArray[np.float64], state: StateLike, alive: Alive = keep_going
) -> Iterator[LiveRunUp]:
    """A run-up over ``speeds`` [rad/s] in one state of heat: coarsely first, then all of it.

    The whole one is :func:`~thermogear.study.run_up.run_up` without branches, to the last bit.
    """
    fine = run_up_plan(case, speeds, temperatures=[state], branch_period=0, block=BLOCK)
    steps = [fine]
    if speeds.size > 4 * COARSE:
        some = speeds[every(speeds.size, step=COARSE)]
        first = HEATED if case.computed else FIRST
        steps.insert(0, run_up_plan(case, some, temperatures=[state], branch_period=0, block=first))
    for plan in steps:
        yield from _followed(LiveRunUp(plan, plan is not fine), alive)


def _followed(found: LiveRunUp, alive: Alive) -> Iterator[LiveRunUp]:
    plan = found.plan
    variables = plan.variables()
    for name, v in variables.items():
        fill = STATUS.index("not_converged") if name == "status" else v.fill
        found.arrays[name] = np.full([plan.sizes[d] for d in v.dims], fill, np.dtype(v.dtype))
    for one in slices(plan, threads=1, alive=alive):
        key = tuple(int(one.where[n][0] // plan.cuts[n]) for n in plan.cuts)
        for name, v in variables.items():
            found.arrays[name][region_of(plan, key, v)] = one.arrays[name]
        found.done += one.where["pinion_speed"].size
        yield found


def fingerprint(case: GearCase, speeds: NDArray[np.float64], state: StateLike) -> bytes:
    """All that a run-up over ``speeds`` in one state hangs on; b"" where it cannot move."""
    try:
        plan = run_up_plan(case, speeds[[0, -1]], temperatures=[state], branch_period=0)
        points = plan.family(0)(speeds[[0, -1]][:, None])
    except ThermogearError:
        return b""
    lanes = points.flat
    parts: Mapping[str, Any] = {
        "speeds": speeds,
        "status": points.status,
        "lanes": (lanes.period, lanes.damping, lanes.half_backlash, lanes.stiffness, lanes.force),
        "scales": (points.length, points.rate, points.stiffness),
        "start": case.simulation.initial_state,
    }
    return b"|".join(
        np.ascontiguousarray(one).tobytes()
        for part in parts.values()
        for one in (part if isinstance(part, tuple) else (part,))
    )


def ends_at(found: LiveRunUp, speed: float) -> dict[str, tuple[float, float]]:
    """The states at the speed nearest to ``speed``, running up and running down: (X, X')."""
    place = int(np.argmin(np.abs(np.array(found.plan.speeds) - speed)))
    states = {}
    for way, name in enumerate(("running up", "running down")):
        x, v = (float(found.arrays[f"end_{n}"][0, way, place]) for n in "xv")
        if np.isfinite(x) and np.isfinite(v):
            states[name] = (x, v)
    return states
