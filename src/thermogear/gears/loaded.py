"""Loaded tooth contact: shares, static transmission error and stiffness of a coupled mesh.

Tooth beams from the true profile, gear bodies as clamped rings that couple neighbouring
teeth, Hertzian contact, deviations of every flank and contact on tip corners, for any number
of positions, loads and temperatures in one call.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import InputError, nearest
from thermogear.gears.candidates import MeshPoints, mesh_points
from thermogear.gears.contact import hertz_pressure, reduced_modulus
from thermogear.gears.contact_compliance import (
    CONTACT_LAWS,
    palmgren_approach,
    yang_sun_stiffness,
)
from thermogear.gears.deviations import Deviation
from thermogear.gears.geometry import Gear, GearPair
from thermogear.gears.ring import body_matrices, foot_load
from thermogear.gears.stiffness import Moduli
from thermogear.gears.tooth import STARTS, flank_point, tooth_compliances

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]

BODIES = {
    "bore_clamped": "ring held at the bore: statics",
    "rim": "the same without its wind-up against the bore: for a lumped dynamic model",
}
LEAST_LINE_LOAD = 1e3
"""Line load [N/m] below which stiffness and shares are those at this load (1 N/mm)."""

_DEGREE = 48


@dataclass(frozen=True)
class LoadedModel:
    """The choices of the loaded contact.

    body: reading of the hub, see :data:`BODIES`; contact: see :data:`CONTACT_LAWS`; start: of
    the tooth's beam, see :data:`STARTS`; extended: contact on tip corners off the path;
    coupled: a tooth moves under its neighbours' load.
    """

    body: str = "bore_clamped"
    contact: str = "weber-banaschek"
    start: str = "30-degree"
    extended: bool = True
    coupled: bool = True

    def __post_init__(self) -> None:
        for name, known in (("body", BODIES), ("contact", CONTACT_LAWS), ("start", STARTS)):
            value = getattr(self, name)
            if value not in known:
                raise InputError(
                    f"loaded.{name}",
                    repr(value),
                    allowed=" | ".join(known),
                    fix=nearest(str(value), known),
                )


@lru_cache(maxsize=256)
def _tooth_series(gear: Gear, start: str) -> tuple[Floats, tuple[float, float]]:
    """Chebyshev series of the beam compliance for unit modulus and width over the flank."""
    low = gear.junction[1]
    high = float(np.tan(gear.pressure_angle_at(gear.tip_radius)))
    # 0.5 % beyond the flank's ends, where rounding may put a tip corner
    margin = 5e-3 * (high - low)
    span = (max(low - margin, 0.0), high + margin)

    nodes = chebyshev.chebpts1(_DEGREE + 1)
    t = 0.5 * (span[0] + span[1]) + 0.5 * (span[1] - span[0]) * nodes
    values = tooth_compliances(gear, t, start, modulus=1.0, face_width=1.0).total
    return np.asarray(chebyshev.chebfit(nodes, values, _DEGREE)), span


def _tooth_unit(gear: Gear, t: Floats, start: str) -> Floats:
    series, (low, high) = _tooth_series(gear, start)
    x = np.clip((2.0 * t - low - high) / (high - low), -1.0, 1.0)
    return np.asarray(chebyshev.chebval(x, series))


def _body_unit(gear: Gear, t: Floats, direction: int, model: LoadedModel) -> Floats:
    """Ring compliance between the candidates for unit modulus and width, (position, pair, pair).

    ``direction`` +1: teeth farther on the path stand ahead in the direction of their load.
    """
    table, centre = body_matrices(gear, windup=model.body == "bore_clamped")
    load = foot_load(gear, t)
    count = t.shape[1]
    out = np.zeros((*t.shape, count))
    for j in range(count):
        for k in range(count):
            if j == k or model.coupled:
                by = load[:, k] @ table[centre + direction * (j - k)].T
                out[:, j, k] = np.einsum("pa,pa->p", load[:, j], by)
    return out


class LoadedMesh(NamedTuple):
    """Solution arrays: lead is the broadcast shape of load, moduli and deviations.

    deflection, unloaded [m], tangent, secant [N/m], settled: (*lead, position); force [N],
    share, pressure [Pa]: (*lead, position, pair); points: the candidates.
    """

    deflection: Floats
    unloaded: Floats
    tangent: Floats
    secant: Floats
    settled: NDArray[np.bool_]
    force: Floats
    share: Floats
    pressure: Floats
    points: MeshPoints


@dataclass(frozen=True, eq=False)
class MeshSystem:
    """The compliances and gaps of a mesh at its positions: what the kernel solves.

    Built once for a pair, its phases, moduli and deviations; ``lead`` is the shape those (and
    ``shape``, that of the loads) broadcast to.
    """

    pair: GearPair
    points: MeshPoints
    lead: tuple[int, ...]
    gaps: Floats
    tooth: Floats
    body: Floats
    depth: Floats
    radius: Floats
    tooth_modulus: Floats
    body_modulus: Floats
    reduced: Floats
    law: str

    @classmethod
    def of(
        cls,
        pair: GearPair,
        shape: tuple[int, ...],
        phase: ArrayLike,
        moduli: tuple[Moduli, Moduli],
        deviations: Sequence[Deviation],
        model: LoadedModel,
        flank: str,
    ) -> MeshSystem:
        """Geometry, unit compliances and gaps; see :func:`loaded_contact` for the arguments."""
        points = mesh_points(pair, phase, flank, model.extended)
        positions, count = points.s.shape
        gears = (pair.pinion, pair.wheel)
        gap = points.point.gap
        for deviation in deviations:
            gap = gap + deviation.gap(points.contacts)
        lead = np.broadcast_shapes(
            shape, gap.shape[:-2], *(np.shape(e) for m in moduli for e in (m.tooth, m.body))
        )
        cases = int(np.prod(lead, dtype=np.int64))
        if gap.ndim == 2:
            gaps = gap[None]
        else:
            gaps = np.broadcast_to(gap, (*lead, positions, count)).reshape(cases, positions, count)

        strings = (points.point.pinion, points.point.wheel)
        parameters = [rho / gear.base_radius for gear, rho in zip(gears, strings, strict=True)]
        nu = [gear.material.poisson_ratio for gear in gears]
        depth = np.empty((2, positions, count))
        for i, (gear, t) in enumerate(zip(gears, parameters, strict=True)):
            at = flank_point(gear, t)
            # a candidate whose corner misses the flank has no depth; it never carries
            h = np.maximum(at.x / np.cos(at.beta), 1e-3 * gear.module)
            depth[i] = np.log(2.0 * h) - nu[i] / (2.0 * (1.0 - nu[i]))
        tooth_modulus = np.stack([_flat(m.tooth, lead) for m in moduli], axis=-1)
        return cls(
            pair=pair,
            points=points,
            lead=lead,
            gaps=np.ascontiguousarray(gaps),
            tooth=np.stack(
                [_tooth_unit(g, t, model.start) for g, t in zip(gears, parameters, strict=True)]
            ),
            # the pinion's load points against its rotation, the wheel's along it
            body=np.stack(
                [
                    _body_unit(g, t, sign, model)
                    for g, t, sign in zip(gears, parameters, (-1, 1), strict=True)
                ]
            ),
            depth=depth,
            radius=np.maximum(
                strings[0] * strings[1] / (strings[0] + strings[1]), 1e-3 * pair.pinion.module
            ),
            tooth_modulus=tooth_modulus,
            body_modulus=np.stack([_flat(m.body, lead) for m in moduli], axis=-1),
            reduced=reduced_modulus(tooth_modulus[:, 0], nu[0], tooth_modulus[:, 1], nu[1]),
            law=model.contact,
        )

    def solve(
        self, asked: Floats, by_load: bool
    ) -> tuple[Floats, Floats, Floats, NDArray[np.bool_]]:
        """(force, deflection, tangent stiffness, settled) for loads > 0 or for deflections.

        asked: one value a case, shape (case,). Returns shapes (case, position[, pair]).
        """
        from thermogear.gears.sharing_kernel import share_many

        width = self.pair.face_width
        nu = [g.material.poisson_ratio for g in (self.pair.pinion, self.pair.wheel)]
        cases, (positions, count) = asked.size, self.points.s.shape
        force = np.empty((cases, positions, count))
        delta = np.empty((cases, positions))
        stiffness = np.empty((cases, positions))
        settled = np.empty((cases, positions), dtype=np.bool_)
        share_many(
            asked,
            by_load,
            self.gaps,
            self.tooth,
            self.body,
            self.depth,
            np.log(4.0 * self.radius),
            1.0 / (self.tooth_modulus * width),
            1.0 / (self.body_modulus * width),
            _contact_coefficients(self.law, self.tooth_modulus, nu, self.reduced, width),
            force,
            delta,
            stiffness,
            settled,
        )
        return force, delta, stiffness, settled


def _flat(values: ArrayLike, lead: tuple[int, ...]) -> Floats:
    """``values`` broadcast to ``lead``, one axis of cases."""
    return np.ascontiguousarray(
        np.broadcast_to(np.asarray(values, dtype=float), lead).reshape(-1), dtype=float
    )


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
) -> LoadedMesh:
    """The arrays behind :func:`loaded_contact`, which says what they mean."""
    load = np.asarray(normal_force, dtype=float)
    if not np.all(np.isfinite(load) & (load >= 0.0)):
        raise InputError("normal_force", f"{load} N", allowed=">= 0, finite")
    moduli = (pinion or Moduli.of(pair.pinion), wheel or Moduli.of(pair.wheel))
    system = MeshSystem.of(
        pair, load.shape, phase, moduli, deviations, model or LoadedModel(), flank
    )
    lead, width = system.lead, pair.face_width
    asked = _flat(load, lead)
    carried = np.where(asked == 0.0, LEAST_LINE_LOAD * width, asked)
    force, delta, stiffness, settled = system.solve(carried, by_load=True)

    share = force / carried[:, None, None]
    force[asked == 0.0] = 0.0
    unloaded = np.broadcast_to(system.gaps.min(axis=-1), delta.shape)
    secant = carried[:, None] / (delta - unloaded)
    delta = np.where(asked[:, None] == 0.0, unloaded, delta)
    pressure = hertz_pressure(force / width, system.radius, system.reduced[:, None, None])

    def shaped(values: Floats) -> Floats:
        return values.reshape(*lead, *values.shape[1:])

    return LoadedMesh(
        shaped(delta),
        shaped(np.array(unloaded)),
        shaped(stiffness),
        shaped(secant),
        settled.reshape(*lead, *settled.shape[1:]),
        shaped(force),
        shaped(share),
        shaped(pressure),
        system.points,
    )


def mesh_force(
    pair: GearPair,
    deflection: ArrayLike,
    phase: ArrayLike,
    *,
    pinion: Moduli | None = None,
    wheel: Moduli | None = None,
    deviations: Sequence[Deviation] = (),
    model: LoadedModel | None = None,
    flank: str = "drive",
) -> tuple[Floats, Floats]:
    """Load-shared force of one flank side at a given deflection: the inverse of the mesh.

    F = sum_j F_j,  sum_k C_jk F_k + delta_H(F_j) + e_j = delta  (F_j > 0),  >= delta  (else)

    Every tooth pair comes into and out of contact by itself, which the one spring
    k(t) f(x) cannot show.

    deflection: delta [m], shape ``lead``; with half backlash b and displacement y of the
    pinion's base circle over the wheel's it is y - b on the drive flank and -y - b on the back
    flank. Deviations carry their full S_j (thermal growth less the axes' movement).
    Other arguments as :func:`loaded_contact`; ``model`` defaults to the "rim" body, the reading
    of a lumped model whose inertia takes up the hub's torsion. Returns (F [N], dF/d delta
    [N/m]) of shape (*lead, position); both 0 before the first pair touches.
    """
    delta = np.asarray(deflection, dtype=float)
    if not np.all(np.isfinite(delta)):
        raise InputError("deflection", f"{delta} m", allowed="finite")
    moduli = (pinion or Moduli.of(pair.pinion), wheel or Moduli.of(pair.wheel))
    system = MeshSystem.of(
        pair, delta.shape, phase, moduli, deviations, model or LoadedModel(body="rim"), flank
    )
    force, _, stiffness, settled = system.solve(_flat(delta, system.lead), by_load=False)
    total = np.where(settled, force.sum(axis=-1), np.nan)
    return (
        total.reshape(*system.lead, *total.shape[1:]),
        stiffness.reshape(*system.lead, *total.shape[1:]),
    )


def _contact_coefficients(
    law: str, modulus: Floats, nu: Sequence[float], reduced: Floats, width: float
) -> Floats:
    """[case, 6]: depth factors of both gears, C, ln(pi b E*), K, constant compliance."""
    out = np.zeros((modulus.shape[0], 6))
    if law == "weber-banaschek":
        for i in range(2):
            out[:, i] = 2.0 * (1.0 - nu[i] ** 2) / (np.pi * modulus[:, i] * width)
        # half of the two factors: a grows with the root of the force
        out[:, 2] = 1.0 / (np.pi * reduced * width)
        out[:, 3] = np.log(np.pi * width * reduced)
    elif law == "palmgren":
        out[:, 4] = palmgren_approach(1.0, reduced, width)
    else:
        out[:, 5] = 1.0 / yang_sun_stiffness(reduced, width)
    return out


DIMENSIONS = ((), ("operating",), ("temperature", "load"))
_MEANING = {
    "transmission_error": ("m", "static transmission error under load"),
    "unloaded_error": ("m", "transmission error at first touch, without load"),
    "tangent_stiffness": ("N/m", "tangent mesh stiffness dF/d(deflection)"),
    "secant_stiffness": ("N/m", "secant mesh stiffness, load over elastic deflection"),
    "contact_pairs": ("1", "number of tooth pairs that carry load"),
    "status": ("1", "status of the point: 0 ok, 2 not converged"),
    "pair_force": ("N", "normal force of the tooth pair"),
    "load_share": ("1", "share of the normal force on the tooth pair"),
    "contact_pressure": ("Pa", "greatest Hertzian pressure of the tooth pair"),
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

    C: tooth beams and both clamped rings, coupled between teeth; delta_H: contact law; e_j: gap
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
    1 N/mm. A position that does not settle has status 2 and nan values.

    Plane stress body and plane strain contact; the band between all plane stress and all plane
    strain is -2.6 .. +4.3 % in stiffness.
    Finite elements of whole gears agree within 1.3 % for m 5, 25:75, and within 2.3 % for pairs
    of 17:43 to 40:120 with 20 degrees, a thin rim among them; steep flanks with a sharp fillet
    (25 degrees, rho_fP 0.3) come out up to 5 % too compliant. Contact on tip corners and relief
    stand without such a check. Raises InputError for loads < 0 and deviations that do not fit
    the gears.
    Source: Weber & Banaschek 1953; ring body by Fourier series; extended contact exact.
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
    lead = mesh.deflection.shape[:-1]
    if dimensions is None:
        names = (
            DIMENSIONS[len(lead)]
            if len(lead) < len(DIMENSIONS)
            else tuple(f"axis_{i}" for i in range(len(lead)))
        )
    else:
        names = tuple(dimensions)
    if len(names) != len(lead):
        raise InputError("dimensions", names, allowed=f"{len(lead)} names, one for each axis")
    loaded = (mesh.share > 0.0).sum(axis=-1)
    along, by_pair = (*names, "mesh_phase"), (*names, "mesh_phase", "pair")
    values: dict[str, tuple[tuple[str, ...], ArrayLike]] = {
        "transmission_error": (along, mesh.deflection),
        "unloaded_error": (along, mesh.unloaded),
        "tangent_stiffness": (along, mesh.tangent),
        "secant_stiffness": (along, mesh.secant),
        "contact_pairs": (along, loaded),
        "status": (along, np.where(mesh.settled, 0, 2).astype(np.int8)),
        "pair_force": (by_pair, mesh.force),
        "load_share": (by_pair, mesh.share),
        "contact_pressure": (by_pair, mesh.pressure),
        "mean_stiffness": (names, mesh.tangent.mean(axis=-1)),
        "double_contact_length": (names, (loaded > 1).mean(axis=-1) * pair.base_pitch),
        "pair_position": (("mesh_phase", "pair"), mesh.points.s),
    }
    coordinates: dict[str, tuple[tuple[str, ...], ArrayLike]] = {
        "mesh_phase": (("mesh_phase",), phi),
        "normal_force": (names, np.broadcast_to(np.asarray(normal_force, dtype=float), lead)),
    }

    def dressed(name: str) -> dict[str, str]:
        units, words = _MEANING[name]
        return {"units": units, "long_name": words}

    return xr.Dataset(
        {k: xr.Variable(d, v, dressed(k)) for k, (d, v) in values.items()},
        {k: xr.Variable(d, v, dressed(k)) for k, (d, v) in coordinates.items()},
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
