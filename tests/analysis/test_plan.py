"""Families, ensembles and plans.

Every place once, what a chunk needs is there first, no more threads than asked for.
"""

import json
import threading
from itertools import accumulate

import numpy as np
import pytest

from thermogear.analysis.family import ModelFamily, axis_values, family_for, lanes_and_status
from thermogear.analysis.section import starts_of
from thermogear.base.errors import InputError
from thermogear.base.excitation import Periodic
from thermogear.base.plan import (
    Stopped,
    Variable,
    axis_coordinates,
    checked,
    computed,
    gather,
    keys_of,
    region_of,
)
from thermogear.dynamics.exact_map import Ensemble
from thermogear.dynamics.models import DeadZoneModel, TorsionalModel
from thermogear.dynamics.return_map import return_map

ROWS, LENGTH, CUT = 3, 11, 4


class Sums:
    """Running sums along every row, carried from chunk to chunk; counts who runs at once."""

    kind = "sums"

    def __init__(self, meet=1):
        self.sizes = {"row": ROWS, "place": LENGTH, "digit": 2}
        self.cuts = {"row": 1, "place": CUT}
        self.meeting = threading.Barrier(meet, timeout=10.0)
        self.lock = threading.Lock()
        self.running = self.most = 0

    def variables(self):
        return {
            "total": Variable(("row", "place"), "float64", float("nan"), {"units": "m"}),
            "digits": Variable(("row", "place", "digit"), "int16", -1),
        }

    def coordinates(self):
        axes = (np.arange(ROWS), 0.5 * np.arange(LENGTH))
        return axis_coordinates(("row", "place"), ("1", "m"), axes)

    def needs(self, key):
        return (key[0], key[1] - 1) if key[1] else None

    def compute(self, key, before, alive):
        with self.lock:
            self.running += 1
            self.most = max(self.most, self.running)
        if key[1] == 0:
            self.meeting.wait()
        alive()
        assert (before is None) == (key[1] == 0)
        first = CUT * key[1]
        values = np.arange(first, min(first + CUT, LENGTH)) + 100.0 * key[0]
        carried = 0.0 if before is None else before["total"][0, -1]
        total = carried + np.cumsum(values)
        with self.lock:
            self.running -= 1
        return {
            "total": total[None],
            "digits": np.stack([total // 10, total % 10], axis=-1)[None],
        }

    def finish(self, data):
        data.attrs["finished"] = 1
        return data


WHOLE = np.array([list(accumulate(range(100 * r, 100 * r + LENGTH))) for r in range(ROWS)])


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_the_whole_is_that_of_one_piece_on_no_more_threads_than_asked_for(threads):
    plan = Sums(meet=threads if threads == 3 else 1)  # three chunks meet: they run side by side
    told = []
    data = gather(plan, threads=threads, progress=lambda done, of: told.append((done, of)))
    assert np.array_equal(data["total"], WHOLE)
    assert np.array_equal(10 * data["digits"][..., 0] + data["digits"][..., 1], WHOLE)
    assert (data["total"].dtype, data["digits"].dtype) == (np.float64, np.int16)
    assert (data["total"].attrs["units"], data["place"].attrs["units"]) == ("m", "m")
    assert data["place"].values.tolist() == [0.5 * n for n in range(LENGTH)]
    assert data.attrs == {"kind": "sums", "finished": 1}
    assert plan.most <= threads
    assert told == [(n, 9) for n in range(1, 10)]


def test_chunks_cover_every_place_once_the_last_cut_fastest():
    plan = Sums()
    keys = keys_of(plan)
    assert keys == sorted(keys)
    seen = np.zeros((ROWS, LENGTH, 2), int)
    for key in keys:
        seen[region_of(plan, key, plan.variables()["digits"])] += 1
    assert np.all(seen == 1)


def test_work_goes_on_from_what_is_there_and_asks_for_nothing_else():
    plan = Sums()
    keys = keys_of(plan)
    all_of = dict(computed(plan, keys, load=lambda key: pytest.fail(f"asked for {key}")))
    asked = []

    def load(key):
        asked.append(key)
        return all_of[key]

    wanted = [key for key in keys if key[1] == 2 or key[0] == 1]
    again = dict(computed(plan, wanted, load, threads=2))
    assert sorted(again) == wanted
    assert sorted(asked) == [(0, 1), (2, 1)]
    for key in wanted:
        assert np.array_equal(again[key]["total"], all_of[key]["total"])


def test_closing_ends_what_runs():
    class Endless(Sums):
        def compute(self, key, before, alive):
            self.meeting.wait()  # both run before the first may end
            if key[0] == 0:
                return {name: np.zeros((1, CUT, 2)[: 2 + (name == "digits")]) for name in arrays}
            try:
                while True:
                    alive()
            except Stopped:
                self.ended = True
                raise

    arrays = ("total", "digits")
    plan = Endless(meet=2)
    work = computed(plan, [(0, 0), (1, 0)], load=lambda key: {}, threads=2)
    assert next(work)[0] == (0, 0)
    work.close()
    assert plan.ended


def test_a_chunk_of_the_wrong_shape_is_an_error():
    plan = Sums()
    arrays = {"total": np.zeros((1, CUT - 1)), "digits": np.zeros((1, CUT, 2))}
    with pytest.raises(ValueError, match=r"total of chunk \(0, 0\): shape \(1, 3\), expected"):
        checked(plan, (0, 0), arrays)


def test_a_family_says_what_defines_it_and_lets_the_rest_vary():
    model = DeadZoneModel(
        damping_ratio=0.05,
        frequency=0.7,
        stiffness=Periodic(1.0, (0.1 - 0.2j,)),
        force=Periodic(0.3, ()),
        half_backlash=2.0,
    )
    family = ModelFamily(model, ("frequency", "half_backlash"))
    assert family.units == ("1", "1")
    told = family.inputs()
    assert "frequency" not in told
    assert "half_backlash" not in told
    assert told["type"] == "DeadZoneModel"
    assert told["damping_ratio"] == 0.05
    assert told["stiffness"] == {"mean": 1.0, "harmonics": [[0.1, -0.2]]}
    assert json.loads(json.dumps(told)) == told
    lanes, status = lanes_and_status(family, np.array([[0.5, 1.0], [2.0, 3.0]]))
    assert lanes.period == pytest.approx([4.0 * np.pi, np.pi], rel=1e-15)
    assert lanes.half_backlash.tolist() == [1.0, 3.0]
    assert status.tolist() == [0, 0]
    # a family of no parameter gives its one lane as often as asked
    same, _ = lanes_and_status(ModelFamily(model, ()), np.empty((3, 0)))
    assert same.half_backlash.tolist() == [2.0] * 3
    assert family_for(family, ("frequency", "half_backlash")) is family
    with pytest.raises(InputError, match="parameter: got"):
        family_for(family, ("frequency",))
    with pytest.raises(InputError, match="allowed different parameters"):
        ModelFamily(model, ("frequency", "frequency"))
    for wrong, name in ((lanes, "model"), (DeadZoneModel, "model")):
        with pytest.raises(InputError, match=rf"{name}: got"):
            ModelFamily(wrong, ())


@pytest.mark.parametrize("values", [[], [[1.0, 2.0]], [1.0, np.nan], [1.0, 2.0, 1.0]])
def test_an_axis_is_finite_and_never_twice_the_same(values):
    with pytest.raises(InputError, match="speed: got"):
        axis_values("speed", values)
    assert axis_values("speed", 3.0).tolist() == [3.0]
    assert axis_values("speed", [2.0, 1.0]).tolist() == [2.0, 1.0]


def test_an_ensemble_is_its_lanes_one_by_one_and_keeps_the_last_sections():
    model = TorsionalModel(
        damping_ratio=[0.1, 0.18, 0.15],
        frequency=1.245,
        stiffness_amplitude=0.335,
        mean_force=0.017,
        force_amplitude=-1.16,
    )
    start = np.array([[0.0, 0.0], [1.0, 0.2], [-1.0, 0.1]])
    group = Ensemble(model.lanes(), start, threads=2)
    first = group.run(7)
    kept = group.run(9, keep=4)
    assert (first.shape, kept.shape, group.elapsed) == ((3, 0, 2), (3, 4, 2), 16)
    for lane in range(3):
        path = return_map(model.lanes().take(lane)).visit(start[lane], 16)
        assert np.array_equal(kept[lane], path.points[-4:])
        assert np.array_equal(group.state[lane], path.points[-1])
        assert path.shares.sum() == pytest.approx(1.0, abs=1e-12)
    assert starts_of((1.0, 2.0), 2).tolist() == starts_of([[1.0, 2.0]], 2).tolist()
    assert starts_of(start, 3).tolist() == start.tolist()
    for wrong in (start[:2], np.zeros(3), [np.inf, 0.0]):
        with pytest.raises(InputError, match="initial_state: got"):
            starts_of(wrong, 3)
    section = return_map(model.lanes().take(1))
    assert section.distance(start[0], start[1]) == pytest.approx(1.0)
    assert section.distance(np.zeros(2), np.array([0.1, 1.245])) == pytest.approx(1.0)
    with pytest.raises(InputError, match="3 lanes"):
        return_map(model.lanes())
