"""Many samples of one case side by side: which fields one mesh cycle takes as columns, and how.

A column is an array of SI values of one field, one entry for each sample. Geometry is one for all
samples of a cycle; what else a file says in numbers of loads, heat, oil, backlash, widths,
finish, moduli, expansion, damping and error may be a column.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import ThermogearError
from thermogear.base.excitation import Excitations, Periodic, padded
from thermogear.base.materials import Lubricant
from thermogear.base.parameters import PARAMETERS
from thermogear.base.plan import Alive, keep_going
from thermogear.base.units import ZERO_CELSIUS
from thermogear.base.vocabulary import HEAT_NOT_SETTLED, STATUS
from thermogear.case.allowed import within
from thermogear.case.backlash import cold_from_soaked, normal_half
from thermogear.case.build import Follows, TemperatureRule
from thermogear.case.case import GearCase
from thermogear.case.fields import BODY
from thermogear.case.thermal_state import UNDEFORMED, ThermalState, unknown_where
from thermogear.gears.contact import path_of_contact
from thermogear.gears.geometry import Gear
from thermogear.heat.lubrication import grade
from thermogear.mesh.cycle import Cycle
from thermogear.mesh.excite import EXCITES, excitations, over_turn
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Varied
from thermogear.mesh.thermal import HotPair

Columns = Mapping[str, Floats]

BATCH = 256
"""Samples in one mesh cycle."""
FEW = 3
"""Positions along the path of contact: what moves the teeth hangs on the mesh phase alone."""
GEARS_AT = "gear_temperature"
"""The one column that is a state of heat: both addenda, the rest as the case says they follow."""
FREE = (
    "operating.speed", "operating.torque", "dynamics.damping_ratio", "cold_half_backlash",
    "cold_backlash", "error_amplitude", "oil_viscosity",
    "gears.pinion.roughness", "gears.wheel.roughness", GEARS_AT,
)  # fmt: skip
"""Columns of every case: fields of the file, and parameters that no field says."""
WIDTHS = ("gears.pinion.face_width", "gears.wheel.face_width")
BODIES = ("pinion_bore", "wheel_bore", "housing")
OF_OIL = ("oil.viscosity_40", "oil.viscosity_100", "oil.density_15")
OF_MATERIAL = ("youngs_modulus", "thermal_expansion")

BODIES_OF: dict[str, Callable[[GearCase, HotPair], Any]] = {
    "oil_temperature": lambda _, hot: hot.operating.oil_temperature,
    "pinion_temperature": lambda _, hot: hot.temperatures.pinion_addendum,
    "tooth_temperature": lambda _, hot: np.maximum(
        hot.temperatures.pinion_addendum, hot.temperatures.wheel_addendum
    ),
    "case": lambda case, hot: np.full(hot.count, case, object),
    "hot_pair": lambda _, hot: np.array(
        [replace(hot, operating=hot.operating.part(slice(n, n + 1))) for n in range(hot.count)]
    ),
}
"""What is wanted of the operating points themselves, no quantity of the mesh cycle."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Samples:
    """``case`` with its operating points in columns, and what else vibration needs.

    ``damping_ratio`` [-] and ``error`` (times the case's own), (sample,); ``inertias`` [kg m^2],
    (sample, 2). ``cycles``: those that the motion was made of, for the answers that follow.
    """

    case: GearCase
    damping_ratio: Floats
    error: Floats
    inertias: Floats
    cycles: dict[object, Cycle] = field(default_factory=dict)

    def excited(self, found: Mapping[str, NDArray[Any]]) -> Excitations:
        """What excites the samples whose :func:`quasi_static` is ``found``, at their speeds."""
        case = self.case
        return with_error(
            excitations(
                found,
                case.pair,
                damping_ratio=self.damping_ratio,
                inertias=self.inertias,
                harmonics=case.harmonics,
            ),
            Periodic.columns([case.transmission_error]) * self.error[:, None],
        )


def with_error(springs: Excitations, error: NDArray[np.complex128]) -> Excitations:
    """``springs`` with coefficients of a kinematic error [m] added, (sample, 1 + harmonic).

    Harmonics of the error are those of the mesh frequency, whatever the period of the springs.
    """
    error = over_turn(error, springs.mesh_periods)
    width = max(error.shape[1], springs.error.shape[1])
    return replace(springs, error=padded(error, width) + padded(springs.error, width))


def fields_of(name: str) -> tuple[str, ...]:
    """The columns that a parameter means: fields of the file, or itself."""
    one = PARAMETERS.get(name)
    if name in ("cold_half_backlash", GEARS_AT) or one is None or not one.fields:
        return (name,)
    return one.fields


def takes(case: GearCase, field: str) -> bool:
    """Whether ``field`` may be a column of samples of ``case``."""
    table, _, last = field.rpartition(".")
    if field in FREE:
        return True
    if field == "backlash.value" or field in OF_OIL:
        return _given(case, field) is not None
    if field in WIDTHS:
        # the heat balance knows one housing and one width
        return not case.computed
    if table.startswith("materials."):
        # a backlash given at a temperature hangs on how much the materials expand
        soaked = _given(case, "backlash.temperature") is not None
        return last in OF_MATERIAL and _given(case, field) is not None and not soaked
    return not case.computed and _takes_heat(case, field)


def _takes_heat(case: GearCase, field: str) -> bool:
    """Of given temperatures: as the file gives them, outright or below the addenda."""
    known = {f"temperatures.{gear}_addendum" for gear in ("pinion", "wheel")}
    rule = case.temperature_rule
    if rule is None:
        return False
    for body, place in ((b, f"temperatures.{b}") for b in BODIES):
        follows: Follows = getattr(rule, body)
        known.add(f"{place}_below_addendum" if follows.below else place)
    known.add("oil.temperature_below_addendum" if rule.oil.below else "oil.temperature")
    return field in known


def _given(case: GearCase, field: str) -> object:
    """What the file says of ``field``; None where it leaves it out."""
    table: Any = case.file
    for part in field.split("."):
        table = table.get(part) if isinstance(table, dict) else getattr(table, part, None)
    return table


def sampled(case: GearCase, columns: Columns, count: int) -> Samples:
    """``count`` samples of ``case``: its first speed and torque, with ``columns`` in their place.

    Every column is one that :func:`takes` allows, (sample,) in SI.
    """

    def column(field: str, value: ArrayLike) -> Floats:
        found = np.asarray(columns.get(field, value), dtype=float)
        return np.array(np.broadcast_to(found, (count,)))

    stated = case.stated
    widths = tuple(
        columns.get(field, np.full(count, gear.face_width))
        for field, gear in zip(WIDTHS, (case.pair.pinion, case.pair.wheel), strict=True)
    )
    rule, changes = case.temperature_rule, dict[str, Any]()
    if rule is not None and not case.computed:
        rule, changes = _heat(case, rule, columns)
    made = replace(
        case,
        temperature_rule=rule,
        stated=replace(
            stated,
            speed=column("operating.speed", case.speeds[0]),
            torque=column("operating.torque", case.torques[0]),
            lubricant=_oil(case, columns),
            varied=_varied(case, columns, widths),
            **changes,
        ),
    )
    own = np.array(case.inertias)
    if case.inertia_kind != "given":
        first = (case.pair.pinion.face_width, case.pair.wheel.face_width)
        own = own * np.stack([w / one for w, one in zip(widths, first, strict=True)], axis=1)
    return Samples(
        case=made,
        damping_ratio=column("dynamics.damping_ratio", case.damping_ratio),
        error=_error(case, columns, count),
        inertias=np.array(np.broadcast_to(own, (count, 2))),
    )


def _error(case: GearCase, columns: Columns, count: int) -> Floats:
    """The kinematic error over the case's, its first harmonic scaled to the column's amplitude."""
    harmonics = case.transmission_error.harmonics
    own = abs(harmonics[0]) if harmonics else 0.0
    if "error_amplitude" not in columns or own == 0.0:
        return np.ones(count)
    return np.asarray(columns["error_amplitude"] / own)


def _varied(case: GearCase, columns: Columns, widths: tuple[Floats, ...]) -> Varied:
    """What of the pair differs between the samples."""
    found: dict[str, Floats] = {}
    if any(field in columns for field in WIDTHS):
        found["face_width"] = np.minimum(*widths)
    pair = case.pair
    for side, gear in (("pinion", pair.pinion), ("wheel", pair.wheel)):
        if f"gears.{side}.roughness" in columns:
            found[f"{side}_roughness"] = columns[f"gears.{side}.roughness"]
        found |= _of_material(columns, gear, side)
    grown = f"materials.{case.housing.name}.thermal_expansion"
    if grown in columns:
        found["housing_expansion"] = columns[grown]
    for column, share in (("cold_half_backlash", 1.0), ("cold_backlash", 0.5)):
        if column in columns:
            found["half_backlash"] = share * columns[column]
    if "backlash.value" in columns:
        found["half_backlash"] = _cold(case, columns["backlash.value"])
    return Varied(**found)


def _of_material(columns: Columns, gear: Gear, side: str) -> dict[str, Floats]:
    at = f"materials.{gear.material.name}"
    names = {"youngs_modulus": f"{side}_modulus", "thermal_expansion": f"{side}_expansion"}
    return {
        own: columns[f"{at}.{name}"] for name, own in names.items() if f"{at}.{name}" in columns
    }


def _cold(case: GearCase, value: Floats) -> Floats:
    """Cold half backlash [m] of the file's kind of backlash."""
    table, reference = case.file.backlash, case.file.temperatures.reference
    rise = 0.0 if table.temperature is None else table.temperature - reference
    half = normal_half(value, str(table.direction), str(table.extent), case.pair)
    return cold_from_soaked(half, rise, case.pair, case.housing.thermal_expansion)


def _oil(case: GearCase, columns: Columns) -> Lubricant:
    """The oils of the samples; a grade alone is a mineral oil of the package's own lines."""
    own = case.stated.lubricant
    if "oil_viscosity" in columns:
        lines = [grade(float(nu)) for nu in columns["oil_viscosity"]]
    elif any(field in columns for field in OF_OIL):
        given = case.file.oil
        rows = np.broadcast_arrays(
            *(columns.get(f, np.array(getattr(given, f.split(".")[1]), float)) for f in OF_OIL)
        )
        lines = [
            Lubricant.from_two_points(
                own.name,
                (ZERO_CELSIUS + 40.0, float(nu_40)),
                (ZERO_CELSIUS + 100.0, float(nu_100)),
                density_15=float(rho),
            )
            for nu_40, nu_100, rho in zip(*rows, strict=True)
        ]
    else:
        return own
    return replace(
        lines[0],
        name=own.name,
        walther_a=np.array([one.walther_a for one in lines]),
        walther_b=np.array([one.walther_b for one in lines]),
        density_15=np.array([one.density_15 for one in lines]),
    )


def _heat(
    case: GearCase, rule: TemperatureRule, columns: Columns
) -> tuple[TemperatureRule, dict[str, Any]]:
    """The rule of the samples' temperatures, and the temperatures it gives."""

    def follows(place: str, one: Follows) -> Follows:
        place += "_below_addendum" if one.below else ""
        return replace(one, value=columns.get(place, one.value))

    made = replace(
        rule,
        pinion_bore=follows("temperatures.pinion_bore", rule.pinion_bore),
        wheel_bore=follows("temperatures.wheel_bore", rule.wheel_bore),
        housing=follows("temperatures.housing", rule.housing),
        oil=follows("oil.temperature", rule.oil),
    )
    given = case.stated.temperatures
    tips = {
        name: columns.get(f"temperatures.{name}", getattr(given, name))
        for name in ("pinion_addendum", "wheel_addendum")
    }
    return made, {
        "temperatures": made.at(**tips),
        "oil_temperature": made.oil_at(tips["pinion_addendum"]),
    }


def quasi_static(
    case: GearCase,
    columns: Columns,
    count: int,
    model: MeshModel,
    state: ThermalState,
    want: Sequence[str],
    *,
    path_positions: int = FEW,
    sample: Callable[[GearCase, Columns, int], Samples] = sampled,
    alive: Alive = keep_going,
) -> dict[str, NDArray[Any]]:
    """Stored quantities of the mesh cycle of ``count`` samples, in SI: name -> (sample, ...).

    ``sample`` is :func:`sampled`, or one that keeps what it made.
    ``want`` names them (:func:`~thermogear.mesh.cycle.mesh_cycle`); only they are computed, and
    with them ``pinion_speed``, ``pinion_torque`` and ``status``. A sample that no case could
    have is "impossible", one whose heat or mesh does not settle says so, both are nan, and no
    other one notices. Raises what is wrong where no sample is possible. ``alive`` is called
    before each cycle and raises to end the work.
    """
    refused: list[ThermogearError] = []

    def asked(places: NDArray[np.int64]) -> list[tuple[NDArray[np.int64], dict[str, NDArray[Any]]]]:
        """The cycle of samples that do it, halved where one is refused until it is alone."""
        alive()
        some = {name: values[places] for name, values in columns.items()}
        try:
            here = sample(case, some, places.size)
            return [(places, _cycle(here, some, model, state, want, path_positions))]
        except ThermogearError as error:
            if places.size == 1:
                refused.append(error)
                return []
        halves = np.split(places, [places.size // 2])
        return [part for half in halves for part in asked(half)]

    chunks = (np.arange(first, min(first + BATCH, count)) for first in range(0, count, BATCH))
    parts = [part for places in chunks for part in asked(places)]
    if not parts:
        raise refused[0]
    found: dict[str, NDArray[Any]] = {}
    for name, like in parts[0][1].items():
        kind = np.promote_types(like.dtype, float)
        found[name] = np.full((count, *like.shape[1:]), np.nan, kind)
        for places, values in parts:
            found[name][places] = values[name]
    lost = np.isnan(found["status"])
    found["status"] = np.where(lost, STATUS.index("impossible"), found["status"]).astype(np.int8)
    return found


def _cycle(
    samples: Samples,
    columns: Columns,
    model: MeshModel,
    state: ThermalState,
    want: Sequence[str],
    path_positions: int,
) -> dict[str, NDArray[Any]]:
    temperature, case = columns.get(GEARS_AT), samples.case
    if temperature is None:
        balance = (
            state.balance(case, model, from_hot=False)
            if state != UNDEFORMED and state.held is None
            else None
        )
        operating = state.moving(case, model)
    else:
        within("state", BODY, temperature)
        fixed = case.follow != "proportional"
        balance = (
            case.balance(model, temperature if fixed else None, from_hot=False)
            if case.computed
            else None
        )
        operating = case.operating_at(temperature, model)
    hot = HotPair(case.pair, replace(operating, housing=case.housing), model)
    s = path_of_contact(case.pair, path_positions)
    # what is asked after the motion takes the same mesh, and ends its keeping
    key = (model, state, path_positions)
    cycle = samples.cycles.pop(key, None) or Cycle(
        hot, tuple(case.deviations), s, case.mesh_positions
    )
    if want == EXCITES:
        samples.cycles[key] = cycle
    cyclic = [name for name in want if name not in BODIES_OF]
    found = {name: np.asarray(values) for name, values in cycle.quantities(cyclic).items()}
    found |= {
        name: np.broadcast_to(BODIES_OF[name](case, hot), hot.count).copy()
        for name in want
        if name in BODIES_OF
    }
    if balance is not None:
        lost = state.open(case, balance, given=temperature is not None)
        found["status"] = np.where(lost, HEAT_NOT_SETTLED, found["status"])
        found |= unknown_where(lost, found, want)
    return found | {"pinion_speed": operating.speed, "pinion_torque": operating.torque}
