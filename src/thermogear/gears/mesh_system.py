"""What the loaded contact is solved from: the model's choices, compliances and gaps of a mesh.

Forces on the candidates of contact are >= 0, gaps are >= 0, and one of both is 0: a complementarity
problem with a convex energy, solved by the active set of Lawson and Hanson with Newton's steps for
the Hertzian approach (``sharing_kernel``). Its size is the few tooth pairs that may touch, so that
a direct solve is cheap. A point that does not settle is told as such.
Checked by ``tests/gears/test_sharing_kernel.py``: enumeration of all contact sets, least energy.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import require_choice
from thermogear.gears.candidates import MeshPoints, mesh_points
from thermogear.gears.contact import pair_reduced_modulus, reduced_modulus
from thermogear.gears.corner import flank_ends
from thermogear.gears.deviations import GEARS, Deviation, FlankShape
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair
from thermogear.gears.ring import body_matrices, foot_load
from thermogear.gears.stiffness import (
    CONTACT_LAWS,
    Moduli,
    palmgren_approach,
    yang_sun_stiffness,
)
from thermogear.gears.tooth import STARTS, flank_point, unit_compliance
from thermogear.gears.tooth_damage import Damage, as_damaged, damages_of
from thermogear.gears.tooth_table import MATES, PLANES, tooth_table
from thermogear.gears.touch import Touch, first_touch
from thermogear.gears.turn import ToothShapes

BODIES = {
    "bore_clamped": "ring held at the bore: statics",
    "rim": "the same without its wind-up against the bore: for a lumped dynamic model",
}


_MOST_WIDTHS = 8
"""Half widths at which averaged flanks are asked for: from 0 to 0.4 mm their gap is known to 4 nm
beside a corner of 3 um/mm."""


@dataclass(frozen=True, kw_only=True)
class LoadedModel:
    """The choices of the loaded contact.

    tooth: see :data:`TEETH`; plane: of the solved tooth, see :data:`PLANES`; body: reading of the
    hub, see :data:`BODIES`, by default that of a case file; contact: see :data:`CONTACT_LAWS`;
    start: of the tooth's beam, see :data:`STARTS`; extended: contact on tip corners off the path;
    coupled: a tooth moves under its neighbours' load.

    >>> LoadedModel(contact="palmgren").body
    'rim'
    """

    tooth: str = "solved"
    plane: str = "stress"
    body: str = "rim"
    contact: str = "weber-banaschek"
    start: str = "30-degree"
    extended: bool = True
    coupled: bool = True

    def __post_init__(self) -> None:
        for name, known in (
            ("tooth", TEETH),
            ("plane", PLANES),
            ("body", BODIES),
            ("contact", CONTACT_LAWS),
            ("start", STARTS),
        ):
            require_choice(f"loaded.{name}", getattr(self, name), known)


TEETH = {
    "solved": "finite elements of one sector of the gear, tooth, fillets and body",
    "beam": "beam of the true profile on a ring: Weber and Banaschek with a coupled body",
}


def _beam_on_ring(
    gear: Gear, t: Floats, angle: Floats, direction: int, model: LoadedModel
) -> tuple[Floats, Floats]:
    """Beam compliance (position, pair) and ring compliance (position, pair, pair).

    Unit modulus and width. ``direction`` +1: teeth farther on the path are ahead in the direction
    of their load; ``angle`` [rad], by which the load on a tip's edge is turned, is left out.
    """
    table, centre = body_matrices(gear, windup=model.body == "bore_clamped")
    load = foot_load(gear, t)
    out = np.zeros((*t.shape, t.shape[1]))
    for j, k in np.ndindex(out.shape[1:]):
        if j == k or model.coupled:
            by = load[:, k] @ table[centre + direction * (j - k)].T
            out[:, j, k] = np.einsum("pa,pa->p", load[:, j], by)
    return unit_compliance(gear, t, model.start), out


def _solved(
    gear: Gear, t: Floats, angle: Floats, direction: int, model: LoadedModel
) -> tuple[Floats, Floats]:
    """The same from finite elements, split by where the energy sits."""
    table = tooth_table(gear, model.plane)
    # the mate's normal on an edge is turned from the flank's towards the root
    tooth, body = table.under(t, angle)
    out = np.zeros((*t.shape, t.shape[1]))
    for j, k in np.ndindex(out.shape[1:]):
        if j == k:
            out[:, j, j] = body[:, j]
        elif model.coupled:
            # the load points away from the side that the loaded flank faces
            out[:, j, k] = table.coupled(t[:, j], loaded=t[:, k], lag=-direction * (j - k))
    if model.body == "rim":
        out -= table.windup
    return tooth, out


class Drawn(NamedTuple):
    """What the drawing alone decides of a mesh: unit compliances, what the contact law takes.

    places (position, pair, 7): see :func:`~thermogear.gears.sharing_kernel._approach`.
    """

    tooth: Floats
    body: Floats
    places: Floats


@lru_cache(maxsize=32)
def as_drawn(
    pair: GearPair,
    phases: bytes,
    flank: str,
    model: LoadedModel,
    damages: tuple[Damage, ...] = (),
) -> Drawn:
    """Remembered: a heat balance, a row of temperatures, a sweep ask for the same places."""
    points = mesh_points(pair, np.frombuffer(phases), flank, model.extended)
    points = as_damaged(points, damages, model.extended)
    at = points.point
    gears, strings = (pair.pinion, pair.wheel), (at.pinion, at.wheel)
    # a candidate that misses the flank (it never carries) at its end
    parameters = [
        np.clip(rho, *ends) / gear.base_radius
        for gear, rho, ends in zip(gears, strings, flank_ends(pair), strict=True)
    ]
    radius = np.maximum(
        strings[0] * strings[1] / (strings[0] + strings[1]), 1e-3 * pair.pinion.module
    )
    flanks = [flank_point(gear, t) for gear, t in zip(gears, parameters, strict=True)]
    depths = [p.x / np.cos(p.beta) for p in flanks]
    places = np.stack([*depths, radius, at.rounding, at.angle, at.distance, at.lever], axis=-1)
    compliance = _solved if model.tooth == "solved" else _beam_on_ring
    angles = [
        np.where((rho == ends[1]) | (points.broken == edge), at.angle, 0.0)
        for rho, ends, edge in zip(strings, flank_ends(pair), (2, 1), strict=True)
    ]
    # the pinion's load points against its rotation, the wheel's along it
    parts = [
        compliance(gear, t, angle, sign, model)
        for gear, t, angle, sign in zip(gears, parameters, angles, (-1, 1), strict=True)
    ]
    for damage in damages:
        i = GEARS.index(damage.gear)
        more = damage.softer(points.contacts, parameters[i], angles[i], model.plane)
        parts[i] = parts[i][0] + more[0], parts[i][1] + more[1]
    tooth, body = (np.stack(part) for part in zip(*parts, strict=True))
    lever = at.lever[..., None]
    return Drawn(tooth / at.lever**2, body / (lever * at.lever[..., None, :]), places)


def _with_damages(
    points: MeshPoints,
    sound: Drawn,
    place: NDArray[np.int64],
    damages: tuple[Damage, ...],
    model: LoadedModel,
) -> tuple[Drawn, NDArray[np.int64]]:
    """``sound`` and behind it what damaged teeth change, and the place of each position in both.

    A place is one fraction of a mesh period and, of each damage, how far its tooth is: it comes
    again with every turn of that gear, and where no damage is felt it is that of sound teeth.
    """
    contacts = points.contacts
    pitches = np.stack([damage.pitches(contacts) for damage in damages], axis=1)
    felt = np.any(np.abs(pitches) <= MATES, axis=2)
    far = 1 + max(contacts.pair.pinion.teeth, contacts.pair.wheel.teeth)
    rows = np.flatnonzero(np.any(felt, axis=1))
    states = np.column_stack([place, np.where(felt, pitches[:, :, 0], far)])[rows]
    if not rows.size:
        return sound, place
    _, first, which = np.unique(states, axis=0, return_index=True, return_inverse=True)
    phases = contacts.phase[rows[first]].tobytes()
    damaged = as_drawn(contacts.pair, phases, contacts.flank, model, damages)
    place = place.copy()
    place[rows] = len(sound.places) + np.ravel(which)
    tooth, body = (np.concatenate(two, axis=1) for two in zip(sound[:2], damaged[:2], strict=True))
    return Drawn(tooth, body, np.concatenate([sound.places, damaged.places])), place


@dataclass(frozen=True, eq=False, kw_only=True)
class MeshSystem:
    """The compliances and gaps of a mesh at its positions: what the kernel solves.

    Built once for a pair, its phases, moduli and deviations; ``lead`` is the shape those (and
    ``shape``, that of the loads) broadcast to. ``tooth``, ``body`` and ``places`` belong to the
    fractions of the phases alone; ``place``: which of them each position has.
    """

    pair: GearPair
    points: MeshPoints
    lead: tuple[int, ...]
    gaps: Floats
    edges: NDArray[np.int8]
    tooth: Floats
    body: Floats
    places: Floats
    place: NDArray[np.int64]
    tooth_modulus: Floats
    body_modulus: Floats
    reduced: Floats
    law: str

    @classmethod
    def of(
        cls,
        pair: GearPair,
        *,
        shape: tuple[int, ...],
        phase: ArrayLike,
        moduli: tuple[Moduli, Moduli],
        deviations: Sequence[Deviation],
        model: LoadedModel,
        flank: str,
        load: ArrayLike = 0.0,
        damage: Damage | None = None,
        touch: Touch | None = None,
    ) -> MeshSystem:
        """Geometry, unit compliances and gaps; see :func:`loaded_contact` for the arguments.

        load [N]: its Hertzian half width averages the flanks' shapes; touch: of all deviations,
        where it is known; damage: one beside those among the deviations.
        """
        damages = damages_of(deviations if damage is None else (*deviations, damage))
        points = mesh_points(pair, phase, flank, model.extended)
        once, place = points.fractions
        drawn = as_drawn(pair, once.contacts.phase.tobytes(), flank, model)
        if damages:
            points = as_damaged(points, damages, model.extended)
            drawn, place = _with_damages(points, drawn, place, damages, model)
        positions, count = points.s.shape
        gap, edge = touch or _pressed_touch(points, deviations, load)
        lead = np.broadcast_shapes(
            shape, gap.shape[:-2], *(np.shape(e) for m in moduli for e in (m.tooth, m.body))
        )
        cases = int(np.prod(lead, dtype=np.int64))
        whole = (cases, positions, count)
        gaps, edges = (
            one[None]
            if gap.ndim == 2
            else np.broadcast_to(one, (*lead, positions, count)).reshape(whole)
            for one in (gap, edge)
        )

        tooth_modulus = np.stack([flat(m.tooth, lead=lead) for m in moduli], axis=-1)
        return cls(
            pair=pair,
            points=points,
            lead=lead,
            gaps=np.ascontiguousarray(gaps, dtype=float),
            edges=np.asarray(edges, dtype=np.int8),
            tooth=drawn.tooth,
            body=drawn.body,
            places=drawn.places,
            place=place,
            tooth_modulus=tooth_modulus,
            body_modulus=np.stack([flat(m.body, lead=lead) for m in moduli], axis=-1),
            reduced=reduced_modulus(
                tooth_modulus[:, 0],
                pair.pinion.material.poisson_ratio,
                tooth_modulus[:, 1],
                pair.wheel.material.poisson_ratio,
            ),
            law=model.contact,
        )

    def with_touch(self, touch: Touch) -> MeshSystem:
        """The same cases with other gaps and edges, (case, position, pair)."""
        return replace(self, gaps=np.ascontiguousarray(touch.gap), edges=touch.edge)

    def solve(self, loads: Floats) -> tuple[Floats, Floats, Floats, NDArray[np.bool_]]:
        """(force, deflection, tangent stiffness, settled) under ``loads`` F_n [N] > 0.

        loads: one a case, shape (case,). Returns shapes (case, position[, pair]).
        """
        from thermogear.gears.sharing_kernel import share_many

        width = self.pair.face_width
        nu = [g.material.poisson_ratio for g in (self.pair.pinion, self.pair.wheel)]
        cases, (positions, count) = loads.size, self.points.s.shape
        force = np.empty((cases, positions, count))
        delta, stiffness = np.empty((2, cases, positions))
        settled = np.empty((cases, positions), dtype=np.bool_)
        share_many(
            loads,
            self.gaps,
            self.tooth,
            self.body,
            self.places,
            self.place,
            1.0 / (self.tooth_modulus * width),
            1.0 / (self.body_modulus * width),
            4.0 / (np.pi * width * self.reduced),
            _contact_coefficients(self.law, self.tooth_modulus, nu, self.reduced, width),
            force,
            delta,
            stiffness,
            settled,
        )
        return force, delta, stiffness, settled


def _pressed_touch(points: MeshPoints, deviations: Sequence[Deviation], load: ArrayLike) -> Touch:
    """Gaps and edges of flanks averaged over the half width of each ``load`` [N], (*lead, ...).

    Of more than :data:`_MOST_WIDTHS` loads the gaps are interpolated in the half width, which the
    mean of a corner follows in proportion.
    """
    if not any(isinstance(d, FlankShape | ToothShapes) for d in deviations):
        return first_touch(points, deviations)
    pair = points.contacts.pair
    roots = np.sqrt(pressed_spread(pair, load))
    nodes = np.unique(roots)
    if nodes.size > _MOST_WIDTHS:
        nodes = np.linspace(nodes[0], nodes[-1], _MOST_WIDTHS)
    touches = [first_touch(points, deviations, float(root) ** 2) for root in nodes]
    gap, edge = touches[0]
    for low, high, touch in zip(nodes[:-1], nodes[1:], touches[1:], strict=True):
        part = np.clip((roots - low) / (high - low), 0.0, 1.0)[..., None, None]
        with np.errstate(invalid="ignore"):  # what never touches has no share of it
            between = (1.0 - part) * gap + part * touch.gap
        gap = np.where(part == 0.0, gap, np.where(part == 1.0, touch.gap, between))
        edge = np.where(part < 0.5, edge, touch.edge)
    return Touch(gap, edge)


def pressed_spread(pair: GearPair, load: ArrayLike) -> Floats:
    """4 F/(pi b E*) [m] of each ``load`` [N], with cold moduli: see ``first_touch``.

    >>> from thermogear import Gear
    >>> pair = GearPair(Gear(20, 3e-3), Gear(40, 3e-3))
    >>> (pressed_spread(pair, [1e3, 2e3]) / pressed_spread(pair, 1e3)).tolist()
    [1.0, 2.0]
    """
    softness = 4.0 / (np.pi * pair.face_width * pair_reduced_modulus(pair))
    return np.asarray(softness * np.asarray(load, dtype=float))


def flat(values: ArrayLike, *, lead: tuple[int, ...]) -> Floats:
    """``values`` broadcast to ``lead``, one axis of cases.

    >>> flat(2e9, lead=(3,))
    array([2.e+09, 2.e+09, 2.e+09])
    """
    return np.ascontiguousarray(
        np.broadcast_to(np.asarray(values, dtype=float), lead).reshape(-1), dtype=float
    )


def _contact_coefficients(
    law: str, modulus: Floats, nu: Sequence[float], reduced: Floats, width: float
) -> Floats:
    """[case, 6]: what the kernel's contact takes."""
    out = np.zeros((modulus.shape[0], 6))
    if law == "weber-banaschek":
        for i in range(2):
            out[:, i] = 2.0 * (1.0 - nu[i] ** 2) / (np.pi * modulus[:, i] * width)
            out[:, 2 + i] = nu[i] / (1.0 - nu[i])
    elif law == "palmgren":
        out[:, 4] = palmgren_approach(1.0, reduced, width)
    else:
        out[:, 5] = 1.0 / yang_sun_stiffness(reduced, width)
    return out
