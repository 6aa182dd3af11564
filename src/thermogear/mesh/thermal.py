"""Where heat and the centrifugal pull join the mesh: added flank material and moduli.

Positions s [m] are measured from the pinion's tangent point; the last axis is the position,
the first the operating point.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.gears.centrifugal import centrifugal_displacement, centrifugal_flank_growth
from thermogear.gears.contact import flank_radii, pair_positions
from thermogear.gears.deviations import Contacts
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair
from thermogear.heat.expansion import RadialField, centre_distance_growth, flank_growth
from thermogear.heat.gearbox import body_places
from thermogear.heat.thesis_profile import deformed_points, thesis_flank_growth
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Operating, Temperatures


def _column(values: ArrayLike, count: int) -> Floats:
    """One value per operating point as a column against positions."""
    return np.broadcast_to(np.asarray(values, dtype=float), (count,))[:, None]


@dataclass(frozen=True, eq=False)
class HotPair:
    """A gear pair in its temperature fields, with the model's readings of heat.

    ``operating`` gives ``count`` operating points; every result has shape (count, ...).
    """

    pair: GearPair
    operating: Operating
    model: MeshModel

    @property
    def count(self) -> int:
        return self.operating.speed.size

    @property
    def temperatures(self) -> Temperatures:
        return self.operating.temperatures

    # --- what the operating points vary ----------------------------------------------------
    def _own(self, name: str, gear: Gear) -> Floats | None:
        """A varied property of one of the two gears, (count,)."""
        side = "pinion" if gear is self.pair.pinion else "wheel"
        found: Floats | None = getattr(self.operating.varied, f"{side}_{name}")
        return found

    @property
    def half_backlash(self) -> Floats:
        """Cold half backlash [m], (count,)."""
        varied = self.operating.varied.half_backlash
        return np.full(self.count, self.operating.half_backlash) if varied is None else varied

    @property
    def face_width(self) -> float | Floats:
        """Common face width [m]; a column (count, 1) where it is varied."""
        varied = self.operating.varied.face_width
        return self.pair.face_width if varied is None else varied[:, None]

    @property
    def widened(self) -> float | Floats:
        """The face width over the pair's, 1.0 or (count, 1)."""
        return self.face_width / self.pair.face_width

    def roughness(self, gear: Gear) -> float | Floats:
        """Ra [m] of one of the two gears; a column (count, 1) where it is varied."""
        varied = self._own("roughness", gear)
        return gear.roughness if varied is None else varied[:, None]

    def expansion(self, gear: Gear) -> float | Floats:
        """lambda over the material's, 1.0 or (count, 1); all growth is linear in it."""
        varied = self._own("expansion", gear)
        return 1.0 if varied is None else varied[:, None] / gear.material.thermal_expansion

    # --- fields ------------------------------------------------------------------------------
    @cached_property
    def _fields(self) -> tuple[RadialField, RadialField]:
        return self._field(self.pair.pinion), self._field(self.pair.wheel)

    def field(self, gear: Gear) -> RadialField:
        """The radial field of one of the two gears, temperatures of shape (count, 1).

        Through bore, body, root circle and tooth where the body's node is known
        (:func:`~thermogear.heat.gearbox.body_places`); the thesis's flank keeps the one
        logarithm from bore to addendum that it is printed for.
        """
        return self._fields[0 if gear is self.pair.pinion else 1]

    def _field(self, gear: Gear) -> RadialField:
        t = self.temperatures
        bore, body, tip = (
            (t.pinion_bore, t.pinion_body, t.pinion_addendum)
            if gear is self.pair.pinion
            else (t.wheel_bore, t.wheel_body, t.wheel_addendum)
        )
        between: tuple[tuple[float, ArrayLike], ...] = ()
        if body is not None and self.model.flank != "thesis":
            between = body_places(
                gear, body=_column(body, self.count), tooth=_column(tip, self.count)
            )
        return RadialField(
            bore_radius=gear.bore_radius,
            tip_radius=gear.tip_radius,
            bore_temperature=_column(bore, self.count),
            addendum_temperature=_column(tip, self.count),
            reference=t.reference,
            between=between,
        )

    def drawn(self) -> HotPair:
        """The same pair at one operating point with nothing grown, by heat or speed."""
        points = self.operating if self.operating.varied.grows else self.operating.point(0)
        return replace(self, operating=points.as_drawn())

    def warmed(self, rise: float) -> HotPair:
        """The same pair with both gears hotter by ``rise`` [K] everywhere, housing as it is."""
        t = self.temperatures
        gears: dict[str, Any] = {
            name: kelvin + rise for name, kelvin in t.bodies.items() if name != "housing"
        }
        hotter = replace(t, **gears)
        return replace(self, operating=replace(self.operating, temperatures=hotter))

    # --- growth ---------------------------------------------------------------------
    def _pull(self, gear: Gear) -> Floats:
        """Speed [rad/s] at which ``gear`` as its material is grows as it does, (count, 1).

        Growth goes as rho omega^2/E; the thesis's flank knows none.
        """
        felt = 0.0 if self.model.flank == "thesis" else np.asarray(self.operating.pulled, float)
        over = 1.0 if gear is self.pair.pinion else self.pair.ratio
        varied = self._own("modulus", gear)
        stiffer = 1.0 if varied is None else varied / gear.material.youngs_modulus
        return _column(felt * self.operating.speed / (over * np.sqrt(stiffer)), self.count)

    def grown(self, gear: Gear, radius: ArrayLike, angle: ArrayLike) -> tuple[Floats, Floats]:
        """Where points of a gear's tooth are when it is hot and turns, (count, points).

        ``radius`` [m], ``angle`` [rad] from the tooth's centre line: by heat as
        :func:`~thermogear.heat.thesis_profile.deformed_points`, and straight outward by the pull.
        """
        times = self.expansion(gear)
        r, theta = np.asarray(radius, dtype=float), np.asarray(angle, dtype=float)
        far, turned = deformed_points(gear, self.field(gear), r, theta, self.model.bore)
        pulled = centrifugal_displacement(gear, r, self._pull(gear), self.model.bore)
        return (
            np.asarray(r + times * (far - r) + pulled),
            np.asarray(theta + times * (turned - theta) - theta * pulled / r),
        )

    def pulled_material(self, s: ArrayLike) -> tuple[Floats, Floats]:
        """Normal growth [m] of both flanks at ``s`` [m] by that pull, (count, positions)."""
        first, second = (
            centrifugal_flank_growth(gear, radius, self._pull(gear), self.model.bore)
            for gear, radius in zip(
                (self.pair.pinion, self.pair.wheel), flank_radii(self.pair, s), strict=True
            )
        )
        return first, second

    def growth(self, s: ArrayLike, taken_off: ArrayLike = 0.0) -> tuple[Floats, Floats]:
        """Normal growth [m] of pinion and wheel flank at ``s`` [m] by heat, (count, positions).

        ``taken_off`` [-] is a uniform strain that is not counted (flank growth only).
        """
        p, w = self.pair.pinion, self.pair.wheel
        r1, r2 = flank_radii(self.pair, s)
        if self.model.flank == "thesis":
            return (
                self.expansion(p) * thesis_flank_growth(p, self.field(p), r1),
                self.expansion(w) * thesis_flank_growth(w, self.field(w), r2),
            )

        def grown(gear: Gear, radius: Floats) -> Floats:
            times = self.expansion(gear)
            off = np.asarray(taken_off) / times
            field, bore = self.field(gear), self.model.bore
            return times * flank_growth(gear, field, radius, bore, strain_taken_off=off)

        return grown(p, r1), grown(w, r2)

    @property
    def _housing_expansion(self) -> float | Floats:
        """lambda_h [1/K], a number or (count,)."""
        varied = self.operating.varied.housing_expansion
        return self.operating.housing.thermal_expansion if varied is None else varied

    def axis_opening(self) -> Floats:
        """Da sin(alpha_w) [m], shape (count,): what the warm housing opens the mesh by."""
        if self.model.housing == "rigid":
            return np.zeros(self.count)
        opened = centre_distance_growth(
            self.pair.centre_distance,
            self._housing_expansion,
            temperature=np.broadcast_to(
                np.asarray(self.temperatures.housing, dtype=float), (self.count,)
            ),
            reference=self.temperatures.reference,
        )
        return np.asarray(opened * np.sin(self.pair.operating_pressure_angle))

    def added_material(self, s: ArrayLike) -> Floats:
        """S(s) = delta_n1 + delta_n2 - Da sin(alpha_w) [m], (count, positions).

        With the thesis's flank each deformation counts half, as its b' has it. The housing's
        strain is taken off before adding, because rho_1 + rho_2 = a_w sin(alpha_w): a pair as
        hot as its housing gives exactly 0.
        """
        if self.model.flank == "thesis":
            first, second = self.growth(s)
            return 0.5 * (first + second) - self.axis_opening()[:, None]
        strain: ArrayLike = 0.0
        if self.model.housing == "expands":
            rise = np.asarray(self.temperatures.housing, dtype=float) - self.temperatures.reference
            strain = _column(self._housing_expansion * rise, self.count)
        first, second = self.growth(s, strain)
        return first + second

    # --- moduli -----------------------------------------------------------------------
    def moduli(self, gear: Gear) -> tuple[Floats, Floats]:
        """(E of the teeth, E of the body) [Pa], shape (count,).

        Teeth at the pitch radius's temperature (at root or tip circle where a large profile
        shift puts the pitch circle outside the tooth), the body at its mean by area up to the
        root circle; E at 20 C where the model keeps the modulus constant.
        """
        varied = self._own("modulus", gear)
        stiffer = 1.0 if varied is None else varied / gear.material.youngs_modulus
        if self.model.modulus == "constant":
            both = np.full(self.count, gear.material.youngs_modulus) * stiffer
            return both, both
        field = self.field(gear)
        middle = min(max(gear.pitch_radius, gear.root_radius), gear.tip_radius)
        teeth = gear.material.youngs_modulus_at(field.temperature(middle))
        body = gear.material.youngs_modulus_at(field.area_mean(gear.root_radius))
        return teeth[:, 0] * stiffer, body[:, 0] * stiffer


@dataclass(frozen=True, eq=False)
class ThermalDeviation:
    """What heat and speed add to both flanks as a deviation of the loaded contact."""

    hot: HotPair

    def gap(self, at: Contacts) -> Floats:
        """-(S_1 + S_2) [m] at the contacts, (count, position, pair).

        A tip corner off the path carries the growth of the path's end: what shifts every flank
        alike then changes nothing.
        """
        by_pull, by_heat = self.gaps(at)
        return by_pull + by_heat

    def gaps(self, at: Contacts) -> tuple[Floats, Floats]:
        """:meth:`gap` by the centrifugal pull and by heat, apart."""
        s, again = np.clip(at.s, at.pair.path.a, at.pair.path.e), None
        if np.ptp(at.phase) > 1.0:
            # every mesh period has the same places, but for the rounding of its phases
            fraction = np.round(at.phase % 1.0, 11)
            _, first, again = np.unique(fraction, return_index=True, return_inverse=True)
            s = s[first]
        shape, flat = (self.hot.count, *s.shape), s.ravel()
        added = np.add(*self.hot.pulled_material(flat)), self.hot.added_material(flat)
        pull, heat = (-part.reshape(shape) for part in added)
        return (pull, heat) if again is None else (pull[:, again], heat[:, again])


def _carried(
    positions: Floats, values: Callable[[Floats], Floats], weights: Callable[[Floats], Floats]
) -> Floats:
    """sum_j k_j S_j / sum_j k_j over the pairs present; (phases, pairs) -> (count, phases)."""
    present = np.isfinite(positions)
    filled = np.where(present, positions, float(positions[present].flat[0]))
    shape = filled.shape
    k = np.where(present.ravel(), weights(filled.ravel()), 0.0).reshape(-1, *shape)
    s = values(filled.ravel()).reshape(-1, *shape)
    return np.asarray((k * s).sum(axis=-1) / k.sum(axis=-1))


def thesis_thermal_stiffness(
    hot: HotPair, phase: Floats, weights: Callable[[Floats], Floats]
) -> Floats:
    """The thesis's k_T over the mesh phase [N/m], (count, phases).

    k_Ti = F_n/Delta f_i (the printed division by the face width would leave N/m^2),
    k_T = k_T1 k_T2/(k_T1 + k_T2) = F_n/(Delta f_1 + Delta f_2), Delta f the mean over the pairs
    in contact by their stiffness ``weights`` (positions -> (count, positions)). Where nothing has
    grown the print tends to infinity; 0 is returned there. It grows with load and falls as the
    gear heats: heat is no spring.
    """
    force = hot.operating.torque / hot.pair.pinion.base_radius
    drive = pair_positions(hot.pair, phase)
    grown = _carried(drive, lambda s: np.add(*hot.growth(s)), weights)
    return np.divide(force[:, None], grown, out=np.zeros_like(grown), where=grown > 0.0)
