"""Which indicator sees a fault of which size: computed series of gears, healthy and with it.

Every gear pair is one drawing of the case's class, followed over its whole turn with each fault and
without, hot and undeformed, at each load. Noise is added to its synchronous averages, and the
indicators of :mod:`~thermogear.study.diagnosis` are held against limits that healthy averages set.
Two questions: does a change show in the *same machine*, before and after, and does it show in
*another machine* of the class, of which nothing was recorded before.
Checked by ``tests/study/test_detection.py`` and ``trials/detection.py``.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from typing import Any

import numpy as np
import xarray as xr

from thermogear.analysis.order_statistics import proportion
from thermogear.base.arrays import Dataset, Floats, Whole
from thermogear.base.display import SPEED
from thermogear.base.errors import InputError
from thermogear.base.excitation import Excitations
from thermogear.base.notice import Notice, stored_notices
from thermogear.base.plan import (
    Alive,
    Arrays,
    Coordinate,
    Key,
    Variable,
    axis_coordinates,
    empty_arrays,
    keep_going,
    ranges_of,
    real,
)
from thermogear.base.vocabulary import STATUS, label, moves, status_attributes
from thermogear.case.case import GearCase
from thermogear.case.family import GearFamily
from thermogear.case.fault_schema import FaultTable
from thermogear.case.faults import fault_words, whole_turn
from thermogear.case.points import points_of
from thermogear.case.thermal_state import HOT, UNDEFORMED, ThermalState
from thermogear.gears.deviations import GEARS, Deviation
from thermogear.gears.tooth_table import MATES
from thermogear.mesh.excite import excitations
from thermogear.mesh.series import SeriesMesh, changed_mesh, series_mesh
from thermogear.mesh.thermal import HotPair
from thermogear.signals.indicators import gear_indicators
from thermogear.signals.synchronous import shared_step
from thermogear.study.diagnosis import INDICATORS, loudest_teeth
from thermogear.study.faults import TurnMotion, turn_motions
from thermogear.study.series import series_parts
from thermogear.study.series_along import HEATED

HEALTHY = 60
"""Parts of the class whose healthy series are known: the greatest of the 59 others is exceeded by
more than 5 % of all parts with a chance of .95^59 = 5 %, whatever their distribution (Wilks 1941).
As many averages of one machine set its own limits."""
PARTS = 16
"""Parts that get the faults: chosen. 23 on 47 teeth take three minutes on two cores then."""
NOISE = 0.3
"""Noise over the rms of the first healthy part: chosen, as in ``trials/diagnosis.py``."""
TURNS = 100
"""Turns of the pinion in an average, about: chosen."""
LOADS = (0.5, 1.0, 1.5)
"""Loads over that of a case that states one."""
SAMPLES = 64
"""Of a mesh period, a divisor of 192. Of its contact 96 positions are solved: 64 move the rms of an
acceleration by 10 to 15 %, and what an indicator sees with it. Harmonics are the case's at every
speed: of slow pairs they do not reach the natural vibration, as those of
:func:`~thermogear.study.faults.fault_motions` do."""
HIGHEST = SAMPLES / 2
"""Natural frequency over the mesh's at most: half the samples (Nyquist). Beyond, the resonance
folds into lower orders: of 17 and 54 teeth at 49 half the power of the wheel's average."""
STATES = (HOT, UNDEFORMED)
SIGNALS = ("acceleration", "mesh_force")
QUESTIONS = ("same machine", "another machine")
SIGHTS = (*INDICATORS, "any", "tooth")
"""What sees a fault: the indicators; any of them, which errs more often than one (1/60 of sound
ones; 15 independent ones 22 %); last, whether the difference signal is loudest over the contact of
the faulty tooth or of a neighbour: of the same machine that of the change, of another that of the
average. A tooth too far forward hits before its time, one that yields rings after it;
by chance 3/z."""
SIZES = (0.25, 0.5, 1.0)
"""Of each fault, over what the case or :func:`usual_faults` states."""
SIZED = {
    "crack": ("depth", "share"), "chip": ("height",), "missing": (), "pitch": ("amount",),
    "spall": ("width_share", "length"), "wear": ("depth", "revolutions"),
    "eccentricity": ("amount",),
}  # fmt: skip
"""The size of each kind of fault: the first of these fields that is stated."""
BLOCK = 4  # parts of a chunk
JAMMED, NOT_CONVERGED = STATUS.index("jammed"), STATUS.index("not_converged")


def usual_faults(module: float) -> tuple[FaultTable, ...]:
    """Four faults of tooth 3 for gears of a ``module`` [m], at their largest size: chosen.

    A crack a third of the way across and a pitch error of .006 modules on the pinion, a spall over
    .8 of the face and a chip of .4 modules on the wheel.

    >>> [fault_words(fault) for fault in usual_faults(2e-3)][1]
    'pitch error of 12 um, pinion tooth 3'
    """
    kinds: tuple[tuple[str, str, dict[str, Any]], ...] = (
        ("crack", "pinion", {"share": 0.32}),
        ("pitch", "pinion", {"amount": f"{6e-3 * module} m"}),
        ("spall", "wheel", {"length": f"{0.5 * module} m", "depth": f"{0.05 * module} m",
                            "width_share": 0.8}),
        ("chip", "wheel", {"height": f"{0.4 * module} m"}),
    )  # fmt: skip
    return tuple(FaultTable(kind=kind, gear=gear, tooth=3, **sizes) for kind, gear, sizes in kinds)


def size_of(fault: FaultTable) -> tuple[str, float]:
    """The field that is the size of a fault, and its value [SI]; ("", 1) of a missing tooth."""
    stated = ((name, getattr(fault, name)) for name in SIZED[fault.kind])
    return next(((name, float(value)) for name, value in stated if value is not None), ("", 1.0))


@dataclass(frozen=True, kw_only=True)
class DetectionPlan:
    """What :func:`detection_plan` says; ``families``: each fault at its sizes, rising."""

    case: GearCase
    bundle: str
    families: tuple[tuple[FaultTable, ...], ...]
    speeds: tuple[float, ...]
    torques: tuple[float, ...]
    parts: int = PARTS
    healthy: int = HEALTHY
    noise: float = NOISE
    turns: int = TURNS
    overrides: tuple[tuple[str, str], ...] = ()
    kind: str = "detect"

    @property
    def variants(self) -> tuple[tuple[FaultTable | None, int], ...]:
        """What is looked for in the average of which gear: nothing in both, and every fault at
        every size in that of its own."""
        every = (fault for family in self.families for fault in family)
        return ((None, 0), (None, 1), *((fault, GEARS.index(fault.gear)) for fault in every))

    @property
    def sizes(self) -> dict[str, int]:
        return {
            "state": len(STATES), "pinion_speed": len(self.speeds),
            "pinion_torque": len(self.torques), "part": self.healthy,
            "variant": len(self.variants), "signal": len(SIGNALS),
            "indicator": len(INDICATORS), "question": len(QUESTIONS),
        }  # fmt: skip

    @property
    def cuts(self) -> dict[str, int]:
        return {"state": 1, "pinion_speed": 1, "pinion_torque": 1, "part": BLOCK}

    def inputs(self) -> dict[str, Any]:
        return {
            "model": self._family(HOT).inputs() | {"overrides": [list(x) for x in self.overrides]},
            "faults": [fault.model_dump() for family in self.families for fault in family],
            "speeds": list(self.speeds), "torques": list(self.torques), "parts": self.parts,
            "healthy": self.healthy, "noise": self.noise, "turns": self.turns,
        }  # fmt: skip

    def variables(self) -> dict[str, Variable]:
        dims = tuple(self.cuts)
        each = ("variant", "signal", "indicator")
        tooth = {"long_name": "mesh period of the turn in which the loudest tooth enters"}
        return {
            "status": Variable(dims, "int8", 0, status_attributes()),
            "value": real(dims, "indicator of one average", "", *each),
            "own_beyond": real(dims, "beyond the machine's own limit", "1", *each),
            "own_shift": real(dims, "standard deviations of its own averages", "1", *each),
            "loudest": Variable((*dims, *each[:2], "question"), "int32", -1, tooth),
        }

    def coordinates(self) -> dict[str, Coordinate]:
        axes = axis_coordinates(
            ("pinion_speed", "pinion_torque"), ("rad/s", "N m"), (self.speeds, self.torques)
        )
        words: dict[str, Sequence[str]] = {
            "state": [state.kind for state in STATES], "signal": SIGNALS,
            "indicator": INDICATORS, "question": QUESTIONS,
        }  # fmt: skip
        return axes | {name: _named(name, some) for name, some in words.items()}

    def needs(self, key: Key) -> Key | None:
        return None

    def pilot(self, share: float, *, turn: int) -> float:
        """Compute a block of parts with their faults; what share it was."""
        self.compute((turn % len(STATES), 0, turn % len(self.torques), 0), None, keep_going)
        # a fault is solved where it acts alone: two thirds of a healthy part, about
        blocks = (self.parts + 1.5 * self.healthy / len(self.variants)) / BLOCK
        return 1.0 / (blocks * len(STATES) * len(self.speeds) * len(self.torques))

    def compute(self, key: Key, before: Arrays | None, alive: Alive) -> Arrays:
        arrays = empty_arrays(self, key)
        hot, excited = self._scenes[key[:3]]
        parts = range(self.healthy)[ranges_of(self, key)["part"]]
        faulty = slice(min(max(self.parts - parts.start, 0), len(parts)))
        arrays["status"][...] = excited.status
        if not moves(excited.status).all():
            return arrays
        drawn = self.series[0][parts.start : parts.stop]
        mesh = series_mesh(hot, drawn, self.turn)
        arrays["status"][0, 0, 0], sound = self._motions(excited, mesh)
        averages = [
            self._noisy(self._averages(sound[faulty], gear), gear, parts, HEALTHY - 1)
            for gear in range(len(GEARS))
        ]
        limits = [self._indicators(rows, gear) for gear, rows in enumerate(averages)]
        for variant, (fault, gear) in enumerate(
            self.variants if faulty.stop else self.variants[:2]
        ):
            alive()
            motions = sound
            if fault is not None:
                damaged = self.series[variant - 1][parts.start : parts.start + faulty.stop]
                changed = changed_mesh(mesh.of(faulty), hot, damaged, self._acting(fault))
                motions = self._motions(excited, changed)[1]
            rows = self._noisy(self._averages(motions, gear), gear, parts, 1, variant + 1)[:, 0]
            values = self._indicators(rows, gear)
            arrays["value"][0, 0, 0, : len(rows), variant] = values
            here, some = (0, 0, 0, faulty, variant), rows[faulty]
            held = against(values[faulty], healthy=limits[gear], axis=1)
            arrays["own_beyond"][here], arrays["own_shift"][here] = held
            changes = np.stack([some - averages[gear].mean(axis=1), some], axis=2)
            arrays["loudest"][here] = self._teeth(changes, gear)
        return arrays

    # --- what all parts share -----------------------------------------------------------------

    def _family(self, state: ThermalState) -> GearFamily:
        """The mean tooth over speed and torque."""
        names = ("pinion_speed", "pinion_torque")
        return GearFamily(self.case.mean_tooth(), names, self.bundle, state)

    @cached_property
    def _scenes(self) -> dict[Key, tuple[HotPair, Excitations]]:
        """The sound pair at each point, and what excites its mean tooth."""
        scenes: dict[Key, tuple[HotPair, Excitations]] = {
            (state, i, j): (
                family.quasi_static([[speed, torque]], HEATED)["hot_pair"][0],
                family.excitations(np.array([[speed, torque]])),
            )
            for state, family in enumerate(map(self._family, STATES))
            for i, speed in enumerate(self.speeds)
            for j, torque in enumerate(self.torques)
        }
        for (_, i, _), (_, excited) in scenes.items():
            points = points_of(excited)
            order = points.flat.period[0] / (2.0 * np.pi * points.mesh_periods)
            if order > HIGHEST:
                rpm = SPEED(self.speeds[i])
                raise InputError(
                    "operating.speed", f"{rpm:.6g} rpm",
                    why=f"the natural frequency is {order:.3g} times that of the mesh",
                    fix=f"take {np.ceil(rpm * order / HIGHEST):.0f} rpm or more",
                )  # fmt: skip
        return scenes

    @cached_property
    def series(self) -> list[tuple[tuple[Deviation, ...], ...]]:
        """Deviations of the healthy parts, then of those that get each fault."""

        def drawn(count: int, *faults: FaultTable) -> tuple[tuple[Deviation, ...], ...]:
            file = self.case.file.model_copy(update={"faults": faults})
            return series_parts(replace(self.case, file=file), count)

        faults = [fault for family in self.families for fault in family]
        return [drawn(self.healthy), *(drawn(self.parts, fault) for fault in faults)]

    @property
    def teeth(self) -> tuple[int, int]:
        """Of pinion and wheel."""
        return self.case.pair.pinion.teeth, self.case.pair.wheel.teeth

    @property
    def turn(self) -> int:
        """Mesh periods after which the same teeth meet again."""
        return int(np.lcm(*self.teeth))

    @property
    def averaged(self) -> tuple[int, int]:
        """Turns of pinion and wheel in an average: whole turns of both, about :attr:`turns`."""
        z1, z2 = self.teeth
        several = max(1, round(self.turns * z1 / self.turn))
        return several * self.turn // z1, several * self.turn // z2

    def entry(self, fault: FaultTable) -> int:
        """The mesh period of the gear's turn in which the faulty tooth enters."""
        first = self.case.tooth_number(fault.gear, 0) - 1
        return (fault.place - first) % self.teeth[GEARS.index(fault.gear)]

    def _acting(self, fault: FaultTable) -> Whole:
        """Mesh periods of the turn in which a fault acts."""
        every = np.arange(self.turn)
        if fault.kind == "eccentricity" or not whole_turn(fault):
            return every
        # a tip's edge may touch one period early, and one late; a body yields farther away
        reach = 1 + MATES * (fault.kind in ("crack", "missing"))
        late = (every - self.entry(fault) + reach) % self.teeth[GEARS.index(fault.gear)]
        return np.flatnonzero(late < 2 * reach + np.ceil(self.case.pair.contact_ratio))

    # --- averages and indicators ----------------------------------------------------------------

    def _motions(self, point: Excitations, mesh: SeriesMesh) -> tuple[Whole, list[TurnMotion]]:
        """Status and motion of each part of ``mesh``."""
        count, speed = len(mesh.stiffness), point.mesh_frequency[0] / self.teeth[0]
        jammed = np.where(mesh.half_backlash.min(axis=1) <= 0.0, JAMMED, point.status)
        status = np.where(np.isnan(mesh.stiffness).any(axis=1), NOT_CONVERGED, jammed)
        curves = {
            "status": status, "mesh_stiffness": mesh.stiffness, "spring_error": mesh.spring_error,
            "half_backlash": mesh.half_backlash.mean(axis=1),
            "cold_half_backlash": np.repeat(point.reference_half_backlash, count),
            "pinion_speed": np.repeat(speed, count),
            "pinion_torque": np.repeat(point.torques[:, 0], count),
            "mesh_periods": np.array(self.turn),
        }  # fmt: skip
        excited = excitations(
            curves, self.case.pair, damping_ratio=point.damping_ratio[0],
            inertias=point.inertias[0], transmission_error=self.case.transmission_error,
            harmonics=self.case.harmonics,
        )  # fmt: skip
        rows = np.stack([curves["pinion_speed"], curves["pinion_torque"]], axis=1)
        return status, turn_motions(self.case, points_of(excited), rows, SAMPLES)

    def _averages(self, motions: Sequence[TurnMotion], gear: int) -> Floats:
        """Averages over a turn of a gear, (part, signal, sample); nan where nothing moves."""
        turn = self.teeth[gear] * SAMPLES
        averages = [
            [getattr(motion, name).reshape(-1, turn).mean(axis=0) for name in SIGNALS]
            for motion in motions
        ]
        return np.reshape(averages, (len(motions), len(SIGNALS), turn))

    @cached_property
    def level(self) -> Floats:
        """Noise of each signal, rms [m/s^2, N] up to half the samples: a share of the rms about its
        mean of the first part at the first speed and the middle torque, hot."""
        hot, excited = self._scenes[0, 0, (len(self.torques) - 1) // 2]
        mesh = series_mesh(hot, self.series[0][:1], self.turn)
        averages = self._averages(self._motions(excited, mesh)[1], 0)
        return np.asarray(self.noise * averages[0].std(axis=-1))

    def _noisy(
        self, averages: Floats, gear: int, parts: range, count: int, stream: int = 0
    ) -> Floats:
        """``count`` of each average of the first of ``parts`` (part, signal, sample) with noise:
        (part, draw, signal, sample). The same noise hot and cold, at all loads."""
        noise = np.zeros((len(averages), count, *averages.shape[1:]))
        for part, rows in zip(parts, noise, strict=False):
            rows[:] = np.random.default_rng([self.case.seed, gear, part, stream]).normal(
                size=rows.shape
            )
        spread = self.level / np.sqrt(self.averaged[gear])
        return np.asarray(averages[:, None] + spread[:, None] * noise)

    def _orders(self, gear: int) -> dict[str, int]:
        teeth, mate = self.teeth[gear], self.teeth[1 - gear]
        highest = min(self.case.harmonics * teeth, teeth * SAMPLES // 2 - 1)
        return {"highest": highest, "step": shared_step(mesh_order=teeth, mate_order=mate)}

    def _indicators(self, averages: Floats, gear: int) -> Floats:
        """Indicators of averages (..., sample) of a gear, (..., indicator); nan where any is.

        Over one baseline NA4 is the fourth moment of the residual but for a factor: so it stands.
        """
        known = np.nan_to_num(averages)
        values = gear_indicators(known, mesh_order=self.teeth[gear], **self._orders(gear))
        rows = [values["residual_fourth" if name == "na4" else name] for name in INDICATORS]
        lost = np.isnan(averages).any(axis=-1, keepdims=True)
        return np.asarray(np.where(lost, np.nan, np.stack(rows, axis=-1)))

    def _teeth(self, averages: Floats, gear: int) -> Whole:
        """The loudest tooth of averages of a gear, -1 where they are not known."""
        known = np.nan_to_num(averages)
        ratio = self.case.pair.contact_ratio
        tooth = loudest_teeth(
            known, teeth=self.teeth[gear], contact_ratio=ratio, **self._orders(gear)
        )
        return np.where(np.isnan(averages).any(axis=-1), np.int64(-1), tooth)

    def finish(self, data: Dataset) -> Dataset:
        """Shares detected with their intervals."""
        return _labelled(self, data, detected(self, data))


def _named(dim: str, words: Sequence[str]) -> Coordinate:
    """A coordinate of names."""
    return (dim,), np.arange(len(words)), {"names": json.dumps(list(words))}


# --- what is counted ------------------------------------------------------------------------------


def against(values: Floats, *, healthy: Floats, axis: int) -> tuple[Floats, Floats]:
    """Whether values are beyond the greatest of the healthy along their ``axis``, which they lack,
    and how many standard deviations from their mean; what is nan among the healthy is left out.

    >>> healthy = np.array([[1.0, 2.0, 3.0]] * 2)
    >>> against(np.array([5.0, 2.0]), healthy=healthy, axis=1)
    (array([1., 0.]), array([3., 0.]))
    """
    known = np.ma.masked_invalid(healthy)
    shift = (values - known.mean(axis=axis)) / known.std(axis=axis, ddof=1)
    return np.ma.filled(1.0 * (values > known.max(axis=axis)), 0.0), np.ma.filled(shift, np.nan)


def detected(plan: DetectionPlan, data: Dataset) -> Arrays:
    """What is counted, over (question, state, pinion_speed, pinion_torque, variant, signal, sight).

    ``detected`` of ``judged`` parts, ``detected_share`` with its interval of 95 %, ``shift``: the
    median in standard deviations of the healthy. "any" is detected where an indicator is. Another
    machine is held against the healthy ones of all parts but itself.
    """
    values, gears = data["value"].values, [gear for _, gear in plan.variants]
    of_machine = [data[f"own_{name}"].values[:, :, :, : plan.parts] for name in ("beyond", "shift")]
    others = [
        against(values[:, :, :, n], healthy=np.delete(values[:, :, :, :, gears], n, axis=3), axis=3)
        for n in range(plan.parts)
    ]
    of_class = [np.stack(some, axis=3) for some in zip(*others, strict=True)]
    beyond, shift = (np.stack(both) for both in zip(of_machine, of_class, strict=True))
    entries = np.array([-9 if fault is None else plan.entry(fault) for fault, _ in plan.variants])
    loud = np.moveaxis(data["loudest"].values[:, :, :, : plan.parts], -1, 0)
    sought = (loud >= 0) & (entries >= 0)[:, None]
    off = (loud - entries[:, None] + 1) % np.take(plan.teeth, gears)[:, None]
    judged, hits = (
        np.concatenate([each, each.any(axis=-1, keepdims=True), of_tooth[..., None]], axis=-1)
        .sum(axis=4)
        for each, of_tooth in (
            (np.isfinite(shift), sought), (beyond == 1.0, sought & (off <= 2))
        )
    )  # fmt: skip
    ends = [
        proportion(int(k), of=max(int(n), 1)) for k, n in zip(hits.flat, judged.flat, strict=True)
    ]
    share, low, high = np.moveaxis(np.reshape(ends, (*hits.shape, 3)), -1, 0)
    middle = np.ma.median(np.ma.masked_invalid(shift), axis=4)  # type: ignore[no-untyped-call]
    none = np.full((*hits.shape[:-1], 2), np.nan)
    return {
        "detected": hits, "judged": judged, "detected_share": share, "detected_low": low,
        "detected_high": high, "shift": np.append(np.ma.filled(middle, np.nan), none, axis=-1),
    }  # fmt: skip


def _labelled(plan: DetectionPlan, data: Dataset, counted: Arrays) -> Dataset:
    """``data`` with what was ``counted``, and which faults and sizes the variants are."""
    dims = ("question", "state", "pinion_speed", "pinion_torque", "variant", "signal", "sight")
    words = [[fault_words(fault) for fault in family] for family in plan.families]
    sizes = [
        size_of(fault)[1] / size_of(family[-1])[1] for family in plan.families for fault in family
    ]
    names = {
        "sight": SIGHTS,
        "variant": ["none, pinion", "none, wheel", *chain(*words)],
        "fault": [f"{w[-1].partition(' of ')[0]}, {w[-1].rpartition(', ')[2]}" for w in words],
    }
    about_class = Notice.of(
        "detection_of_a_class", parts=plan.parts, healthy=plan.healthy - 1,
        accuracy=plan.case.accuracy, seed=plan.case.seed, turns=plan.averaged[0],
        share=plan.noise, lost=int((~moves(data["status"].values)).sum()) or None,
    )  # fmt: skip
    train = [Notice.of("detection_without_train")] * (plan.case.train is not None)
    added = label(
        {
            name: (dims, values, "1", name.replace("_", " parts, "))
            for name, values in counted.items()
        }
        | {
            "relative_size": (("variant",), [0, 0, *sizes], "1", "size over the largest"),
            "noise": (("signal",), plan.level, "", "noise, rms"),
        },
        {name: xr.Variable(*_named(name, some)) for name, some in names.items()},
    )
    return data.merge(added).assign_attrs(
        families=[len(family) for family in plan.families], parts=plan.parts,
        averaged=list(plan.averaged), notices=stored_notices([about_class, *train]),
    )  # fmt: skip


# --- what is asked --------------------------------------------------------------------------------


def detection_plan(
    case: GearCase,
    *,
    bundle: str = "",
    parts: int = PARTS,
    noise: float = NOISE,
    turns: int = TURNS,
) -> DetectionPlan:
    """Which indicator sees which fault of ``case`` at which of its speeds and loads, hot and cold.

    The case's faults, one at a time, at a quarter, half and all of their size, or
    :func:`usual_faults`; its torques, or :data:`LOADS` times the one it has. ``parts`` of the
    series get the faults; ``noise`` [-], white up to half the samples, over the rms of the first
    healthy part; ``turns`` of the pinion in an average, about. The pair on rigid bearings: x'' +
    e'' and the mesh force are what a sensor would follow. InputError without a class, for textbook
    springs, and for what the gears cannot have.

    >>> from thermogear.case.case import load_case
    >>> changes = {"model.bundle": "consistent", "flanks.accuracy": "6"}
    >>> plan = detection_plan(load_case("rig", changes))
    >>> len(plan.variants), plan.averaged
    (14, (99, 33))
    """
    for name, got, low, high in (
        ("parts", parts, 8, HEALTHY), ("noise", noise, 0.0, 100.0), ("turns", turns, 1, 100_000),
    ):  # fmt: skip
        if not low <= got <= high:
            raise InputError(name, got, allowed=f"{low}..{high}")
    torques = case.torques if len(case.torques) > 1 else tuple(x * case.torques[0] for x in LOADS)
    stated = case.file.faults or usual_faults(case.pair.pinion.module)
    families = tuple(
        tuple(
            fault.model_copy(update={name: size * value}) if name else fault
            for size in (SIZES if name else (1.0,))
        )
        for fault in stated
        for name, value in [size_of(fault)]
    )
    sound = case.sound()
    family = GearFamily(sound.mean_tooth(), ("pinion_speed", "pinion_torque"), bundle)
    if family.model.stiffness != "loaded":
        raise InputError("model.stiffness", family.model.stiffness, allowed="loaded")
    family.require({"pinion_speed": case.speeds, "pinion_torque": torques})
    # what a floor of a spall may carry is refused at the greatest torque
    operating = sound.file.operating.model_copy(update={"torque": torques})
    file = sound.file.model_copy(update={"operating": operating})
    plan = DetectionPlan(
        case=replace(sound, file=file), bundle=family.bundle, families=families,
        speeds=tuple(case.speeds), torques=tuple(torques), parts=parts, noise=noise, turns=turns,
        overrides=case.overrides,
    )  # fmt: skip
    _ = plan.series  # refuses what the gears cannot have
    return plan
