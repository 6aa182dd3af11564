"""The one door in: from a case and the names of what varies to a function rows -> points.

The analyses know lanes and numbers only. ``family(case, names, bundle, state)`` is called with
rows of SI values, one column for each name, and returns :class:`~thermogear.case.points.Points`:
lanes, and what turns dimensionless results back into micrometres, hertz and newtons.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from itertools import product
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.analysis.family import ModelFamily
from thermogear.base.arrays import Floats, Whole
from thermogear.base.errors import InputError, ThermogearError, nearest
from thermogear.base.excitation import Excitations, Periodic
from thermogear.base.parameters import NUMBERS
from thermogear.base.plan import Alive, keep_going
from thermogear.base.vocabulary import STATUS, moves, still
from thermogear.case.allowed import (
    LANE,
    gear_parameter,
    gear_reader,
    number_parameter,
    require_numbers,
    within,
)
from thermogear.case.backlash import require_room
from thermogear.case.base import Case
from thermogear.case.case import DimensionlessCase, GearCase, gear_case
from thermogear.case.faults import fault_words, whole_turn
from thermogear.case.points import Points, excitations, on_numbers, points_of
from thermogear.case.ranges import warn_of_torque
from thermogear.case.samples import (
    FEW,
    GEARS_AT,
    WIDTHS,
    Columns,
    Samples,
    fields_of,
    quasi_static,
    sampled,
    takes,
    with_error,
)
from thermogear.case.thermal_state import HOT, UNDEFORMED, StateLike, ThermalState
from thermogear.dynamics.lanes import Lanes
from thermogear.dynamics.models import TorsionalModel
from thermogear.mesh.excite import EXCITES, NO_ERROR
from thermogear.mesh.model import MeshModel

KEPT = 8
"""Mesh cycles a family remembers."""
OF_A_POINT = (
    "pinion_speed", "pinion_torque", GEARS_AT, "cold_half_backlash", "damping_ratio", *LANE,
)  # fmt: skip
"""What is checked by itself; every corner of other parameters is read as a case file."""
BESIDE = ("operating.speed", "dynamics.damping_ratio", "error_amplitude")
"""Columns that no mesh cycle of given heat knows."""


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

    >>> found = family(load_case("rig"), ["rpm"])
    >>> found.names
    ('pinion_speed',)
    """
    if isinstance(case, DimensionlessCase):
        for option, given in (("bundle", bundle), ("state", ThermalState.of(state) != HOT)):
            if given:
                raise InputError(
                    option,
                    repr(bundle if option == "bundle" else state),
                    why="a dimensionless case has no gears",
                    fix="leave it out",
                )
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

    With a parameter gear_temperature the state is "hot". Rows whose geometry is one share a mesh
    cycle (:mod:`thermogear.case.samples`); every other value of a field that is no column makes a
    case of its own. ``alive`` is called between cycles and raises to end the work.
    """

    case: GearCase
    names: tuple[str, ...]
    bundle: str = ""
    state: ThermalState = HOT
    alive: Alive = field(default=keep_going, repr=False, compare=False)
    _cases: dict[tuple[float, ...], GearCase] = field(
        init=False, repr=False, compare=False, default_factory=dict
    )
    _springs: dict[tuple[object, ...], Excitations] = field(
        init=False, repr=False, compare=False, default_factory=dict
    )
    _samples: dict[tuple[object, ...], Samples] = field(
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
        if self.state != HOT and GEARS_AT in names:
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

    def require(self, axes: Mapping[str, ArrayLike]) -> None:
        """Refuse ``axes`` (SI) that no case file could hold, before anything is computed.

        Of fields of the case file every corner of the grid is read as a case. Warns as a case
        with these values does.
        """
        for name, values in axes.items():
            within(name, gear_reader(name), values)
            if name.startswith("faults."):
                self._require_felt(name)
        if "cold_half_backlash" in axes:
            half = axes["cold_half_backlash"]
            require_room("cold_half_backlash", half, self.case.pair, of_half=1.0)
        if "pinion_torque" in axes:
            warn_of_torque(self.case.pair, axes["pinion_torque"])
        read = {name: np.asarray(values) for name, values in axes.items() if name not in OF_A_POINT}
        ends = ({float(v.min()), float(v.max())} for v in read.values())
        for corner in product(*ends):
            if corner:
                self.case.with_values(dict(zip(read, corner, strict=True)), told=False)

    def _require_felt(self, name: str) -> None:
        """Refuse a fault that nothing feels: of one tooth in the mean one, a crack elsewhere."""
        fault = self.case.file.faults[int(name.split(".")[1])]
        alone = self.case.file.gears.period == "mesh" and whole_turn(fault)
        if alone or (fault.kind == "crack" and self.model.stiffness != "loaded"):
            raise InputError(
                name,
                fault_words(fault),
                why="nothing here feels it",
                fix='state gears.period = "turn", and a bundle with model.stiffness = loaded',
            )

    def __call__(self, points: Floats) -> Points:
        rows = np.asarray(points, dtype=float)
        made = points_of(self.excitations(rows))
        numbers = {name: rows[:, i] for i, name in enumerate(self.names) if name in LANE}
        return on_numbers(made, numbers) if numbers else made

    def excitations(self, rows: Floats) -> Excitations:
        """The excitation of every row, in SI; a row that no case could have does not move."""
        groups, place = self._placed(np.asarray(rows, dtype=float))
        found = Excitations.joined([self._excited(group) for group in groups])
        every = found.take(np.maximum(place, 0))
        lost = np.int8(STATUS.index("impossible"))
        return replace(every, status=np.where(place < 0, lost, every.status))

    def quasi_static(
        self, rows: ArrayLike, want: Collection[str], *, path_positions: int = FEW
    ) -> dict[str, NDArray[Any]]:
        """Stored quantities of the mesh cycle of every row, in SI: name -> (row, ...).

        ``want`` names them (:func:`~thermogear.mesh.cycle.mesh_cycle`), and "oil_temperature",
        "tooth_temperature" (the hotter addendum), "pinion_temperature" (its addendum) [K], and as
        objects "hot_pair", the pair of the row alone as hot as it is, and "case", whose gears and
        flanks it has: what varies in columns is in the pair; only they are computed.
        ``path_positions`` along the path of contact, where a quantity runs over it.
        With them ``status``: a row that no case could have ("impossible"), or whose heat or mesh
        does not settle, is nan, and the others do not notice.
        """
        groups, place = self._placed(np.asarray(rows, dtype=float))
        parts = [self._cycled(group, tuple(want), path_positions) for group in groups]
        found = {}
        for name in parts[0]:
            values = np.concatenate([one[name] for one in parts])[np.maximum(place, 0)]
            if name == "status":
                values[place < 0] = STATUS.index("impossible")
            elif np.any(place < 0):
                values = values.astype(np.promote_types(values.dtype, float))
                values[place < 0] = np.nan
            found[name] = values
        return found

    def _placed(self, rows: Floats) -> tuple[list[_Group], Whole]:
        """Groups of rows, and the place of each row in them, one after the other; -1: nowhere.

        Raises what is wrong where no row has a case.
        """
        groups, place, done = [], np.full(len(rows), -1), 0
        refused: list[ThermogearError] = []
        for names, values, index, columns in self._kinds(rows):
            try:
                case = self._case_with(names, values)
            except ThermogearError as error:
                refused.append(error)
                continue
            groups.append(_Group(case, tuple(values), index, columns))
            place[index] = done + np.arange(index.size)
            done += index.size
        if not groups:
            raise refused[0]
        return groups, place

    def _kinds(self, rows: Floats) -> Iterator[tuple[list[str], Floats, Whole, Columns]]:
        """Rows that share a case: what is put into its file, which rows, and their columns."""
        varied = [i for i, name in enumerate(self.names) if name not in LANE]
        read = [
            i
            for i in varied
            if not all(takes(self.case, field) for field in fields_of(self.names[i]))
        ]
        plain = [i for i in varied if i not in read]
        kinds, which = np.unique(rows[:, read], axis=0, return_inverse=True)
        for kind, values in enumerate(kinds if read else np.empty((1, 0))):
            index = np.flatnonzero(which == kind) if read else np.arange(len(rows))
            columns = {
                field: np.ascontiguousarray(rows[index, i])
                for i in plain
                for field in (
                    (GEARS_AT,) if self.names[i] == GEARS_AT else fields_of(self.names[i])
                )
            }
            names = [self.names[i] for i in read]
            yield names, values, index, columns

    def _case_with(self, names: Sequence[str], values: Floats) -> GearCase:
        """The case with parameters of its file put to other ``values`` (SI)."""
        if not names:
            return self.case

        def make() -> GearCase:
            made = self.case.with_values(dict(zip(names, values, strict=True)), told=False)
            if any(name.startswith("operating.") for name in names):
                return made
            return replace(made, speeds=self.case.speeds, torques=self.case.torques)

        return _kept(self._cases, tuple(values.tolist()), make)

    def _excited(self, group: _Group) -> Excitations:
        case, columns, count = group.case, group.columns, group.index.size
        beside = {name: columns[name] for name in (*BESIDE, *WIDTHS) if name in columns}
        samples = sampled(case, beside, count)
        if self.state.hangs_on_the_load(case):
            springs = self._meshed(group)
        else:
            # of given heat springs and backlash know no damping, and the speed by the growth alone
            known = {name: values for name, values in columns.items() if name not in BESIDE}
            turning = samples.case.stated.speed
            speed = np.sign(turning) if self.state == UNDEFORMED else turning
            every = np.stack([*known.values(), speed])
            _, first, which = np.unique(every, axis=1, return_index=True, return_inverse=True)
            key = (group.values, every[:, first].tobytes())
            some = {n: v[first] for n, v in (known | {"operating.speed": speed}).items()}
            distinct = replace(group, columns=some, index=first)
            springs = _kept(self._springs, key, lambda: self._meshed(distinct)).take(which.ravel())
        return replace(
            with_error(
                springs, Periodic.columns([case.transmission_error]) * samples.error[:, None]
            ),
            mesh_frequency=case.pair.pinion.teeth * samples.case.stated.speed,
            damping_ratio=samples.damping_ratio,
            inertias=samples.inertias,
        )

    def _meshed(self, group: _Group) -> Excitations:
        """Springs, backlash and load of a group, without the kinematic error."""
        found = self._cycled(group, EXCITES, group.case.path_positions)
        return excitations(replace(group.case, transmission_error=NO_ERROR), found)

    def _cycled(
        self, group: _Group, want: Sequence[str], path_positions: int = FEW
    ) -> dict[str, NDArray[Any]]:
        """Quantities of the mesh cycle of every row of a group, and its status."""
        case = group.case
        # by its place where a choice that varies changes the name
        known = [m.name for m in case.models]
        names = known if self.bundle in known else [m.name for m in self.case.models]
        model = case.models[names.index(self.bundle)]

        def sample(case: GearCase, columns: Columns, count: int) -> Samples:
            """The same for the motion and for the answers: its heat balance is solved once."""
            key = (group.values, count, *((n, v.tobytes()) for n, v in columns.items()))
            return _kept(self._samples, key, lambda: sampled(case, columns, count))

        return quasi_static(
            case, group.columns, group.index.size, model, self.state, want,
            path_positions=path_positions, sample=sample, alive=self.alive,
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class _Group:
    """Rows ``index`` of one ``case``, made of other ``values`` in its file; the rest in columns."""

    case: GearCase
    values: tuple[float, ...]
    index: Whole
    columns: Columns


Kept = TypeVar("Kept")


def _kept(kept: dict[Any, Kept], key: object, make: Callable[[], Kept]) -> Kept:
    """What ``make`` made for ``key``, the oldest forgotten; threads share what is kept."""
    value = kept.get(key)
    if value is None:
        value = make()
        for old in list(kept)[: max(len(kept) - KEPT + 1, 0)]:
            kept.pop(old, None)
        kept[key] = value
    return value


def along(family: GearFamily | NumberFamily) -> Callable[[float], Points]:
    """value -> the one moving point of a family of one parameter, remembered.

    InputError where nothing moves.
    """

    @lru_cache(maxsize=256)
    def at(value: float) -> Points:
        return moving(family(np.array([[value]])), family)

    return at


def moving(points: Points, family: GearFamily | NumberFamily) -> Points:
    """``points`` themselves; InputError where nothing moves."""
    if points.still.any():
        raise still(int(points.status.max()), getattr(family, "state", HOT).words)
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

    @cached_property
    def _fixed(self) -> bool:
        """Whether nothing but the speed differs between the points."""
        one, lanes = self.points, self.points.flat
        rows = (
            one.status, one.stiffness, one.length, one.rate, one.error, one.force,
            one.half_backlash, lanes.damping, lanes.half_backlash, lanes.stiffness,
        )  # fmt: skip
        return all(np.array_equal(row[1:], row[:-1]) for row in rows)

    @cached_property
    def _first(self) -> Points:
        return self.points.take(np.zeros(1, int))

    def __call__(self, points: Floats) -> Points:
        at = np.asarray(points, dtype=float)[:, 0]
        place = np.searchsorted(self.values, at, side="right") - 1
        place = np.minimum(np.maximum(place, 0), len(self.values) - 2)
        low, high = self.values[place], self.values[place + 1]
        # a little beyond the ends too, so that it can be differentiated there
        weight = np.minimum(np.maximum((at - low) / (high - low), -0.01), 1.01)
        a = self._first if self._fixed and at.size == 1 else self.points.take(place)
        b = a if self._fixed else self.points.take(place + 1)
        mesh = self.points.mesh_frequency
        return between_points(a, b, weight, mesh=(mesh[place], mesh[place + 1]))


def between_points(
    a: Points, b: Points, weight: Floats, *, mesh: tuple[Floats, Floats] | None = None
) -> Points:
    """``a`` + ``weight`` (b - a) of gears: stiffness, error, backlash straight, speed exactly.

    ``mesh``: the mesh frequencies of both [rad/s] where a and b stand for other speeds.
    """

    def mix(first: NDArray[Any], second: NDArray[Any]) -> NDArray[Any]:
        if first is second:
            return first
        share = weight[:, None] if first.ndim == 2 else weight
        # exact at both points, so that a grid that ends there gives the same bits
        below, beyond_two = (
            first + share * (second - first),
            second + (share - 1.0) * (second - first),
        )
        return np.asarray(np.where(share < 1.0, below, beyond_two))

    stiffness = mix(a.stiffness, b.stiffness)
    length = mix(a.length, b.length)
    rate = mix(a.rate, b.rate)
    error = mix(a.error, b.error)
    force = mix(a.force, b.force)
    speed = mix(*((a.mesh_frequency, b.mesh_frequency) if mesh is None else mesh))
    frequency = speed / rate / a.mesh_periods
    ranks = np.arange(error.shape[1])
    with np.errstate(invalid="ignore"):  # a point without a gap has no lengths
        push = error * (ranks * frequency[:, None]) ** 2 / length[:, None]
    push[:, 0] = force / (stiffness * length)
    # a grid point has its own status; between two the worse one holds
    worse = np.where(moves(a.status) & (b.status != 0), b.status, a.status)
    status = np.where(weight == 0.0, a.status, np.where(weight == 1.0, b.status, worse))
    flat = Lanes(
        period=2.0 * np.pi / frequency,
        damping=mix(a.flat.damping, b.flat.damping),
        half_backlash=mix(a.flat.half_backlash, b.flat.half_backlash),
        stiffness=mix(a.flat.stiffness, b.flat.stiffness),
        force=push,
        stiffness_pieces=a.flat.stiffness_pieces,
        force_pieces=a.flat.force_pieces,
        mesh_periods=a.mesh_periods,
    )
    hot = mix(a.half_backlash, b.half_backlash)
    return Points(flat, status, length, rate, stiffness, force, error, speed, hot)
