"""Loads, clearances and tilts of a drive train at rest under its torque, cold and hot."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import chain

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.progress import Progress, silent
from thermogear.base.vocabulary import STATUS, label
from thermogear.case.case import GearCase
from thermogear.results.result import Notice, Result
from thermogear.shafts.train import SHAFTS
from thermogear.study.declared import Statics, declared
from thermogear.study.shafts.sketch import sketch
from thermogear.study.shafts.state import JAMMED, TrainState, places_of, plan_of, settled

TILT_SHARE = 0.5
"""Misalignment across the face over the mesh deflection from which a plane mesh is doubtful."""
POINT, RING = ("state", "operating"), ("state", "operating", "bearing")


@declared(Statics)
def statics(case: GearCase, *, progress: Progress = silent) -> Result:
    """Bearing loads, deflections, tilts and centre distance of a case's drive train at rest.

    Undeformed and hot, at the operating points (at most six). Groups: ``statics`` over (state,
    operating), ``bearings`` over (state, operating, bearing), ``deflection`` of both shafts along
    their length; SI. Raises InputError for a case without shafts, or whose shafts nothing holds.
    """
    places = places_of(case)
    found = settled(case, places, progress=progress)
    plan = plan_of(case)
    train = plan.drive_train(pair=case.pair)
    return Result.of(
        Statics.kind,
        f"Loads of the shafts: {case.title}",
        {
            "statics": of_mesh(case, found),
            "bearings": of_bearings(case, found),
            "deflection": _deflections(found),
        },
        notices(case, found),
        **case.provenance,
        bundle=case.models[0].name,
        train=sketch(train, case.pair),
    )


def coordinates(found: Sequence[Sequence[TrainState]]) -> dict[str, object]:
    """State and operating point of every number."""
    row = found[0]
    return {
        "state": [states[0].state.kind for states in found],
        "pinion_speed": (("operating",), [one.speed for one in row]),
        "pinion_torque": (("operating",), [one.torque for one in row]),
    }


def _grid(found: Sequence[Sequence[TrainState]], of: Callable[[TrainState], ArrayLike]) -> Floats:
    """A number of every equilibrium over (state, operating, ...), nan where there is none."""
    shape = next(
        (np.shape(of(one)) for row in found for one in row if one.equilibrium is not None), ()
    )
    return np.array(
        [
            [np.full(shape, np.nan) if one.equilibrium is None else of(one) for one in row]
            for row in found
        ],
        dtype=float,
    )


def of_mesh(case: GearCase, found: Sequence[Sequence[TrainState]]) -> Dataset:
    """What the mesh feels, over (state, operating)."""
    width = min(case.pair.pinion.face_width, case.pair.wheel.face_width)

    def backlash(one: TrainState) -> float:
        return 2.0 * one.mesh.half_backlash + sum(one.rest.flank_openings)

    return label(
        {
            "mesh_force": (POINT, _grid(found, lambda s: s.rest.mesh_force), "N", "mesh force"),
            "mesh_deflection": (
                POINT,
                _grid(found, lambda s: s.rest.mesh_force / s.band[1]),
                "m",
                "deflection of the teeth at mean stiffness",
            ),
            "centre_distance_growth": (
                POINT,
                _grid(found, lambda s: s.rest.centre_distance_growth),
                "m",
                "growth of the centre distance by the deflection of shafts and bearings",
            ),
            "contact_ratio": (
                POINT,
                _grid(found, lambda s: s.mesh.pair.contact_ratio),
                "1",
                "contact ratio at the actual centre distance",
            ),
            "backlash_at_shift": (
                POINT,
                _grid(found, backlash),
                "m",
                "normal backlash of the teeth with the shift of the centres in it",
            ),
            "mean_stiffness": (
                POINT,
                _grid(found, lambda s: s.band[1]),
                "N/m",
                "mean mesh stiffness at the actual centre distance",
            ),
            "misalignment": (
                POINT,
                _grid(found, lambda s: s.rest.misalignment),
                "rad",
                "tilt of the gears against each other in the plane of action",
            ),
            "misalignment_across_face": (
                POINT,
                _grid(found, lambda s: abs(s.rest.misalignment) * width),
                "m",
                "tilt times face width: how far the flanks part across the face",
            ),
            "rounds": (
                POINT,
                _grid(found, lambda s: len(s.growths)),
                "1",
                "rounds of centre distance and stiffness",
            ),
            "status": (POINT, [[one.status for one in row] for row in found]),
        },
        coordinates(found),
    )


def of_bearings(case: GearCase, found: Sequence[Sequence[TrainState]]) -> Dataset:
    """Load, clearance, displacement and stiffness of every bearing, hot and cold."""
    plan = plan_of(case)
    ratio = case.pair.pinion.teeth / case.pair.wheel.teeth

    def limit(name: str) -> Floats:
        def of(one: TrainState) -> Floats:
            loads = np.linalg.norm(one.rest.bearing_force, axis=-1)
            return plan.limits(loads, one.speed, ratio)[name]

        return _grid(found, of)

    def given(name: str) -> Floats:
        return np.array([[getattr(one, name) for one in row] for row in found], dtype=float)

    load = _grid(found, lambda s: s.rest.bearing_force)
    moved = _grid(found, lambda s: s.rest.bearing_displacement)
    stiff = _grid(found, lambda s: s.rest.bearing_stiffness)
    warm = given("temperatures")
    return label(
        {
            "bearing_load": (RING, np.linalg.norm(load, axis=-1), "N", "load of the bearing"),
            "bearing_load_x": (RING, load[..., 0], "N", "load along x"),
            "bearing_load_y": (RING, load[..., 1], "N", "load along y"),
            "journal_x": (RING, moved[..., 0], "m", "journal in its ring along x"),
            "journal_y": (RING, moved[..., 1], "m", "journal in its ring along y"),
            "radial_internal_clearance": (RING, 2.0 * given("half_plays")),
            "bearing_stiffness_x": (RING, stiff[..., 0, 0], "N/m", "tangent stiffness along x"),
            "bearing_stiffness_y": (RING, stiff[..., 1, 1], "N/m", "tangent stiffness along y"),
            "inner_ring_temperature": (RING, warm[..., 0], "K", "temperature of the inner ring"),
            "outer_ring_temperature": (RING, warm[..., 2], "K", "temperature of the outer ring"),
            "static_safety": (RING, limit("static_safety"), "1", "static safety C0/P0"),
            "least_load_ratio": (
                RING,
                limit("least_load_ratio"),
                "1",
                "load over the least load that keeps the elements rolling",
            ),
            "bearing_life": (RING, limit("life"), "s", "basic rating life L10 at this load"),
        },
        coordinates(found) | {"bearing": list(plan.bearing_names)},
    )


def _deflections(found: Sequence[Sequence[TrainState]]) -> Dataset:
    """Lines of both shafts: x and y [m] over the length."""
    variables: dict[str, object] = {}
    places: dict[str, object] = {}
    assembly = found[0][0].assembly
    for number, shaft in enumerate(SHAFTS):
        nodes = assembly.nodes[number]
        rows = {
            c: [assembly.index[f"{shaft}.{i}.{c}"] for i in range(nodes.size)] for c in ("x", "y")
        }
        for c, at in rows.items():
            variables[f"{shaft}_{c}"] = (
                (*POINT, f"{shaft}_position"),
                _grid(found, partial(_displaced, at)),
                "m",
                f"deflection of the {shaft}'s shaft along {c}",
            )
        places[f"{shaft}_position"] = (
            (f"{shaft}_position",),
            nodes - nodes[assembly.gear_nodes[number]],
            "m",
            "distance along the shaft from the middle of the gear",
        )
    return label(variables, coordinates(found) | places)


def _displaced(rows: list[int], one: TrainState) -> Floats:
    return one.rest.displacement[rows]


def notices(case: GearCase, found: Sequence[Sequence[TrainState]]) -> Iterator[Notice]:
    """What limits the model, and what one should look at."""
    yield Notice.of("plane_mesh")
    width = min(case.pair.pinion.face_width, case.pair.wheel.face_width)
    tilted = max(
        (
            abs(one.rest.misalignment) * width * one.band[1] / max(one.rest.mesh_force, 1e-9)
            for row in found
            for one in row
            if one.equilibrium is not None and one.rest.mesh_force > 0.0
        ),
        default=0.0,
    )
    if tilted > TILT_SHARE:
        yield Notice.of("gears_tilt", tilt=tilted)
    for one in chain.from_iterable(found):
        if one.equilibrium is None or one.status == JAMMED:
            yield Notice.of(
                "train_without_rest" if one.equilibrium is None else "train_jammed",
                about=one.state.words,
                speed=one.speed,
                torque=one.torque,
                status=STATUS[one.status],
            )
    plan = plan_of(case)
    yield from plan.misfits()
    for row in found:
        plays = 2.0 * np.min([one.half_plays for one in row], axis=0)
        tight = np.flatnonzero(plays < 0.0)
        if tight.size:
            yield Notice.of(
                "bearings_preloaded",
                about=row[0].state.words,
                bearings=[plan.bearing_names[place] for place in tight],
                clearances=plays[tight],
            )
