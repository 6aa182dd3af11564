"""Speed and torque of every stage under every load, from what the shafts and their loads say.

Speeds run from the shafts that have one through the ratios of the stages; torques follow from the
balance of every shaft without losses. A torque acts on its shaft about the shaft's own u axis, so
that torque times speed above 0 drives (REXS).
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from thermogear.base.errors import InputError
from thermogear.case.rexs import gearbox
from thermogear.case.rexs.attributes import Reader
from thermogear.case.rexs.gearbox import Stage
from thermogear.case.rexs.model import Attribute, Component, LoadCase

_UNIQUE = 1e-6
"""Share of a unit torque that the balance may leave open."""
_IDLE = 1e-9
"""Share of the greatest torque below which a stage carries none."""
_MOST = 2_000_000
_LARGEST = 10_000
"""Entries of the balance: a hundred shafts with a hundred torques."""
_LOSSES = 0.1
"""Torques that a file gives may miss the balance without losses by as much of the greatest."""


@dataclass(frozen=True, kw_only=True)
class Load:
    """One load of a stage: ``speed`` [rad/s] with its sign and ``torque`` [N m] of gear_1 by the
    mesh, as far as they are known; ``duration`` [s] or ``share`` of the time. ``speed_read``: the
    speed is in the file; ``signed``: its sense is known."""

    name: str
    speed: float | None
    torque: float | None
    speed_read: bool = False
    duration: float | None = None
    share: float | None = None
    signed: bool = True
    other_speed: float | None = None


class Drive:
    """The shafts and stages of a model as one train."""

    def __init__(self, reader: Reader) -> None:
        self.reader = reader
        model = self.model = reader.model
        self.shafts = [one.id for one in model.of_type("shaft")]
        self.of_gear = gearbox.shafts_of_gears(model)
        self.loads = gearbox.loads_of_shafts(model)
        self.joined = gearbox.joined_shafts(model)
        self.switched = gearbox.switched_shafts(model)
        self.meshes: list[tuple[Component, int, int, int, int]] = []
        self.crossed: set[int] = set()
        self.open = dict.fromkeys(sorted(gearbox.planetary_shafts(model)))
        for stage, first, second in gearbox.meshes(model):
            self._mesh(stage, first, second)
        size = len(model.load_cases) * (len(self.shafts) + len(self.of_gear) + len(self.meshes))
        if size > _MOST:
            raise InputError(
                "load_spectrum",
                f"{len(model.load_cases)} load cases of {len(self.of_gear)} gears",
                allowed=f"at most {_MOST} together",
                why="no gearbox has as many",
            )
        self.neighbours: dict[int, list[tuple[int, float, bool]]] = {}
        links = [(one, other, 1.0, True) for one, other in self.joined]
        links += [
            (first, second, z1 / z2, stage.id not in self.crossed)
            for stage, first, second, z1, z2 in self.meshes
        ]
        for one, other, ratio, sure in links:
            self.neighbours.setdefault(one, []).append((other, ratio, sure))
            self.neighbours.setdefault(other, []).append((one, 1.0 / ratio, sure))

    def _mesh(self, stage: Component, first: Component, second: Component) -> None:
        shafts = (self.of_gear.get(first.id), self.of_gear.get(second.id))
        try:
            teeth = [self.reader.whole(one, "number_of_teeth") for one in (first, second)]
        except InputError:
            teeth = [None, None]
        if None in shafts or None in teeth or 0 in teeth:
            self.open.update(dict.fromkeys(one for one in shafts if one is not None))
            return
        z1, z2 = (abs(t or 0) for t in teeth)
        inner = (
            any(one.type == "ring_gear" for one in (first, second))
            or min(t or 0 for t in teeth) < 0
        )
        sense = 1 if inner else -1
        if stage.type != "cylindrical_stage":
            sense = self._crossing(stage, first, second)
        elif not self._parallel(first, second):
            sense = -sense
        self.meshes.append((stage, shafts[0] or 0, shafts[1] or 0, z1, sense * z2))

    def _crossing(self, stage: Component, first: Component, second: Component) -> int:
        """1 where both gears of crossed axes turn alike about their u axes, -1 where not.

        Bevel cones that point both along or both against their u axes turn against each other.
        """
        cones = {self.reader.words(one, "bevel_cone_orientation") for one in (first, second)}
        if not cones <= {"positive", "negative"}:
            self.crossed.add(stage.id)
        return -1 if len(cones) == 1 else 1

    def _parallel(self, first: Component, second: Component) -> bool:
        """Whether the u axes of both shafts point the same way; so where nothing is said."""
        axes = [
            self.reader.vector(self.model.at(self.of_gear.get(gear.id)), "u_axis_vector")
            or self.reader.vector(gear, "u_axis_vector")
            for gear in (first, second)
        ]
        if axes[0] is None or axes[1] is None:
            return True
        return sum(a * b for a, b in zip(axes[0], axes[1], strict=True)) >= 0.0

    # --- what is asked for ----------------------------------------------------------------
    def loads_of(self, stage: Stage) -> list[Load]:
        """The load cases of a stage, or the one load of the model itself."""
        cases: list[LoadCase | None] = [*self.model.load_cases] or [None]
        return [self._load(stage, case) for case in cases]

    def _load(self, stage: Stage, case: LoadCase | None) -> Load:
        over: dict[int, dict[str, Attribute]] = {} if case is None else case.components
        speeds, read, signed = self.speeds(over)
        shaft = self.of_gear.get(stage.gears[0].id)
        speed = speeds.get(shaft) if shaft is not None else None
        torque = self._torque(stage, over, speeds)
        unit = next(iter(self.model.of_type("gear_unit")), None)
        bare = Component(unit.id, unit.type) if unit is not None else None
        lasts, share = (
            self.reader.number(bare, name, over.get(bare.id) if bare else None)
            for name in ("operating_time", "operating_time_fraction")
        )
        return Load(
            name="the model" if case is None else f"load case {case.id}",
            speed=speed,
            torque=torque,
            speed_read=shaft in read,
            duration=None if lasts is None else lasts.si,
            share=None if share is None else share.si,
            signed=shaft in signed,
            other_speed=speeds.get(self.of_gear.get(stage.gears[1].id, -1)),
        )

    # --- speeds ----------------------------------------------------------------------------
    def speeds(
        self, over: dict[int, dict[str, Attribute]]
    ) -> tuple[dict[int, float], set[int], set[int]]:
        """Shaft -> speed [rad/s]; the shafts whose speed the file has, and whose sense it has.

        What a load case says goes before what the model says, defining shafts before others.
        """
        found: dict[int, float] = {}
        read: set[int] = set()
        unsure: set[int] = set()
        for own in (True, False):
            table = over if own else {}
            given = self._given(table, True, only_over=own)
            given = {**self._given(table, False, only_over=own), **given}
            for shaft, speed in given.items():
                if shaft not in found:
                    found[shaft] = speed
                    read.add(shaft)
            self._spread(found, unsure, over)
        return found, read, set(found) - unsure

    def _given(
        self, over: dict[int, dict[str, Attribute]], defines: bool, *, only_over: bool
    ) -> dict[int, float]:
        found: dict[int, float] = {}
        holders = [(one, one) for one in self.shafts]
        holders += [(gear, shaft) for gear, shaft in self.of_gear.items()]
        for holder, shaft in holders:
            component = self.model.at(holder)
            if component is None or (only_over and holder not in over):
                continue
            bare = Component(component.id, component.type) if only_over else component
            says = self.reader.truth(component, "defines_speed", over.get(holder))
            speed = self.reader.number(bare, "rotational_speed", over.get(holder))
            if speed is not None and bool(says) is defines:
                found.setdefault(shaft, speed.si)
        return found

    def _engaged(self, over: dict[int, dict[str, Attribute]]) -> list[tuple[int, int]]:
        """Pairs of shafts that a coupling turns alike in the gear of a load case.

        ``is_engaged`` is one truth, or one for each gear; ``gear_shift_index`` counts from 1.
        """
        if not self.switched:
            return []
        unit = next(iter(self.model.of_type("gear_unit")), None)
        index = (
            self.reader.whole(unit, "gear_shift_index", over.get(unit.id))
            if unit is not None
            else None
        )
        found = []
        for one, other, coupling in self.switched:
            engaged = self.reader.attribute(coupling, "is_engaged", over.get(coupling.id))
            values = None if engaged is None else engaged.value
            if isinstance(values, list):
                place = 1 if index is None and len(values) == 1 else index or 0
                values = values[place - 1] if 1 <= place <= len(values) else False  # type: ignore[assignment]
            if str(values).strip().lower() in ("true", "1"):
                found.append((one, other))
        return found

    def _spread(
        self,
        found: dict[int, float],
        unsure: set[int],
        over: dict[int, dict[str, Attribute]],
    ) -> None:
        """Through stages and connections, as far as they reach."""
        engaged: dict[int, list[tuple[int, float, bool]]] = {}
        for one, other in self._engaged(over):
            engaged.setdefault(one, []).append((other, 1.0, True))
            engaged.setdefault(other, []).append((one, 1.0, True))
        waiting = list(found)
        while waiting:
            one = waiting.pop()
            for other, ratio, sure in (*self.neighbours.get(one, ()), *engaged.get(one, ())):
                if other in found:
                    continue
                found[other] = found[one] * ratio
                if not sure or one in unsure:
                    unsure.add(other)
                waiting.append(other)

    # --- torques ---------------------------------------------------------------------------
    def _torque(
        self, stage: Stage, over: dict[int, dict[str, Attribute]], speeds: dict[int, float]
    ) -> float | None:
        """Torque [N m] on gear_1 by the mesh: from the loads of the shafts, else as given."""
        balanced = self._balance(over, speeds)
        if stage.component.id in balanced:
            return balanced[stage.component.id]
        for place, gear in enumerate(stage.gears):
            data = gearbox.gear_data_of(self.model, stage.component, gear)
            found = (
                self.reader.number(data, "torque", over.get(data.id)) if data is not None else None
            )
            if found is not None:
                teeth = [self.reader.whole(one, "number_of_teeth") or 1 for one in stage.gears]
                scale = 1.0 if place == 0 else abs(teeth[0] / teeth[1])
                return scale * found.si
        return None

    def _balance(
        self, over: dict[int, dict[str, Attribute]], speeds: dict[int, float]
    ) -> dict[int, float]:
        """Stage -> torque on gear_1 by its mesh, where the balance of the shafts decides it.

        Unknown are the torque of every stage, of every connection, of every load that defines none
        and of gears whose stage has no ratio, planetary ones too: sum of the torques on a shaft = 0
        for each shaft; on gear_2 T2 = T1 z2/z1 for external gears, so that no power is lost.
        """
        known, unknown = self._external(over, speeds)
        if not self.meshes or not any(known.values()):
            return {}
        columns: list[dict[int, float]] = []
        for _, first, second, z1, z2 in self.meshes:
            column = {first: 1.0}
            column[second] = column.get(second, 0.0) - z2 / z1
            columns.append(column)
        alike = (*self.joined, *self._engaged(over))
        columns += [{one: 1.0, other: -1.0} for one, other in alike]
        columns += [{shaft: 1.0} for shaft in (*unknown, *self.open)]
        held = Counter(shaft for _, *both, _, _ in self.meshes for shaft in both)
        ends = [{one: 1.0} for one in self.shafts if one not in self.loads and held[one] == 1]
        return self._solved(columns, known) or self._solved([*columns, *ends], known)

    def _solved(self, columns: list[dict[int, float]], known: dict[int, float]) -> dict[int, float]:
        rows = {shaft: k for k, shaft in enumerate(self.shafts)}
        if len(rows) * len(columns) > _LARGEST:
            return {}
        matrix = np.zeros((len(rows), len(columns)))
        for k, column in enumerate(columns):
            for shaft, share in column.items():
                matrix[rows[shaft], k] += share
        right = np.array([-known.get(shaft, 0.0) for shaft in self.shafts])
        _, sizes, modes = np.linalg.svd(matrix)
        rank = int(np.sum(sizes > 1e-10 * sizes.max(initial=1.0)))
        free = modes[rank:]
        solution = np.linalg.lstsq(matrix, right, rcond=None)[0]
        miss = np.abs(matrix @ solution - right)
        if miss.size and miss.max() > _LOSSES * np.abs(right).max():
            return {}
        torques = np.where(np.abs(solution) < _IDLE * np.abs(right).max(), 0.0, solution)
        return {
            stage.id: float(torques[k])
            for k, (stage, *_) in enumerate(self.meshes)
            if not free.size or np.abs(free[:, k]).max() < _UNIQUE
        }

    def _external(
        self, over: dict[int, dict[str, Attribute]], speeds: dict[int, float]
    ) -> tuple[dict[int, float], list[int]]:
        """Shaft -> known torque from outside; the shafts with a load that is left to follow."""
        known: dict[int, float] = {}
        unknown = []
        defined = any(
            self.reader.truth(load, "defines_torque", over.get(load.id))
            for loads in self.loads.values()
            for load in loads
        )
        for shaft, loads in self.loads.items():
            for load in loads:
                own = over.get(load.id)
                says = self.reader.truth(load, "defines_torque", own)
                torque = self.reader.number(load, "torque_around_u_axis", own)
                power = self.reader.number(load, "power", own)
                value = None if torque is None else torque.si
                if value is None and power is not None and speeds.get(shaft):
                    value = power.si / speeds[shaft]
                if value is not None and (says or not defined):
                    known[shaft] = known.get(shaft, 0.0) + value
                elif self.reader.truth(load, "transmits_torque", own) is not False:
                    unknown.append(shaft)
        return known, unknown
