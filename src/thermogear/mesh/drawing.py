"""Both gears in mesh as numbers: outlines, places, contact points, load shares and gaps.

Frame: the pinion's centre is the origin, the first axis points to the wheel's centre; the pinion
drives and turns from the first axis to the second. One outline is one pitch of a gear in the frame
of its tooth (:mod:`thermogear.gears.outline`); the drive side is that of positive angles, on the
wheel seen from its own centre.

The tooth ``k`` of a gear is, at phase phi and with everything small ``factor`` times as large at

    pinion  start + factor set_back/r_b + 2 pi (phi + k)/z,
    wheel   start + factor (set_back + lag)/r_b - 2 pi (phi + k)/z,

with the outline tight + factor (outline - tight), point by point, and the wheel's centre at
a + factor (a' - a): ``tight`` is the tooth that leaves no gap at the centre distance a of the
drawing. Factor 1 is the truth.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.display import kind_in_words
from thermogear.base.vocabulary import label
from thermogear.gears.candidates import mesh_points
from thermogear.gears.deviations import Deviation, FlankShape
from thermogear.gears.geometry import Gear
from thermogear.gears.outline import LAND, outline, span_over_teeth
from thermogear.gears.pair import GearPair
from thermogear.gears.tooth_damage import Damage
from thermogear.gears.turn import Eccentricity, mean_tooth
from thermogear.mesh.clearance import Clearance
from thermogear.mesh.elastic import LoadedPair, elastic_pair
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Operating
from thermogear.mesh.thermal import HotPair

PHASES = tuple(k / 48 for k in range(48))
"""Mesh phases of a drawing: a slider's steps over one mesh period."""
NAMES = ("pinion", "wheel")


def drawn_gears(
    pair: GearPair,
    states: Mapping[str, Operating],
    model: MeshModel,
    *,
    deviations: Sequence[Deviation] = (),
    phases: ArrayLike = PHASES,
    fineness: int = 1,
) -> Dataset:
    """What both gears look like in mesh, over ``states`` of heat by name and operating points.

    Over (gear, outline_point): ``tight_radius``, ``tight_angle``; over (state, operating, gear,
    outline_point): ``outline_radius``, ``outline_angle`` [m, rad] of one pitch, flanks with the
    shapes among ``deviations``, grown by heat and speed. The backlash that the centre distance does
    not open is taken off all four flanks alike: nobody says which gear is the thinner. Over (state,
    operating): ``centre_distance``, and over the mesh phase ``lag`` [m], how far the wheel stays
    behind until the first pair of drive flanks touches without load. Over (mesh_phase,
    contact_pair): where a pair touches, ``contact_x``, ``contact_y`` [m]; with state and operating
    point its ``load_share``, and the gaps [m] left between its drive and its back flanks,
    ``drive_gap`` and ``back_gap``, nan where the pair cannot touch.

    Growth is that of :func:`~thermogear.heat.expansion.flank_growth` whatever flank the ``model``
    has; load share, body, housing and bore are the model's. All teeth are drawn alike: where they
    differ or a gear is eccentric, flanks, shares and gaps are those of the mean tooth
    (:func:`~thermogear.gears.turn.mean_tooth`).
    ``phases`` of the mesh period, one axis; ``fineness`` times as many points.
    """
    model = model.override(flank="growth")
    given, deviations = deviations, mean_tooth(pair, deviations)
    phase = np.asarray(phases, dtype=float)
    hots = {name: HotPair(pair, at, model) for name, at in states.items()}
    first = next(iter(hots.values()))
    half = first.half_backlash
    tight = [
        outline(gear, set_back=-0.25 * pair.normal_backlash, fineness=fineness)
        for gear in (pair.pinion, pair.wheel)
    ]
    shapes = {
        name: [_outlines(hot, gear, deviations, fineness) for gear in (pair.pinion, pair.wheel)]
        for name, hot in hots.items()
    }
    drive = mesh_points(pair, phase)
    gaps = {name: Clearance(hot, phase, deviations).gaps for name, hot in hots.items()}
    lag = np.stack([one.min(axis=-1) for one, _ in gaps.values()])
    drive_gap = np.stack([one for one, _ in gaps.values()]) - lag[..., None]
    back_gap = np.stack([two for _, two in gaps.values()]) + lag[..., None]
    back_gap = back_gap + 2.0 * half[:, None, None]
    share = np.stack([_shares(hot, deviations, phase, drive.s) for hot in hots.values()])
    contact = _places(pair, drive.contacts.pinion, drive.s)
    contact[~np.isfinite(drive.point.gap)] = np.nan
    state, pairs = ("state", "operating"), ("mesh_phase", "contact_pair")
    every = (*state, *pairs)
    curve = ("gear", "outline_point")
    starts, backs = _starts(pair), np.broadcast_to(0.5 * half, (len(hots), half.size))
    distance = np.stack([pair.centre_distance + _opened(hot) for hot in hots.values()])

    def stacked(part: int) -> Floats:
        return np.stack([np.stack([gear[part] for gear in two], axis=1) for two in shapes.values()])

    far, near = stacked(0).max(axis=-1), stacked(0).min(axis=-1)
    clearance = distance[..., None] - far - near[..., ::-1]

    def of_both(name: str) -> Floats:
        return np.array([float(getattr(gear, name)) for gear in (pair.pinion, pair.wheel)])

    cut = 0.5 * float(half[0]) - 0.25 * pair.normal_backlash
    spans = [span_over_teeth(gear, cut) for gear in (pair.pinion, pair.wheel)]
    thick = [
        2.0 * r * (float(gear.half_thickness_angle(r)) - cut / gear.base_radius)
        for gear in (pair.pinion, pair.wheel)
        for r in (gear.pitch_radius,)
    ]
    circles = ("base", "pitch", "tip", "root", "form", "bore")
    angle = pair.operating_pressure_angle
    skipped = sorted({
        kind_in_words(whole)
        for whole, mean in zip(given, deviations, strict=True)
        if not isinstance(mean, FlankShape | Damage | Eccentricity)
    })  # fmt: skip
    return label(
        {
            "tight_radius": (curve, np.stack([one.radius for one in tight]), "m",
                             "radius of the outline that leaves no backlash"),
            "tight_angle": (curve, np.stack([one.angle for one in tight]), "rad",
                            "angle of that outline from the tooth's axis"),
            "outline_radius": ((*state, *curve), stacked(0), "m", "radius of the true outline"),
            "outline_angle": ((*state, *curve), stacked(1), "rad",
                              "angle of the true outline from the tooth's axis"),
            "centre_distance": (state, distance, "m", "centre distance"),
            "tip_clearance": ((*state, "gear"), clearance, "m",
                              "from the gear's tip to the root circle of the other"),
            "set_back": (state, backs, "m",
                         "normal distance of each flank from the one without backlash"),
            "lag": ((*state, "mesh_phase"), lag, "m",
                    "how far the wheel stays behind till the first drive flanks touch"),
            "load_share": (every, share, "1", "share of the normal force on the tooth pair"),
            "drive_gap": (every, _finite(drive_gap), "m", "gap between the pair's drive flanks"),
            "back_gap": (every, _finite(back_gap), "m", "gap between the pair's back flanks"),
            "contact_x": (pairs, contact.real, "m", "place of contact along the line of centres"),
            "contact_y": (pairs, contact.imag, "m", "place of contact across it"),
            "start": ("gear", starts, "rad", "angle of the tooth that enters, at phase 0"),
            "teeth": ("gear", of_both("teeth").astype(np.int64), "1", "number of teeth"),
            "span": ("gear", [one.length for one in spans], "m",
                     "base tangent length over span_teeth, cold, without deviations"),
            "span_teeth": ("gear", [one.teeth for one in spans], "1", "teeth of that length"),
            "thickness": ("gear", thick, "m",
                          "tooth thickness on the pitch circle, cold, without deviations"),
            **{
                f"{name}_radius": ("gear", of_both(f"{name}_radius"), "m", f"{name} radius")
                for name in circles
            },
        },
        {
            "gear": list(NAMES),
            "state": list(hots),
            "mesh_phase": phase,
            "pinion_speed": (("operating",), first.operating.speed),
            "pinion_torque": (("operating",), first.operating.torque),
        },
        {
            "bundle": model.name,
            "drawn_distance": pair.centre_distance,
            "module": pair.pinion.module,
            "operating_pressure_angle": angle,
            "path_points": json.dumps({k.upper(): v for k, v in pair.path._asdict().items()}),
            "line_of_action": pair.line_of_action,
            "not_drawn": ", ".join(skipped),
        },
    )  # fmt: skip


def _finite(gap: Floats) -> Floats:
    return np.where(np.isfinite(gap), gap, np.nan)


def _starts(pair: GearPair) -> Floats:
    """Axes [rad] of the tight teeth whose drive flanks touch at A."""
    wider = 0.25 * pair.normal_backlash
    angle, (p, w) = pair.operating_pressure_angle, (pair.pinion, pair.wheel)
    return np.array(
        [
            (pair.path.a - wider) / p.base_radius - p.base_half_angle - angle,
            math.pi
            + (pair.line_of_action - pair.path.a - wider) / w.base_radius
            - w.base_half_angle
            - angle,
        ]
    )


def _places(pair: GearPair, rho: Floats, s: Floats) -> NDArray[np.complex128]:
    """The pinion's points of string ``rho`` [m] while the involutes meet at ``s``, in the frame."""
    r = pair.pinion.base_radius
    turned = (s - rho) / r - pair.operating_pressure_angle
    return np.asarray((r + 1j * rho) * np.exp(1j * turned))


def _opened(hot: HotPair) -> Floats:
    """What the warm housing moves the axes apart by [m], (count,)."""
    return np.asarray(hot.axis_opening() / math.sin(hot.pair.operating_pressure_angle))


def _outlines(
    hot: HotPair, gear: Gear, deviations: Sequence[Deviation], fineness: int
) -> tuple[Floats, Floats]:
    """(radius, angle) of one gear at every operating point, (count, point)."""
    pair = hot.pair
    found = [
        outline(gear, set_back=back, pair=pair, deviations=deviations, fineness=fineness)
        for back in (0.5 * hot.half_backlash - 0.25 * pair.normal_backlash).tolist()
    ]
    radius = np.stack([one.radius for one in found])
    angle = np.stack([one.angle for one in found])
    far, turned = hot.grown(gear, radius, angle)
    # the ring grows straight outward: along the root land the tooth's own turn fades away
    kept, steps = np.ones(radius.shape[-1]), LAND * fineness + 1
    kept[:steps] = np.linspace(0.0, 1.0, steps)
    kept[-steps:] = np.linspace(1.0, 0.0, steps)
    return far, angle + kept * (turned - angle)


def _shares(hot: HotPair, deviations: Sequence[Deviation], phase: Floats, s: Floats) -> Floats:
    """Share of the load of every candidate pair, (count, phases, pair)."""
    elastic = elastic_pair(hot, tuple(deviations))
    if hot.model.sharing == "loaded":
        return np.asarray(LoadedPair(hot, tuple(deviations)).solve(phase).share)
    path = hot.pair.path
    on = (s >= path.a) & (s < path.e)
    found = np.zeros((hot.count, *s.shape))
    found[:, on] = elastic.share(s[on]).share
    return found
