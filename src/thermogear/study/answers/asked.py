"""What several answers share: the case, its mesh cycles, the surveys; and how one is held."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.settle import UNDECIDED
from thermogear.analysis.side_by_side import RULE
from thermogear.base.arrays import Floats
from thermogear.base.display import worded
from thermogear.base.excitation import fourier_rows
from thermogear.base.limits import LIMITS, NO_LIMIT
from thermogear.base.progress import Progress
from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.base.vocabulary import HEAT_NOT_SETTLED, STATUS, STILL, is_known
from thermogear.case.case import GearCase
from thermogear.case.duty import chosen_point, point_duty
from thermogear.case.flank_schema import LEAST_PARTS
from thermogear.case.points import excitations, points_of
from thermogear.case.response import VALUES
from thermogear.case.thermal_state import HOT, ThermalState
from thermogear.dynamics.turns import SLOWEST_PART, longest
from thermogear.gears.deviations import Deviation
from thermogear.gears.turn import mean_tooth, numbered_from
from thermogear.mesh.balance import Gearbox, HeatBalance
from thermogear.mesh.balance_table import LOSSES
from thermogear.mesh.clearance import PARTS
from thermogear.mesh.elastic import ElasticPair, elastic_pair
from thermogear.mesh.excite import EXCITES
from thermogear.mesh.model import MeshModel
from thermogear.mesh.thermal import HotPair
from thermogear.mesh.warm_up import WarmUp, warm_up
from thermogear.results.answer import Answer
from thermogear.study.series import Series, SeriesPoint, series_motion
from thermogear.study.speeds import FARTHEST, Speeds, look, motions_of, starts_of

Cycle = Mapping[str, NDArray[Any]]
MOVES = (*EXCITES, "status", "pinion_speed", "pinion_torque")
OF_COLD = ("transmission_error",)
OF_HOT = (
    *EXCITES,
    "greatest_flash_temperature",
    "least_film_parameter",
    "normal_force",
    "transmission_error",
    "mean_stiffness",
    "least_half_backlash",
    *(f"half_backlash_by_{part}" for part in PARTS),
    "jam_temperature",
)
"""What the answers take from the mesh cycle, undeformed and hot."""
MOST_POINTS = 60
"""Operating points that are answered one by one."""
SLOWEST = 1e-3
"""Mesh over natural frequency below which no motion is followed: vibrations die out within a small
part of a mesh period."""
WARMEST_USUAL = ZERO_CELSIUS + 120.0
"""Oil [K] at which it is said what a bath carries: above the limits of all kinds of oil."""
MOST_WETTED = 0.5
"""The other end of the band in which the wetted share of a gear is guessed (ours)."""
NO_BATH = "it rests on an oil bath that cannot exist"
MOST_ASSEMBLIES = 8
"""Assemblies of gears whose teeth differ that are computed (chosen)."""
POSITIONS = 60
"""Phases of a mesh period at which another drawing or assembly is solved: enough for two figures of
its error (:data:`~thermogear.mesh.elastic.TURN_POSITIONS` move it by some percent)."""
WARM_UP_TOLERANCE = 0.1
"""Error [K] of temperatures."""


SERIES_POINTS = 4
"""Operating points up to which a series is answered for at each; else at the hardest and at that of
the least torque, where flanks part first."""
LOWEST, HIGHEST, STEP = 0.1, 1.4, 0.06
"""Mesh over natural frequency of a series, from where the tenth harmonic meets it, and the step."""


@dataclass(frozen=True, eq=False)
class Asked:
    """A case with its two mesh cycles, and the surveys that several answers share."""

    case: GearCase
    model: MeshModel
    cold: Cycle
    hot: Cycle
    progress: Progress

    @property
    def count(self) -> int:
        """How many operating points the case has."""
        return int(self.hot["status"].size)

    def _part(self, points: list[int]) -> dict[str, NDArray[Any]]:
        """What moves the hot pair at some operating points.

        Over a turn with its least half backlash all along: motions that do not reach the back side
        are the same with any, and a hit is told rather than missed.
        """
        part = {name: self.hot[name][points] for name in MOVES}
        if self.mesh_periods > 1:
            part["half_backlash"] = self.hot["least_half_backlash"][points]
        return part | {"mesh_periods": np.full(len(points), self.mesh_periods)}

    @cached_property
    def points(self) -> list[int]:
        """The operating points that are answered: all, of very many a spread and the hardest."""
        count = self.count
        spread = np.linspace(0, count - 1, min(count, MOST_POINTS)).round().astype(int)
        return sorted({*spread.tolist(), self.hardest})

    def at(self, point: int) -> str:
        """The operating point in words; empty where the case has one alone."""
        if self.count == 1:
            return ""
        rpm = float(self.hot["pinion_speed"][point]) / RPM
        return f"{rpm:.6g} rpm, {float(self.hot['pinion_torque'][point]):.6g} N m"

    def moves(self, point: int) -> bool:
        return STATUS[int(self.hot["status"][point])] == "ok"

    def no_bath(self, point: int) -> str:
        """Why no oil bath is kept at a point; empty where one is, or no oil is known.

        Words for the figure "hottest_bath".
        """
        used = self.case.stated.lubricant
        if not self.bodies[0][point] > used.hottest_bath:
            return ""
        bound = "its flash point" if used.flash_point else "as its flash point is not given"
        return f"no oil bath exists above {{hottest_bath:.0f °C}}, {bound}"

    def unsettled(self, point: int) -> str:
        """Why nothing hot is stated of a point; empty where it is."""
        if why := self.lost(point):
            return why
        return NO_BATH if self.no_bath(point) else ""

    def lost(self, point: int) -> str:
        """Why nothing hot is known of a point; empty where it is."""
        status = int(self.hot["status"][point])
        if is_known(status):
            return ""
        words = STILL[STATUS[status]]
        why = self.case.balance(self.model).lost.get(point) if status == HEAT_NOT_SETTLED else ""
        return words + f": {why}" * bool(why)

    def still(self, point: int) -> str:
        """Why the hot pair does not move at a point; empty where it does."""
        jammed = bool(self.hot["status"][point] == STATUS.index("jammed"))
        return self.unsettled(point) or "the hot pair is jammed" * jammed

    @cached_property
    def hardest(self) -> int:
        """The operating point of the greatest power."""
        at = self.case.stated
        return int(np.argmax(at.speed * at.torque))

    @cached_property
    def bodies(self) -> tuple[Floats, Floats]:
        """(oil, hotter teeth) [K] of every point."""
        at = self.case.operating_of(self.model)
        teeth = np.maximum(at.temperatures.pinion_addendum, at.temperatures.wheel_addendum)
        shape = (self.count,)
        return np.broadcast_to(at.oil_temperature, shape), np.broadcast_to(teeth, shape)

    @property
    def mesh_periods(self) -> int:
        """After how many of them the pair repeats itself: over so many it is answered."""
        return self.case.period.mesh_periods

    @property
    def worst_pair(self) -> str:
        """Of which tooth pair flash and film are, in words; none where all are alike."""
        return " in the worst tooth pair of the turn" * (
            self.mesh_periods > 1 and self.model.sharing == "loaded"
        )

    @cached_property
    def mean_tooth(self) -> tuple[Deviation, ...]:
        """The deviations that all teeth share."""
        return mean_tooth(self.case.pair, self.case.deviations)

    def elastic(
        self, state: ThermalState, point: int, deviations: Sequence[Deviation]
    ) -> ElasticPair:
        """The springs of the pair with ``deviations`` at one operating point."""
        return elastic_pair(self.hot_pair(state, point), deviations)

    def hot_pair(self, state: ThermalState, point: int) -> HotPair:
        """The pair in a ``state`` of heat at one operating point."""
        operating = state.operating(self.case, self.model).part(slice(point, point + 1))
        return HotPair(self.case.pair, replace(operating, housing=self.case.housing), self.model)

    @property
    def pinion(self) -> Floats:
        """The pinion's teeth [K] of every point: a jam is told by them."""
        at = self.case.operating_of(self.model).temperatures
        return np.broadcast_to(np.asarray(at.pinion_addendum), (self.count,))

    def _balance(self, box: Gearbox) -> HeatBalance:
        """The heat balance of every point in another gearbox, reached from cold."""
        at = self.case.stated
        return self.case.balance_of(
            self.model, at.speed, at.torque, gearbox=box, varied=at.varied, from_hot=False
        )

    @cached_property
    def bath(self) -> tuple[Floats, Floats]:
        """(heat made, heat that the bath carries off) [W] with its oil at 120 C, every point."""
        held = {**self.case.gearbox.measured, "oil": WARMEST_USUAL}
        found = self._balance(replace(self.case.gearbox, measured=held))
        every = sum(np.asarray(getattr(found.losses, name)) for name in LOSSES)
        made = np.where(found.settled, every, np.nan)
        return made, made - found.steady.heat_out["oil"]

    @cached_property
    def _wetted(self) -> HeatBalance | None:
        """The heat balance with half of the gears wetted.

        None where the share is given, or nothing is computed with it.
        """
        left_out = (a.field for a in self.case.assumptions if a.default)
        if not self.case.computed or "gearbox.wetted_share" not in left_out:
            return None
        around = replace(self.case.gearbox.surroundings, wetted_share=(MOST_WETTED, MOST_WETTED))
        return self._balance(replace(self.case.gearbox, surroundings=around))

    @cached_property
    def wetter(self) -> tuple[Floats, Floats] | None:
        """(oil, hotter teeth) [K] with half of the gears wetted, nan where nothing settles.

        None where the share is given, or nothing is computed with it.
        """
        found = self._wetted
        if found is None:
            return None
        oil, first, second = (
            np.where(found.settled, found.steady[name], np.nan)
            for name in ("oil", "pinion_tooth", "wheel_tooth")
        )
        return oil, np.maximum(first, second)

    @property
    def in_series(self) -> bool:
        """Whether the answers are of a series of parts."""
        return self.case.series > 1 and self.model.stiffness == "loaded"

    @property
    def points_of_series(self) -> list[int]:
        """The operating points that a series is answered for."""
        if self.count <= SERIES_POINTS:
            return self.points
        at = self.case.stated
        lightest = np.lexsort((-at.speed, np.where(at.torque > 0.0, at.torque, np.inf)))[0]
        return sorted({self.hardest, int(lightest)})

    @cached_property
    def series(self) -> dict[int, SeriesPoint]:
        """The pairs of the series by operating point, where they move; empty of one part alone."""
        case = self.case
        if not self.in_series:
            return {}
        by_point = {}
        points = [
            point
            for point in self.points_of_series
            if not self.still(point) and case.stated.torque[point] > 0.0
        ]
        for number, point in enumerate(points):
            self.progress("series", number, len(points))
            speed = float(case.stated.speed[point])
            by_point[point] = self._parts.followed(
                self.hot_pair(HOT, point),
                excitations(case, self._part([point])),
                self._speeds_of_series,
                own_speed=speed,
                bounds_to=speed,
            )
        return by_point

    @cached_property
    def _parts(self) -> Series:
        return Series.of(self.case)

    def wetter_factors(self, point: int) -> Floats | None:
        """Dynamic factors of the first parts of the series with half of the gears wetted, (part,).

        Of the least number of parts, at the first damping and the own speed; None as of
        :attr:`wetter`, and where the heat does not settle.
        """
        found, case = self._wetted, self.case
        if found is None or not found.settled[point]:
            return None
        at = replace(found.operating.part(slice(point, point + 1)), housing=case.housing)
        mesh = self._parts.some(slice(LEAST_PARTS)).mesh(HotPair(case.pair, at, self.model))
        speed, damping = case.stated.speed[[point]], np.array(case.dampings[:1])
        motion = series_motion(mesh, excitations(case, self._part([point])), speed, damping)
        return motion.dynamic_factor[0, :, 0]

    @cached_property
    def _speeds_of_series(self) -> Floats:
        """Speeds [rad/s] of a series, the same at each operating point, with their own."""
        own = self.case.stated.speed[self.points_of_series]
        natural = np.sqrt(self.hot["mean_stiffness"][self.hardest] / self.case.equivalent_mass)
        natural /= self.case.pair.pinion.teeth
        high = max(HIGHEST, min(1.1 * own.max() / natural, FARTHEST))
        count = int(np.ceil(np.log(high / LOWEST) / np.log1p(STEP)))
        return np.unique(np.append(natural * np.geomspace(LOWEST, high, count + 1), own))

    @cached_property
    def warming(self) -> WarmUp:
        """The way from cold to steady at the hardest point."""
        case, at = self.case, self.case.stated
        self.progress("warm-up", 0, 1)
        found = warm_up(
            case.pair,
            point_duty(case, *chosen_point(case)),
            at.lubricant,
            at.half_backlash,
            self.model,
            gearbox=case.gearbox,
            reference=at.temperatures.reference,
            housing=at.housing,
            deviations=case.deviations,
            moments=40,
            tolerance=WARM_UP_TOLERANCE,
        )
        self.progress("warm-up", 1, 1)
        return found

    @cached_property
    def speeds(self) -> Speeds | None:
        """Motions over speed at the hardest point; None where it does not move."""
        if not self.moves(self.hardest) or self.unsettled(self.hardest):
            return None
        self.progress("speeds", 0, 1)
        mesh = excitations(self.case, self._part([self.hardest]))
        if mesh.status[0] != STATUS.index("ok"):
            return None
        found = look(mesh, teeth=self.case.pair.pinion.teeth, own=self.case.stated.speed)
        self.progress("speeds", 1, 1)
        return found

    @cached_property
    def assemblies(self) -> tuple[Floats, Floats]:
        """Static error [m] peak to peak and dynamic factor, greatest of the motions, of assemblies.

        Of the hardest point, hot as it is: of those that gears of a common divisor can be put
        together in, beside the case's own, evenly chosen, :data:`MOST_ASSEMBLIES` with it at most.
        Empty where there is one alone, or the case states its marks; nan where nothing settles.
        """
        case, count = self.case, self.case.assembly_count
        if count == 1 or case.file.gears.marks is not None:
            return np.empty(0), np.empty(0)
        mesh = excitations(case, self._part([self.hardest]))
        phase = np.arange(POSITIONS) / POSITIONS
        errors, factors = [], []
        for wheel in np.linspace(0, count, min(count, MOST_ASSEMBLIES), endpoint=False).astype(int)[
            1:
        ]:
            flanks = [
                numbered_from(case.pair, deviation, wheel=int(wheel))
                for deviation in case.deviations
            ]
            curves = self.elastic(HOT, self.hardest, flanks).over(phase)
            errors.append(float(np.ptp(curves.transmission_error)))
            highest = min(case.harmonics, POSITIONS // 2 - 1) * self.mesh_periods
            here = points_of(
                replace(
                    mesh,
                    stiffness=fourier_rows(curves.stiffness, highest),
                    error=fourier_rows(np.asarray(curves.spring_error), highest),
                )
            )
            _, figures = motions_of(here, starts_of(here))
            factors.append(float(np.nanmax(figures["dynamic_factor"], initial=-np.inf)))
        return np.array(errors), np.where(np.isfinite(factors), factors, np.nan)

    def slow(self, point: int) -> bool:
        """Whether the pair turns so slowly that no motion is followed."""
        natural = np.sqrt(self.hot["mean_stiffness"][point] / self.case.equivalent_mass)
        mesh = self.case.pair.pinion.teeth * self.case.stated.speed[point]
        # parts differ somewhat in their natural frequency
        return bool(mesh < (1.1 * SLOWEST_PART if self.in_series else SLOWEST) * natural)

    def motionless(self, point: int) -> str:
        """Why a moving pair has no steady motion at a point."""
        if not self.case.stated.torque[point] > 0.0:
            return "there is no load"
        slow = "it turns too slowly to vibrate"
        if self.in_series:
            slow = "it turns too slowly for a series: ask for one part by flanks.parts"
        most = RULE.cap if self.mesh_periods == 1 else longest(self.mesh_periods)
        return slow if self.slow(point) else f"no motion is steady within {most} mesh periods"

    @cached_property
    def motion(self) -> dict[str, Floats]:
        """Figures (point, motion) of the motions at the operating points answered, else nan.

        From rest first, then from the other starts of the look over speeds and from the motions
        that it found within a step of the point's own. Where a motion does not settle ``undecided``
        is 1, its figures nan or, over a turn, of the later half of what was followed. Nan too where
        the pair turns so slowly that none is followed: the load is static.
        """
        points = points_of(excitations(self.case, self._part(self.points)))
        slow = np.array([self.slow(point) for point in self.points])
        stated = np.array([not self.unsettled(point) for point in self.points])
        moving = np.flatnonzero((points.status == 0) & ~slow & stated)
        if not moving.size:
            return {name: np.full((self.count, 1), np.nan) for name in (*VALUES, "undecided")}
        points = points.take(moving)
        starts = starts_of(points)
        if self.speeds is not None:
            speed = points.mesh_frequency / self.case.pair.pinion.teeth
            starts = np.concatenate([starts, self.speeds.beside(speed, start=starts[:, 0])], axis=1)
        motions, figures = motions_of(points, starts)
        lane = motions.lane
        figures["undecided"] = np.where(motions.label == UNDECIDED, 1.0, 0.0)
        place = np.arange(lane.size) - np.searchsorted(lane, lane)
        every = {}
        for name, values in figures.items():
            every[name] = np.full((self.count, place.max() + 1), np.nan)
            every[name][np.array(self.points)[moving[lane]], place] = values
        return every


def answer(
    question: str,
    name: str,
    sentence: str,
    value: float,
    *,
    limit: str = "",
    most: float | None = None,
    verdict: str = "",
    at: str = "",
    figures: Mapping[str, Any] = MappingProxyType({}),
    units: Mapping[str, str] = MappingProxyType({}),
) -> Answer:
    """An answer held against its limit in the table.

    ``most`` is the bound where it hangs on the case, ``verdict`` overrules where it must. The
    ``figures`` stand in the ``sentence`` as :func:`~thermogear.base.display.worded` puts them, and
    are kept beside it; ``units`` of those that it leaves out, or states without.
    """
    bound = (LIMITS | NO_LIMIT)[limit or name]
    if most is not None:
        bound = replace(bound, most=most)
    words, told = worded(sentence, figures)
    kept = {name: number for name, number in figures.items() if not isinstance(number, str)}
    return Answer(
        name=name,
        question=question,
        sentence=words,
        value=float(value) if np.isfinite(value) else None,
        unit=bound.unit,
        limit=bound.beside(float(value)),
        source=bound.source,
        verdict=verdict or bound.verdict(value),
        operating=at,
        figures=kept,
        units={name: told.get(name) or units.get(name, "") for name in kept},
    )


def undecided(question: str, name: str, why: str, **about: Any) -> Answer:
    """An answer without a value, for the reason ``why``; ``about`` as in :func:`answer`."""
    return answer(question, name, f"Not decided: {why}.", float("nan"), **about)
