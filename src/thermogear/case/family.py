"""The one door in: from a case and the names of what varies to a function rows -> points.

The analyses know lanes and numbers only. ``family(case, names, bundle, state)`` is called with
rows of SI values, one column for each name, and returns :class:`~thermogear.case.points.Points`:
lanes, and what turns dimensionless results back into micrometres, hertz and newtons.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.analysis.family import ModelFamily
from thermogear.base.errors import InputError, nearest
from thermogear.base.excitation import Excitation
from thermogear.base.parameters import NUMBERS
from thermogear.case.allowed import (
    LANE,
    gear_parameter,
    gear_reader,
    number_parameter,
    require_numbers,
    within,
)
from thermogear.case.case import Case, DimensionlessCase, GearCase, gear_case, load_case
from thermogear.case.points import Points, excitations, on_numbers, points_of
from thermogear.case.ranges import warn_of_torque
from thermogear.case.thermal_state import HOT, StateLike, ThermalState
from thermogear.dynamics.models import TorsionalModel
from thermogear.dynamics.tables import Lanes
from thermogear.mesh.model import MeshModel

Floats = NDArray[np.float64]
Whole = NDArray[np.int64]

BATCH = 256
"""Operating points in one mesh cycle."""
FEW = 3
"""Positions along the path of contact: what moves the teeth hangs on the mesh phase alone."""
KEPT = 8
"""Mesh cycles a family remembers."""
OF_A_POINT = (
    "pinion_speed", "pinion_torque", "gear_temperature", "cold_half_backlash", "damping_ratio",
    *LANE,
)  # fmt: skip
"""What varies within one case; every value of another parameter is another case file."""


def family(
    case: Case,
    names: Sequence[str] = (),
    bundle: str = "",
    state: StateLike = HOT,
    *,
    numbers: Mapping[str, float] | None = None,
) -> GearFamily | NumberFamily:
    """The family of ``case`` over the parameters ``names``: rows of SI values -> points.

    Of a gear case: under ``bundle`` (the first by default) in ``state``; names are those of
    :data:`~thermogear.base.parameters.GEARS` or dotted fields of the file. Of a dimensionless case:
    its base set, some of its ``numbers`` changed, over numbers of the equation. Parameters that
    are not named stay as in the case, at its first speed and torque. Raises InputError for what
    the case does not have.
    """
    if isinstance(case, DimensionlessCase):
        for option, given in (("bundle", bundle), ("state", ThermalState.of(state) != HOT)):
            if given:
                raise _without_gears(option, bundle if option == "bundle" else state)
        full = tuple(number_parameter(name).name for name in names)
        return NumberFamily(base_model(case, numbers), full)
    if numbers:
        raise InputError(
            next(iter(numbers)),
            "a number beside a gear case",
            why="the gears decide the numbers of their equation",
            fix="put a field in place, for instance dynamics.damping_ratio=0.1",
        )
    return GearFamily(gear_case(case), tuple(names), bundle, ThermalState.of(state))


def _without_gears(option: str, got: object) -> InputError:
    return InputError(
        option, repr(got), why="a dimensionless case has no gears", fix="leave it out"
    )


# --- numbers ------------------------------------------------------------------------------


@dataclass(frozen=True)
class NumberFamily(ModelFamily):
    """The dimensionless equation with some of its numbers put to other values."""

    def require(self, axes: Mapping[str, ArrayLike]) -> None:
        """Refuse ``axes`` that no case file could hold, before anything is computed."""
        require_numbers({n: getattr(self.model, n) for n in NUMBERS} | dict(axes))

    def __call__(self, points: Floats) -> Points:
        rows = np.asarray(points, dtype=float)
        lanes: Lanes = super().__call__(rows).lanes()
        return Points.plain(lanes.take(np.arange(len(rows)) % len(lanes)))


def base_model(
    case: DimensionlessCase, changes: Mapping[str, float] | None = None
) -> TorsionalModel:
    """The base set of a dimensionless case, with some numbers changed."""
    values: dict[str, float] = {}
    for name, given in case.base.items():
        if len(given) != 1 and name not in (changes or {}):
            raise InputError(
                f"base.{name}",
                f"{len(given)} entries",
                allowed="one",
                why="a base set is one point",
            )
        values[name] = float(given[0])
    values |= changes or {}
    require_numbers(values)
    return TorsionalModel(**values)


# --- gears --------------------------------------------------------------------------------


@dataclass(frozen=True)
class GearFamily:
    """Gear parameters -> points, for one ``case``, one bundle of it and one state of its heat.

    Beside a parameter gear_temperature the state is "hot". A parameter that is no other operating
    point (a dotted field, the face width) reads the case again for each of its values.
    """

    case: GearCase
    names: tuple[str, ...]
    bundle: str = ""
    state: ThermalState = HOT
    _kept: dict[tuple[object, ...], tuple[GearCase, list[Excitation | None]]] = field(
        init=False, repr=False, compare=False, default_factory=dict
    )

    def __post_init__(self) -> None:
        gear_case(self.case)
        names = tuple(gear_parameter(name).name for name in self.names)
        object.__setattr__(self, "names", names)
        object.__setattr__(self, "state", ThermalState.of(self.state))
        known = [m.name for m in self.case.models]
        if not self.bundle:
            object.__setattr__(self, "bundle", known[0])
        if self.bundle not in known:
            raise InputError("bundle", repr(self.bundle), fix=nearest(self.bundle, known))
        if self.state != HOT and "gear_temperature" in names:
            raise InputError(
                "state",
                self.state.words,
                why="the gear temperature itself is varied here",
                fix="leave out the state, or the temperature",
            )

    @property
    def units(self) -> tuple[str, ...]:
        return tuple(gear_parameter(name).unit for name in self.names)

    @property
    def model(self) -> MeshModel:
        """The bundle's choices."""
        return next(m for m in self.case.models if m.name == self.bundle)

    def inputs(self) -> dict[str, Any]:
        return {
            "case": self.case.text,
            "overrides": [list(pair) for pair in self.case.overrides],
            "bundle": self.bundle,
            "choices": dict(self.model.choices()),
            "state": self.state.stored,
        }

    def __call__(self, points: Floats) -> Points:
        rows = np.asarray(points, dtype=float)
        made = points_of(self.excitations(rows))
        numbers = {name: rows[:, i] for i, name in enumerate(self.names) if name in LANE}
        return on_numbers(made, numbers) if numbers else made

    def excitations(self, rows: Floats) -> list[Excitation | None]:
        """The excitation of every row, in SI; None where the pair is jammed."""
        read = [i for i, name in enumerate(self.names) if name not in OF_A_POINT]
        if not read:
            return self._excitations(self.case, self.names, rows)
        # one case for each combination of file fields
        plain = [i for i in range(len(self.names)) if i not in read]
        names = tuple(self.names[i] for i in plain)
        found: list[Excitation | None] = [None] * len(rows)
        for values in np.unique(rows[:, read], axis=0):
            chosen = np.flatnonzero((rows[:, read] == values).all(axis=1))
            case = self._case_with(dict(zip((self.names[i] for i in read), values, strict=True)))
            if not any(self.names[i].startswith("operating.") for i in read):
                case = replace(case, speeds=self.case.speeds, torques=self.case.torques)
            _put(found, chosen, self._excitations(case, names, rows[chosen][:, plain]))
        return found

    def require(self, axes: Mapping[str, ArrayLike]) -> None:
        """Refuse ``axes`` (SI) that no case file could hold, before anything is computed.

        Of fields of the case file every corner of the grid is read as a case. Warns as a case
        with these values does.
        """
        for name, values in axes.items():
            within(name, gear_reader(name), values)
        if "pinion_torque" in axes:
            warn_of_torque(self.case.pair, axes["pinion_torque"])
        read = {name: np.asarray(values) for name, values in axes.items() if name not in OF_A_POINT}
        ends = ({float(v.min()), float(v.max())} for v in read.values())
        for corner in product(*ends):
            self._case_with(dict(zip(read, corner, strict=True)))

    def _case_with(self, values: Mapping[str, float]) -> GearCase:
        """The case with parameters of its file put to other ``values`` (SI)."""
        fields = tuple(
            (place, str(gear_reader(name).written(float(value))))
            for name, value in values.items()
            for place in gear_parameter(name).fields
        )
        return _case_with(self.case.text, self.case.overrides, fields) if fields else self.case

    def _excitations(
        self, case: GearCase, names: tuple[str, ...], rows: Floats
    ) -> list[Excitation | None]:
        columns = dict(zip(names, rows.T, strict=True))
        count = len(rows)

        def column(name: str, value: float) -> Floats:
            return np.array(
                np.broadcast_to(np.asarray(columns.get(name, value), dtype=float), (count,))
            )

        speed = column("pinion_speed", case.speeds[0])
        torque = column("pinion_torque", case.torques[0])
        backlash = column("cold_half_backlash", case.stated.half_backlash)
        damping = column("damping_ratio", case.damping_ratio)
        found: list[Excitation | None] = [None] * count
        for state, mine in self._states(columns.get("gear_temperature"), count):
            for half in np.unique(backlash[mine]):
                chosen = mine[backlash[mine] == half]
                some = self._loaded(
                    case, state, speed[chosen], torque[chosen], half_backlash=float(half)
                )
                _put(found, chosen, some)
        return [
            one if one is None else replace(one, damping_ratio=float(zeta))
            for one, zeta in zip(found, damping, strict=True)
        ]

    def _states(
        self, temperature: Floats | None, count: int
    ) -> Iterator[tuple[ThermalState, Whole]]:
        """Every state of heat, and the rows that are in it."""
        if temperature is None:
            yield self.state, np.arange(count)
            return
        for kelvins in np.unique(temperature):
            yield ThermalState.of(float(kelvins)), np.flatnonzero(temperature == kelvins)

    def _loaded(
        self,
        case: GearCase,
        state: ThermalState,
        speed: Floats,
        torque: Floats,
        *,
        half_backlash: float,
    ) -> list[Excitation | None]:
        """The excitation of every row, those that share heat and load out of one mesh cycle."""
        if state.hangs_on_the_load(case):
            found: list[Excitation | None] = []
            for first in range(0, speed.size, BATCH):
                some = slice(first, first + BATCH)
                found += self._cycle(case, state, speed[some], torque[some], half_backlash)
            return found
        # where the heat is given, springs and backlash do not know the speed
        loads, which = np.unique(torque, return_inverse=True)
        slow = float(speed.min())
        key = (state.stored, half_backlash, *loads.tolist())
        kept = self._kept.get(key)
        if kept is None or kept[0] is not case or slow <= 0.0:
            springs: list[Excitation | None] = []
            for first in range(0, loads.size, BATCH):
                load = loads[first : first + BATCH]
                springs += self._cycle(case, state, np.full(load.size, slow), load, half_backlash)
            while len(self._kept) >= KEPT:
                self._kept.pop(next(iter(self._kept)), None)
            self._kept[key] = kept = (case, springs)
        teeth = case.pair.pinion.teeth
        rows = (kept[1][place] for place in which.tolist())
        return [
            one if one is None else replace(one, mesh_frequency=teeth * float(omega))
            for one, omega in zip(rows, speed, strict=True)
        ]

    def _cycle(
        self,
        case: GearCase,
        state: ThermalState,
        speed: Floats,
        torque: Floats,
        half_backlash: float,
    ) -> list[Excitation | None]:
        """The excitations of one mesh cycle."""
        # by its place: a choice that varies changes the name
        model = case.models[[m.name for m in self.case.models].index(self.bundle)]
        stated = replace(case.stated, speed=speed, torque=torque, half_backlash=half_backlash)
        here = replace(case, stated=stated)
        return excitations(case, case.cycle(state.moving(here, model), model, FEW))


@lru_cache(maxsize=64)
def _case_with(
    text: str, overrides: tuple[tuple[str, str], ...], fields: tuple[tuple[str, str], ...]
) -> GearCase:
    return gear_case(load_case(text, dict(overrides) | dict(fields)))


def _put(found: list[Excitation | None], places: Whole, some: Sequence[Excitation | None]) -> None:
    for place, one in zip(places.tolist(), some, strict=True):
        found[place] = one


def along(family: GearFamily | NumberFamily) -> Callable[[float], Points]:
    """value -> the one moving point of a family of one parameter, remembered.

    InputError where the pair is jammed.
    """

    @lru_cache(maxsize=256)
    def at(value: float) -> Points:
        return moving(family(np.array([[value]])), family)

    return at


def moving(points: Points, family: GearFamily | NumberFamily) -> Points:
    """``points`` themselves; InputError where the pair is jammed."""
    if points.jammed.any():
        words = family.state.words if isinstance(family, GearFamily) else ""
        raise InputError(
            "operating",
            f"a jammed pair ({words})",
            why="the half backlash is used up: no clearance is left to move in",
            fix="lower the temperature or raise the backlash",
        )
    return points


@dataclass(frozen=True, eq=False)
class Tabulated:
    """A family of one parameter between the points of a grid where it was computed.

    Stiffness, error and backlash run straight from point to point; speed enters exactly. Where
    they do not depend on the parameter, as with given temperatures over speed, so does all.
    """

    family: GearFamily
    values: Floats
    points: Points

    @classmethod
    def of(cls, family: GearFamily, values: Floats) -> Tabulated:
        """Computed on ``values``, ascending."""
        return cls(family, values, family(values[:, None]))

    @property
    def names(self) -> tuple[str, ...]:
        return self.family.names

    @property
    def units(self) -> tuple[str, ...]:
        return self.family.units

    def inputs(self) -> dict[str, Any]:
        return self.family.inputs()

    def __call__(self, points: Floats) -> Points:
        at = np.asarray(points, dtype=float)[:, 0]
        place = np.clip(np.searchsorted(self.values, at, side="right") - 1, 0, len(self.values) - 2)
        low, high = self.values[place], self.values[place + 1]
        # a little beyond the ends too, so that it can be differentiated there
        weight = np.clip((at - low) / (high - low), -0.01, 1.01)
        a, b = self.points.take(place), self.points.take(place + 1)

        def mix(one: NDArray[Any], two: NDArray[Any]) -> NDArray[Any]:
            share = weight[:, None] if one.ndim == 2 else weight
            return np.asarray(one + share * (two - one))

        stiffness = mix(a.stiffness, b.stiffness)
        length = mix(a.length, b.length)
        rate = mix(a.rate, b.rate)
        error = mix(a.error, b.error)
        force = mix(a.force, b.force)
        mesh = mix(a.mesh_frequency, b.mesh_frequency)
        frequency = mesh / rate
        ranks = np.arange(error.shape[1])
        push = error * (ranks * frequency[:, None]) ** 2 / length[:, None]
        push[:, 0] = force / (stiffness * length)
        status = np.maximum(a.status, b.status)
        flat = Lanes(
            period=2.0 * np.pi / frequency,
            damping=mix(a.flat.damping, b.flat.damping),
            half_backlash=mix(a.flat.half_backlash, b.flat.half_backlash),
            stiffness=mix(a.flat.stiffness, b.flat.stiffness),
            force=push,
            stiffness_pieces=a.flat.stiffness_pieces,
            force_pieces=a.flat.force_pieces,
        )
        hot = mix(a.half_backlash, b.half_backlash)
        return Points(flat, status, length, rate, stiffness, force, error, mesh, hot)
