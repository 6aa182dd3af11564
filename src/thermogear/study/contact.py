"""Loaded contact of a case over mesh position, load and temperature."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Dataset
from thermogear.base.errors import InputError
from thermogear.base.progress import Progress, silent
from thermogear.base.vocabulary import dressed, label
from thermogear.case.case import GearCase
from thermogear.case.thermal_state import HOT, UNDEFORMED, ThermalState
from thermogear.gears.iso6336 import iso6336_stiffness
from thermogear.gears.loaded import loaded_contact
from thermogear.gears.turn import mean_tooth
from thermogear.mesh.operating import Operating
from thermogear.mesh.thermal import HotPair
from thermogear.results.result import Notice, Result
from thermogear.study.corners import HotContact
from thermogear.study.declared import Contact, declared
from thermogear.study.relief import UNIFORM, one_point
from thermogear.study.turn import turn_contact

PARTS = (0.1, 0.25, 0.5, 1.0, 2.0)
"""Loads, as parts of the case's greatest, where none are named."""
DIFFERENCES = (-40.0, -20.0, 0.0, 20.0, 40.0)
"""Pinion's temperature less the wheel's [K]."""
LIGHT = tuple(np.geomspace(0.02, 2.0, 41))
"""Loads, as parts of the case's greatest, of the double-contact picture."""


@declared(Contact)
def loaded_survey(
    case: GearCase,
    torques: Sequence[float] = (),
    *,
    body: str | None = None,
    progress: Progress = silent,
) -> Result:
    """Stiffness, transmission error, shares, pressure and double contact of the case's pair.

    ``torques`` [N m] of the pinion, by default parts of the case's greatest; ``body``
    "bore-clamped" (statics) or "rim", by default the case's own. Temperatures: undeformed, the
    case's hot state, and the row of gear temperatures.

    Groups: ``contact`` over (temperature, load, mesh_phase[, pair]) as :func:`loaded_contact`
    gives it, with ``corner_onset_torque`` [N m] over (temperature, gear); ``base_pitch`` over
    (temperature_difference, load) with the hot pair's gears of unequal temperature:
    ``double_contact_length``, ``mean_stiffness``, ``edge_contact_share``, ``peak_to_peak_error``;
    ``iso_6336`` the stiffness of method B at the same loads. Where teeth differ these are of the
    mean tooth; ``turn``, ``teeth``, ``assemblies`` (:func:`~thermogear.study.turn.turn_contact`)
    are of the whole turn, hot, under the greatest of ``torques``, else the case's greatest.
    """
    most = max(case.torques, default=0.0)
    if not len(torques) and most <= 0.0:
        raise InputError("operating.torque", "0 N m", allowed="> 0 N m", fix="pass --torques")
    moments = np.asarray(torques, dtype=float) if len(torques) else most * np.asarray(PARTS)
    if not np.all(np.isfinite(moments) & (moments > 0.0)):
        raise InputError("torques", f"{moments} N m", allowed="> 0 N m, finite")
    model = case.models[0].override(stiffness="loaded", body=body or case.models[0].body)
    states = [UNDEFORMED, HOT, *map(ThermalState.of, case.gear_temperatures)]
    for state in states:
        state.require_settled(case, case.models[0])
    progress("loaded contact", 0, 2)
    ones = [one_point(s.operating(case, case.models[0]), float(moments[0])) for s in states]
    alike = mean_tooth(case.pair, case.deviations)
    at = HotContact(HotPair(case.pair, stacked(ones), model), alike)
    contact = _solve(at, moments)
    contact = contact.assign(
        corner_onset_torque=dressed(
            ("temperature", "gear"),
            at.onset(float(moments.max())),
            "N m",
            "pinion torque from which a tip corner of this gear carries, 0 where it does at any; "
            "nan where at no load here or undercut ends the path",
        )
    ).assign_coords(
        temperature=[state.words for state in states],
        gear_temperature=dressed(
            ("temperature",),
            np.array([state.temperature for state in states], dtype=float),
            "K",
            "both addenda where they are given",
        ),
        load=dressed(("load",), moments, "N m", "pinion torque"),
    )
    progress("loaded contact", 1, 2)
    unequal = [apart(ones[1], difference) for difference in DIFFERENCES]
    reach = max(most, float(moments.max()))
    light = reach * np.asarray(LIGHT)
    hotter = HotPair(case.pair, stacked(unequal), model)
    heated = _solve(HotContact(hotter, alike), light)
    progress("loaded contact", 2, 2)
    error = heated["transmission_error"]
    base_pitch = label(
        {
            "double_contact_length": heated["double_contact_length"],
            "mean_stiffness": heated["mean_stiffness"],
            "edge_contact_share": heated["edge_contact_share"],
            "peak_to_peak_error": (
                ("temperature", "load"),
                np.ptp(error.values, axis=-1),
                "m",
                "transmission error, peak to peak",
            ),
        }
    ).rename(temperature="temperature_difference")
    base_pitch = base_pitch.assign_coords(
        temperature_difference=dressed(
            ("temperature_difference",),
            np.asarray(DIFFERENCES),
            "K",
            "pinion's temperature less the wheel's",
        ),
        load=dressed(("load",), light, "N m", "pinion torque"),
    )
    width = case.pair.face_width
    line = moments / case.pair.pinion.pitch_radius / width
    iso = iso6336_stiffness(case.pair, line)
    compared = label(
        {
            "iso_stiffness": (
                ("load",),
                iso.mesh * width,
                "N/m",
                "mesh stiffness c_gamma b, method B",
            ),
            "loaded_stiffness": (
                ("load",),
                contact["mean_stiffness"].sel(temperature=UNDEFORMED.kind).values,
                "N/m",
                "mean tangent stiffness of the loaded contact, undeformed",
            ),
        },
        {"load": (("load",), moments, "N m", "pinion torque")},
    )
    lost = int((contact["status"].values != 0).sum() + (heated["status"].values != 0).sum())
    groups = {"contact": contact, "base_pitch": base_pitch, "iso_6336": compared}
    if case.period.mesh_periods > 1:
        moment = float(moments.max()) if len(torques) else most
        hot = HotPair(case.pair, replace(ones[1], torque=np.array([moment])), model)
        groups |= turn_contact(case, hot)
        lost += int(np.isnan(groups["turn"]["transmission_error"].values).sum())
    return Result.of(
        Contact.kind,
        f"Loaded contact: {case.title}",
        groups,
        _notices(case, at, lost, groups),
        **case.provenance,
        body=model.body,
        base_pitch_length=case.pair.base_pitch,
        path_points={k.upper(): v for k, v in case.pair.path._asdict().items()},
    )


def _solve(at: HotContact, moments: NDArray[np.float64]) -> Dataset:
    """The loaded contact over (temperature, load, mesh_phase)."""
    load = np.tile(moments / at.pair.pinion.base_radius, (at.hot.count, 1))
    return loaded_contact(
        at.pair, load, UNIFORM, **at.arguments, dimensions=("temperature", "load")
    )


def stacked(points: Sequence[Operating]) -> Operating:
    """Single operating points as one array of them."""
    bodies: dict[str, Any] = {
        name: np.array([float(np.ravel(p.temperatures.bodies[name])[0]) for p in points])
        for name in points[0].temperatures.bodies
    }
    return replace(
        points[0],
        speed=np.concatenate([p.speed for p in points]),
        torque=np.concatenate([p.torque for p in points]),
        oil_temperature=np.array([float(np.ravel(p.oil_temperature)[0]) for p in points]),
        temperatures=replace(points[0].temperatures, **bodies),
        pulled=np.array([float(np.ravel(p.pulled)[0]) for p in points]),
    )


def apart(point: Operating, difference: float) -> Operating:
    """``point`` with the pinion hotter by half the ``difference`` [K], the wheel colder by it."""
    t, half = point.temperatures, 0.5 * difference
    signs = {"pinion": half, "wheel": -half}
    gears: dict[str, Any] = {
        name: kelvin + signs[name.partition("_")[0]]
        for name, kelvin in t.bodies.items()
        if name != "housing"
    }
    return replace(point, temperatures=replace(t, **gears))


def _notices(
    case: GearCase, at: HotContact, lost: int, groups: Mapping[str, Dataset]
) -> Iterator[Notice]:
    contact, compared = groups["contact"], groups["iso_6336"]
    edges, loads = contact["edge_contact_share"], contact["corner_load_share"]
    apart = (compared["iso_stiffness"] / compared["loaded_stiffness"] - 1.0).values
    yield Notice.of("loaded_contact_unchecked", body=at.hot.model.body)
    yield Notice.of("iso_stiffness_apart", apart=[[apart.min(), apart.max()]])
    if bool((edges > 0.0).any()):
        most = edges.isel(edges.argmax(...))
        where = {
            "share": most.item(),
            "state": str(most["temperature"].values),
            "torque": most["load"].item(),
        }
        if case.pair.cut_short:
            yield Notice.of("edge_of_undercut", **where)
        else:
            top = loads.isel(loads.argmax(...))
            where |= {"gear": str(top["gear"].values), "load": top.item()}
            yield Notice.of("edge_contact_at_most", **where)
    if at.yields(at.under(contact["load"].values[None, :], phase=UNIFORM)).any():
        yield Notice.of("edge_settles")
    if lost:
        yield Notice.of("positions_not_settled", lost=lost)
    if any(m.stiffness != "loaded" for m in case.models):
        yield Notice.of("contact_of_every_bundle")
    if "turn" in groups:
        turn = groups["turn"].attrs
        yield Notice.of(
            "survey_of_mean_tooth", mesh_periods=turn["mesh_periods"], torque=turn["torque"]
        )
    if "assemblies" in groups:
        ways = groups["assemblies"]
        swings = ways["peak_to_peak_error"].values
        yield Notice.of(
            "assembly_not_stated",
            swings=[[swings.min(), swings.max()]],
            computed=swings.size,
            count=ways.attrs["of"],
        )
