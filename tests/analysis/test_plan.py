"""Plans: every place once, what a chunk needs is there first, no more threads than asked for."""

import threading
from itertools import accumulate

import numpy as np
import pytest

from thermogear.analysis.plan import (
    Stopped,
    Variable,
    axis_coordinates,
    checked,
    computed,
    gather,
    keys_of,
    region_of,
)

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
            if key[0] == 0:
                return super().compute(key, before, alive)
            try:
                while True:
                    alive()
            except Stopped:
                self.ended = True
                raise

    plan = Endless()
    work = computed(plan, [(0, 0), (1, 0)], load=lambda key: {}, threads=2)
    assert next(work)[0] == (0, 0)
    work.close()
    assert plan.ended


def test_a_chunk_of_the_wrong_shape_is_an_error():
    plan = Sums()
    arrays = {"total": np.zeros((1, CUT - 1)), "digits": np.zeros((1, CUT, 2))}
    with pytest.raises(ValueError, match=r"total of chunk \(0, 0\): shape \(1, 3\), expected"):
        checked(plan, (0, 0), arrays)
