"""Tip relief of a case's hot pair: the one that evens the loaded transmission error."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError
from thermogear.base.progress import Progress, silent
from thermogear.base.vocabulary import label
from thermogear.case.case import GearCase
from thermogear.case.flanks import relief_text
from thermogear.case.thermal_state import HOT, ThermalState
from thermogear.gears.deviations import Contacts, Relief
from thermogear.gears.loaded import LoadedMesh, solve_mesh
from thermogear.gears.relief import MOST_EVALUATIONS, PLACES, STARTS, optimise_tip_relief
from thermogear.gears.stiffness import Moduli
from thermogear.mesh.elastic import LoadedPair
from thermogear.mesh.operating import Operating
from thermogear.mesh.thermal import HotPair, ThermalDeviation
from thermogear.results.result import Notice, Result
from thermogear.study.declared import ReliefSurvey, declared, mean_tooth_notices
from thermogear.study.relief_series import ReliefTask, series_relief

LOADS = tuple(np.arange(0.1, 1.75, 0.1))
"""Loads, as parts of the one designed for, at which the pairs are compared."""
UNIFORM = np.arange(200) / 200
"""Positions of a mesh period [periods] at which the loaded contact is solved."""
EDGE_SHARE = "share of the mesh period in which a tip corner carries load"


@declared(ReliefSurvey)
def relief_survey(
    case: GearCase,
    *,
    torque: float | Sequence[float] | None = None,
    gear_temperature: float | Sequence[float] | None = None,
    shape: str = ReliefSurvey.shape,
    symmetric: bool = ReliefSurvey.symmetric,
    largest: float | None = None,
    progress: Progress = silent,
) -> Result:
    """The tip relief of both gears with the least peak-to-peak static transmission error.

    ``torque`` [N m] of the pinion (default: the case's greatest), one or several, and
    ``gear_temperature`` [K] of both addenda (default: the case's hot state), likewise, are what is
    designed for; ``shape`` linear or parabolic; ``symmetric``: both gears alike; ``largest`` amount
    [m]. Other deviations of the case stay; tip reliefs it has already are replaced.

    Of a case of a series, and for several loads or temperatures, as
    :func:`~thermogear.study.relief_series.series_relief`. Else the error peak to peak is least.
    Groups: ``error`` over (pair_kind, mesh_phase) at the design load; ``loads`` the peak-to-peak
    error over other loads; attributes carry the relief and its lines for the case file. Where a
    tip corner carries (``edge_contact``) the ``greatest_pressure`` is nan.
    """
    if not case.torques:
        raise InputError("operating.torque", "nothing", allowed="one torque")
    moments = np.atleast_1d(max(case.torques) if torque is None else torque).tolist()
    for name, values, unit in (("torque", moments, "N m"), ("largest", [largest], "m")):
        if 0.0 in values:
            raise InputError(name, f"0 {unit}", allowed=f"> 0 {unit}")
    whole, case = case, case if case.series > 1 else case.mean_tooth()
    taken = tuple(mean_tooth_notices(whole, case))
    model = case.models[0].override(stiffness="loaded")
    given = [None] if gear_temperature is None else np.atleast_1d(gear_temperature).tolist()
    states = [HOT if kelvins is None else ThermalState.of(kelvins) for kelvins in given]
    for state in states:
        state.require_settled(case, case.models[0])
    hots = [
        HotPair(case.pair, one_point(state.operating(case, case.models[0]), moment), model)
        for state in states
        for moment in moments
    ]
    if case.series > 1 or len(hots) > 1:
        task = ReliefTask(case, hots, shape, symmetric, largest)
        return series_relief(task, notices=taken, progress=progress)
    (hot,), (moment,) = hots, moments
    moduli = [
        Moduli(tooth=np.ravel(m.tooth)[0], body=np.ravel(m.body)[0]) for m in LoadedPair(hot).moduli
    ]
    deviations = [
        *(d for d in case.deviations if not (isinstance(d, Relief) and d.end == "tip")),
        Seen(ThermalDeviation(hot), 0),
    ]
    force = moment / case.pair.pinion.base_radius
    most = 2 * PLACES + STARTS * MOST_EVALUATIONS
    design = optimise_tip_relief(
        case.pair,
        force,
        pinion=moduli[0],
        wheel=moduli[1],
        deviations=deviations,
        model=model.loaded,
        shape=shape,
        largest=largest,
        symmetric=symmetric,
        progress=lambda done: progress("relief", done, most),
    )
    progress("relief", most, most)

    def mesh(reliefs: tuple[Relief, ...], forces: NDArray[np.float64]) -> LoadedMesh:
        return solve_mesh(
            case.pair,
            forces,
            UNIFORM,
            pinion=moduli[0],
            wheel=moduli[1],
            deviations=[*deviations, *reliefs],
            model=model.loaded,
        ).checked()

    pairs = {"unrelieved": (), "relieved": (design.pinion, design.wheel)}
    loads = force * np.asarray(LOADS)
    curves, laddered = (
        [mesh(reliefs, forces) for reliefs in pairs.values()]
        for forces in (np.array([force]), loads)
    )
    by = ("pair_kind", "mesh_phase")
    return Result.of(
        ReliefSurvey.kind,
        f"Tip relief: {case.title}",
        {
            "error": label(
                {
                    "transmission_error": (
                        by,
                        np.stack([c.deflection[0] for c in curves]),
                        "m",
                        "static transmission error under load",
                    ),
                    "tangent_stiffness": (
                        by,
                        np.stack([c.tangent[0] for c in curves]),
                        "N/m",
                        "tangent mesh stiffness",
                    ),
                    "greatest_pressure": (
                        by,
                        np.stack([c.pressure[0].max(axis=-1) for c in curves]),
                        "Pa",
                        "greatest Hertzian pressure of any pair; not valid (nan) in edge contact",
                    ),
                    "edge_contact": (
                        by,
                        np.stack([np.bitwise_or.reduce(c.edge[0], axis=-1) for c in curves]),
                    ),
                    "edge_contact_share": (
                        ("pair_kind",),
                        [float(c.edge_share[0]) for c in curves],
                        "1",
                        EDGE_SHARE,
                    ),
                },
                {
                    "pair_kind": list(pairs),
                    "mesh_phase": (("mesh_phase",), UNIFORM, "1", "mesh phase"),
                },
            ),
            "loads": label(
                {
                    "peak_to_peak_error": (
                        ("pair_kind", "load"),
                        np.stack([np.ptp(c.deflection, axis=-1) for c in laddered]),
                        "m",
                        "transmission error, peak to peak",
                    ),
                    "edge_contact_share": (
                        ("pair_kind", "load"),
                        np.stack([c.edge_share for c in laddered]),
                        "1",
                        EDGE_SHARE,
                    ),
                },
                {
                    "pair_kind": list(pairs),
                    "load": (
                        ("load",),
                        loads * case.pair.pinion.base_radius,
                        "N m",
                        "pinion torque",
                    ),
                },
            ),
        },
        (*taken, *_notices(case, model.loaded.body, [float(c.edge_share[0]) for c in curves])),
        **case.provenance,
        torque=moment,
        pinion_addendum=float(np.ravel(hot.temperatures.pinion_addendum)[0]),
        wheel_addendum=float(np.ravel(hot.temperatures.wheel_addendum)[0]),
        shape=shape,
        symmetric=symmetric,
        **{name: float(np.ptp(c.deflection)) for name, c in zip(pairs, curves, strict=True)},
        evaluations=design.evaluations,
        reliefs={
            r.gear: {"amount_m": r.amount, "length_m": r.length, "shape": r.shape}
            for r in (design.pinion, design.wheel)
        },
        paste="\n\n".join(relief_text(r.gear, r) for r in (design.pinion, design.wheel)),
    )


def one_point(operating: Operating, torque: float) -> Operating:
    """The first point of ``operating`` alone, under ``torque`` [N m]."""
    return replace(operating.point(0), torque=np.array([torque]))


@dataclass(frozen=True, eq=False)
class Seen:
    """A deviation over operating points, its first axis taken at ``places``."""

    deviation: ThermalDeviation
    places: Any

    def gap(self, at: Contacts) -> NDArray[np.float64]:
        """e [m], (places, position, pair)."""
        return np.asarray(self.deviation.gap(at)[self.places])


def _notices(case: GearCase, body: str, edges: Sequence[float]) -> Iterator[Notice]:
    yield Notice.of("loaded_contact_unchecked", body=body)
    yield Notice.of("relief_of_one_load")
    if any(edges):
        yield Notice.of("edge_contact_of_relief", without=edges[0], relieved=edges[1])
    if any(isinstance(d, Relief) and d.end == "tip" for d in case.deviations):
        yield Notice.of("relief_of_case_replaced")
