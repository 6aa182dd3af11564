"""The quasi-static mesh cycle: from pair, operating points and choices to one labelled Dataset."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.errors import InputError, nearest
from thermogear.base.vocabulary import NO_OIL_BATH, STATUS, label
from thermogear.gears.contact import (
    entrainment_velocity,
    flank_radii,
    path_of_contact,
    sliding_velocity,
)
from thermogear.gears.deviations import Deviation
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair
from thermogear.heat.expansion import base_circle_growth
from thermogear.heat.gearbox import body_radius
from thermogear.heat.losses import efficiency
from thermogear.heat.temperature import conduction_power
from thermogear.mesh.clearance import PARTS, Clearance
from thermogear.mesh.elastic import (
    ElasticPair,
    LoadedPair,
    MeshCurves,
    PathShare,
    elastic_pair,
    in_series,
    mean_share,
    mean_stiffness_of_body,
    tooth_pair_shares,
    turn_phases,
)
from thermogear.mesh.friction_path import FrictionPath
from thermogear.mesh.mesh_heat import MeshHeat, mesh_heat
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Operating
from thermogear.mesh.thermal import HotPair, thesis_thermal_stiffness
from thermogear.mesh.turn_spread import OF_TURN, OF_WORST_PAIR, WORST, spread_of_turn

PATH = ("operating", "path_position")
PHASE = ("operating", "mesh_phase")
POINT = ("operating",)
ALONG = ("path_position",)


def mesh_cycle(
    pair: GearPair,
    operating: Operating,
    model: MeshModel | None = None,
    *,
    deviations: Sequence[Deviation] = (),
    path_positions: int = 201,
    mesh_positions: int = 240,
    want: Collection[str] = (),
) -> Dataset:
    """Everything quasi-static about ``pair`` at its operating points, in SI.

    Along the path of contact A..E of one tooth pair (``path_position`` s [m] from the pinion's
    tangent point): rolling and sliding velocities, load share, line load, Hertz contact,
    friction, flash and contact temperature, thermal growth of both flanks, and the springs of
    the pair. Over the mesh phase (0 where a pair enters at A): mesh stiffness, half backlash,
    kinematic error. Per operating point: normal force, mean and extreme stiffness, half backlash,
    jam temperature (of the pinion's addendum: once when both gears warm alike and the housing
    stays, once when shafts and housing rise in proportion; nan where that never jams), and
    ``status``: ``ok``; ``jammed`` where the least half backlash over the phase is <= 0 (the values
    stay: they say how far it is jammed); ``no_oil_bath`` where the oil is hotter than any bath of
    it; ``not_converged`` where the loaded contact did not settle.
    ``friction_coefficient_least`` and ``_greatest`` span the laws of oiled contacts that are
    within their range there, ``friction_outside_range`` is 1 where the chosen one is not, and
    ``film_outside_range`` where the film forms beyond the range of the oil's viscosity line.
    ``edge_contact`` names the tip corner that carries along the path, where the pressure is
    nan; ``edge_contact_share`` is the share of the mesh period with such a corner, beyond A and
    E too, nan where the stiffness model knows none.

    ``want``: names of stored quantities; only they are computed, with ``status``, which then says
    ``not_converged`` where one of them is not known. Left out, all are.

    ``deviations`` of the flanks (relief, profile, ...) enter the loaded contact and the clearance
    (:func:`~thermogear.mesh.clearance.Clearance`); the cold half backlash is that of the flanks
    without them. Where teeth differ or a gear is eccentric
    (:func:`~thermogear.gears.turn.turn_period`) the cycle is the whole turn: ``mesh_phase`` runs
    over its L mesh periods, the attribute ``mesh_periods``, with ``mesh_positions`` in each, so
    that a sound pair beside it is computed at the same ones; the half backlash and the jams are
    those of the tightest tooth pairs of the turn; losses and what is along the path are of the mean
    over all tooth pairs, the latter at the mean of their load shares; and :data:`OF_TURN` say how
    flash temperature, Hertz pressure and film differ between the tooth pairs, each by its worst
    place along the path. ``model`` defaults to
    :meth:`MeshModel.consistent`. Zero torque gives zero contact and flash; zero speed gives
    zero flash; the pitch point has its limit values. Warns outside the ranges of the sources;
    raises InputError for fewer than 2 positions.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> warm = Temperatures.uniform(353.15, reference=293.15)
    >>> point = Operating(
    ...     speed=[100.0], torque=[200.0], lubricant=lubricant("FVA3"), oil_temperature=353.15,
    ...     temperatures=warm, half_backlash=60e-6,
    ... )
    >>> cycle = mesh_cycle(pair, point, mesh_positions=32, path_positions=21)
    >>> f"{cycle.attrs['contact_ratio']:.3f}, {1e6 * cycle.least_half_backlash.item():.1f} um"
    '1.635, 60.0 um'
    """
    for name, count in (("path_positions", path_positions), ("mesh_positions", mesh_positions)):
        if count < 2:
            raise InputError(name, count, allowed=">= 2")
    hot = HotPair(pair, operating, MeshModel.consistent() if model is None else model)
    s = path_of_contact(pair, path_positions)
    cycle = Cycle(hot, tuple(deviations), s, mesh_positions)
    variables = {
        name: (POINT if name == "status" else TABLE[name][0], values)
        for name, values in cycle.quantities(want).items()
        if name != "mesh_periods"
    }
    coordinates: dict[str, tuple[tuple[str, ...], ArrayLike]] = {
        "pinion_speed": (POINT, operating.speed),
        "pinion_torque": (POINT, operating.torque),
    }
    if any("path_position" in dims for dims, _ in variables.values()):
        r1, r2 = flank_radii(pair, s)
        coordinates |= {"path_position": (ALONG, s), "pinion_radius": (ALONG, r1)}
        coordinates["wheel_radius"] = (ALONG, r2)
    if any("mesh_phase" in dims for dims, _ in variables.values()):
        coordinates["mesh_phase"] = (("mesh_phase",), turn_phases(cycle.mesh_periods, cycle.phase))
    points = pair.path
    return label(
        variables,
        coordinates,
        {
            "bundle": hot.model.name,
            "choices": json.dumps(hot.model.choices()),
            "path_points": json.dumps({k.upper(): v for k, v in points._asdict().items()}),
            "contact_ratio": pair.contact_ratio,
            **({"mesh_periods": cycle.mesh_periods} if cycle.mesh_periods > 1 else {}),
        },
    )


def _asked(want: Collection[str]) -> Collection[str]:
    """The names to compute; all without any."""
    for name in want:
        if name not in TABLE and name != "status":
            raise InputError("want", repr(name), fix=nearest(name, TABLE))
    return frozenset(want) or TABLE.keys()


@dataclass(frozen=True, eq=False)
class Cycle:
    """What the quantities of one cycle are made of, each computed when first asked for.

    At path positions ``s`` [m] and ``positions`` of each mesh period.
    """

    hot: HotPair
    deviations: tuple[Deviation, ...]
    s: Floats
    positions: int

    @cached_property
    def elastic(self) -> ElasticPair:
        return elastic_pair(self.hot, self.deviations)

    @property
    def mesh_periods(self) -> int:
        return self.elastic.mesh_periods

    @property
    def phase(self) -> Floats:
        """Of one mesh period."""
        return np.asarray(np.arange(self.positions) / self.positions)

    def quantities(self, want: Collection[str] = ()) -> dict[str, ArrayLike]:
        """The bare arrays of :func:`mesh_cycle`, SI, in the order of :data:`TABLE`, then status.

        Of a turn ``mesh_periods`` too, (count,).
        """
        names = _asked(want)
        springs = self.parts if any(name in SPRINGS for name in names) else {}
        left_out = {name: "it has other springs" for name in SPRINGS if name not in springs}
        if not self.teeth_differ:
            left_out |= dict.fromkeys(OF_TURN, "no two tooth pairs carry different loads")
        for name in left_out.keys() & set(want):
            tooth, sharing = self.hot.model.tooth, self.hot.model.sharing
            why = f"{left_out[name]} with model.tooth = {tooth}, model.sharing = {sharing}"
            raise InputError("want", repr(name), allowed=" | ".join(springs) or None, why=why)
        values = {
            name: of(self)
            for name, (_, of) in TABLE.items()
            if name in names and name not in left_out
        }
        if self.mesh_periods > 1:
            values["mesh_periods"] = np.full(self.hot.count, self.mesh_periods)
        return values | {"status": self.status(names)}

    # --- along the path ---------------------------------------------------------------------
    @property
    def teeth_differ(self) -> bool:
        """Whether tooth pairs carry different loads: rules of thumb for sharing feel no flank."""
        return self.mesh_periods > 1 and self.hot.model.sharing == "loaded"

    @cached_property
    def shares(self) -> PathShare:
        """Of every tooth pair of the turn, (count, tooth pair, positions)."""
        return tooth_pair_shares(self.elastic, self.s)

    @cached_property
    def path(self) -> FrictionPath:
        mean = mean_share(self.shares) if self.teeth_differ else None
        return FrictionPath(self.elastic, self.s, mean)

    @cached_property
    def of_turn(self) -> dict[str, Floats]:
        """:data:`OF_TURN`; nan where the loaded contact is not known."""
        return spread_of_turn(self.elastic, self.s, self.shares)

    @cached_property
    def heat(self) -> MeshHeat:
        return mesh_heat(self.elastic)

    @cached_property
    def growth(self) -> tuple[Floats, Floats]:
        by_heat, by_pull = self.hot.growth(self.s), self.hot.pulled_material(self.s)
        return by_heat[0] + by_pull[0], by_heat[1] + by_pull[1]

    @cached_property
    def parts(self) -> dict[str, Floats]:
        known = self.path.solved if isinstance(self.elastic, LoadedPair) else None
        return self.elastic.parts(self.s, known)

    @cached_property
    def flash(self) -> Floats:
        return self.path.flash(self.path.friction)

    # --- over the mesh phase ----------------------------------------------------------------
    @cached_property
    def curves(self) -> MeshCurves:
        return self.elastic.over(self.phase)

    @cached_property
    def thermal(self) -> Floats:
        if self.hot.model.thermal_stiffness != "thesis":
            return np.zeros_like(self.curves.stiffness)
        found = thesis_thermal_stiffness(self.hot, self.phase, self.elastic.pair_stiffness)
        return np.tile(found, self.mesh_periods)

    @cached_property
    def stiffness(self) -> Floats:
        return self.curves.stiffness + self.thermal

    @cached_property
    def gap(self) -> Clearance:
        return Clearance(self.hot, self.phase, self.elastic.deviations)

    @cached_property
    def rim(self) -> Floats:
        return self._of_body("rim")

    @cached_property
    def clamped(self) -> Floats:
        return self._of_body("bore-clamped")

    def _of_body(self, body: str) -> Floats:
        model = self.hot.model
        if (model.stiffness, model.body, model.spring) == ("loaded", body, "tangent"):
            return np.asarray(self.curves.stiffness.mean(axis=-1))
        return mean_stiffness_of_body(self.elastic, self.phase, body)

    def status(self, names: Collection[str]) -> NDArray[np.int64]:
        """Where the gap is used up, and where what is asked for is not known."""
        bath = np.where(self.hot.operating.no_bath, NO_OIL_BATH, STATUS.index("ok"))
        found = np.where(self.gap.least > 0.0, bath, STATUS.index("jammed"))
        # a turn is solved only for what is asked
        known = np.ones(self.hot.count, np.bool_)
        if self.mesh_periods == 1 or "curves" in vars(self):
            known &= np.isfinite(self.stiffness).all(axis=1)
        elif "heat" in vars(self):
            known &= self.heat.settled
        for name, mean in (("rim_stiffness", "rim"), ("bore_clamped_stiffness", "clamped")):
            if name in names:
                known &= np.isfinite(getattr(self, mean))
        if not {"edge_contact", *CONTACT, *OF_WORST_PAIR, *OF_TURN}.isdisjoint(names):
            known &= self.path.settled
        return np.where(known, found, STATUS.index("not_converged"))

    # --- per gear ---------------------------------------------------------------------------
    def base_growth(self, gear: Gear) -> Floats:
        times = self.hot.expansion(gear)
        growth = times * base_circle_growth(gear, self.hot.field(gear), self.hot.model.bore)
        return np.broadcast_to(np.ravel(growth), (self.hot.count,))

    def shaft_heat(self, gear: Gear) -> Floats:
        """What passes the body node enters the bore; without one the whole field carries it."""
        t = self.hot.temperatures
        bore, body, tip = (
            (t.pinion_bore, t.pinion_body, t.pinion_addendum)
            if gear is self.hot.pair.pinion
            else (t.wheel_bore, t.wheel_body, t.wheel_addendum)
        )
        known = body is not None and self.hot.model.flank != "thesis"
        power = conduction_power(
            bore_radius=gear.bore_radius,
            tip_radius=body_radius(gear) if known else gear.tip_radius,
            bore_temperature=bore,
            addendum_temperature=tip if body is None or not known else body,
            conductivity=gear.material.thermal_conductivity,
            face_width=gear.face_width,
        )
        return np.broadcast_to(power * np.ravel(self.hot.widened), (self.hot.count,))


Made = Callable[[Cycle], ArrayLike]


def _of_contact(of: Made, c: Cycle) -> Floats:
    """Over the path of contact; nan where the loaded contact is not known."""
    values = np.broadcast_to(np.asarray(of(c)), (c.hot.count, c.s.size))
    return np.where(c.path.settled[:, None], values, np.nan)


def _worst(name: str, c: Cycle) -> Floats:
    """The worst along the path, of all tooth pairs of a turn where these differ."""
    sign = WORST[name][1]
    if c.teeth_differ:
        return c.of_turn[f"{name}_{'greatest' if sign > 0.0 else 'least'}_of_turn"]
    return np.asarray(sign * np.fmax.reduce(sign * _of_contact(CONTACT[name], c), axis=-1))


def _of_heat(name: str, c: Cycle) -> Floats:
    """A time mean over the mesh; nan where the loaded contact is not known."""
    return np.where(c.heat.settled, getattr(c.heat, name), np.nan)


def _kinematic(law: Callable[..., Floats], c: Cycle) -> Floats:
    return law(c.hot.pair, c.hot.operating.speed[:, None], c.s)


CONTACT: dict[str, Made] = {
    "pinion_rolling_velocity": lambda c: c.path.velocities[0],
    "wheel_rolling_velocity": lambda c: c.path.velocities[1],
    "sliding_velocity": partial(_kinematic, sliding_velocity),
    "entrainment_velocity": partial(_kinematic, entrainment_velocity),
    "load_share": lambda c: c.path.share,
    "line_load": lambda c: c.path.line_load,
    "hertz_half_width": lambda c: c.path.half_width,
    "hertz_pressure": lambda c: np.where(c.path.edge > 0, np.nan, c.path.pressure),
    "film_thickness": lambda c: c.path.film,
    "film_parameter": lambda c: c.path.film_parameter,
    "friction_coefficient": lambda c: c.path.friction,
    "friction_coefficient_mixed": lambda c: c.path.mixed,
    "friction_coefficient_dry": lambda c: c.path.dry,
    "friction_coefficient_least": lambda c: c.path.band[0],
    "friction_coefficient_greatest": lambda c: c.path.band[1],
    "flash_temperature": lambda c: c.flash,
    "flash_temperature_mixed": lambda c: c.path.flash(c.path.mixed),
    "flash_temperature_dry": lambda c: c.path.flash(c.path.dry),
    "pinion_heat_share": lambda c: c.path.heat_share,
    "contact_temperature": lambda c: c.path.contact(c.flash),
    "pinion_body_temperature": lambda c: c.path.body_temperatures[0],
    "wheel_body_temperature": lambda c: c.path.body_temperatures[1],
}
"""Of one tooth pair in its contact: load, Hertz, film, friction, flash."""

SPRINGS = (
    "hertz_stiffness",
    *(
        f"{gear}_{part}_stiffness"
        for gear in ("pinion", "wheel")
        for part in ("bending", "shear", "axial", "body", "gear")
    ),
)
"""The springs of one tooth pair, in the order of storage; each model of the teeth has some."""


def _one_of(of: Callable[[Cycle], dict[str, Floats]], name: str, c: Cycle) -> Floats:
    return of(c)[name]


TABLE: dict[str, tuple[tuple[str, ...], Made]] = {
    **{name: (PATH, partial(_of_contact, of)) for name, of in CONTACT.items()},
    "edge_contact": (PATH, lambda c: c.path.edge),
    "friction_outside_range": (
        PATH,
        lambda c: np.broadcast_to(c.path.outside, (c.hot.count, c.s.size)).astype(np.int8),
    ),
    "film_outside_range": (POINT, lambda c: c.path.beyond_oil.astype(np.int8)),
    "reduced_radius": (ALONG, lambda c: c.path.radius),
    "normal_force": (POINT, lambda c: c.elastic.force),
    "dynamic_viscosity": (POINT, lambda c: c.path.viscosity[:, 0]),
    "frictional_power": (POINT, partial(_of_heat, "power")),
    "pinion_share_of_heat": (POINT, partial(_of_heat, "partition")),
    "power_off_the_path": (POINT, partial(_of_heat, "beyond")),
    "flank_conductance": (POINT, partial(_of_heat, "conductance")),
    "mesh_efficiency": (
        POINT,
        lambda c: efficiency(
            power=c.hot.operating.speed * c.hot.operating.torque, loss=_of_heat("power", c)
        ),
    ),
    "pinion_deformation": (PATH, lambda c: c.growth[0]),
    "wheel_deformation": (PATH, lambda c: c.growth[1]),
    "deformation_sum": (PATH, lambda c: c.growth[0] + c.growth[1]),
    "pinion_base_growth": (POINT, lambda c: c.base_growth(c.hot.pair.pinion)),
    "pinion_shaft_heat": (POINT, lambda c: c.shaft_heat(c.hot.pair.pinion)),
    "wheel_base_growth": (POINT, lambda c: c.base_growth(c.hot.pair.wheel)),
    "wheel_shaft_heat": (POINT, lambda c: c.shaft_heat(c.hot.pair.wheel)),
    **{name: (PATH, partial(_one_of, lambda c: c.parts, name)) for name in SPRINGS},
    "pair_stiffness": (PATH, lambda c: in_series(c.parts)),
    "elastic_stiffness": (PHASE, lambda c: c.curves.stiffness),
    "thermal_stiffness": (PHASE, lambda c: c.thermal),
    "mesh_stiffness": (PHASE, lambda c: c.stiffness),
    "half_backlash_curve": (PHASE, lambda c: c.gap.half_backlash),
    "kinematic_error": (PHASE, lambda c: c.gap.error),
    "spring_error": (
        PHASE,
        lambda c: c.gap.error if c.curves.spring_error is None else c.curves.spring_error,
    ),
    "transmission_error": (PHASE, lambda c: c.curves.transmission_error),
    "mean_stiffness": (POINT, lambda c: c.stiffness.mean(axis=1)),
    "rim_stiffness": (POINT, lambda c: c.rim),
    "bore_clamped_stiffness": (POINT, lambda c: c.clamped),
    "peak_to_peak_stiffness": (
        POINT,
        lambda c: c.stiffness.max(axis=1) - c.stiffness.min(axis=1),
    ),
    "mid_range_stiffness": (
        POINT,
        lambda c: 0.5 * (c.stiffness.max(axis=1) + c.stiffness.min(axis=1)),
    ),
    # counted from the least, so that a constant gap keeps its last bit
    "half_backlash": (
        POINT,
        lambda c: c.gap.least + (c.gap.half_backlash - c.gap.least[:, None]).mean(axis=1),
    ),
    "cold_half_backlash": (POINT, lambda c: c.hot.half_backlash),
    "least_half_backlash": (POINT, lambda c: c.gap.least),
    **{
        f"half_backlash_by_{name}": (POINT, partial(_one_of, lambda c: c.gap.parts, name))
        for name in PARTS
    },
    "jam_temperature": (POINT, lambda c: c.gap.jam_temperature),
    "proportional_jam_temperature": (POINT, lambda c: c.gap.proportional_jam_temperature),
    "edge_contact_share": (POINT, lambda c: c.curves.edge_share),
    **{name: (POINT, partial(_worst, of)) for name, of in OF_WORST_PAIR.items()},
    **{name: (POINT, partial(_one_of, lambda c: c.of_turn, name)) for name in OF_TURN},
}
"""Every stored quantity, in the order of storage: its dimensions and what it is made of."""
