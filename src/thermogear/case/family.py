"""Gear words for the analyses: from speed, torque, temperature, backlash, damping to lanes.

The analyses know lanes and numbers only. A :class:`GearFamily` turns rows of gear parameters
into lanes; the :class:`GearPoints` it makes also carry the lengths, rates and forces that turn
the dimensionless results back into micrometres, hertz and newtons.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, replace
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import InputError, nearest
from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.base.vocabulary import STATES, STATUS, UNDEFORMED
from thermogear.case.allowed import gear_reader, read_value, within
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.fields import Measure
from thermogear.case.ranges import warn_of_torque
from thermogear.case.units import KINDS
from thermogear.dynamics.models import TorsionalModel, from_excitation
from thermogear.dynamics.tables import Lanes
from thermogear.mesh.excite import excitation
from thermogear.mesh.model import MeshModel

Floats = NDArray[np.float64]

BATCH = 256
"""Operating points in one mesh cycle."""


@dataclass(frozen=True)
class Word:
    """A gear parameter: its SI ``unit``, the ``shown`` unit with factor and zero, what it is."""

    unit: str
    shown: str
    _: KW_ONLY
    factor: float
    zero: float
    words: str


WORDS: dict[str, Word] = {
    "pinion_speed": Word("rad/s", "rpm", factor=1.0 / RPM, zero=0.0, words="pinion speed"),
    "pinion_torque": Word("N m", "N m", factor=1.0, zero=0.0, words="pinion torque"),
    "gear_temperature": Word(
        "K",
        "degC",
        factor=1.0,
        zero=ZERO_CELSIUS,
        words="addendum temperature of both gears",
    ),
    "cold_half_backlash": Word(
        "m", "um", factor=1e6, zero=0.0, words="cold half backlash on the line of action"
    ),
    "damping_ratio": Word("1", "1", factor=1.0, zero=0.0, words="damping ratio"),
}
SHORT = {
    "rpm": "pinion_speed",
    "speed": "pinion_speed",
    "torque": "pinion_torque",
    "temperature": "gear_temperature",
    "backlash": "cold_half_backlash",
    "damping": "damping_ratio",
    "zeta": "damping_ratio",
}
"""Names a command line may use."""


def word(name: str) -> str:
    """The full name of a gear parameter; dotted names are fields of the case file."""
    full = SHORT.get(name, name)
    if full not in WORDS and "." not in full:
        raise InputError(
            "parameter", repr(name), fix=nearest(name, [*WORDS, *SHORT]) + " or a dotted field"
        )
    return full


def unit_of(name: str) -> str:
    """The SI unit of a gear parameter or a dotted field."""
    if name in WORDS:
        return WORDS[name].unit
    reader = gear_reader(name)
    return KINDS[reader.kind].si if isinstance(reader, Measure) else "1"


def read_word(name: str, text: str) -> float:
    """A value of a gear parameter as a person writes it, as SI.

    With its unit as in a case file; a bare number of one of :data:`WORDS` is in its shown unit.
    """
    one, reader = WORDS.get(name), gear_reader(name)
    try:
        number = float(text)
    except ValueError:
        return read_value(name, reader, text)
    if one is None and isinstance(reader, Measure):
        unit = KINDS[reader.kind].shown
        raise InputError(
            name,
            text,
            allowed=reader.allowed,
            why="the unit is missing",
            fix=f"write it at every value: {name}={text} {unit}:TO {unit}:COUNT",
        )
    value = number if one is None else number / one.factor + one.zero
    within(name, reader, value)
    return value


@dataclass(frozen=True, eq=False)
class GearPoints:
    """Lanes of gear operating points, and what turns their numbers back into SI.

    ``status`` 1 where the pair is jammed (its lane is a placeholder). ``length`` b_c [m], ``rate``
    omega_n [rad/s], ``stiffness`` mean k_m [N/m], ``force`` mean F [N], ``error`` Fourier
    coefficients of e [m] (point, harmonic), ``mesh_frequency`` [rad/s], ``half_backlash`` hot b'
    [m]; the last axis of arrays is the point.
    """

    flat: Lanes
    status: NDArray[np.int8]
    length: Floats
    rate: Floats
    stiffness: Floats
    force: Floats
    error: NDArray[np.complex128]
    mesh_frequency: Floats
    half_backlash: Floats

    def lanes(self) -> Lanes:
        """The dimensionless lanes."""
        return self.flat

    def take(self, index: NDArray[np.int64]) -> GearPoints:
        """Some of the points."""
        return GearPoints(
            self.flat.take(index),
            self.status[index],
            self.length[index],
            self.rate[index],
            self.stiffness[index],
            self.force[index],
            self.error[index],
            self.mesh_frequency[index],
            self.half_backlash[index],
        )


@dataclass(frozen=True)
class GearFamily:
    """Gear parameters -> lanes, for one ``case`` and one bundle of it, ``bundle``.

    ``state`` "hot" (as the case says), "undeformed" (everything at the reference temperature) or
    the addendum temperature [K] of both gears; beside a parameter gear_temperature it is "hot".
    Parameters that are not named stay as in the case, at its first speed and torque. A dotted
    name is a field of the case file, so that every value there can be swept; each of its
    values reads the case again.
    """

    case: GearCase
    names: tuple[str, ...]
    bundle: str = ""
    state: str | float = "hot"

    def __post_init__(self) -> None:
        gear_case(self.case)
        for name in self.names:
            word(name)
        known = [m.name for m in self.case.models]
        if not self.bundle:
            object.__setattr__(self, "bundle", known[0])
        if self.bundle not in known:
            raise InputError("bundle", repr(self.bundle), fix=nearest(self.bundle, known))
        if isinstance(self.state, str) and self.state not in STATES:
            raise InputError("state", repr(self.state), allowed="'hot' | 'undeformed' | kelvins")
        if self.state != "hot" and "gear_temperature" in self.names:
            raise InputError(
                "state",
                repr(self.state) if isinstance(self.state, str) else f"{self.state:g} K",
                why="the gear temperature itself is varied here",
                fix="leave out the state, or the temperature",
            )

    @property
    def units(self) -> tuple[str, ...]:
        return tuple(unit_of(name) for name in self.names)

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
            "state": self.state,
        }

    def __call__(self, points: Floats) -> GearPoints:
        rows = np.asarray(points, dtype=float)
        dotted = [i for i, name in enumerate(self.names) if "." in name]
        if not dotted:
            return self._points(self.case, rows)
        # one case for each combination of file fields
        plain = [i for i in range(len(self.names)) if i not in dotted]
        bare = replace(self, names=tuple(self.names[i] for i in plain))
        parts: list[tuple[NDArray[np.int64], GearPoints]] = []
        for values in np.unique(rows[:, dotted], axis=0):
            chosen = np.flatnonzero((rows[:, dotted] == values).all(axis=1))
            case = self._case_with(dict(zip((self.names[i] for i in dotted), values, strict=True)))
            parts.append((chosen, bare._points(case, rows[chosen][:, plain])))
        return _joined(parts, len(rows))

    def require(self, axes: Mapping[str, ArrayLike]) -> None:
        """Refuse ``axes`` (SI) that no case file could hold, before anything is computed.

        Of fields of the case file every corner of the grid is read as a case. Warns as a case
        with these values does.
        """
        for name, values in axes.items():
            within(name, gear_reader(name), values)
        if "pinion_torque" in axes:
            warn_of_torque(self.case.pair, axes["pinion_torque"])
        dotted = {name: np.asarray(values) for name, values in axes.items() if "." in name}
        ends = ({float(v.min()), float(v.max())} for v in dotted.values())
        for corner in product(*ends):
            self._case_with(dict(zip(dotted, corner, strict=True)))

    def _case_with(self, values: Mapping[str, float]) -> GearCase:
        """The case with fields of its file put to other ``values`` (SI)."""
        fields = tuple(
            (name, str(gear_reader(name).written(float(value)))) for name, value in values.items()
        )
        return _case_with(self.case.text, self.case.overrides, fields) if fields else self.case

    def _points(self, case: GearCase, rows: Floats) -> GearPoints:
        columns = dict(zip(self.names, rows.T, strict=True))
        count = len(rows)

        def column(name: str, value: float) -> Floats:
            return np.array(
                np.broadcast_to(np.asarray(columns.get(name, value), dtype=float), (count,))
            )

        speed = column("pinion_speed", case.speeds[0])
        torque = column("pinion_torque", case.torques[0])
        backlash = column("cold_half_backlash", case.stated.half_backlash)
        damping = column("damping_ratio", case.damping_ratio)
        state: Floats | None = columns.get("gear_temperature")
        if state is None and not isinstance(self.state, str):
            state = np.full(count, self.state)
        keys = np.stack([backlash, np.zeros(count) if state is None else state], axis=1)
        parts: list[tuple[NDArray[np.int64], GearPoints]] = []
        for half, heat in np.unique(keys, axis=0):
            rows_here = np.flatnonzero((backlash == half) & (keys[:, 1] == heat))
            for first in range(0, rows_here.size, BATCH):
                chosen = rows_here[first : first + BATCH]
                cycle = self._cycle(case, speed[chosen], torque[chosen], float(half), float(heat))
                parts.append((chosen, _points_of(case, cycle, damping[chosen])))
        return _joined(parts, count)

    def _cycle(
        self, case: GearCase, speed: Floats, torque: Floats, half_backlash: float, heat: float
    ) -> xr.Dataset:
        """The mesh cycle at these points; ``heat`` the gear temperature, 0: by the state."""
        model = next(m for m in case.models if m.name == self.bundle)
        stated = replace(case.stated, speed=speed, torque=torque, half_backlash=half_backlash)
        here = replace(case, stated=stated)
        if heat != 0.0:
            operating = here.operating_at(heat, model)
        elif self.state == UNDEFORMED:
            operating = stated.as_drawn()
        else:
            operating = here.operating_of(model)
        return case.cycle(operating, model)


@lru_cache(maxsize=64)
def _case_with(
    text: str, overrides: tuple[tuple[str, str], ...], fields: tuple[tuple[str, str], ...]
) -> GearCase:
    return gear_case(load_case(text, dict(overrides) | dict(fields)))


def _points_of(case: GearCase, cycle: xr.Dataset, damping: Floats) -> GearPoints:
    """The lanes of a mesh cycle, jammed points as placeholders."""
    lean = cycle.drop_dims("path_position", errors="ignore")
    found = excitation(
        lean,
        case.pair,
        damping_ratio=case.damping_ratio,
        inertias=case.inertias,
        transmission_error=case.transmission_error,
        harmonics=case.harmonics,
    )
    jammed = np.array([one is None for one in found])
    ready = [
        replace(o, damping_ratio=float(z)) if o else o for o, z in zip(found, damping, strict=True)
    ]
    moving = [one for one in ready if one is not None]
    count = len(found)
    nan = np.full(count, np.nan)
    if not moving:
        idle = TorsionalModel(
            damping_ratio=0.1,
            frequency=np.ones(count),
            stiffness_amplitude=0.0,
            mean_force=0.1,
            force_amplitude=0.0,
        ).lanes()
        status = np.full(count, STATUS.index("jammed"), np.int8)
        none = np.full((count, 1), np.nan, complex)
        return GearPoints(idle, status, nan, nan, nan, nan, none, nan, nan)
    # a jammed point borrows the lane of a moving one; its status keeps it still
    place = np.where(jammed, 0, np.cumsum(~jammed) - 1)
    width = 1 + max(len(one.error.harmonics) for one in moving)
    error = np.zeros((len(moving), width), complex)
    for row, one in enumerate(moving):
        error[row, 0] = one.error.mean
        error[row, 1 : 1 + len(one.error.harmonics)] = one.error.harmonics
    values = np.array(
        [
            (
                one.reference_half_backlash,
                one.natural_frequency,
                one.stiffness.mean,
                one.mean_force,
                one.mesh_frequency,
                one.half_backlash,
            )
            for one in moving
        ]
    )[place]
    length, rate, stiffness, force, mesh, hot = values.T.copy()
    return GearPoints(
        from_excitation(moving).lanes().take(place),
        np.where(jammed, STATUS.index("jammed"), 0).astype(np.int8),
        length,
        rate,
        stiffness,
        force,
        error[place],
        mesh,
        hot,
    )


def _joined(parts: Sequence[tuple[NDArray[np.int64], GearPoints]], count: int) -> GearPoints:
    """Parts put in the order of the rows."""
    if len(parts) == 1:
        return parts[0][1]
    order = np.argsort(np.concatenate([index for index, _ in parts]), kind="stable")
    points = [part for _, part in parts]

    def wide(arrays: list[NDArray[Any]]) -> NDArray[Any]:
        width = max(a.shape[1] for a in arrays) if arrays[0].ndim == 2 else 0
        if width:
            arrays = [np.pad(a, ((0, 0), (0, width - a.shape[1]))) for a in arrays]
        return np.concatenate(arrays)[order]

    def of(name: str) -> NDArray[Any]:
        return wide([getattr(part, name) for part in points])

    def flat_of(name: str) -> NDArray[Any]:
        return wide([getattr(part.flat, name) for part in points])

    none = (None,) * count
    flat = Lanes(
        period=flat_of("period"),
        damping=flat_of("damping"),
        half_backlash=flat_of("half_backlash"),
        stiffness=flat_of("stiffness"),
        force=flat_of("force"),
        stiffness_pieces=none,
        force_pieces=none,
    )
    return GearPoints(
        flat,
        of("status"),
        of("length"),
        of("rate"),
        of("stiffness"),
        of("force"),
        of("error"),
        of("mesh_frequency"),
        of("half_backlash"),
    )


@dataclass(frozen=True, eq=False)
class Tabulated:
    """A family of one parameter between the points of a grid where it was computed.

    Stiffness, error and backlash run straight from point to point; speed enters exactly. Where
    they do not depend on the parameter, as with given temperatures over speed, so does all.
    """

    family: GearFamily
    values: Floats
    points: GearPoints

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

    def __call__(self, points: Floats) -> GearPoints:
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
        return GearPoints(flat, status, length, rate, stiffness, force, error, mesh, hot)


def gear_axes(axes: Mapping[str, ArrayLike]) -> dict[str, Floats]:
    """Axes under their full names, values as given (SI)."""
    found: dict[str, Floats] = {}
    for name, values in axes.items():
        full = word(name)
        if full in found:
            raise InputError("parameter", repr(name), allowed="different parameters")
        found[full] = np.atleast_1d(np.asarray(values, dtype=float))
    return found
