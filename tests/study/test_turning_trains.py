"""A case's train on cages that turn: orders of rolling, lines, whole ratios, what is refused."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from conftest import Compared
from study.test_journals import BALLS, PAIR, SHAFTS, SPRING, bearing
from thermogear.analysis.forced import settle_forced
from thermogear.base.arrays import Dataset
from thermogear.base.errors import InputError
from thermogear.case.case import GearCase, load_case
from thermogear.case.thermal_state import UNDEFORMED
from thermogear.dynamics.ladder import Engine
from thermogear.shafts.bearings.catalogue import catalogue_bearing
from thermogear.study.shafts.family import TrainFamily
from thermogear.study.shafts.motion import Moved, _table, _told, moved
from thermogear.study.shafts.record import SAMPLES
from thermogear.study.shafts.state import plan_of, settled
from thermogear.views.pages.train_motion import _tables, bearing_force_order
from thermogear.views.picture import Line

WHOLE = """inside = { kind = "ball", bore = "30 mm", outside_diameter = "62 mm", width = "16 mm", \
elements = 9, element_diameter = "9.2 mm", pitch_diameter = "46 mm" }"""
"""g = 1/5: the cage turns 2/5, and 18/5 balls pass, in a turn of its shaft."""


@cache
def case(law: str, train: str) -> GearCase:
    places = [("pinion", 10.0), ("pinion", 120.0), ("wheel", 10.0), ("wheel", 120.0)]
    text = PAIR.replace("[train]", f"[train]\n{train}") + SHAFTS
    laws = (law, law, SPRING, SPRING)
    text += "".join(bearing(*at, one) for at, one in zip(places, laws, strict=True))
    found = load_case(text)
    assert isinstance(found, GearCase)
    return found


TURNING = 'cages = "turning"'


@cache
def train(law: str, words: str) -> Moved:
    own = case(law, words)
    ((state,),) = settled(own, [0], states=[UNDEFORMED])
    return moved(own, state, coordinates=12)


def test_cages_turn_as_elements_roll(compared: Compared) -> None:
    """A ring's race at Omega d_i/2 carries a rolling element's middle at half of that speed.

    The CWRU record's 6205 (0.3126 in balls on 1.537 in): cage 0.39828, outer race 3.5848 a turn.
    """
    measured = replace(
        catalogue_bearing("6205"), element_diameter=0.3126 * 0.0254, pitch_diameter=1.537 * 0.0254
    )
    compared("cage and outer race", "orders of the CWRU record",
             [measured.cage_order - 0.39828, measured.outer_order - 3.5848], 1e-4)  # fmt: skip
    plan = plan_of(case(BALLS, 'cages = "turning"\ncage_slip = 0.02\nsense = "clockwise"'))
    rolling = catalogue_bearing("6206")
    speed = -0.98 * rolling.inner_raceway / (2.0 * rolling.pitch_diameter) / 27.0
    away = np.array(plan.cage_orders((27, 44))) - [speed, speed, 0.0, 0.0]
    compared("cages of a train", "half the race's speed over the pitch radius", away, 1e-15)
    assert plan_of(case(BALLS, "")).cage_orders((27, 44)) == [0.0] * 4


def test_locked_cages_have_their_old_proof(compared: Compared) -> None:
    """2/15 of a pitch in a mesh period: an orbit of 15, whose multiplier is the exponent's."""
    own = train(WHOLE, TURNING)
    assert own.train is not None
    assert own.motion is not None
    assert (own.motion.name, own.train.model.cycle) == ("period-1", 15)
    assert len(own.cages) == 3
    section = replace(own.train.model, cycle=1).return_map()
    orbit = own.motion.state
    found = settle_forced(section, np.stack([orbit, own.train.start]), cap=4000)
    assert found.name == "settled"
    floquet = np.log(abs(own.motion.multiplier)) / 15.0 / section.period
    away = (found.lyapunov - floquet) / found.lyapunov_error
    compared("conditional exponent over its stated error", "ln |Floquet multiplier|/T", away, 4.0)
    # the state that two starts come to lies on that orbit
    at = found.discarded % 15
    on = section.carry(orbit, 15, turn=0)[at - 1] if at else orbit
    compared("settled state under locked cages", "the proven orbit, in half backlashes",
             section.distance(found.state, on), 1e-4)  # fmt: skip


def test_the_ball_pass_line_is_that_of_whole_turns(compared: Compared) -> None:
    """Over 15 mesh periods of the locked cages a plain transform has the ball pass in bin 2."""
    own = train(WHOLE, TURNING)
    assert own.train is not None
    assert own.motion is not None
    (table, bearings) = stored(WHOLE), own.train.model.bearings
    run = Engine(own.train.model).run(own.motion.state, 15, samples=SAMPLES)
    q = run.samples[:, : own.train.model.size]
    away = []
    for place, one in enumerate(bearings):
        force = one.force(q @ one.directions, phase=run.sample_phase)
        peak = 2.0 * np.abs(np.fft.rfft(force, axis=0)[2]).max() / force.shape[0]
        away.append(table["ball_pass_line"].values[0, 0, place] / peak - 1.0)
        assert table["ball_pass_order"].values[place] == pytest.approx(2.0 / 15.0, rel=1e-12)
    compared("ball-pass line", "transform of whole cage turns", away, 1e-3)


@cache
def stored(law: str) -> Dataset:
    return _table(case(law, TURNING), [[train(law, TURNING)]])


def test_balls_with_clearance_pass_and_springs_do_not() -> None:
    """A line at Z (1 - g)/2 far above what lies beside it; no order where nothing rolls."""
    own, data = train(BALLS, TURNING), stored(BALLS)
    assert own.motion is not None
    assert own.record is not None
    assert (own.motion.name, own.cages) == ("settled", ())
    assert data["label"].values.tolist() == [["settled"]]
    assert -0.08 < float(data["conditional_exponent"].values[0, 0]) < -0.06
    order = catalogue_bearing("6206").outer_order / 27.0
    assert data["ball_pass_order"].values[:2] == pytest.approx([order, order], rel=1e-12)
    force = own.record.bearing_force[:, 0, 0]
    count = np.arange(force.size)
    window = 1.0 - np.cos(2.0 * np.pi * count / force.size)

    def line(at: float) -> float:
        turn = np.exp(-2j * np.pi * at * count / SAMPLES)
        return float(abs(((force - force.mean()) * window) @ turn))

    beside = max(line(order + share / 512.0) for share in (-9.0, -6.0, 6.0, 9.0))
    assert line(order) > 100.0 * beside
    assert line(1.0 - order) > 100.0 * max(line(1.0 - order + s / 512.0) for s in (-6.0, 6.0))
    springs, still = train(SPRING, TURNING), train(SPRING, "")
    assert np.isnan(stored(SPRING)["ball_pass_order"].values).all()
    assert springs.motion is not None
    assert still.motion is not None
    assert np.array_equal(springs.motion.state, still.motion.state)
    rows = still.record.bearing_force if still.record is not None else np.empty(0)
    assert springs.record is not None
    assert np.array_equal(springs.record.bearing_force, rows)


def test_what_a_reader_sees_of_turning_cages() -> None:
    data = stored(BALLS)
    columns = [len(_tables(each)[1].head) for each in (data, stored(SPRING))]
    assert columns[0] == columns[1] + 2
    panels = [panel for row in bearing_force_order(data, 0).panels for panel in row]
    order = float(data["ball_pass_order"][0])
    drawn = [{mark.x for mark in panel.marks if isinstance(mark, Line)} for panel in panels]
    assert {order, 2.0 * order} <= drawn[0]
    assert not {order, 2.0 * order} & drawn[2]
    notices = {one.code: one.data for one in _told([[train(BALLS, TURNING)]])}
    assert notices["train_cages_turn"]["known"] == 1
    assert notices["train_cages_turn"]["periods"] == train(BALLS, TURNING).motion.discarded  # type: ignore[union-attr]
    assert "train_cages" not in notices


def test_cages_that_turn_are_refused_where_a_motion_must_come_again() -> None:
    with pytest.raises(InputError, match=r"train.cages.*turning.*standing"):
        TrainFamily(case(BALLS, TURNING), ("pinion_speed",))
    for words in ('cages = "rolling"', "cage_slip = 0.6", "cage_slip = 0.02"):
        with pytest.raises(InputError, match="cage"):
            case(BALLS, words)
