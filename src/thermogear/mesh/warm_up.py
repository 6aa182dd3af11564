"""A gear pair through its duty: the closed loop of friction and heat in time, from a cold start.

Gears warm before their housing: the backlash is often least on the way and not at the end.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base import bounds
from thermogear.base.arrays import Floats
from thermogear.base.errors import ConvergenceError, InputError, ValidityWarning
from thermogear.base.materials import MATERIALS, Lubricant, Material
from thermogear.base.progress import Progress, silent
from thermogear.gears.deviations import Deviation
from thermogear.gears.pair import GearPair
from thermogear.gears.turn import mean_tooth
from thermogear.heat.free_convection import with_free_convection
from thermogear.heat.gearbox import Losses, joined, thermal_network
from thermogear.heat.network import ThermalNetwork
from thermogear.heat.transient import Course, State, Stretch, follow
from thermogear.mesh.balance import Gearbox, HeatedPair, node_temperatures, pair_losses
from thermogear.mesh.clearance import Clearance
from thermogear.mesh.cycle import mesh_cycle
from thermogear.mesh.mesh_heat import PHASES as HEAT_PHASES
from thermogear.mesh.mesh_heat import MeshHeat, mesh_heat
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Operating
from thermogear.mesh.thermal import HotPair

PHASES = 240
"""Mesh phases at which the least half backlash is looked for, as many as a mesh cycle has.

With 32 the least of flanks with deviations was missed by up to 1.3 % of it."""
BLOCK = 200
"""Moments that are evaluated together: memory, not the result."""
TURN_POSITIONS, LEAST_PHASES = 16384, 12
"""Positions over a turn at which a moment's load is shared, in whole phases of each mesh period, at
least so many: up to 341 mesh periods those of the heat balance. 12 to 16 phases give the mesh's
loss within 1.5 % of 48 (5 % at 2 N/mm and pitch errors of 3 um)."""
MESHED = 100
"""Moments whose mesh is solved together."""


@dataclass(frozen=True, kw_only=True)
class Duty:
    """What a pair has to do: pieces in which speed, torque and ambient stay.

    ``time`` [s], shape (pieces + 1,), rising from 0: the beginning of every piece and the end of
    the last, which may be inf (until steady). ``speed`` [rad/s] >= 0 and ``torque`` [N m] >= 0 of
    the pinion and ``ambient`` [K], shape (pieces,). Raises InputError in one line otherwise.

    >>> Duty(time=[0.0, 600.0], speed=[100.0], torque=[200.0], ambient=[293.15]).time
    array([  0., 600.])
    """

    time: Floats
    speed: Floats
    torque: Floats
    ambient: Floats

    def __post_init__(self) -> None:
        for name in ("time", "speed", "torque", "ambient"):
            values = np.atleast_1d(np.asarray(getattr(self, name), dtype=float))
            object.__setattr__(self, name, values)
        t = self.time
        rising = t.ndim == 1 and t.size > 1 and t[0] == 0.0 and bool(np.all(np.diff(t) > 0.0))
        if not rising:
            raise InputError("duty.time", f"{t.size} times", allowed="two or more, rising from 0 s")
        for name, allowed in (
            ("speed", bounds.SPEED),
            ("torque", bounds.TORQUE),
            ("ambient", bounds.BODY),
        ):
            values = getattr(self, name)
            if values.shape != (t.size - 1,):
                raise InputError(
                    f"duty.{name}", f"{values.size} values", allowed=f"one a piece, {t.size - 1}"
                )
            allowed.require(f"duty.{name}", values)

    @classmethod
    def steady(cls, speed: float, torque: float, *, ambient: float) -> Duty:
        """One piece held until it is steady: ``speed`` [rad/s], ``torque`` [N m], ambient [K]."""
        return cls(
            time=np.array([0.0, np.inf]),
            speed=np.array([speed]),
            torque=np.array([torque]),
            ambient=np.array([ambient]),
        )

    @property
    def pieces(self) -> int:
        """How many pieces there are."""
        return int(self.speed.size)


@dataclass(frozen=True, kw_only=True)
class Worst:
    """The moment of the least half backlash.

    ``time`` [s], ``half_backlash`` [m] (<= 0: jammed), ``margin`` [K] by which both gears could be
    hotter, the housing as it is, until the backlash is used up (nan where no heat does it),
    ``temperatures`` [K] of the free nodes, ``piece`` of the duty.
    """

    time: float
    half_backlash: float
    margin: float
    temperatures: dict[str, float]
    piece: int


@dataclass(frozen=True, eq=False, kw_only=True)
class WarmUp:
    """A pair through its duty, arrays (time,); a jump of the duty is there twice, before and after.

    ``time`` [s] and ``piece`` of the duty; ``temperatures`` [K] of all nodes, given ones too;
    ``losses`` [W]; ``half_backlash`` least over the mesh phase [m]; ``margin`` to the jam [K];
    ``operating``: the state at every moment; ``course``: heat in, out and kept, and any moment
    between; ``worst`` moment; ``jams`` [s] when the backlash is used up; ``held`` nodes [K]. What
    the temperatures lead to is computed when it is first asked for; ``losses`` warn once where the
    oil leaves its viscosity line.
    """

    duty: Duty
    course: Course
    _chain: _Chain = field(repr=False)

    @property
    def time(self) -> Floats:
        return self.course.time

    @property
    def piece(self) -> NDArray[np.int64]:
        return self.course.stretch

    @property
    def held(self) -> Mapping[str, float]:
        return self._chain.held

    @property
    def temperatures(self) -> dict[str, Floats]:
        held = {name: np.full(self.time.size, t) for name, t in self.held.items()}
        return {**self.course.temperatures, **held, "ambient": self.duty.ambient[self.piece]}

    @cached_property
    def operating(self) -> Operating:
        return self._chain.operating(self._state)

    @property
    def _state(self) -> State:
        return self._at(self.course.temperatures, self.piece)

    def _at(self, state: State, piece: ArrayLike) -> State:
        """What the chain finds at temperatures of the course in ``piece`` of the duty."""
        return {**state, "piece": np.broadcast_to(piece, np.shape(next(iter(state.values()))))}

    @cached_property
    def losses(self) -> Losses:
        return self._chain.losses_of(self._state)

    @cached_property
    def _clearance(self) -> Clearance:
        return self._chain.clearance(self._state)

    @cached_property
    def half_backlash(self) -> Floats:
        return self._clearance.least

    @property
    def margin(self) -> Floats:
        teeth = self.temperatures["pinion_tooth"]
        return np.asarray(self._clearance.jam_temperature - teeth)

    def _gap(self, state: State, piece: ArrayLike) -> Floats:
        """Least half backlash [m] of states (count,) in ``piece`` of the duty."""
        return self._chain.clearance(self._at(state, piece)).least

    @cached_property
    def jams(self) -> Floats:
        left, still = self.half_backlash, np.diff(self.time) == 0.0
        # a leap of the speed may use up the backlash at once
        leaps = np.flatnonzero((left[1:] <= 0.0) & (left[:-1] > 0.0) & still)
        return np.sort(np.concatenate([self.course.falls(self._gap), self.time[leaps]]))

    @cached_property
    def worst(self) -> Worst:
        """Located between the stored moments."""
        left, place = self.half_backlash, int(np.argmin(self.half_backlash))
        when, piece = float(self.time[place]), int(self.piece[place])
        ends = self.time[max(place - 1, 0)], self.time[min(place + 1, left.size - 1)]
        if ends[0] < when < ends[1]:
            for _ in range(3):
                near = np.linspace(*ends, 17)
                gaps = self._gap(self.course.at(near), piece)
                place = int(np.argmin(gaps))
                ends = near[max(place - 1, 0)], near[min(place + 1, near.size - 1)]
            when = float(near[place]) if gaps[place] <= left.min() else when
        state = {name: np.atleast_1d(t) for name, t in self.course.at(when).items()}
        here = self._chain.clearance(self._at(state, [piece]))
        return Worst(
            time=when,
            half_backlash=float(here.least[0]),
            margin=float(
                here.jam_temperature[0] - np.ravel(here.hot.temperatures.pinion_addendum)[0]
            ),
            temperatures={name: float(t[0]) for name, t in state.items()},
            piece=piece,
        )


def warm_up(
    pair: GearPair,
    duty: Duty,
    lubricant: Lubricant,
    half_backlash: float,
    model: MeshModel | None = None,
    *,
    gearbox: Gearbox | None = None,
    start: float | Mapping[str, float] | None = None,
    reference: float = 293.15,
    housing: Material = MATERIALS["steel"],
    deviations: Sequence[Deviation] = (),
    times: ArrayLike = (),
    moments: int = 60,
    tolerance: float = 1e-3,
    progress: Progress = silent,
) -> WarmUp:
    """Temperatures, half backlash and jam of a pair over its ``duty``.

    C dT/dt = q(T) - G(T) T with the losses of the mesh, churning and bearings and every conductance
    at the present temperatures, as :func:`heat_balance` has them; see
    :func:`~thermogear.heat.transient.follow`. At rest free convection remains between gears and
    oil (:func:`~thermogear.heat.free_convection.with_free_convection`). The friction of the mesh
    and the conductance of its contact are computed at some moments and interpolated between.

    ``lubricant``, ``half_backlash`` [m] cold, ``model``, ``gearbox`` (its measured nodes held from
    the start; its ambient is the duty's), ``reference`` [K], ``housing`` and ``deviations`` as
    :func:`heat_balance`; ``start`` [K] of all nodes or by node, else the first ambient;
    ``times`` [s] to be stored with some ``moments`` of each piece;
    ``tolerance`` [K] of the temperatures' error.

    A jam does not end the course; a node of 700 K does. Raises ConvergenceError where the loaded
    contact does not settle.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> duty = Duty(time=[0.0, 600.0], speed=[100.0], torque=[200.0], ambient=[293.15])
    >>> course = warm_up(pair, duty, lubricant("FVA3"), 60e-6)
    >>> f"{course.temperatures['oil'][-1] - 273.15:.1f} C"
    '24.1 C'
    """
    chain = _Chain(
        pair=pair,
        duty=duty,
        lubricant=lubricant,
        half_backlash=half_backlash,
        model=MeshModel.consistent() if model is None else model,
        box=Gearbox() if gearbox is None else gearbox,
        reference=reference,
        housing=housing,
        deviations=deviations,
    )
    with warnings.catch_warnings(action="ignore", category=ValidityWarning):
        # told once, by the losses
        course = follow(
            [
                Stretch(
                    end=float(end),
                    network=chain.network,
                    lagging=chain.mesh,
                    given={"piece": piece},
                )
                for piece, end in enumerate(duty.time[1:])
            ],
            chain.start(start, float(duty.ambient[0])),
            times=times,
            moments=moments,
            tolerance=tolerance,
            progress=progress,
        )
    return WarmUp(duty=duty, course=course, _chain=chain)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Chain(HeatedPair):
    """From temperatures to losses, conductances and clearance of one pair in its duty.

    States hold temperatures [K] of the free nodes and the ``piece`` of the duty, arrays (count,).
    """

    duty: Duty
    held: dict[str, float] = field(init=False)

    def __post_init__(self) -> None:
        held = {name: float(np.ravel(t)[0]) for name, t in self.box.measured.items()}
        object.__setattr__(self, "held", held)

    def start(self, given: float | Mapping[str, float] | None, cold: float) -> dict[str, float]:
        """Temperatures [K] of the free nodes at time 0, of an ambient of ``cold`` [K]."""
        named = given if isinstance(given, Mapping) else {}
        whole = cold if given is None or isinstance(given, Mapping) else float(given)
        bounds.BODY.require("start", [whole, *named.values()])
        free = [name for name in self.box.nodes if name not in self.held]
        for name in named:
            if name not in free:
                raise InputError("start", repr(name), allowed=" | ".join(free))
        return {name: float(named.get(name, whole)) for name in free}

    def nodes(self, state: State) -> dict[str, Floats]:
        """Temperatures [K] of all nodes, held ones too, (count,)."""
        whole = np.shape(state["piece"])
        return {
            n: np.full(whole, self.held[n]) if n in self.held else state[n] for n in self.box.nodes
        }

    def operating(self, state: State) -> Operating:
        """The operating points of a state."""
        at, piece = self.nodes(state), np.asarray(state["piece"], dtype=int)
        return Operating(
            self.duty.speed[piece],
            self.duty.torque[piece],
            self.lubricant,
            at["oil"],
            node_temperatures(at, self.reference),
            self.half_backlash,
            self.housing,
        )

    def mesh(self, state: State) -> Floats:
        """Friction power [W], its share into the pinion and conductance [W/K], (count, 3)."""
        elastic = self.elastic(self.operating(state))
        phases = max(TURN_POSITIONS // elastic.mesh_periods, LEAST_PHASES)
        means = mesh_heat(elastic, min(HEAT_PHASES, phases))
        if not means.settled.all():
            count = int(np.count_nonzero(~means.settled))
            raise ConvergenceError(
                f"loaded contact: {count} of {means.settled.size} operating points did not settle"
            )
        return np.stack([means.power, means.partition, means.conductance], axis=1)

    def losses(self, state: State, at: Operating) -> Losses:
        """Of the whole chain at the operating points of a state, its mesh as it lags there."""
        power, first, between = np.clip(state["lagging"], 0.0, [np.inf, 1.0, np.inf]).T
        means = MeshHeat(power, first, between, 0.0 * power, power >= 0.0, 0.0 * power)
        losses, _ = pair_losses(self.pair, at, self.elastic(at), self.box, self.nodes(state), means)
        return losses

    def network(self, state: State) -> ThermalNetwork:
        """The law of every piece."""
        at, piece = self.operating(state), np.asarray(state["piece"], dtype=int)
        around = replace(self.box.surroundings, ambient=self.duty.ambient[piece])
        bare = thermal_network(
            self.pair.pinion,
            self.pair.wheel,
            at.speed,
            self.losses(state, at),
            at.lubricant,
            at.oil_temperature,
            around,
            dict(self.held),
            self.nodes(state)["housing"],
        )
        gears = {"pinion": self.pair.pinion, "wheel": self.pair.wheel}
        known = {name: np.asarray(t) for name, t in bare.fixed.items()} | dict(state)
        full = {name: known.get(name, np.asarray(around.ambient)) for name in bare.nodes}
        return with_free_convection(bare, gears, at.lubricant, around, full)

    def clearance(self, state: State) -> Clearance:
        """Over the mesh phase, of a state."""
        with warnings.catch_warnings(action="ignore", category=ValidityWarning):
            # of the oil, which a gap does not feel
            hot = HotPair(self.pair, self.operating(state), self.model)
        return Clearance(hot, np.arange(PHASES) / PHASES, self.deviations)

    def losses_of(self, state: State) -> Losses:
        """At many moments; warns once where the oil leaves its line."""
        parts: list[Losses] = []
        count = np.size(state["piece"])
        with warnings.catch_warnings(
            record=True, action="always", category=ValidityWarning
        ) as told:
            for first in range(0, count, BLOCK):
                here = {name: t[first : first + BLOCK] for name, t in state.items()}
                full = {**here, "lagging": self.mesh(here)}
                parts.append(self.losses(full, self.operating(here)))
        for text in dict.fromkeys(str(one.message) for one in told):
            warnings.warn(text, ValidityWarning, stacklevel=3)
        return joined(parts, [min(BLOCK, count - BLOCK * k) for k in range(len(parts))])


MESHING = {
    "greatest_flash": ("K", "greatest flash temperature along the path"),
    "greatest_contact_temperature": ("K", "greatest contact temperature along the path"),
    "least_film_parameter": ("1", "least film parameter along the path"),
    "mean_friction": ("1", "friction coefficient, mean by load"),
    "mean_stiffness": ("N/m", "mean mesh stiffness"),
}
"""What :func:`meshing` finds: units and words."""


def meshing(
    pair: GearPair,
    operating: Operating,
    model: MeshModel,
    deviations: Sequence[Deviation] = (),
    progress: Progress = silent,
) -> dict[str, tuple[str, Floats, str, str]]:
    """Flash, film, friction and stiffness (:data:`MESHING`) at every moment, for ``label``.

    ``operating``: the moments; nan for what needs load or speed where there is none. Solved in
    blocks: memory and progress, not the result. Where teeth differ or a gear is eccentric, of the
    mean tooth (:func:`~thermogear.gears.turn.mean_tooth`): a turn at every moment costs too much.
    """
    deviations = mean_tooth(pair, deviations)
    found: dict[str, list[Floats]] = {name: [] for name in MESHING}
    count = operating.speed.size
    for first in range(0, count, MESHED):
        progress("mesh", first, count)
        part = operating.part(slice(first, first + MESHED))
        cycle = mesh_cycle(
            pair, part, model, deviations=deviations, path_positions=41, mesh_positions=96
        )
        loaded = part.torque > 0.0
        turning = loaded & (part.speed > 0.0)
        friction = cycle["friction_coefficient"] * cycle["line_load"]
        carried = cycle["line_load"].sum("path_position").values
        for name, values in {
            "greatest_flash": cycle["greatest_flash_temperature"].values,
            "greatest_contact_temperature": cycle["greatest_contact_temperature"].values,
            "least_film_parameter": np.where(turning, cycle["least_film_parameter"].values, np.nan),
            "mean_friction": np.where(
                turning,
                friction.sum("path_position").values / np.where(carried > 0.0, carried, 1.0),
                np.nan,
            ),
            "mean_stiffness": np.where(loaded, cycle["mean_stiffness"].values, np.nan),
        }.items():
            found[name].append(values)
    progress("mesh", count, count)
    return {
        name: ("moment", np.concatenate(parts), *MESHING[name]) for name, parts in found.items()
    }
