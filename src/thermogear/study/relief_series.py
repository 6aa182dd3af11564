"""Tip relief of a series: designed on some parts of a class, judged on others, over all loads."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import lcm

import numpy as np

from thermogear.analysis.order_statistics import proportion
from thermogear.base.arrays import Dataset, Floats
from thermogear.base.bounds import RELIEF_AMOUNT, RELIEF_LENGTH
from thermogear.base.errors import ConvergenceError
from thermogear.base.progress import Progress, silent
from thermogear.base.vocabulary import label
from thermogear.case.case import GearCase
from thermogear.case.flanks import relief_text
from thermogear.gears.candidates import mesh_points
from thermogear.gears.deviations import GEARS, Deviation, Relief, active_profile
from thermogear.gears.mesh_system import MeshSystem, pressed_spread
from thermogear.gears.pair import GearPair
from thermogear.gears.stiffness import Moduli
from thermogear.gears.touch import ReshapedParts
from thermogear.mesh.elastic import elastic_pair
from thermogear.mesh.thermal import HotPair, ThermalDeviation
from thermogear.results.result import Notice, Result
from thermogear.study.series import series_parts

DESIGN_PARTS, JUDGED_PARTS = 16, 64
"""Parts a relief is designed on and judged by. Measured on a 13/60 of module 6 mm at two loads: the
mean figure of a relief designed on 16 is .1 % above the best of a grid, on one drawing 5 %."""
SCREENED_PARTS = 4
"""Parts of them on which a grid of shared amounts and lengths is screened."""
PERIODS = 40
"""Mesh periods of the turn that are solved, drawn at random."""
POSITIONS = 48, 96
"""Positions of each of them: in the search, and where a relief is judged."""
GRID = 6
"""Amounts, and lengths, of the grid."""
MOST_EVALUATIONS = 400
"""Reliefs tried in both searches together, about; told as progress."""
MOST_WORSE = 1 / 8
"""Share of the parts designed on that a relief may make worse: one of more is not taken (ours)."""
LEAST_GAIN = 0.01
"""Gain over the parts designed on below which no relief is proposed: chosen, of the order of the
standard error of a gain judged by :data:`JUDGED_PARTS`."""
GRIND = 1e-6
"""Step of the amounts [m]: what is usually written on a drawing (ours)."""
_SHORTEST = 0.05  # base pitches

Reliefs = tuple[Relief, Relief]


def ground_length(longest: float) -> float:
    """Step of the lengths [m]: a tenth of a millimetre, of a profile below 1 mm a hundredth."""
    return 1e-4 if longest >= 1e-3 else 1e-5


@dataclass(frozen=True)
class _Loaded:
    """One load case of some parts: what a relief does not change."""

    system: MeshSystem
    parts: ReshapedParts
    load: float


class PartErrors:
    """Transmission error within a mesh period of many parts at several loads, relief by relief.

    ``hots``: one operating point each. ``periods`` (n,): mesh periods of the turn; the same of
    every part. The figure is the root mean square [m] of the static transmission error about its
    mean over each mesh period, over all these periods: what excites at the mesh frequency and its
    harmonics, without the slow run-out of shafts.
    """

    def __init__(
        self,
        hots: Sequence[HotPair],
        parts: Sequence[Sequence[Deviation]],
        *,
        periods: Floats,
        positions: int,
    ) -> None:
        self._shape = len(parts), len(periods), positions
        phase = (np.asarray(periods)[:, None] + np.arange(positions) / positions).ravel()
        self._loads = [self._loaded(hot, parts, phase) for hot in hots]

    def _loaded(self, hot: HotPair, parts: Sequence[Sequence[Deviation]], phase: Floats) -> _Loaded:
        thermal, elastic = ThermalDeviation(hot), elastic_pair(hot)
        load = float(elastic.force[0]) / float(np.ravel(hot.widened)[0])
        points = mesh_points(hot.pair, phase, "drive", hot.model.loaded.extended)
        shaped = ReshapedParts(
            points,
            [(*part, thermal) for part in parts],
            float(np.sqrt(pressed_spread(hot.pair, load))) ** 2,
        )
        system = MeshSystem.of(
            hot.pair,
            shape=(len(parts),),
            phase=phase,
            moduli=(_flat(elastic.moduli[0]), _flat(elastic.moduli[1])),
            deviations=(),
            model=hot.model.loaded,
            flank="drive",
            touch=shaped.touch(()),
        )
        return _Loaded(system, shaped, load)

    def curves(self, reliefs: Sequence[Relief]) -> Floats:
        """Deflection [m] about its mean over each mesh period, (load, part, period, position)."""
        curves = []
        for case in self._loads:
            touch, loads = case.parts.touch(reliefs), np.full(self._shape[0], case.load)
            system = case.system.with_touch(touch)
            _, deflection, _, settled = system.solve(loads)
            if not settled.all():
                lost = int(np.count_nonzero(~settled))
                raise ConvergenceError(
                    f"loaded contact: {lost} of {settled.size} positions did not settle"
                )
            curves.append(deflection.reshape(self._shape))
        errors = np.stack(curves)
        return np.asarray(errors - errors.mean(axis=-1, keepdims=True))

    def rms(self, reliefs: Sequence[Relief]) -> Floats:
        """The figure of every part at every load [m], (load, part)."""
        return np.asarray(np.sqrt((self.curves(reliefs) ** 2).mean(axis=(-2, -1))))


def _flat(moduli: Moduli) -> Moduli:
    return Moduli(tooth=np.ravel(moduli.tooth), body=np.ravel(moduli.body))


def ratios(before: Floats, *, after: Floats) -> Floats:
    """Mean over the loads of each part's figure, with a relief over without, (part,).

    >>> ratios(np.array([[2.0], [4.0]]), after=np.array([[1.0], [2.0]]))
    array([0.5])
    """
    return np.asarray(after.mean(axis=0) / before.mean(axis=0))


def drawn_periods(pair: GearPair, seed: int, *, count: int = PERIODS) -> Floats:
    """Mesh periods of a turn drawn at random, each once: all of a turn that is no longer.

    >>> drawn_periods(GearPair(Gear(20, 3e-3), Gear(40, 3e-3)), 1).size
    40
    """
    turn = lcm(pair.pinion.teeth, pair.wheel.teeth)
    return np.sort(np.random.default_rng(seed).choice(turn, min(count, turn), replace=False))


class Ground:
    """Tip reliefs of both gears in steps that can be ground: four whole numbers.

    ``largest`` amount [m]; amounts of pinion and wheel in steps of :data:`GRIND`, lengths along the
    line of action in steps of :func:`ground_length`, within what a case file takes.
    """

    def __init__(self, pair: GearPair, *, shape: str, largest: float, symmetric: bool) -> None:
        longest = pair.path.e - pair.path.a
        self.step = np.array([GRIND, GRIND, *2 * [ground_length(longest)]])
        shortest = max(_SHORTEST * pair.base_pitch, RELIEF_LENGTH.least)
        most = min(largest, RELIEF_AMOUNT.most)
        self.low = np.ceil(np.array([0.0, 0.0, shortest, shortest]) / self.step - 1e-6).astype(int)
        high = np.floor(np.array([most, most, longest, longest]) / self.step + 1e-6).astype(int)
        self.high = np.maximum(high, self.low)
        self.shape, self.symmetric = shape, symmetric

    def reliefs(self, x: Sequence[int]) -> Reliefs:
        """The reliefs of a place."""
        pinion, wheel = (
            Relief(
                gear,
                amount=round(float(x[n] * self.step[n]), 9),
                length=round(float(x[n + 2] * self.step[n + 2]), 9),
                shape=self.shape,
            )
            for n, gear in enumerate(GEARS)
        )
        return pinion, wheel

    def grid(self) -> Iterator[tuple[int, ...]]:
        """Places alike on both gears, :data:`GRID` amounts above 0 by as many lengths."""
        amounts, lengths = (
            np.unique(np.linspace(self.low[n], self.high[n], GRID + 1)[1 - n // 2 :].round())
            for n in (0, 2)
        )
        for amount in amounts.astype(int).tolist():
            for length in lengths.astype(int).tolist():
                yield amount, amount, length, length

    def nearby(self, x: Sequence[int], *, apart: Sequence[int]) -> Iterator[tuple[int, ...]]:
        """Places ``apart`` from ``x``, one number after the other; of both gears if symmetric."""
        moves = np.diag(apart)
        if self.symmetric:
            moves = np.array([moves[0] + moves[1], moves[2] + moves[3]])
        for move in (*moves, *-moves):
            yield tuple(np.clip(np.add(x, move), self.low, self.high).tolist())


def search(
    ground: Ground,
    screen: Callable[[Reliefs], float],
    figure: Callable[[Reliefs], float],
    starts: Sequence[tuple[int, ...]] = (),
) -> tuple[int, ...]:
    """The place with the least ``figure`` that was seen, no relief among them.

    No relief, the best of a grid by ``screen`` and other ``starts`` are compared by ``figure``;
    from the best each number is moved by a step up and down, the best move taken, and the steps
    halved where none is better, down to what can be ground. A proof that none is less there is not.
    """
    first = min(ground.grid(), key=lambda x: screen(ground.reliefs(x)))
    known: dict[tuple[int, ...], float] = {}

    def at(x: tuple[int, ...]) -> float:
        if x not in known:
            known[x] = figure(ground.reliefs(x))
        return known[x]

    best = min(((0, 0, *first[2:]), first, *starts), key=at)
    apart = np.maximum((ground.high - ground.low) // (2 * GRID), 1)
    while True:
        near = min(ground.nearby(best, apart=apart), key=at)
        if at(near) < at(best):
            best = near
        elif np.all(apart == 1):
            return best
        else:
            apart = np.maximum(apart // 2, 1)


def start_of_relief(pair: GearPair, relief: Relief) -> tuple[float, float]:
    """Diameter [m] and roll angle [rad] at which a tip relief begins.

    rho = string length of the base circle of radius r_b; d = 2 (r_b^2 + rho^2)^(1/2), the roll
    angle is rho/r_b.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> diameter, roll = start_of_relief(pair, Relief("pinion", amount=20e-6, length=4e-3))
    >>> f"{1e3 * diameter:.2f} mm, {roll:.4f} rad"
    '84.12 mm, 0.5021 rad'
    """
    base = pair.gear(relief.gear).base_radius
    rho = active_profile(pair, relief.gear)[2] - relief.length
    return 2.0 * float(np.hypot(base, rho)), rho / base


@dataclass(frozen=True)
class ReliefTask:
    """What a relief is designed for: single loaded operating points, and how it may look."""

    case: GearCase
    hots: Sequence[HotPair]
    shape: str
    symmetric: bool
    largest: float | None


def series_relief(
    task: ReliefTask, *, notices: Sequence[Notice] = (), progress: Progress = silent
) -> Result:
    """The tip relief with the least mean error of the parts of a case's series, over all loads.

    Designed on :data:`DESIGN_PARTS` parts and judged by :data:`JUDGED_PARTS` others of the same
    seed; beside it the relief designed on perfect flanks, and that of the case, if it has any. Of a
    case of one part that part is what all are designed on and judged by. The figure of a part is
    that of :class:`PartErrors`, its ratio that of :func:`ratios`, of which the mean over the parts
    is least. A relief that makes more than :data:`MOST_WORSE` of the parts designed on worse, or
    gains less than :data:`LEAST_GAIN` over them, is not taken.

    Groups: ``parts`` over (relief, load, part): figures and, over (relief, part), ratios;
    ``profile`` over (gear, place): what the relief takes off along the profile. Attributes:
    ``reliefs`` with diameter and roll angle of their start, ``gains`` as :func:`_gain`.
    """
    case, pair = task.case, task.case.pair
    judged_by = JUDGED_PARTS if case.series > 1 else 1
    parts = [
        tuple(d for d in part if not _tip(d))
        for part in (
            series_parts(case, DESIGN_PARTS + JUDGED_PARTS)
            if case.series > 1
            else [case.deviations]
        )
    ]
    seed = 0 if case.file.flanks is None else case.file.flanks.seed
    periods = drawn_periods(pair, seed) if case.series > 1 else np.zeros(1)
    evaluations = 0

    def errors(of: Sequence[Sequence[Deviation]], which: int, over: Floats = periods) -> PartErrors:
        return PartErrors(task.hots, of, periods=over, positions=POSITIONS[which])

    def figure(of: PartErrors) -> Callable[[Reliefs], float]:
        before = of.rms(())

        def mean_ratio(reliefs: Reliefs) -> float:
            nonlocal evaluations
            evaluations += 1
            progress("relief", min(evaluations, MOST_EVALUATIONS - 1), MOST_EVALUATIONS)
            ratio = ratios(before, after=of.rms(reliefs))
            return float(ratio.mean()) + float(np.mean(ratio > 1.0) > MOST_WORSE)

        return mean_ratio

    perfect = errors([()], 1, np.zeros(1))
    largest = task.largest
    if largest is None:
        plain = perfect.curves(())
        largest = 3.0 * float((np.ptp(plain, axis=-1) - plain.min(axis=-1)).max())
    ground = Ground(pair, shape=task.shape, largest=largest, symmetric=task.symmetric)
    screen = figure(perfect)
    on_perfect = search(ground, screen, screen)
    of_design = figure(errors(parts[:DESIGN_PARTS], 0))
    place = search(ground, figure(errors(parts[:SCREENED_PARTS], 0)), of_design, [on_perfect])
    if of_design(ground.reliefs(place)) > 1.0 - LEAST_GAIN:
        place = (0, 0, *place[2:])
    reliefs = ground.reliefs(place)
    candidates: dict[str, tuple[Relief, ...]] = {
        "none": (), "series": reliefs, "perfect": ground.reliefs(on_perfect),
    }  # fmt: skip
    if had := tuple(d for d in case.deviations if isinstance(d, Relief) and _tip(d)):
        candidates["case"] = had
    judge = errors(parts[-judged_by:], 1)
    rms = np.stack([judge.rms(cut) for cut in candidates.values()])
    ratio = np.stack([ratios(rms[0], after=after) for after in rms])
    progress("relief", MOST_EVALUATIONS, MOST_EVALUATIONS)
    torques = [float(hot.operating.torque[0]) for hot in task.hots]
    return Result.of(
        "relief",
        f"Tip relief: {case.title}",
        {
            "parts": label(
                {
                    "mesh_error": (("relief", "load", "part"), rms, "m", "rms within mesh periods"),
                    "ratio": (("relief", "part"), ratio, "1", "mean over the loads, over without"),
                },
                {
                    "relief": list(candidates),
                    "load": ("load", torques, "N m", "pinion torque"),
                    "part": ("part", np.arange(judged_by), "1", "number of the part judged"),
                },
            ),
            "profile": _profile(pair, reliefs),
        },
        (*notices, *_notices(case, task.hots[0].model.loaded.body)),
        **case.provenance,
        torques=torques,
        pinion_addendum=[float(np.ravel(h.temperatures.pinion_addendum)[0]) for h in task.hots],
        wheel_addendum=[float(np.ravel(h.temperatures.wheel_addendum)[0]) for h in task.hots],
        shape=task.shape,
        symmetric=task.symmetric,
        evaluations=evaluations,
        designed_on=min(DESIGN_PARTS, len(parts)),
        least_gain=LEAST_GAIN,
        mesh_periods=len(periods),
        turn=lcm(pair.pinion.teeth, pair.wheel.teeth),
        gains={
            name: _gain(values)
            for name, values in zip(candidates, ratio, strict=True)
            if name != "none"
        },
        reliefs={r.gear: _row(pair, r) for r in reliefs},
        paste="\n\n".join(relief_text(r.gear, r) for r in reliefs),
    )


def _tip(deviation: Deviation) -> bool:
    return isinstance(deviation, Relief) and deviation.end == "tip"


def _gain(ratio: Floats) -> dict[str, float]:
    """Mean gain 1 - ratio with its standard error over the parts, the worst part's ratio, and the
    share of parts made worse with its interval after Clopper and Pearson.

    A single part has no standard error and no interval.
    """
    count, worse = ratio.size, int(np.count_nonzero(ratio > 1.0))
    gain = {"gain": 1.0 - float(ratio.mean()), "worst": float(ratio.max()), "worse": worse}
    if count == 1:
        return gain
    share = proportion(worse, of=count)
    error = float(ratio.std(ddof=1)) / count**0.5
    return gain | {"standard_error": error, "worse_low": share.low, "worse_high": share.high}


def _row(pair: GearPair, relief: Relief) -> dict[str, float | str]:
    diameter, roll = start_of_relief(pair, relief)
    return {
        "amount_m": relief.amount,
        "length_m": relief.length,
        "shape": relief.shape,
        "start_diameter_m": diameter,
        "start_roll_angle_rad": roll,
    }


def _profile(pair: GearPair, reliefs: Reliefs) -> Dataset:
    """What the reliefs take off over the active profile of both gears, (gear, place)."""
    places = []
    for relief in reliefs:
        start, _, tip = active_profile(pair, relief.gear)
        rho = np.array([start, tip - relief.length, *np.linspace(tip - relief.length, tip, 21)[1:]])
        base = pair.gear(relief.gear).base_radius
        places.append((relief.taken_off(pair, rho), rho / base, 2.0 * np.hypot(base, rho)))
    by = ("gear", "place")
    taken, roll, diameter = (np.stack(column) for column in zip(*places, strict=True))
    return label(
        {
            "taken_off": (by, taken, "m", "material taken off along the line of action"),
            "roll_angle": (by, roll, "rad", "roll angle"),
            "diameter": (by, diameter, "m", "diameter"),
        },
        {"gear": list(GEARS)},
    )


def _notices(case: GearCase, body: str) -> Iterator[Notice]:
    yield Notice.of("loaded_contact_unchecked", body=body)
    if any(map(_tip, case.deviations)):
        yield Notice.of("relief_of_case_replaced")
