"""Along the path of contact: load, Hertz contact, film, friction, flash temperature."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import ConvergenceError, ValidityWarning
from thermogear.base.materials import Lubricant
from thermogear.base.units import ZERO_CELSIUS
from thermogear.gears.contact import (
    flank_radii,
    hertz_half_width,
    hertz_pressure,
    reduced_radius,
    rolling_velocities,
)
from thermogear.gears.sharing import equal_share
from thermogear.heat.contact_state import FILMS, ContactState, PitchPoint
from thermogear.heat.film import (
    film_parameter,
    film_thickness,
    mean_roughness_film_parameter,
    pressure_viscosity,
    regime,
    rms_roughness,
    thermal_reduction,
)
from thermogear.heat.friction import (
    LUBRICATED,
    ROUGHNESS_LIMIT,
    BenedictKelley,
    ConstantDry,
    laws_together,
    outside_range,
)
from thermogear.heat.lubrication import (
    THINNEST,
    dynamic_viscosity,
    kinematic_viscosity,
    walther_slope,
)
from thermogear.heat.moving_source import flash_temperature
from thermogear.heat.temperature import (
    contact_temperature,
    flank_exchange,
    frictional_heat,
    heat_partition,
)
from thermogear.mesh.elastic import ElasticPair, PathShare
from thermogear.mesh.thermal import HotPair


class InletOil(NamedTuple):
    """An oil where the film forms, each (count, 1)."""

    dynamic: Floats
    """eta [Pa s]"""
    kinematic: Floats
    """nu [m^2/s]"""
    pressure: Floats
    """alpha [1/Pa]"""
    slope: Floats
    """-d ln nu/dT [1/K]"""


@dataclass(frozen=True, eq=False)
class FrictionPath:
    """The lubricated contact of one tooth pair at ``s`` [m], results (count, positions), SI.

    ``shares`` of the load at ``s`` where they are known already; else the model's rule says.
    """

    elastic: ElasticPair
    s: Floats
    shares: PathShare | None = None

    @property
    def hot(self) -> HotPair:
        """The pair in its fields."""
        return self.elastic.hot

    @property
    def inlet_temperature(self) -> Floats:
        """Temperature [K] of the oil that enters the contact, (count, 1)."""
        operating = self.hot.operating
        body = self.hot.model.inlet == "body"
        found = operating.flanks if body else np.asarray(operating.oil_temperature, dtype=float)
        return np.broadcast_to(found, (self.hot.count,))[:, None]

    @property
    def _oil(self) -> Lubricant:
        """The oil of each point as a column against the positions."""
        return self.hot.operating.lubricant.part((slice(None), None))

    @cached_property
    def inlet_oil(self) -> InletOil:
        """The oil at the film's inlet; beyond the oil's range extrapolated, see ``beyond_oil``."""
        oil, warm = self._oil, self.inlet_temperature
        with warnings.catch_warnings():
            if self.hot.model.inlet == "body":
                # the flanks' temperature is a result: a status, where a given one is warned of
                warnings.simplefilter("ignore", ValidityWarning)
            return InletOil(
                dynamic_viscosity(oil, warm),
                kinematic_viscosity(oil, warm),
                pressure_viscosity(oil, warm),
                walther_slope(oil, warm),
            )

    @property
    def viscosity(self) -> Floats:
        """eta [Pa s] at the inlet, (count, 1)."""
        return self.inlet_oil.dynamic

    @cached_property
    def beyond_oil(self) -> NDArray[np.bool_]:
        """Where the film's inlet leaves the range of the oil's viscosity line, (count,)."""
        low, high = self.hot.operating.lubricant.temperature_range
        warm = self.inlet_temperature[:, 0]
        return np.asarray(
            (warm < low) | (warm > high) | (self.inlet_oil.kinematic[:, 0] < THINNEST)
        )

    def warn_beyond_oil(self) -> None:
        """ValidityWarning with temperatures and range where ``beyond_oil``."""
        if not np.any(self.beyond_oil):
            return
        oil, warm = self.hot.operating.lubricant, self.inlet_temperature[self.beyond_oil, 0]
        low, high = (end - ZERO_CELSIUS for end in oil.temperature_range)
        warnings.warn(
            f"film: flanks of {warm.min() - ZERO_CELSIUS:.0f} .. {warm.max() - ZERO_CELSIUS:.0f} C "
            f"leave the range {low:.0f} .. {high:.0f} C, from {THINNEST * 1e6:g} mm^2/s on, of "
            f"{oil.name}'s viscosity line",
            ValidityWarning,
            stacklevel=2,
        )

    @cached_property
    def bath_viscosity(self) -> Floats:
        """eta [Pa s] of the oil supply, (count, 1), which laws of mean friction take."""
        supplied = np.asarray(self.hot.operating.oil_temperature, dtype=float)
        return dynamic_viscosity(self._oil, np.broadcast_to(supplied, (self.hot.count,))[:, None])

    @cached_property
    def velocities(self) -> tuple[Floats, Floats]:
        """Rolling velocities [m/s] of pinion and wheel flank."""
        return rolling_velocities(self.hot.pair, self.hot.operating.speed[:, None], self.s)

    @cached_property
    def solved(self) -> PathShare:
        """Share and corners at ``s``."""
        return self.elastic.share(self.s) if self.shares is None else self.shares

    @cached_property
    def settled(self) -> NDArray[np.bool_]:
        """Whether the shares of an operating point are known, (count,)."""
        return np.asarray(np.isfinite(self.solved.share).all(axis=1))

    @cached_property
    def share(self) -> Floats:
        """Share of the normal force; equal shares, which are no result, where not ``settled``."""
        return np.where(
            self.settled[:, None], self.solved.share, equal_share(self.hot.pair, self.s)
        )

    @property
    def edge(self) -> NDArray[np.int8]:
        """Where a tip corner carries: Hertz's formula says nothing about its pressure there."""
        return self.solved.edge

    def checked(self) -> FrictionPath:
        """The same where every point is settled; raises ConvergenceError where one is not."""
        if not np.all(self.settled):
            raise ConvergenceError(
                f"loaded contact: {int((~self.settled).sum())} of {self.hot.count} operating "
                "points did not settle"
            )
        return self

    @cached_property
    def line_load(self) -> Floats:
        """w [N/m] of this tooth pair."""
        return np.asarray(self.share * self.elastic.force[:, None] / self.hot.face_width)

    @cached_property
    def radius(self) -> Floats:
        """Reduced radius of curvature [m], (positions,)."""
        return reduced_radius(self.hot.pair, self.s)

    @cached_property
    def half_width(self) -> Floats:
        """Hertzian half width B [m]."""
        return hertz_half_width(self.line_load, self.radius, self.elastic.contact_modulus)

    @cached_property
    def pressure(self) -> Floats:
        """Hertzian pressure at the centre [Pa]."""
        return hertz_pressure(self.line_load, self.radius, self.elastic.contact_modulus)

    def _film_by(self, law: str) -> Floats:
        """Film thickness [m] by a named law at the inlet's temperature, shear heating included."""
        oil = self.inlet_oil
        v1, v2 = self.velocities
        entrainment, slide = 0.5 * (v1 + v2), np.abs(v1 - v2)
        ratio = np.divide(slide, entrainment, out=np.zeros_like(slide), where=entrainment > 0.0)
        conductivity = self.hot.operating.lubricant.thermal_conductivity
        thin = thermal_reduction(entrainment, ratio, oil.dynamic, oil.slope, conductivity)
        return film_thickness(
            self.line_load,
            entrainment,
            oil.dynamic,
            oil.pressure,
            self.radius,
            2.0 * self.elastic.contact_modulus,
            law=law,
            thermal_factor=thin,
        )

    @cached_property
    def film(self) -> Floats:
        """Least film thickness [m], Dowson and Higginson, inlet shear heating included.

        0 at rest, infinite without load.
        """
        return self._film_by("dowson-higginson")

    @cached_property
    def film_parameter(self) -> Floats:
        """Lambda = h_min over the flanks' combined rms roughness."""
        pair = self.hot.pair
        return film_parameter(
            self.film,
            roughness_1=rms_roughness(self.hot.roughness(pair.pinion)),
            roughness_2=rms_roughness(self.hot.roughness(pair.wheel)),
        )

    @cached_property
    def central_film_parameter(self) -> Floats:
        """Central film (Grubin, inlet shear heating included) over the flanks' mean Ra."""
        pair = self.hot.pair
        return mean_roughness_film_parameter(
            self._film_by("grubin"),
            roughness_1=self.hot.roughness(pair.pinion),
            roughness_2=self.hot.roughness(pair.wheel),
        )

    @cached_property
    def regime(self) -> NDArray[np.int64]:
        """Index into ``heat.film.REGIMES``: boundary, mixed, elastohydrodynamic."""
        return regime(self.film_parameter)

    @cached_property
    def state(self) -> ContactState:
        """All that a friction law may ask for."""
        return self._state(FILMS)

    def _state(self, films: Sequence[str]) -> ContactState:
        """The same with some of the films alone: they cost as much as all the rest."""
        pair, oil = self.hot.pair, self.hot.operating.lubricant
        v1, v2 = self.velocities
        pitch = np.array([pair.path.c])
        at_1, at_2 = rolling_velocities(pair, self.hot.operating.speed[:, None], pitch)
        return ContactState(
            line_load=self.line_load,
            speed_1=v1,
            speed_2=v2,
            reduced_radius=self.radius,
            pressure=self.pressure,
            viscosity=self.viscosity,
            roughness=0.5 * (self.hot.roughness(pair.pinion) + self.hot.roughness(pair.wheel)),
            kinematic_viscosity=self.inlet_oil.kinematic,
            **{name: getattr(self, name) for name in films},
            bath_viscosity=self.bath_viscosity,
            pressure_viscosity=self.inlet_oil.pressure,
            pitch_point=PitchPoint(
                line_load=self.elastic.force[:, None] / self.hot.face_width,
                sum_speed=at_1 + at_2,
                reduced_radius=reduced_radius(pair, pitch),
                face_width=self.hot.face_width,
            ),
            lubricant_kind=oil.kind,
        )

    @cached_property
    def dry(self) -> Floats:
        """Constant dry friction."""
        return ConstantDry(self.hot.model.dry_coefficient)(self.state)

    @cached_property
    def mixed(self) -> Floats:
        """Benedict and Kelley's; nan beyond their roughness, where the law has no value."""
        rough = np.asarray(self.state.roughness)
        fine = rough < ROUGHNESS_LIMIT
        if not np.any(fine):
            return np.full(self.state.shape, np.nan)
        if np.all(fine):
            return BenedictKelley()(self.state)
        smooth = replace(self.state, roughness=np.where(fine, rough, rough[fine].min()))
        return np.where(fine, BenedictKelley()(smooth), np.nan)

    @cached_property
    def friction(self) -> Floats:
        """|mu| by the model's law."""
        law = self.hot.model.law
        if isinstance(law, ConstantDry):
            return self.dry
        return law(self._state(getattr(law, "films", FILMS)))

    @cached_property
    def band(self) -> tuple[Floats, Floats]:
        """(least, greatest) |mu| of the laws of oiled contacts within their range."""
        return laws_together(self.state, LUBRICATED).band()

    @cached_property
    def outside(self) -> NDArray[np.bool_]:
        """Where the contact leaves the range of the model's friction law."""
        return outside_range(self.hot.model.law, self.state)

    @cached_property
    def flash_of_unit_friction(self) -> Floats:
        """Flash temperature rise [K] for |mu| = 1, common to both flanks, by the model's method.

        The heat is linear in the coefficient and its partition does not know it.
        """
        pair, model = self.hot.pair, self.hot.model
        v1, v2 = self.velocities
        return flash_temperature(
            1.0,
            self.line_load,
            speed_1=v1,
            speed_2=v2,
            half_width=self.half_width,
            material_1=pair.pinion.material,
            material_2=pair.wheel.material,
            distribution=model.heat_distribution,
            method=model.flash,
        )

    def flash(self, friction: Floats) -> Floats:
        """Flash temperature rise [K] under ``friction``; nan where that is unknown."""
        return np.asarray(friction * self.flash_of_unit_friction)

    def contact(self, flash: Floats) -> Floats:
        """Greatest contact temperature [K] of both flanks under a ``flash`` [K]."""
        return contact_temperature(
            flash,
            self.heat_share,
            bulk_1=self.body_temperatures[0],
            bulk_2=self.body_temperatures[1],
        )

    @cached_property
    def heat_share(self) -> Floats:
        """Share of the frictional heat into the pinion."""
        pair = self.hot.pair
        v1, v2 = self.velocities
        return heat_partition(
            speed_1=v1,
            speed_2=v2,
            contact_coefficient_1=pair.pinion.material.thermal_contact_coefficient,
            contact_coefficient_2=pair.wheel.material.thermal_contact_coefficient,
        )

    @cached_property
    def body_temperatures(self) -> tuple[Floats, Floats]:
        """Body temperatures [K] of both gears at the contact's radii."""
        pair = self.hot.pair
        r1, r2 = flank_radii(pair, self.s)
        return (
            self.hot.field(pair.pinion).temperature(r1),
            self.hot.field(pair.wheel).temperature(r2),
        )

    @cached_property
    def heat(self) -> Floats:
        """Frictional heat of this pair per width [W/m]."""
        v1, v2 = self.velocities
        return frictional_heat(self.friction, self.line_load, speed_1=v1, speed_2=v2)

    @cached_property
    def exchange(self) -> Floats:
        """Heat from flank to flank per width and kelvin of their difference [W/(m K)]."""
        pair = self.hot.pair
        v1, v2 = self.velocities
        return flank_exchange(
            self.half_width,
            speed_1=v1,
            speed_2=v2,
            contact_coefficient_1=pair.pinion.material.thermal_contact_coefficient,
            contact_coefficient_2=pair.wheel.material.thermal_contact_coefficient,
        )
