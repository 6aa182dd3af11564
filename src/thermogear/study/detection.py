"""Which indicator sees a fault of which size: computed series of gears, healthy and with it.

Every gear pair is one drawing of the case's class, followed over its whole turn with each fault and
without, hot and undeformed, at each load. Noise is added to its synchronous averages, and the
indicators of :mod:`~thermogear.study.diagnosis` are held against limits that healthy averages set.
Two questions: does a change show in the *same machine*, before and after, and does it show in
*another machine* of the class, of which nothing was recorded before.
Checked by ``tests/study/test_detection.py`` and ``checks/trial_detection.py``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np

from thermogear.analysis.order_statistics import Estimate, proportion
from thermogear.base.arrays import Dataset, Floats, Whole
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
from thermogear.case.thermal_state import HOT, UNDEFORMED
from thermogear.gears.deviations import GEARS, Deviation
from thermogear.gears.tooth_table import MATES
from thermogear.mesh.excite import excitations
from thermogear.mesh.series import SeriesMesh, changed_mesh, series_mesh
from thermogear.mesh.thermal import HotPair
from thermogear.signals.indicators import gear_indicators
from thermogear.signals.synchronous import repeating_turns, shared_step, synchronous_averages
from thermogear.study.diagnosis import INDICATORS, loudest_teeth
from thermogear.study.faults import TurnMotion, turn_motions
from thermogear.study.series import series_parts
from thermogear.study.series_along import HEATED

HEALTHY = 60
"""Parts of the class whose healthy series are known: the greatest of the 59 others is exceeded by
more than 5 % of all parts with a chance of .95^59 = 5 %, whatever their distribution (Wilks 1941).
As many averages of one machine set its own limits."""
FALSE_ALARMS, SEEN = 0.05, 0.95
"""Share of healthy averages beyond a limit at most, and share of faulty ones that is "seen"."""
PARTS = 16
"""Parts that get the faults: chosen, so that an own pair takes two minutes."""
NOISE = 0.3
"""Noise over the rms of the first healthy part: chosen, as in ``checks/trial_diagnosis.py``."""
TURNS = 100
"""Turns of the pinion in an average, about: chosen."""
LOADS = (0.5, 1.0, 1.5)
"""Loads over that of a case that states one."""
SAMPLES, POSITIONS = 64, 64
"""Of a mesh period: samples of the motion, divisors of 192, and positions of the contact."""
STATES = (HOT, UNDEFORMED)
SIGNALS = ("acceleration", "mesh_force")
SAME, CLASS = QUESTIONS = ("same machine", "another machine")
SIGHTS = (*INDICATORS, "tooth")
"""What sees a fault: the indicators; last, whether the difference signal is loudest at the faulty
tooth or a neighbour: of the same machine that of the change, of another that of the average. A
tooth that stands forward hits before its time, one that yields rings after it; by chance 3/z."""
SIZES = (0.25, 0.5, 1.0)
"""Of each fault, over what the case or :func:`usual_faults` states."""
SIZED = {
    "crack": ("depth", "share"), "chip": ("height",), "missing": (), "pitch": ("amount",),
    "spall": ("width_share", "length"), "wear": ("depth", "revolutions"),
    "eccentricity": ("amount",),
}  # fmt: skip
"""The size of each kind of fault: the first of these fields that is stated."""
BLOCK = 4  # parts of a chunk


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
    for name in SIZED[fault.kind]:
        value = getattr(fault, name)
        if value is not None:
            return name, float(value)
    return "", 1.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Scene:
    """The sound pair at one speed, torque and state of heat, which all parts share."""

    hot: HotPair
    excited: Excitations

    @property
    def status(self) -> int:
        """Of :data:`~thermogear.base.vocabulary.STATUS`."""
        return int(self.excited.status[0])


Averages = dict[str, Floats]
"""Of each gear (part, signal, sample of its turn)."""


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
    kind: str = "detect"
    _known: dict[Any, Any] = field(init=False, repr=False, compare=False, default_factory=dict)

    @property
    def faults(self) -> tuple[FaultTable, ...]:
        """Every fault at every size; variant 0 is none, variant n the n-th of them."""
        return tuple(fault for family in self.families for fault in family)

    @property
    def sizes(self) -> dict[str, int]:
        return {
            "state": len(STATES), "pinion_speed": len(self.speeds),
            "pinion_torque": len(self.torques), "part": self.healthy,
            "variant": 1 + len(self.faults), "signal": len(SIGNALS), "gear": len(GEARS),
            "indicator": len(INDICATORS), "question": len(QUESTIONS),
        }  # fmt: skip

    @property
    def cuts(self) -> dict[str, int]:
        return {"state": 1, "pinion_speed": 1, "pinion_torque": 1, "part": BLOCK}

    def inputs(self) -> dict[str, Any]:
        return {
            "model": self._family(0).inputs(),
            "faults": [fault.model_dump() for fault in self.faults],
            "speeds": list(self.speeds), "torques": list(self.torques), "parts": self.parts,
            "healthy": self.healthy, "noise": self.noise, "turns": self.turns,
        }  # fmt: skip

    def variables(self) -> dict[str, Variable]:
        dims = tuple(self.cuts)
        felt = ("signal", "gear", "indicator")
        own = "of a healthy machine's own averages"
        return {
            "status": Variable(dims, "int8", 0, status_attributes()),
            "value": real(dims, "indicator of one average", "", "variant", *felt),
            "own_limit": real(dims, f"greatest {own}", "", *felt),
            "own_mean": real(dims, f"mean {own}", "", *felt),
            "own_deviation": real(dims, f"standard deviation {own}", "", *felt),
            "loudest": Variable(
                (*dims, "variant", "signal", "gear", "question"), "int32", -1,
                {"long_name": "mesh period of the turn in which the loudest tooth enters"},
            ),
        }  # fmt: skip

    def coordinates(self) -> dict[str, Coordinate]:
        axes = axis_coordinates(
            ("pinion_speed", "pinion_torque"), ("rad/s", "N m"), (self.speeds, self.torques)
        )
        words: dict[str, Sequence[str]] = {
            "state": [state.kind for state in STATES], "signal": SIGNALS, "gear": GEARS,
            "indicator": INDICATORS, "question": QUESTIONS,
        }  # fmt: skip
        return axes | {name: ((name,), np.array(some), {}) for name, some in words.items()}

    def needs(self, key: Key) -> Key | None:
        return None

    def pilot(self, share: float, *, turn: int) -> float:
        """Compute one part with its faults at one operating point; what share it was."""
        state, torque = turn % len(STATES), turn // len(STATES) % len(self.torques)
        part = turn % self.parts
        arrays = empty_arrays(self, (0, 0, 0, 0))
        self._fill(arrays, (state, 0, torque), [part], keep_going)
        points = len(STATES) * len(self.speeds) * len(self.torques)
        faulty = len(self.faults) / 3.0  # a fault is solved where it is alone
        return (1.0 + faulty) / (points * (self.healthy + self.parts * faulty))

    def compute(self, key: Key, before: Arrays | None, alive: Alive) -> Arrays:
        found = empty_arrays(self, key)
        self._fill(found, key[:3], range(self.healthy)[ranges_of(self, key)["part"]], alive)
        return found

    def _fill(self, found: Arrays, point: Key, parts: Sequence[int], alive: Alive) -> None:
        """The parts of a chunk, the healthy ones and those of them that get the faults."""
        scene = self._scene(point)
        found["status"][..., : len(parts)] = scene.status
        if not moves(scene.status):
            return
        mesh = series_mesh(
            scene.hot, [self.series(None)[n] for n in parts], self.turn, positions=POSITIONS
        )
        sound, still = self._averages(scene, mesh)
        found["status"][0, 0, 0, : len(parts)] = still
        faulty = [n for n in parts if n < self.parts]
        some = replace(mesh, **{
            name: getattr(mesh, name)[: len(faulty)]
            for name in ("transmission_error", "spring_error", "stiffness", "half_backlash")
        })  # fmt: skip
        own = self._own(found, sound, faulty) if faulty else {}
        self._measure(found, 0, sound, parts, own)
        for number, fault in enumerate(self.faults if faulty else (), start=1):
            alive()
            damaged = [self.series(number - 1)[n] for n in faulty]
            changed = changed_mesh(some, scene.hot, damaged, self._acting(fault))
            self._measure(found, number, self._averages(scene, changed)[0], faulty, own)

    # --- what all parts share -----------------------------------------------------------------

    def _family(self, state: int) -> GearFamily:
        if ("family", state) not in self._known:
            names = ("pinion_speed", "pinion_torque")
            family = GearFamily(self.case.mean_tooth(), names, self.bundle, STATES[state])
            self._known["family", state] = family
        found: GearFamily = self._known["family", state]
        return found

    def _scene(self, point: Key) -> Scene:
        if point not in self._known:
            state, speed, torque = point
            family, row = self._family(state), [[self.speeds[speed], self.torques[torque]]]
            hot = family.quasi_static(row, HEATED)["hot_pair"][0]
            self._known[point] = Scene(hot=hot, excited=family.excitations(np.array(row)))
        found: Scene = self._known[point]
        return found

    def series(self, fault: int | None) -> tuple[tuple[Deviation, ...], ...]:
        """The parts of the series, or those that get a fault, with it."""
        if ("parts", fault) not in self._known:
            faults = () if fault is None else (self.faults[fault],)
            count = self.healthy if fault is None else self.parts
            file = self.case.file.model_copy(update={"faults": faults})
            self._known["parts", fault] = series_parts(replace(self.case, file=file), count)
        found: tuple[tuple[Deviation, ...], ...] = self._known["parts", fault]
        return found

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
        several = max(1, round(self.turns / repeating_turns(mesh_order=z1, mate_order=z2)))
        return several * self.turn // z1, several * self.turn // z2

    def entry(self, fault: FaultTable) -> int:
        """The mesh period of the gear's turn in which the faulty tooth enters."""
        number = self.case.tooth_number(fault.gear, 0) - 1
        return (fault.place - number) % self.teeth[GEARS.index(fault.gear)]

    def _acting(self, fault: FaultTable) -> Whole:
        """Mesh periods of the turn in which a fault acts."""
        every = np.arange(self.turn)
        if fault.kind == "eccentricity" or not whole_turn(fault):
            return every
        teeth = self.teeth[GEARS.index(fault.gear)]
        # a tip's edge may touch one period early, and one late; a body yields farther away
        reach = 1 + MATES * (fault.kind in ("crack", "missing"))
        behind = (every - self.entry(fault) + reach) % teeth
        return every[behind < 2 * reach + np.ceil(self.case.pair.contact_ratio)]

    # --- averages and indicators ----------------------------------------------------------------

    def _averages(self, scene: Scene, mesh: SeriesMesh) -> tuple[Averages, Whole]:
        """Averages of both signals over a turn of each gear, nan where nothing moves, and the
        status of each part."""
        one, count = scene.excited, len(mesh.stiffness)
        status = np.full(count, scene.status)
        lost = np.isnan(mesh.stiffness).any(axis=1)
        status[lost] = STATUS.index("not_converged")
        status[mesh.half_backlash.min(axis=1) <= 0.0] = STATUS.index("jammed")
        row = np.array([one.mesh_frequency[0] / self.teeth[0], one.torques[0, 0]])
        curves = {
            "status": status, "mesh_stiffness": mesh.stiffness, "spring_error": mesh.spring_error,
            "half_backlash": mesh.half_backlash.mean(axis=1),
            "cold_half_backlash": np.repeat(one.reference_half_backlash, count),
            "pinion_speed": np.repeat(row[0], count), "pinion_torque": np.repeat(row[1], count),
            "mesh_periods": np.array(self.turn),
        }  # fmt: skip
        excited = excitations(
            curves, self.case.pair, damping_ratio=one.damping_ratio[0], inertias=one.inertias[0],
            transmission_error=self.case.transmission_error, harmonics=self.case.harmonics,
        )  # fmt: skip
        motions = turn_motions(self.case, points_of(excited), np.tile(row, (count, 1)), SAMPLES)
        averages = {
            gear: np.stack([[_over_turn(motion, name, teeth) for name in SIGNALS]
                            for motion in motions])
            for gear, teeth in zip(GEARS, self.teeth, strict=True)
        }  # fmt: skip
        return averages, status

    @property
    def level(self) -> Floats:
        """Noise of each signal, rms [m/s^2, N] up to half the samples: a share of the rms about its
        mean of the first part at the first speed and the middle torque, hot."""
        if "level" not in self._known:
            scene = self._scene((0, 0, (len(self.torques) - 1) // 2))
            level = np.full(len(SIGNALS), np.nan)
            if moves(scene.status):
                mesh = series_mesh(scene.hot, self.series(None)[:1], self.turn, positions=POSITIONS)
                level = self.noise * self._averages(scene, mesh)[0][GEARS[0]][0].std(axis=-1)
            self._known["level"] = level
        found: Floats = self._known["level"]
        return found

    def _noisy(self, averages: Averages, gear: int, seeds: Sequence[int], count: int) -> Floats:
        """Averages of a gear (row, signal, sample) with noise, ``count`` of each:
        (row, draw, signal, sample). The same noise hot and cold, at all loads."""
        values = averages[GEARS[gear]][:, None]
        spread = self.level / np.sqrt(self.averaged[gear])
        noise = [
            np.random.default_rng([self.case.seed, gear, seed]).normal(
                size=(count, *values.shape[2:])
            )
            for seed in seeds
        ]
        return np.asarray(values + spread[:, None] * np.array(noise))

    def _indicators(self, averages: Floats, gear: int) -> Floats:
        """Indicators of averages (..., sample) of a gear, (..., indicator); nan where any is.

        Over one baseline NA4 is the fourth moment of the residual but for a factor: so it stands.
        """
        values = gear_indicators(np.nan_to_num(averages), **self._orders(gear))
        rows = [values["residual_fourth" if name == "na4" else name] for name in INDICATORS]
        known = np.isfinite(averages).all(axis=-1, keepdims=True)
        return np.where(known, np.stack(rows, axis=-1), np.nan)

    def _orders(self, gear: int) -> dict[str, int]:
        own, mate = self.teeth[gear], self.teeth[1 - gear]
        most = own * SAMPLES // 2 - 1
        return {
            "mesh_order": own, "highest": min(self.case.harmonics * own, most),
            "step": shared_step(mesh_order=own, mate_order=mate),
        }  # fmt: skip

    def _own(self, found: Arrays, sound: Averages, parts: Sequence[int]) -> Averages:
        """Limits by the averages of each machine that gets the faults; its mean averages."""
        means: Averages = {}
        for gear, name in enumerate(GEARS):
            some = {name: sound[name][: len(parts)]}
            rows = self._noisy(some, gear, [1000 * HEALTHY + n for n in parts], HEALTHY - 1)
            values = self._indicators(rows, gear)
            here = (0, 0, 0, slice(0, len(parts)), slice(None), gear)
            found["own_limit"][here] = values.max(axis=1)
            found["own_mean"][here] = values.mean(axis=1)
            found["own_deviation"][here] = values.std(axis=1, ddof=1)
            means[name] = rows.mean(axis=1)
        return means

    def _measure(
        self, found: Arrays, variant: int, averages: Averages, parts: Sequence[int], own: Averages
    ) -> None:
        """One average of each part with new noise: its indicators, and its loudest teeth."""
        for gear, name in enumerate(GEARS):
            seeds = [1000 * variant + n for n in parts]
            rows = self._noisy(averages, gear, seeds, 1)[:, 0]
            here = (0, 0, 0, slice(0, len(parts)), variant, slice(None), gear)
            found["value"][here] = self._indicators(rows, gear)
            orders = self._orders(gear)
            teeth = orders.pop("mesh_order")
            changes = rows[: len(own[name])] - own[name] if own else rows[:0]
            for question, signal in enumerate((changes, rows)):
                known = np.isfinite(signal).all(axis=-1)
                tooth = loudest_teeth(np.nan_to_num(signal), teeth=teeth, **orders)
                there = (*here[:3], slice(0, len(signal)), *here[4:], question)
                found["loudest"][there] = np.where(known, tooth, -1)

    def finish(self, data: Dataset) -> Dataset:
        """Shares detected with their intervals; the values they are counted from are left out."""
        return detected(self, data)


def _over_turn(motion: TurnMotion, name: str, teeth: int) -> Floats:
    """The synchronous average of a curve over a turn of a gear; nan where it moves not."""
    values, turn = getattr(motion, name), teeth * motion.samples
    if not np.isfinite(values).all():
        return np.full(turn, np.nan)
    whole: Floats = synchronous_averages(values, samples_per_turn=turn, turns=values.size // turn)[
        0
    ]
    return whole


# --- what is counted ------------------------------------------------------------------------------


@lru_cache(maxsize=4096)
def _share(hits: int, of: int) -> Estimate:
    return proportion(hits, of=of) if of else Estimate(np.nan, np.nan, np.nan)


def detected(plan: DetectionPlan, data: Dataset) -> Dataset:
    """``data`` with the shares that are detected, and the smallest size that is seen.

    Over (question, state, pinion_speed, pinion_torque, variant, signal, sight): ``detected`` of
    ``judged`` parts, ``detected_share`` with its interval of 95 %, ``shift``: the median in
    standard deviations of the healthy; ``sight`` are the indicators and the tooth. A fault is
    looked for in the average of its own gear, none (variant 0, false alarms) in the pinion's.
    ``smallest`` (..., fault, signal, sight): the least size over the largest from which on it is
    seen, nan where none is.
    """
    value, some = data["value"].values, (slice(None),) * 3 + (slice(0, plan.parts),)
    healthy = np.ma.masked_invalid(value[:, :, :, :, 0])
    own = [np.ma.masked_invalid(data[f"own_{name}"].values[some])
           for name in ("limit", "mean", "deviation")]  # fmt: skip
    others = [np.ma.masked_array(healthy).copy() for _ in range(plan.parts)]
    for part, rest in enumerate(others):
        rest[:, :, :, part] = np.ma.masked
    limits = [own[0], np.ma.stack([rest.max(axis=3) for rest in others], axis=3)]
    means = [own[1], healthy.mean(axis=3, keepdims=True)]
    deviations = [own[2], healthy.std(axis=3, ddof=1, keepdims=True)]
    shape = (len(QUESTIONS), *value.shape[:3], 1 + len(plan.faults), len(SIGNALS), len(SIGHTS))
    hits, judged = np.zeros((2, *shape), int)
    shift = np.full(shape, np.nan)
    for variant, fault in enumerate((None, *plan.faults)):
        gear = 0 if fault is None else GEARS.index(fault.gear)
        values = np.ma.masked_invalid(value[some][:, :, :, :, variant, :, gear])
        loud = data["loudest"].values[some][:, :, :, :, variant, :, gear]
        for question in range(len(QUESTIONS)):
            here = (question, slice(None), slice(None), slice(None), variant)
            beyond = values > limits[question][..., gear, :]
            hits[here][..., :-1], judged[here][..., :-1] = beyond.sum(axis=3), beyond.count(axis=3)
            off = (values - means[question][..., gear, :]) / deviations[question][..., gear, :]
            shift[here][..., :-1] = np.ma.median(off, axis=3).filled(np.nan)  # type: ignore[no-untyped-call]
            if fault is not None:
                beside = (loud[..., question] - plan.entry(fault) + 1) % plan.teeth[gear] <= 2
                seen = loud[..., question] >= 0
                hits[here][..., -1] = (seen & beside).sum(axis=3)
                judged[here][..., -1] = seen.sum(axis=3)
    counted = zip(hits.ravel().tolist(), judged.ravel().tolist(), strict=True)
    ends = np.reshape([_share(*pair) for pair in counted], (*shape, 3))
    share, low, high = np.moveaxis(ends, -1, 0)
    return _labelled(plan, data, {"detected": hits, "judged": judged}, {
        "detected_share": share, "detected_low": low, "detected_high": high, "shift": shift,
    })  # fmt: skip


def _labelled(plan: DetectionPlan, data: Dataset, counts: Arrays, figures: Arrays) -> Dataset:
    """``data`` with what was counted, sizes in words, and the smallest that is seen."""
    over = ("question", "state", "pinion_speed", "pinion_torque")
    dims = (*over, "variant", "signal", "sight")
    words = {
        "detected": "parts that are detected", "judged": "parts that have a motion",
        "detected_share": "share of parts detected", "detected_low": "low end of its interval",
        "detected_high": "high end of its interval",
        "shift": "median, in standard deviations of the healthy",
    }  # fmt: skip
    seen = figures["detected_share"] >= SEEN
    ends = np.cumsum([1, *map(len, plan.families)])
    relative = [size_of(fault)[1] / size_of(family[-1])[1]
                for family in plan.families for fault in family]  # fmt: skip
    smallest = np.full((*seen.shape[:4], len(plan.families), *seen.shape[5:]), np.nan)
    for family, (first, end) in enumerate(pairwise(ends)):
        still = np.ones_like(seen[..., 0, :, :])
        for variant in range(end - 1, first - 1, -1):
            still &= seen[..., variant, :, :]
            smallest[..., family, :, :][still] = relative[variant - 1]
    added = label(
        {name: (dims, values, "1", words[name]) for name, values in (counts | figures).items()}
        | {
            "smallest": (
                (*over, "fault", "signal", "sight"), smallest, "1",
                "smallest size seen, over the largest",
            ),
            "relative_size": (("variant",), [0.0, *relative], "1", "size over the largest"),
            "noise": (("signal",), plan.level, "", "noise, rms"),
            "healthy_parts": (
                over[1:], moves(data["status"].values).sum(axis=-1), "1",
                "healthy parts that have a motion",
            ),
        },
        {
            "sight": list(SIGHTS),
            "variant": ["none", *(fault_words(fault) for fault in plan.faults)],
            "fault": [_family_words(family[-1]) for family in plan.families],
        },
    )  # fmt: skip
    return data.merge(added).assign_attrs(
        families=[len(family) for family in plan.families], parts=plan.parts,
        noise_share=plan.noise, averaged=list(plan.averaged), teeth=list(plan.teeth),
        bundle=plan.bundle, notices=stored_notices(_notices(plan, data)),
    )  # fmt: skip


def _family_words(fault: FaultTable) -> str:
    """A fault without its size."""
    words = fault_words(fault)
    where = f", {fault.gear}"
    return words.partition(" of ")[0] + words[words.rindex(where) :]


def _notices(plan: DetectionPlan, data: Dataset) -> list[Notice]:
    """What the shares are of, and what they leave out."""
    case, lost = plan.case, int((~moves(data["status"].values)).sum())
    told = [
        Notice.of(
            "detection_of_a_class", parts=plan.parts, healthy=plan.healthy - 1,
            accuracy=case.accuracy, seed=case.seed, turns=plan.averaged[0], share=plan.noise,
            lost=lost or None,
        )
    ]  # fmt: skip
    return told + [Notice.of("detection_without_train")] * (case.train is not None)


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
    >>> len(plan.faults), plan.averaged
    (12, (99, 33))
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
    )  # fmt: skip
    for number in range(len(plan.faults)):
        plan.series(number)
    return plan
