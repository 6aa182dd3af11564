"""The loaded contact over a whole turn: its error and orders, every tooth, the assemblies."""

from __future__ import annotations

import numpy as np

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.vocabulary import dressed, label
from thermogear.case.case import GearCase
from thermogear.gears.candidates import mesh_points
from thermogear.gears.deviations import GEARS
from thermogear.gears.loaded import LoadedMesh
from thermogear.mesh.elastic import TURN_POSITIONS, LoadedPair, turn_phases
from thermogear.mesh.thermal import HotPair
from thermogear.signals.spectra import amplitude_spectrum

HIGHEST_ORDER = 8.0
"""Lines are kept up to this order of the mesh."""
MOST_ASSEMBLIES = 16
"""Assemblies whose error is computed, evenly spread over all of them."""


def turn_contact(case: GearCase, hot: HotPair) -> dict[str, Dataset]:
    """Groups of the turn of ``case`` at the one operating point of ``hot``.

    ``turn``: the transmission error under load and without over ``mesh_phase``, 0 to L mesh
    periods; its mean over the mesh periods, ``mesh_synchronous_error``, over ``period_phase``; its
    lines over ``order`` (of the mesh). ``teeth``: of every ``tooth`` of both gears, by its number
    in the case file, what :func:`_teeth` says. ``assemblies``: the peak-to-peak errors of up to
    :data:`MOST_ASSEMBLIES` of them at the same temperatures, where more than one is possible and
    the case does not say which.
    """
    phase = turn_phases(case.period.mesh_periods, np.arange(TURN_POSITIONS) / TURN_POSITIONS)
    mesh = LoadedPair(hot, case.deviations).solve(phase)
    groups = {
        "turn": _errors(case, hot, phase, mesh),
        "teeth": _teeth(case, mesh),
    }
    if case.assembly_count > 1 and case.file.gears.marks is None:
        groups["assemblies"] = _assemblies(case, hot, phase)
    return groups


def _errors(case: GearCase, hot: HotPair, phase: Floats, mesh: LoadedMesh) -> Dataset:
    loaded, unloaded = mesh.deflection[0], mesh.unloaded[0]
    known = np.where(np.isfinite(loaded).all(), np.stack([loaded, unloaded]), 0.0)
    spectrum = amplitude_spectrum(known, float(TURN_POSITIONS))
    kept = (spectrum.frequencies > 0.0) & (spectrum.frequencies <= HIGHEST_ORDER)
    along, lines = ("mesh_phase",), ("order",)
    variables = {
        "transmission_error": (along, loaded, "m", "static transmission error under load"),
        "unloaded_error": (along, unloaded, "m", "transmission error without load"),
        "mesh_synchronous_error": (
            ("period_phase",),
            loaded.reshape(-1, TURN_POSITIONS).mean(axis=0),
            "m",
            "mean of the error under load over all mesh periods",
        ),
        "line_amplitude": (lines, spectrum.amplitudes[0, kept], "m", "line of the loaded error"),
        "unloaded_line": (lines, spectrum.amplitudes[1, kept], "m", "line of the unloaded error"),
    }
    return label(
        variables,
        {
            "mesh_phase": dressed(along, phase, "1", "mesh phase"),
            "period_phase": dressed(("period_phase",), phase[:TURN_POSITIONS], "1", "mesh phase"),
            "order": dressed(lines, spectrum.frequencies[kept], "1", "order of the mesh"),
        },
        {
            "mesh_periods": case.period.mesh_periods,
            "teeth": [case.pair.pinion.teeth, case.pair.wheel.teeth],
            "first": [case.tooth_number(gear, 0) for gear in GEARS],
            "torque": float(hot.operating.torque[0]),
        },
    )


def _teeth(case: GearCase, mesh: LoadedMesh) -> Dataset:
    """Of every tooth over all its meshes of the turn.

    ``index_error`` [m] along the line of action, > 0 added material: its drive flank's place at the
    pitch point from the mean of all teeth of its gear, as measured about the axis of rotation, so
    that eccentricity is in it. ``load_carried``: load times time over the mean of the gear's teeth.
    ``greatest_share`` of the load, the greatest ``contact_pressure`` [Pa] on its flank with the
    ``position`` [m] from the pinion's tangent point and the ``mate``; nan and 0 where no pressure
    is known.
    """
    import xarray as xr

    contacts, share, pair = mesh.points.contacts, mesh.share[0], case.pair
    pressure = np.where(np.isfinite(mesh.pressure[0]), mesh.pressure[0], 0.0).ravel()
    at_pitch = (pair.path.c - pair.path.a) / pair.base_pitch
    gears = []
    for gear, other in zip(GEARS, GEARS[::-1], strict=True):
        count, tooth = pair.gear(gear).teeth, contacts.tooth(gear)
        # each tooth where its pressure is greatest, in the order of the teeth
        worst = np.lexsort((pressure, tooth.ravel()))
        worst = worst[np.cumsum(np.bincount(tooth.ravel(), minlength=count)) - 1]
        known = pressure[worst] > 0.0
        carried, most = np.bincount(tooth.ravel(), share.ravel(), count), np.zeros(count)
        np.maximum.at(most, tooth, share)
        points = mesh_points(pair, np.arange(count) + at_pitch)
        rank = int(np.argmin(np.abs(points.s[0] - pair.path.c)))
        gaps = [d.gap(points.contacts) for d in case.deviations if getattr(d, "gear", "") == gear]
        gap = np.broadcast_to(sum(gaps), points.s.shape)[:, rank]
        # the tooth at the pitch point is the one that entered last
        gap = gap[np.argsort(points.contacts.tooth(gear)[:, rank])]
        place = np.where(np.isfinite(gap), -gap, np.nan)  # a missing tooth is nowhere
        mates = contacts.tooth(other).ravel()[worst]
        number = [case.tooth_number(gear, n) for n in range(count)]
        columns = {
            "gear": ([gear] * count, "", "gear"),
            "number": (number, "1", "number of the tooth in the case file"),
            "index_error": (
                place - np.nanmean(place),
                "m",
                "drive flank at the pitch point, from the mean",
            ),
            "load_carried": (carried / carried.mean(), "1", "load times time, over the mean"),
            "greatest_share": (most, "1", "greatest share of the load"),
            "contact_pressure": (
                np.where(known, pressure[worst], np.nan),
                "Pa",
                "greatest Hertzian pressure on the flank",
            ),
            "position": (
                np.where(known, mesh.points.s.ravel()[worst], np.nan),
                "m",
                "distance from the pinion's tangent point of the greatest pressure",
            ),
            "mate": (
                known * np.array([case.tooth_number(other, int(n)) for n in mates]),
                "1",
                "tooth of the mate at the greatest pressure, 0: none",
            ),
        }
        rows = label({name: (("tooth",), *entry) for name, entry in columns.items()})
        gears.append(rows.sortby("number"))
    return xr.concat(gears, "tooth")


def _assemblies(case: GearCase, hot: HotPair, phase: Floats) -> Dataset:
    every = case.assemblies()
    step = -(-len(every) // MOST_ASSEMBLIES)
    swings, marks = [], []
    for other in every[::step]:
        mesh = LoadedPair(hot, other.deviations).solve(phase)
        swings.append((np.ptp(mesh.deflection), np.ptp(mesh.unloaded)))
        marks.append(other.tooth_number("wheel", 0))
    loaded, unloaded = np.array(swings).T
    along = ("wheel_tooth",)
    return label(
        {
            "peak_to_peak_error": (along, loaded, "m", "error under load, peak to peak"),
            "unloaded_swing": (along, unloaded, "m", "error without load, peak to peak"),
        },
        {
            "wheel_tooth": dressed(
                along, np.array(marks), "1", "wheel's tooth that meets the pinion's first mark"
            )
        },
        {"of": len(every), "pinion_tooth": case.tooth_number("pinion", 0)},
    )
