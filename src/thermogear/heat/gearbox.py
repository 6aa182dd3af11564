"""The thermal network of a gear pair in its housing, built from geometry, oil and losses.

Nodes: ambient, housing, oil, and of pinion and wheel tooth, body and shaft. The tooth node is
the T_a, the shaft node the T_x of the radial temperature field. What the drawing of a pair
does not say - areas, wetting, shaft lengths - is in :class:`Surroundings`, all of it ours
and meant to be replaced by a user who knows better.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.base.bounds import BODY
from thermogear.base.errors import InputError, ValidityWarning
from thermogear.base.materials import Lubricant, Material
from thermogear.gears.geometry import Gear
from thermogear.heat.convection import MOST_PRANDTL, rotating_face_convection, transition_pieces
from thermogear.heat.lubrication import density, kinematic_viscosity
from thermogear.heat.network import Link, ThermalNetwork
from thermogear.heat.shaft_heat import BearingLoss, ShaftHeat
from thermogear.heat.still_air import still_air_coefficient

ROOM = 293.15
"""The room [K] in which the customary coefficient of a housing is meant."""


@dataclass(frozen=True, kw_only=True)
class Surroundings:
    """Housing, oil bath, shafts and ambient of a gear pair; every default is ours.

    ``ambient`` [K]; ``housing_area`` [m^2] outside and in touch with the oil mist;
    ``housing_coefficient`` [W/(m^2 K)] to the air (10..25 by installation) with the housing at
    ``housing_coefficient_at`` [K] in a room of 20 C, from where it grows as in still air
    (:meth:`outside`); None there: it stays;
    ``oil_housing_coefficient`` [W/(m^2 K)]; ``wetted_share`` of a gear's surface that oil
    covers (0..1), pinion and wheel; ``shaft_length`` [m] from the gear to its bearings on
    each side; ``bearing_conductance`` [W/K] of one bearing into the housing; ``oil_mass``,
    ``housing_mass`` [kg] for the warm-up. ``oil_flow`` [m^3/s] of oil supplied at
    ``supply_temperature`` [K] and drawn off as warm as the bath; 0 for a closed bath. ``train``:
    shafts and bearings as they are drawn, in place of length and conductance; None has a shaft with
    two like bearings at each gear.

    >>> Surroundings(ambient=303.15).oil_flow
    0.0
    """

    ambient: float = 293.15
    housing_area: float = 0.6
    housing_coefficient: float = 15.0
    housing_coefficient_at: float | None = 333.15
    oil_housing_coefficient: float = 200.0
    wetted_share: tuple[float, float] = (0.3, 0.3)
    shaft_length: float = 0.06
    bearing_conductance: float = 10.0
    oil_mass: float = 3.0
    housing_mass: float = 40.0
    housing_specific_heat: float = 470.0
    oil_flow: float = 0.0
    supply_temperature: float = 333.15
    train: ShaftHeat | None = None

    def __post_init__(self) -> None:
        for name in ("ambient", "supply_temperature"):
            BODY.require(f"surroundings.{name}", getattr(self, name))
        for entry in fields(self):
            if getattr(self, entry.name) is None or entry.name == "train":
                continue
            values = np.asarray(getattr(self, entry.name), dtype=float)
            least = values >= 0.0 if entry.name == "oil_flow" else values > 0.0
            if not np.all(np.isfinite(values) & least):
                raise InputError(f"surroundings.{entry.name}", values, allowed="> 0, finite")
        if max(self.wetted_share) > 1.0:
            raise InputError("surroundings.wetted_share", self.wetted_share, allowed="0 < x <= 1")

    def outside(self, housing: ArrayLike) -> Floats:
        """Coefficient [W/(m^2 K)] to the air of a housing at ``housing`` [K], any shape.

        h = h_0 g(T, T_0)/g(T_h, 20 C), g of
        :func:`~thermogear.heat.still_air.still_air_coefficient` for a cube of the housing's area,
        h_0 the coefficient at T_h and T_0 the ambient: ribs and the room's draught, which make h_0
        more than a bare wall has, count at every temperature alike (ours).

        >>> f"{Surroundings().outside(573.15):.1f} W/(m^2 K)"
        '34.1 W/(m^2 K)'
        """
        if self.housing_coefficient_at is None:
            return np.full(np.shape(housing), self.housing_coefficient)
        height = np.sqrt(self.housing_area / 6.0)
        here, usual = (
            still_air_coefficient(wall, ambient=around, height=height)
            for wall, around in ((housing, self.ambient), (self.housing_coefficient_at, ROOM))
        )
        return np.asarray(self.housing_coefficient * here / usual)


@dataclass(frozen=True, eq=False, kw_only=True)
class Losses:
    """Heat sources [W], numbers or arrays over operating points.

    ``mesh`` and the share ``partition_1`` of it that enters the pinion's flank; ``churning`` into
    the oil; ``bearing_1``, ``bearing_2`` (with seals) into the shafts. ``contact`` [W/K] is no
    loss but comes of the same contact: the conductance between both flanks. ``bearings``: of each
    bearing of a drawn train into its rings, by its name; then ``bearing_1`` and ``bearing_2`` are
    the sums of both shafts.

    >>> float(Losses(mesh=200.0, bearing_1=20.0).partition_1)
    0.5
    """

    mesh: ArrayLike
    partition_1: ArrayLike = 0.5
    churning: ArrayLike = 0.0
    bearing_1: ArrayLike = 0.0
    bearing_2: ArrayLike = 0.0
    contact: ArrayLike = 0.0
    bearings: Mapping[str, BearingLoss] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.bearings:
            for field_name, shaft in (("bearing_1", "pinion"), ("bearing_2", "wheel")):
                if np.any(getattr(self, field_name)):
                    raise InputError(
                        f"losses.{field_name}", "beside the bearings one by one", fix="leave it out"
                    )
                mine = [one.loss for name, one in self.bearings.items() if name.startswith(shaft)]
                object.__setattr__(self, field_name, sum(map(np.asarray, mine), np.zeros(())))
        numbers = {name: one.loss for name, one in self.bearings.items()}
        numbers |= {name: getattr(self, name) for name in _NUMBERS}
        for name, value in numbers.items():
            values = np.asarray(value, dtype=float)
            if name in _NUMBERS:
                object.__setattr__(self, name, values)
            if not np.all(np.isfinite(values) & (values >= 0.0)):
                unit = "W/K" if name == "contact" else "W"
                raise InputError(f"losses.{name}", f"{values} {unit}", allowed=">= 0, finite")
        if np.any(np.asarray(self.partition_1) > 1.0):
            raise InputError("losses.partition_1", self.partition_1, allowed="0 .. 1")

    def changed(self, change: Callable[[ArrayLike], Floats]) -> Losses:
        """The same with every number changed, not checked: nan heats no network."""
        found = copy(self)
        for name in _NUMBERS:
            object.__setattr__(found, name, change(getattr(self, name)))
        each = {name: one.changed(change) for name, one in self.bearings.items()}
        object.__setattr__(found, "bearings", each)
        return found

    def unknown_where(self, lost: NDArray[np.bool_]) -> Losses:
        """The same with nan where nothing is known; such losses heat no network."""
        return self.changed(
            lambda v: np.where(lost, np.nan, np.broadcast_to(np.asarray(v, float), lost.shape))
        )


def joined(parts: Sequence[Losses], counts: Sequence[int]) -> Losses:
    """Losses of ``counts`` points each, one after the other.

    >>> joined([Losses(mesh=200.0), Losses(mesh=[100.0])], [2, 1]).mesh
    array([200., 200., 100.])
    """

    def whole(values: Sequence[ArrayLike]) -> Floats:
        each = zip(values, counts, strict=True)
        return np.concatenate([np.broadcast_to(np.asarray(v, float), (n,)) for v, n in each])

    found = copy(parts[0])
    for name in _NUMBERS:
        object.__setattr__(found, name, whole([getattr(one, name) for one in parts]))
    bearings = {
        name: BearingLoss(
            **{
                entry.name: whole([getattr(one.bearings[name], entry.name) for one in parts])
                for entry in fields(BearingLoss)
            }
        )
        for name in found.bearings
    }
    object.__setattr__(found, "bearings", bearings)
    return found


_NUMBERS = ("mesh", "partition_1", "churning", "bearing_1", "bearing_2", "contact")


def oil_prandtl(lubricant: Lubricant, temperature: ArrayLike) -> Floats:
    """Pr = nu rho c/k of an oil [-]; ``temperature`` [K], any shape.

    >>> oil = lubricant("FVA3")
    >>> f"{oil_prandtl(oil, 353.15):.0f}"
    '242'
    """
    heat = density(lubricant, temperature) * lubricant.specific_heat
    diffusivity = lubricant.thermal_conductivity / heat
    return np.asarray(kinematic_viscosity(lubricant, temperature) / diffusivity)


def fluid_from(lubricant: Lubricant) -> float:
    """Temperature [K] from which an oil is thin enough for the laws of convection: Pr <= 10^6.

    >>> f"{fluid_from(lubricant('ISO VG 320')) - 273.15:.1f} C"
    '-13.7 C'
    """
    from scipy.optimize import brentq

    def beyond(kelvin: float) -> float:
        return float(np.log(oil_prandtl(lubricant, kelvin) / MOST_PRANDTL))

    with warnings.catch_warnings(action="ignore", category=ValidityWarning):
        return float(brentq(beyond, BODY.least, BODY.most))


def face_conductance(
    speed: ArrayLike,
    *,
    inner_radius: float,
    outer_radius: float,
    lubricant: Lubricant,
    oil_temperature: ArrayLike,
) -> Floats:
    """int h(r) 2 pi r dr over one wetted face of a rotating ring [W/K].

    ``speed`` omega [rad/s], radii [m], ``oil_temperature`` [K] for the oil's properties. h of
    :func:`rotating_face_convection` with the excess growing as r^2. Shape of speed and
    temperature; 0 at rest.

    >>> oil = lubricant("FVA3")
    >>> g = face_conductance(
    ...     100.0, inner_radius=16e-3, outer_radius=40e-3, lubricant=oil, oil_temperature=353.15
    ... )
    >>> f"{g:.2f} W/K"
    '6.61 W/K'
    """
    omega, kelvin = np.broadcast_arrays(
        np.asarray(speed, dtype=float), np.asarray(oil_temperature, dtype=float)
    )
    viscosity = kinematic_viscosity(lubricant, kelvin)
    r, weights = transition_pieces(omega, viscosity, inner=inner_radius, outer=outer_radius)
    film = rotating_face_convection(
        omega[..., None],
        r,
        viscosity[..., None],
        lubricant.thermal_conductivity,
        oil_prandtl(lubricant, kelvin)[..., None],
    )
    return np.asarray(np.sum(film * 2.0 * np.pi * r * weights, axis=-1))


def body_radius(gear: Gear) -> float:
    """Radius [m] of a gear's body node, sqrt((r_x^2 + r_f^2)/2): it halves the ring's area.

    >>> f"{1e3 * body_radius(Gear(20, 4e-3)):.2f} mm"
    '27.21 mm'
    """
    return float(np.sqrt(0.5 * (gear.bore_radius**2 + gear.root_radius**2)))


def tooth_radius(gear: Gear) -> float:
    """Radius [m] of a gear's tooth node: the pitch circle, held within the tooth.

    A large profile shift puts the pitch circle off the tooth; a tenth of the tooth's height is
    left to root and tip circle.

    >>> f"{1e3 * tooth_radius(Gear(20, 4e-3)):.2f} mm"
    '40.00 mm'
    """
    margin = 0.1 * (gear.tip_radius - gear.root_radius)
    return float(min(max(gear.pitch_radius, gear.root_radius + margin), gear.tip_radius - margin))


def _outer_resistances(gear: Gear) -> tuple[float, float]:
    """(root circle to body node, tooth node to root circle) [K/W]."""
    k, b, at = gear.material.thermal_conductivity, gear.face_width, tooth_radius(gear)
    thickness = 2.0 * at * float(gear.half_thickness_angle(at))
    ring = float(np.log(gear.root_radius / body_radius(gear))) / (2.0 * np.pi * k * b)
    return ring, (at - gear.root_radius) / (k * b * thickness * gear.teeth)


def body_conductances(gear: Gear) -> tuple[float, float]:
    """(tooth to body, body to bore) conductances of a gear by steady conduction [W/K].

    The body node lies at :func:`body_radius`: ring parts 2 pi k b/ln(r_o/r_i). The teeth carry
    the heat from the tooth node (:func:`tooth_radius`) to the root circle through z times the
    thickness there. In series, without other exchange, bore and root circle differ by
    Q ln(r_f/r_x)/(2 pi k b), the radial field's own value.

    >>> [f"{g:.0f} W/K" for g in body_conductances(Gear(20, 4e-3))]
    ['12 W/K', '11 W/K']
    """
    k, b = gear.material.thermal_conductivity, gear.face_width
    inner = 2.0 * np.pi * k * b / np.log(body_radius(gear) / gear.bore_radius)
    return float(1.0 / sum(_outer_resistances(gear))), float(inner)


def body_places(
    gear: Gear, *, body: ArrayLike, tooth: ArrayLike
) -> tuple[tuple[float, Floats], ...]:
    """(radius [m], temperature [K]) of body node, root circle and tooth node.

    ``body``, ``tooth`` [K] of the nodes, any shape. The root circle's temperature is where the
    heat between both nodes has it, T_f = T_b + (T_t - T_b) R_ring/(R_ring + R_teeth), so that a
    field through these places carries the heat of :func:`body_conductances`. Above the tooth
    node nothing is conducted: there the tooth has its node's temperature up to the tip.

    >>> places = body_places(Gear(20, 4e-3), body=353.15, tooth=353.15)
    >>> [f"{1e3 * radius:.1f} mm" for radius, _ in places]
    ['27.2 mm', '35.0 mm', '40.0 mm']
    """
    low, high = np.asarray(body, dtype=float), np.asarray(tooth, dtype=float)
    ring, teeth = _outer_resistances(gear)
    root = low + (high - low) * (ring / (ring + teeth))
    return (
        (body_radius(gear), low),
        (gear.root_radius, np.asarray(root)),
        (tooth_radius(gear), high),
    )


def _heat_capacity(material: Material, area: float, width: float) -> float:
    return material.density * material.specific_heat * area * width


def thermal_network(
    pinion: Gear,
    wheel: Gear,
    speed: ArrayLike,
    losses: Losses,
    lubricant: Lubricant,
    oil_temperature: ArrayLike,
    surroundings: Surroundings | None = None,
    measured: dict[str, ArrayLike] | None = None,
    housing_temperature: ArrayLike | None = None,
) -> ThermalNetwork:
    """The heat balance of a gear pair as a :class:`ThermalNetwork`.

    Nodes ambient, housing, oil (and supply with an oil flow), pinion_tooth, pinion_body,
    pinion_shaft, wheel_tooth, wheel_body, wheel_shaft; with a drawn train inner and outer ring of
    every bearing (:class:`~thermogear.heat.shaft_heat.ShaftHeat`).

    ``speed`` pinion [rad/s], ``losses``, ``oil_temperature`` [K] at which the oil's properties
    are taken (a guess; repeat with the result), ``surroundings`` (default: ours), ``measured``
    temperatures [K] that hold single nodes, such as {"oil": 353.15} of a tempered bath,
    ``housing_temperature`` [K] at which it gives heat to the air (a guess too; left out: where its
    coefficient holds).
    Arrays over operating points of one shape. Flanks and faces give heat to the oil by the
    boundary layer's solution over the wetted share, teeth with the coefficient at their node;
    the flanks exchange heat through their contact.

    >>> oil = lubricant("FVA3")
    >>> gear = Gear(20, 4e-3)
    >>> network = thermal_network(gear, gear, 100.0, Losses(mesh=0.0), oil, 293.15)
    >>> f"{network.steady().temperatures['oil']:.2f} K"
    '293.15 K'
    """
    around = surroundings or Surroundings()
    omega_1 = np.asarray(speed, dtype=float)
    omegas = omega_1, omega_1 * pinion.teeth / wheel.teeth
    outside = (
        around.housing_coefficient
        if housing_temperature is None
        else around.outside(housing_temperature)
    )
    links = [
        Link("oil", "housing", around.oil_housing_coefficient * around.housing_area),
        Link("housing", "ambient", outside * around.housing_area),
    ]
    fixed: dict[str, ArrayLike] = {"ambient": around.ambient}
    if around.oil_flow > 0.0:
        # well mixed: what flows off is as warm as the bath
        carried = density(lubricant, around.supply_temperature) * lubricant.specific_heat
        links.append(Link("oil", "supply", carried * around.oil_flow))
        fixed["supply"] = around.supply_temperature
    capacities = {
        "oil": around.oil_mass * lubricant.specific_heat,
        "housing": around.housing_mass * around.housing_specific_heat,
    }
    nu = kinematic_viscosity(lubricant, oil_temperature)
    prandtl = oil_prandtl(lubricant, oil_temperature)
    for name, gear, omega, share in zip(
        ("pinion", "wheel"), (pinion, wheel), omegas, around.wetted_share, strict=True
    ):
        tooth, body, shaft = f"{name}_tooth", f"{name}_body", f"{name}_shaft"
        outer, inner = body_conductances(gear)
        flanks = 2.0 * gear.teeth * gear.face_width * (gear.tip_radius - gear.root_radius)
        film = rotating_face_convection(
            omega, tooth_radius(gear), nu, lubricant.thermal_conductivity, prandtl
        )
        faces = 2.0 * face_conductance(
            omega,
            inner_radius=gear.bore_radius,
            outer_radius=gear.root_radius,
            lubricant=lubricant,
            oil_temperature=oil_temperature,
        )
        steel, bore = gear.material, gear.bore_radius
        links += [
            Link(tooth, body, outer),
            Link(body, shaft, inner),
            Link(tooth, "oil", share * film * flanks),
            Link(body, "oil", share * faces),
        ]
        ring = np.pi * (gear.root_radius**2 - bore**2)
        rim = 0.5 * np.pi * (gear.tip_radius**2 - gear.root_radius**2)
        capacities[tooth] = _heat_capacity(steel, rim, gear.face_width)
        capacities[body] = _heat_capacity(steel, ring, gear.face_width)
        if around.train is None:
            along = steel.thermal_conductivity * np.pi * bore**2 / around.shaft_length
            mount = 2.0 / (1.0 / along + 1.0 / around.bearing_conductance)
            links.append(Link(shaft, "housing", mount))
            capacities[shaft] = _heat_capacity(
                steel, np.pi * bore**2, gear.face_width + 2.0 * around.shaft_length
            )
        else:
            paths, held = around.train.paths(name, gear.face_width, omega)
            links += paths
            capacities |= held
    links.append(Link("pinion_tooth", "wheel_tooth", losses.contact))
    heat = np.asarray(losses.mesh)
    sources: dict[str, ArrayLike] = {
        "pinion_tooth": heat * losses.partition_1,
        "wheel_tooth": heat * (1.0 - np.asarray(losses.partition_1)),
        "oil": losses.churning,
    }
    if around.train is None:
        sources |= {"pinion_shaft": losses.bearing_1, "wheel_shaft": losses.bearing_2}
    else:
        sources |= around.train.sources(losses.bearings)
    fixed.update(measured or {})
    return ThermalNetwork(tuple(links), sources, fixed, capacities)
