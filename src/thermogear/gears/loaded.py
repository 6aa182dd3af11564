"""Loaded tooth contact: shares, static transmission error and stiffness of a coupled mesh.

Tooth beams from the true profile, gear bodies as clamped rings that couple neighbouring
teeth, Hertzian contact, deviations of every flank and contact on tip corners, for any number
of positions, loads and temperatures in one call.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.base.vocabulary import STATUS, edge_attributes, label, status_attributes
from thermogear.gears.candidates import MeshPoints
from thermogear.gears.contact import hertz_pressure
from thermogear.gears.deviations import Deviation
from thermogear.gears.mesh_system import BODIES, LoadedModel, MeshSystem, flat
from thermogear.gears.pair import GearPair
from thermogear.gears.stiffness import Moduli
from thermogear.gears.tooth_damage import Damage
from thermogear.gears.touch import first_touch

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "BODIES",
    "LEAST_LINE_LOAD",
    "LoadedMesh",
    "LoadedModel",
    "loaded_contact",
    "solve_mesh",
]


LEAST_LINE_LOAD = 1e3
"""Line load [N/m] below which stiffness and shares are those at this load (1 N/mm)."""


class LoadedMesh(NamedTuple):
    """Solution arrays: lead is the broadcast shape of load, moduli and deviations.

    deflection [m], tangent [N/m], settled: (*lead, position); force [N], share, pressure [Pa],
    edge: (*lead, position, pair); points: the candidates; carried [N]: load of tangent and share;
    elastic [m]: deflection under it; deviations: those of the flanks. ``force`` is the part of the
    load that a pair carries: off the path the force on the edge is that over its lever
    (:class:`~thermogear.gears.corner.ContactPoint`). ``edge`` is a place in
    :data:`~thermogear.base.vocabulary.EDGE_CONTACT`; where it is not 0 the pressure is nan: Hertz's
    formula for two involutes says nothing about a corner.
    """

    deflection: Floats
    tangent: Floats
    settled: NDArray[np.bool_]
    force: Floats
    share: Floats
    pressure: Floats
    edge: NDArray[np.int8]
    points: MeshPoints
    carried: Floats
    elastic: Floats
    deviations: Sequence[Deviation]

    @property
    def unloaded(self) -> Floats:
        """Advance [m] of the pinion at first touch, without load, (*lead, position)."""
        gap = first_touch(self.points, self.deviations).gap
        return np.array(np.broadcast_to(gap.min(axis=-1), self.elastic.shape))

    @property
    def secant(self) -> Floats:
        """Load over the deflection from first touch [N/m], (*lead, position)."""
        return np.asarray(self.carried / (self.elastic - self.unloaded))

    @property
    def edge_share(self) -> Floats:
        """Share of the positions at which a tip corner carries load, shape ``lead``."""
        return np.asarray((self.edge > 0).any(axis=-1).mean(axis=-1))

    @property
    def effective_ratio(self) -> Floats:
        """Effective contact ratio: mean number of tooth pairs that carry, shape ``lead``.

        Over the positions of one mesh period, each as long as the next, that is the length of path
        on which a pair carries over the base pitch, what tip corners carry beyond A and E
        included. Above the nominal ratio (E - A)/p_b where corners carry, below it where a gap
        keeps the ends of the path free. To 1/positions for each end.
        """
        return np.asarray((self.share > 0.0).sum(axis=-1).mean(axis=-1))

    @property
    def corner_load(self) -> Floats:
        """Greatest share of the load on a tip corner of pinion and wheel, shape (*lead, 2)."""
        return np.stack(
            [np.where(self.edge & bit, self.share, 0.0).max(axis=(-2, -1)) for bit in (2, 1)],
            axis=-1,
        )

    @property
    def corner_part(self) -> Floats:
        """Share of the positions at which that corner carries, of pinion and wheel, (*lead, 2)."""
        return np.stack(
            [((self.edge & bit) > 0).any(axis=-1).mean(axis=-1) for bit in (2, 1)], axis=-1
        )

    def wider(self, times: Floats) -> LoadedMesh:
        """The same deflections of pairs ``times`` as wide under as much more load, each a case."""
        curve, pairs = times[..., None], times[..., None, None]
        return self._replace(
            tangent=self.tangent * curve, carried=self.carried * curve, force=self.force * pairs
        )

    def checked(self) -> LoadedMesh:
        """The same where every position settled; raises ConvergenceError where one did not."""
        lost = int(np.count_nonzero(~self.settled))
        if lost:
            raise ConvergenceError(
                f"loaded contact: {lost} of {self.settled.size} positions did not settle"
            )
        return self


def solve_mesh(
    pair: GearPair,
    normal_force: ArrayLike,
    phase: ArrayLike,
    *,
    pinion: Moduli | None = None,
    wheel: Moduli | None = None,
    deviations: Sequence[Deviation] = (),
    model: LoadedModel | None = None,
    flank: str = "drive",
    mean_load: ArrayLike | None = None,
    damage: Damage | None = None,
) -> LoadedMesh:
    """The arrays behind :func:`loaded_contact`, which says what they mean.

    mean_load [N]: that whose half width averages the shapes of the flanks, by default each load;
    damage: a crack or a chip of one tooth (:mod:`~thermogear.gears.tooth_damage`).

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{solve_mesh(pair, 4e3, [0.0]).force.sum():.3f} N"
    '4000.000 N'
    """
    load = np.asarray(normal_force, dtype=float)
    if not np.all(np.isfinite(load) & (load >= 0.0)):
        raise InputError("normal_force", f"{load} N", allowed=">= 0, finite")
    moduli = (pinion or Moduli.of(pair.pinion), wheel or Moduli.of(pair.wheel))
    system = MeshSystem.of(
        pair,
        shape=load.shape,
        phase=phase,
        moduli=moduli,
        deviations=deviations,
        model=model or LoadedModel(),
        flank=flank,
        load=load if mean_load is None else mean_load,
        damage=damage,
    )
    lead, width = system.lead, pair.face_width
    asked = flat(load, lead=lead)
    carried = np.where(asked == 0.0, LEAST_LINE_LOAD * width, asked)
    force, delta, stiffness, settled = system.solve(carried)

    share = force / carried[:, None, None]
    idle = settled & (asked == 0.0)[:, None]
    force[idle] = 0.0
    edge = system.edges * (force > 0.0)
    radius = system.places[system.place, :, 2]
    pressure = hertz_pressure(force / width, radius, system.reduced[:, None, None])
    pressure[edge > 0] = np.nan

    def shaped(values: Floats) -> Floats:
        return values.reshape(*lead, *values.shape[1:])

    mesh = LoadedMesh(
        shaped(delta),
        shaped(stiffness),
        settled.reshape(*lead, *settled.shape[1:]),
        shaped(force),
        shaped(share),
        shaped(pressure),
        edge.reshape(*lead, *edge.shape[1:]),
        system.points,
        shaped(carried[:, None]),
        shaped(delta),
        tuple(deviations),
    )
    if not idle.any():
        return mesh
    return mesh._replace(deflection=np.where(shaped(idle), mesh.unloaded, mesh.elastic))


DIMENSIONS = ((), ("operating",), ("temperature", "load"))
_MEANING = {
    "transmission_error": ("m", "static transmission error under load"),
    "unloaded_error": ("m", "transmission error at first touch, without load"),
    "tangent_stiffness": ("N/m", "tangent mesh stiffness dF/d(deflection)"),
    "secant_stiffness": ("N/m", "secant mesh stiffness, load over elastic deflection"),
    "contact_pairs": ("1", "number of tooth pairs that carry load"),
    "pair_force": ("N", "normal force of the tooth pair"),
    "load_share": ("1", "share of the normal force on the tooth pair"),
    "contact_pressure": (
        "Pa",
        "greatest Hertzian pressure of the tooth pair; not valid (nan) in edge contact",
    ),
    "edge_contact_share": ("1", "share of the mesh period in which a tip corner carries load"),
    "corner_period_share": ("1", "share of the mesh period in which this gear's corner carries"),
    "corner_load_share": ("1", "greatest share of the load on a tip corner of this gear"),
    "effective_contact_ratio": ("1", "mean number of tooth pairs that carry"),
    "pair_position": ("m", "distance of the pair from the pinion's tangent point"),
    "mean_stiffness": ("N/m", "tangent mesh stiffness, mean over the positions"),
    "double_contact_length": ("m", "length of path on which two or more pairs carry"),
    "normal_force": ("N", "normal force of the mesh"),
    "mesh_phase": ("1", "mesh phase in periods, 0 where a pair enters at A"),
}


def loaded_contact(
    pair: GearPair,
    normal_force: ArrayLike,
    phase: int | ArrayLike = 200,
    *,
    pinion: Moduli | None = None,
    wheel: Moduli | None = None,
    deviations: Sequence[Deviation] = (),
    model: LoadedModel | None = None,
    flank: str = "drive",
    dimensions: Sequence[str] | None = None,
) -> xr.Dataset:
    """Loaded tooth contact over mesh position x load x temperature.

    At each position the pairs j = -1 .. ceil(contact ratio) share F_n = sum F_j so that

        sum_k C_jk F_k + delta_H(F_j) + e_j = delta  (F_j > 0),   >= delta  (F_j = 0),

    C: teeth and bodies of both gears, coupled between teeth; delta_H: contact law; e_j: gap
    by deviations and, off the path, by the tip corner.

    normal_force: F_n [N] >= 0, shape ``lead``; phase: a number of uniform positions of one
    mesh period, or phases in periods (any real; whole periods choose the teeth); pinion,
    wheel: moduli whose arrays broadcast with the load, e.g. temperature in shape (n, 1);
    deviations: added up, their leading axes broadcast too; model: see :class:`LoadedModel`;
    flank: "drive" or "back"; dimensions: names of the leading axes, by default none,
    ("operating",) or ("temperature", "load").

    Returns a Dataset with axes (*lead, mesh_phase[, pair]). Outputs are kept apart:
    ``transmission_error`` delta (with the elastic deflection); ``unloaded_error`` min e_j;
    ``tangent_stiffness`` 1^T J^-1 1 over the loaded pairs, J the Jacobian of the left side;
    ``secant_stiffness`` F_n/(delta - min e_j); shares, forces, pressures per pair. A load of 0
    leaves forces and pressures 0 and delta unloaded, with stiffness and shares those at
    1 N/mm. A position that does not settle has status not_converged and nan values.

    Where a tip corner carries, ``edge_contact`` says whose it is and the
    pressure is nan: Hertz's curvature of two involutes does not hold on an edge, whose pressure
    is several times higher. ``edge_contact_share`` is the share of the positions with such a
    corner; ``corner_period_share`` and ``corner_load_share``, the greatest share of the load on
    it, are each gear's, nan where undercut ends the path, whose edge is not told from the mate's
    tip corner. Forces and stiffness there are those of a narrow contact
    (:func:`~thermogear.gears.sharing_kernel._half_width`) whose force acts along the normal of the
    flank it touches. ``effective_contact_ratio``: :attr:`LoadedMesh.effective_ratio`.

    Plane stress body and plane strain contact; the band between all plane stress and all plane
    strain is -2.6 .. +4.3 % in stiffness.
    The default body "rim" leaves the hub's torsion to the inertia, as a case file does; held at
    the bore ("bore_clamped", statics) the same load turns the gears farther by a constant.
    With solved teeth, finite elements of whole gears held there, computed apart, agree within 1 %
    at every phase for seven pairs of 14:37 to 28:100 teeth with 20 and 25 degrees, tip corners,
    relief and heat among them (``tests/gears/test_tooth_truth.py``); with the beam on a ring within
    5 %. Raises InputError for loads < 0 and deviations that do not fit the gears.
    Source: Weber & Banaschek 1953; cyclic finite elements; gaps of tip corners exact.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> contact = loaded_contact(pair, 4e3, 32)
    >>> f"{1e-6 * contact.mean_stiffness:.0f} N/um"
    '393 N/um'
    """
    import xarray as xr

    choice = LoadedModel() if model is None else model
    if isinstance(phase, int | np.integer):
        if phase < 1:
            raise InputError("phase", phase, allowed="one position or more")
        phi = np.arange(phase) / phase
    else:
        phi = np.atleast_1d(np.asarray(phase, dtype=float))
    mesh = solve_mesh(
        pair,
        normal_force,
        phi,
        pinion=pinion,
        wheel=wheel,
        deviations=deviations,
        model=choice,
        flank=flank,
    )
    lead, unloaded = mesh.deflection.shape[:-1], mesh.unloaded
    names = tuple(
        dimensions
        if dimensions is not None
        else DIMENSIONS[len(lead)]
        if len(lead) < len(DIMENSIONS)
        else (f"axis_{i}" for i in range(len(lead)))
    )
    if len(names) != len(lead):
        raise InputError("dimensions", names, allowed=f"{len(lead)} names, one for each axis")
    loaded, settled = (mesh.share > 0.0).sum(axis=-1), mesh.settled.all(axis=-1)
    # an undercut's edge is not told from the mate's tip corner
    by_gear, every = (*names, "gear"), np.array(settled & (not pair.cut_short))[..., None]
    along, by_pair = (*names, "mesh_phase"), (*names, "mesh_phase", "pair")
    values: dict[str, tuple[tuple[str, ...], ArrayLike]] = {
        "transmission_error": (along, mesh.deflection),
        "unloaded_error": (along, unloaded),
        "tangent_stiffness": (along, mesh.tangent),
        "secant_stiffness": (along, mesh.carried / (mesh.elastic - unloaded)),
        "contact_pairs": (along, loaded),
        "pair_force": (by_pair, mesh.force),
        "load_share": (by_pair, mesh.share),
        "contact_pressure": (by_pair, mesh.pressure),
        "mean_stiffness": (names, mesh.tangent.mean(axis=-1)),
        "double_contact_length": (
            names,
            np.where(settled, (loaded > 1).mean(axis=-1), np.nan) * pair.base_pitch,
        ),
        "edge_contact_share": (names, np.where(settled, mesh.edge_share, np.nan)),
        "effective_contact_ratio": (names, np.where(settled, mesh.effective_ratio, np.nan)),
        "corner_period_share": (by_gear, np.where(every, mesh.corner_part, np.nan)),
        "corner_load_share": (by_gear, np.where(every, mesh.corner_load, np.nan)),
        "pair_position": (("mesh_phase", "pair"), mesh.points.s),
    }
    coordinates: dict[str, tuple[tuple[str, ...], ArrayLike]] = {
        "mesh_phase": (("mesh_phase",), phi),
        "normal_force": (names, np.broadcast_to(np.asarray(normal_force, dtype=float), lead)),
    }

    def dressed(name: str) -> dict[str, str]:
        units, words = _MEANING[name]
        return {"units": units, "long_name": words}

    status = np.where(mesh.settled, STATUS.index("ok"), STATUS.index("not_converged"))
    flags = {
        "status": xr.Variable(along, status.astype(np.int8), status_attributes()),
        "edge_contact": xr.Variable(by_pair, mesh.edge, edge_attributes()),
    }
    return label(
        {k: xr.Variable(d, v, dressed(k)) for k, (d, v) in values.items()} | flags,
        {k: xr.Variable(d, v, dressed(k)) for k, (d, v) in coordinates.items()}
        | {"gear": xr.Variable("gear", ["pinion", "wheel"], {"long_name": "gear"})},
        {
            "body": choice.body,
            "contact": choice.contact,
            "start": choice.start,
            "extended": int(choice.extended),
            "coupled": int(choice.coupled),
            "flank": flank,
            "contact_ratio": pair.contact_ratio,
        },
    )
