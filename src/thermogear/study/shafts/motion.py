"""Settled motion of a drive train at the operating points of a case, cold and hot."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.any_motion import settle
from thermogear.analysis.forced import settle_forced
from thermogear.analysis.torus import Torus
from thermogear.analysis.walk import Motion, Search
from thermogear.base.arrays import Dataset, Floats
from thermogear.base.progress import Progress, silent
from thermogear.base.vocabulary import STATUS, STILL, label, moves
from thermogear.case.case import GearCase
from thermogear.results.result import Notice
from thermogear.study.declared import fault_notices, mean_tooth_notices
from thermogear.study.shafts.moving import LONGEST, MovingTrain, moving, rubbing
from thermogear.study.shafts.record import (
    PERIODS,
    SAMPLES,
    SHOWN,
    Record,
    ball_pass_lines,
    lines,
    orders_of_lines,
    recorded,
    torus_orders,
)
from thermogear.study.shafts.state import TrainState, places_of, plan_of, settled

POINT = ("state", "operating")
SECTIONS = 64
TORUS_SECTIONS = 512
TORUS_PERIODS = 64
"""Mesh periods of a record on a torus: its lines are closer together."""
BLOW = (-1.0, 1.0)
"""How a second start differs from rest where forces never come again: teeth apart by a half
backlash, at the speed of one in 1/2 pi of a mesh period (chosen: both flanks are struck)."""
TORUS_ANGLES = 256
"""Steps of the closed curve once around."""
PASSES = 512
"""Mesh periods of a record with turning cages: some twenty turns of a shaft, so that lines a tenth
of a shaft order apart are told from each other (chosen)."""
POLISHED = 256
"""Mesh periods of the longest cycle whose Jacobian is asked for."""
TURNS = 4
"""Turns of the slower shaft in a record with forces at shaft orders."""
ERRORS = 12
"""Natural frequencies of the whole train that the reduced one is held against."""


CAGES = (1.0 / 3.0, 2.0 / 3.0)
"""Other positions of the cages, in pitches of the elements on from the drawn one: the fewest
that lie evenly over a pitch with it (chosen)."""
CAGE_SPREAD = 0.05
"""Share by which the greatest force on a bearing may differ over the cages' positions without a
notice: chosen, above the 1 % by which positions differ at rest."""


@dataclass(frozen=True, eq=False, kw_only=True)
class AtCages:
    """What a train settles on with its cages in one place, and its greatest forces [N] there.

    ``mesh_force`` of the drive flanks, ``bearing_force`` (bearing,); nan where it diverges.
    """

    motion: Motion
    mesh_force: float
    bearing_force: Floats

    @staticmethod
    def of(train: MovingTrain, motion: Motion, periods: int) -> AtCages:
        """By a record of so many mesh ``periods`` of the ``motion`` of ``train``."""
        if motion.name == "diverged":
            none = np.full(len(train.state.assembly.bearings), np.nan)
            return AtCages(motion=motion, mesh_force=np.nan, bearing_force=none)
        record = recorded(train, motion.state, periods)
        rings = np.linalg.norm(record.bearing_force, axis=2).max(axis=0)
        return AtCages(
            motion=motion, mesh_force=float(record.mesh_force.max()), bearing_force=rings
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class Moved:
    """A train at one point: its equations, what it settles on, its record; None where jammed.

    ``cages``: as drawn, then at :data:`CAGES`, of a train that has rolling elements.
    """

    state: TrainState
    train: MovingTrain | None = None
    motion: Motion | None = None
    record: Record | None = None
    torus_sections: Floats | None = None
    cages: tuple[AtCages, ...] = ()

    @property
    def status(self) -> int:
        """A place in :data:`~thermogear.base.vocabulary.STATUS`."""
        if self.motion is not None and self.motion.name == "diverged":
            return STATUS.index("diverged")
        return self.state.status


def moved(case: GearCase, state: TrainState, *, coordinates: int | None = None) -> Moved:
    """What the train of ``state`` settles on from rest, with friction of the teeth."""
    if not moves(state.status):
        return Moved(state=state)
    train = moving(case, state, coordinates=coordinates, friction=rubbing(case, state))
    cycle = train.model.cycle
    found = _settled_on(train, search_of(cycle))
    if found.name == "diverged":
        return Moved(state=state, train=train, motion=found)
    teeth = max(case.pair.pinion.teeth, case.pair.wheel.teeth)
    # enough to tell the sidebands of both shafts apart
    periods = PERIODS if cycle == 1 else min(cycle, TURNS * teeth)
    # where forces never come again the record goes on from where the motion was left
    turn = found.discarded if train.forced else 0
    turning = None
    if found.name == "quasi-periodic":
        periods = max(periods, TORUS_PERIODS)
        turning = _on_torus(train, found.state)
    shown = max(periods, PASSES) if train.turning else periods
    return Moved(
        state=state,
        train=train,
        motion=found,
        record=recorded(train, found.state, shown, turn=turn),
        torus_sections=turning,
        cages=tuple(_over_cages(train, found, periods)),
    )


def _settled_on(train: MovingTrain, search: Search) -> Motion:
    """What the train settles on from its start."""
    if not train.forced:
        return settle(train.model.return_map(), train.start, search)
    section = replace(train.model, cycle=1).return_map()
    starts = train.start + np.stack([np.zeros_like(train.start), section.plane.lift @ BLOW])
    return settle_forced(section, starts, cap=LONGEST)


def _over_cages(train: MovingTrain, motion: Motion, periods: int) -> Iterator[AtCages]:
    """The ``motion``, and those with every cage further on, of a train with rolling elements.

    From the same start, of which no others apart by rounding are followed. Mesh and centres stay
    those of the drawn position. Cages that turn freely pass through all positions by themselves.
    """
    if not train.model.cage_cycle or not any(one.elements for one in train.model.bearings):
        return
    yield AtCages.of(train, motion, periods)
    search = replace(search_of(train.model.cycle), starts=1)
    for share in CAGES:
        there = replace(train, model=train.model.with_cages_on(share))
        yield AtCages.of(there, _settled_on(there, search), periods)


def search_of(cycle: int) -> Search:
    """How long a motion is followed whose forces come again after ``cycle`` mesh periods."""
    if cycle == 1:
        return Search()
    if cycle > POLISHED:
        return Search(first=3, cap=24, max_period=2, polish=False, exponent=False, starts=1)
    # as many mesh periods as without
    whole = Search()
    return Search(
        first=max(whole.first // cycle, 1),
        cap=max(whole.cap // cycle, 24),
        max_period=4,
        batch=max(whole.batch // cycle, 1),
        sections=0,
        follow=-(-whole.follow // cycle),
    )


def _on_torus(train: MovingTrain, state: Floats) -> Floats:
    """Deflection of the drive flank [m] and its rate [m/s] once a mesh period, (section, 2)."""
    n, drive = train.model.size, train.model.drive
    path = train.model.return_map().carry(state, TORUS_SECTIONS - 1)
    path = np.vstack([state, path])
    return np.stack([path[:, :n] @ drive, path[:, n : 2 * n] @ drive], axis=1)


def train_motion(
    case: GearCase,
    *,
    places: Sequence[int] | None = None,
    coordinates: int | None = None,
    progress: Progress = silent,
) -> tuple[Dataset, list[Notice]]:
    """Settled motion over (state, operating) of a case with shafts, and what is to be said of it.

    Both flanks on their own lines of action, friction of the teeth, clearance of the bearings,
    forces at shaft orders. ``coordinates`` of the reduced train, the interface and 16 modes if left
    out. A jammed point or one whose motion diverges is a status.
    """
    whole, case = case, case.mean_tooth()
    chosen = places_of(case) if places is None else list(places)
    states = settled(case, chosen, progress=progress)
    found = []
    for s, row in enumerate(states):
        out = []
        for o, one in enumerate(row):
            progress("motion of the train", s * len(chosen) + o, len(states) * len(chosen))
            out.append(moved(case, one, coordinates=coordinates))
        found.append(out)
    progress("motion of the train", len(states) * len(chosen), len(states) * len(chosen))
    faults = fault_notices(case, about="motion of the train")
    return _table(case, found), [*faults, *mean_tooth_notices(whole, case), *_told(found)]


def _table(case: GearCase, found: Sequence[Sequence[Moved]]) -> Dataset:
    flat = [one for row in found for one in row]
    shape = (len(found), len(found[0]))
    teeth = (case.pair.pinion.teeth, case.pair.wheel.teeth)
    cycle = max((one.train.model.cycle for one in flat if one.train is not None), default=1)
    passing = plan_of(case).ball_pass_orders(teeth)
    own = np.union1d(orders_of_lines(teeth, shafts=cycle > 1), ball_pass_lines(passing))
    tori = [None if one.torus_sections is None else _torus(one) for one in flat]
    turned = [torus_orders(one.frequency, curves=one.curves) for one in tori if one is not None]
    orders = np.unique(np.round(np.concatenate([own, *turned]), 9))
    names = plan_of(case).bearing_names
    shown = SHOWN * SAMPLES

    def over(of: Any, *inner: int) -> Floats:
        """A number of every record, nan where there is none."""
        rows = [np.full(inner, np.nan) if one.record is None else of(one, one.record)
                for one in flat]  # fmt: skip
        return np.asarray(rows, dtype=float).reshape(*shape, *inner)

    def periods(record: Record) -> float:
        return record.phase.size / SAMPLES

    def section(one: Moved, record: Record) -> Floats:
        kept = np.full((most, 2), np.nan)
        points = record.sections[:SECTIONS] if one.torus_sections is None else one.torus_sections
        kept[: len(points)] = points
        return kept

    def felt(one: Moved, values: Floats) -> Floats:
        """Lines at the orders that this motion has, nan at those of others."""
        there = (
            torus_orders(_torus(one).frequency, curves=_torus(one).curves)
            if one.torus_sections is not None
            else own
        )
        found = lines(values, orders=orders)
        found[~np.isin(orders, np.round(there, 9))] = np.nan
        return found

    most = TORUS_SECTIONS if turned else SECTIONS
    sections = over(section, most, 2)
    curves = np.full((len(flat), TORUS_ANGLES + 1, 2), np.nan)
    for place, one in enumerate(flat):
        if one.torus_sections is not None:
            curves[place] = _around(_torus(one), one.torus_sections)
    seconds = [[np.nan, np.nan] if t is None else [t.frequency, t.error] for t in tori]
    second = np.reshape(seconds, (*shape, 2))
    count = len(names)
    force = over(lambda one, r: np.linalg.norm(r.bearing_force, axis=2)[:shown].T, count, shown)
    variables: dict[str, Any] = {
        "status": (POINT, np.array([one.status for one in flat], np.int8).reshape(shape)),
        "mesh_force": ((*POINT, "sample"), over(lambda one, r: r.mesh_force[:shown], shown), "N",
                       "force of the drive flanks"),
        "back_force": ((*POINT, "sample"), over(lambda one, r: r.back_force[:shown], shown), "N",
                       "force of the back flanks"),
        "deflection": ((*POINT, "sample"), over(lambda one, r: r.deflection[:shown], shown), "m",
                       "approach of the drive flanks, the error taken off"),
        "bearing_force": ((*POINT, "bearing", "sample"), force, "N", "force on the bearing"),
        "journal_path": ((*POINT, "bearing", "axis", "sample"), over(
            lambda one, r: r.journal_path[:shown].transpose(1, 2, 0), count, 2, shown)),
        "radial_internal_clearance": ((*POINT, "bearing"), 2.0 * np.reshape(
            [one.state.half_plays for one in flat], (*shape, count))),
        "mean_bearing_load": ((*POINT, "bearing", "axis"), over(
            lambda one, r: r.bearing_force.mean(axis=0), count, 2)),
        "bearing_contact_share": ((*POINT, "bearing"), over(
            lambda one, r: r.bearing_contact, count)),
        "bearing_contact_losses": ((*POINT, "bearing"), over(
            lambda one, r: r.bearing_losses / periods(r), count)),
        "mean_bearing_force": ((*POINT, "bearing"), over(
            lambda one, r: np.linalg.norm(r.bearing_force.mean(axis=0), axis=1), count), "N",
            "mean force on the bearing, amount of the vector"),
        "greatest_bearing_force": ((*POINT, "bearing"), over(
            lambda one, r: np.linalg.norm(r.bearing_force, axis=2).max(axis=0), count), "N",
            "greatest force on the bearing"),
        "greatest_mesh_force": (POINT, over(lambda one, r: r.mesh_force.max()), "N",
                                "greatest force of the drive flanks"),
        "mean_mesh_force": (POINT, over(lambda one, r: r.mesh_force.mean()), "N",
                            "mean force of the drive flanks"),
        "train_dynamic_factor": (POINT, over(
            lambda one, r: r.mesh_force.max() / one.state.rest.mesh_force), "1",
            "greatest force of the drive flanks over that at rest"),
        "losses_per_period": (POINT, over(lambda one, r: r.counts["losses"] / periods(r)), "1",
                              "losses of drive contact per mesh period"),
        "back_impacts_per_period": (POINT, over(lambda one, r: r.counts["impacts"] / periods(r)),
                                    "1", "back-side impacts per mesh period"),
        "time_share_of_flanks": ((*POINT, "side"), over(lambda one, r: r.shares, 3), "1",
                                 "share of time in back contact, free flight, drive contact"),
        "section_deflection": ((*POINT, "section"), sections[..., 0], "m",
                               "Poincaré section: deflection along the drive flank"),
        "section_rate": ((*POINT, "section"), sections[..., 1], "m/s",
                         "Poincaré section: its rate"),
        "torus_deflection": ((*POINT, "torus_angle"), curves[..., 0].reshape(*shape, -1)),
        "torus_rate": ((*POINT, "torus_angle"), curves[..., 1].reshape(*shape, -1)),
        "second_frequency": (POINT, second[..., 0]),
        "second_frequency_error": (POINT, second[..., 1]),
        "mesh_frequency": (("operating",), [
            teeth[0] * one.state.speed / (2.0 * np.pi) for one in found[0]]),
        "mesh_force_line": ((*POINT, "line_order"), over(
            lambda one, r: felt(one, r.mesh_force), orders.size), "N",
            "line of the force of the drive flanks (peak)"),
        "bearing_force_line": ((*POINT, "bearing", "line_order"), over(
            lambda one, r: felt(one, r.bearing_force).max(axis=2).T, count,
            orders.size), "N", "line of the bearing force, larger of x and y (peak)"),
        "housing_line": ((*POINT, "line_order"), over(
            lambda one, r: felt(one, r.housing).max(axis=1), orders.size), "m/s^2",
            "line of the housing's acceleration, larger of x and y (peak)"),
        "reduction_error": (POINT, _errors(flat).reshape(shape), "1",
                            "largest error of the 12 lowest natural frequencies by the reduction"),
        "coordinates": (POINT, np.array(
            [0 if one.train is None else one.train.model.size for one in flat]).reshape(shape), "1",
            "coordinates of the reduced train"),
        "followed_periods": (POINT, [
            [0 if m.motion is None else m.motion.followed * cycle for m in row] for row in found]),
        "followed_starts": (POINT, [
            [0 if m.motion is None else m.motion.starts for m in row] for row in found]),
        "ball_pass_order": (("bearing",), passing),
        "ball_pass_line": ((*POINT, "bearing"), over(
            lambda one, r: _at_own_order(r.bearing_force, passing), count)),
        "conditional_exponent": (POINT, _conditional(flat, "lyapunov").reshape(shape)),
        "conditional_exponent_error": (POINT, _conditional(flat, "lyapunov_error").reshape(shape)),
        "multiplier_modulus": (POINT, _of(flat, lambda m: abs(m.multiplier)).reshape(shape)),
        "multiplier_error": (POINT, _of(flat, lambda m: m.multiplier_error).reshape(shape)),
        "used_periods": (POINT, _of(flat, lambda m: m.discarded).reshape(shape), "1",
                         "periods of the return map run until it was known"),
    }  # fmt: skip
    first = found[0]
    data = label(
        variables,
        {
            "state": [row[0].state.state.kind for row in found],
            "bearing": list(names),
            "axis": ["x", "y"],
            "side": ["back", "free", "drive"],
            "line_order": (("line_order",), orders, "1", "order of the mesh frequency"),
            "phase": (("sample",), np.arange(shown) / SAMPLES, "1", "time in mesh periods"),
            "torus_angle": (
                ("torus_angle",),
                np.linspace(0.0, 1.0, TORUS_ANGLES + 1),
                "1",
                "angle of the second motion, in turns",
            ),
            "pinion_speed": (("operating",), [one.state.speed for one in first]),
            "pinion_torque": (("operating",), [one.state.torque for one in first]),
        },
        {"cycle": cycle},
    )
    words = {
        "label": [_name(one) for one in flat],
        "label_reason": [_reason(one) for one in flat],
    }
    texts = {
        name: (POINT, np.array(told, dtype=str).reshape(shape)) for name, told in words.items()
    }
    return _with_cages(data, flat).assign(texts)


def _with_cages(data: Dataset, flat: Sequence[Moved]) -> Dataset:
    """Motion and greatest forces over (state, operating, cage), where a train has elements."""
    if not any(train.cages for train in flat):
        return data
    count = 1 + len(CAGES)

    def over(of: Callable[[AtCages], Any], none: Any) -> NDArray[Any]:
        rows = [[of(at) for at in train.cages] or [none] * count for train in flat]
        of_cages = np.array(rows)
        return of_cages.reshape(*(data.sizes[name] for name in POINT), *of_cages.shape[1:])

    none = np.full(data.sizes["bearing"], np.nan)
    of_cages = label(
        {
            "cage_mesh_force": ((*POINT, "cage"), over(lambda at: at.mesh_force, np.nan)),
            "cage_bearing_force": ((*POINT, "cage", "bearing"),
                                   over(lambda at: at.bearing_force, none)),
        },
        {"cage": ("cage", np.array([0.0, *CAGES]))},
    )  # fmt: skip
    names = over(lambda at: at.motion.name, "")
    return data.merge(of_cages.assign(cage_label=((*POINT, "cage"), names)))


def _of(flat: Sequence[Moved], of: Any) -> Floats:
    return np.array([np.nan if one.motion is None else float(of(one.motion)) for one in flat])


def _conditional(flat: Sequence[Moved], name: str) -> Floats:
    """The conditional exponent of every point, or its error, in a mesh period; nan: none asked."""
    return np.array(
        [
            getattr(one.motion, name) * one.train.model.period
            if one.train is not None and one.train.forced and one.motion is not None
            else np.nan
            for one in flat
        ]
    )


def _at_own_order(force: Floats, passing: Floats) -> Floats:
    """Line of every ``force`` (sample, bearing, 2) at its own order, the larger of x and y."""
    return np.array(
        [
            lines(force[:, place], orders=[order]).max() if np.isfinite(order) else np.nan
            for place, order in enumerate(passing)
        ]
    )


def _torus(one: Moved) -> Torus:
    assert one.motion is not None
    assert one.motion.torus is not None
    return one.motion.torus


def _around(torus: Torus, sections: Floats) -> Floats:
    """The closed curves of ``sections``, one after the other with a gap between, (angle, 2)."""
    found = np.full((TORUS_ANGLES + 1, 2), np.nan)
    share = (TORUS_ANGLES + 2) // torus.curves
    angle = np.linspace(0.0, 1.0, share - 1)
    for which in range(torus.curves):
        first = which * share
        found[first : first + share - 1] = torus.curve(sections, angle=angle, which=which)
    return found


def _errors(flat: Sequence[Moved]) -> Floats:
    """The error of the reduction of every point; trains of one reduction are asked once."""
    found = []
    for one in flat:
        if one.train is None:
            found.append(np.nan)
            continue
        errors = one.train.reduction.frequency_errors(one.state.linear, ERRORS)
        found.append(float(np.abs(errors).max()))
    return np.array(found)


def _name(one: Moved) -> str:
    if one.motion is None:
        return STATUS[one.state.status].replace("_", " ")
    return one.motion.name


def _reason(one: Moved) -> str:
    if one.motion is None:
        return STILL[STATUS[one.state.status]]
    if one.train is not None and not one.train.forced and one.train.model.cycle > 1:
        cycle = one.train.model.cycle
        all_of = "shafts and cages" if one.train.turning else "shafts"
        return f"{one.motion.reason}, one period being {cycle} mesh periods: all {all_of} in place"
    return one.motion.reason


def _told(found: Sequence[Sequence[Moved]]) -> list[Notice]:
    """What a reader has to know of this motion."""
    return [
        Notice.of("train_motion_model"),
        *_told_of_turning([one for one in chain.from_iterable(found) if _turns(one)]),
        *(
            Notice.of(
                "train_motion_open",
                about=one.state.state.words,
                speed=one.state.speed,
                label=one.motion.name,
                reason=one.motion.reason,
            )
            for one in chain.from_iterable(found)
            if one.motion is not None and one.motion.name in ("undecided", "diverged")
        ),
        *_told_of_cages([one for one in chain.from_iterable(found) if one.cages]),
    ]


def _turns(one: Moved) -> bool:
    return one.train is not None and one.train.turning and one.motion is not None


def _told_of_turning(moves: Sequence[Moved]) -> list[Notice]:
    """How far motions with turning cages are known, and what that took."""
    if not moves:
        return []
    motions = [one.motion for one in moves if one.motion is not None]
    known = sum(motion.name not in ("undecided", "diverged") for motion in motions)
    periods = sum(motion.discarded for motion in motions)
    return [Notice.of("train_cages_turn", known=known, of=len(motions), periods=periods)]


def _told_of_cages(trains: Sequence[Moved]) -> list[Notice]:
    """What other positions of the cages cost and change."""
    if not trains:
        return []
    notices, more = [], 0
    for train in trains:
        drawn, *others = (at.motion for at in train.cages)
        more += sum(motion.discarded for motion in others)
        forces = [float(at.bearing_force.max()) for at in train.cages]
        low, high = float(np.nanmin(forces)), float(np.nanmax(forces))
        if any(motion.name != drawn.name for motion in others) or high > (1.0 + CAGE_SPREAD) * low:
            notices.append(
                Notice.of(
                    "train_cages_matter",
                    about=train.state.state.words,
                    speed=train.state.speed,
                    label=drawn.name,
                    others=" and ".join(motion.name for motion in others),
                    low=low,
                    high=high,
                )
            )
    return [
        Notice.of("train_cages", differing=len(notices), of=len(trains), periods=more),
        *notices,
    ]
