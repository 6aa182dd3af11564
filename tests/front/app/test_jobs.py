"""The one thread that works for all pages: whose turn it is, and what a fault leaves behind."""

from __future__ import annotations

import gc
import threading
import time
import weakref
from collections.abc import Callable, Generator, Iterator
from itertools import pairwise
from typing import Any

import pytest

pytest.importorskip("uvicorn")

from thermogear.base.errors import InputError
from thermogear.base.plan import Stopped
from thermogear.front.app import jobs
from thermogear.front.app.wire import Export, Show

Alive = Callable[[], None]
Post = Callable[[str, dict[str, object]], None]


class Slow:
    """A desk whose jobs take ``steps`` steps, and note what they do."""

    def __init__(self, post: Post, log: list[Any], steps: int = 20) -> None:
        self.post, self.log, self.steps = post, log, steps
        self.gate: threading.Event | None = None

    def show(self, show: Show, alive: Alive) -> Generator[None, None, None]:
        self.log.append(("begun", show.number))
        try:
            for step in range(self.steps):
                if self.gate is not None:
                    assert self.gate.wait(5.0)
                alive()
                self.log.append((show.number, step))
                if show.number == 666:
                    raise ZeroDivisionError("a fault\nover two lines")
                if show.number == 22:
                    raise InputError("speed", "-1 rpm", allowed="0..9 rpm")
                yield
            self.log.append(("finished", show.number))
        finally:
            self.log.append(("ended", show.number))

    def export(self, export: Export, alive: Alive) -> dict[str, object]:
        if export.what == "case":
            raise InputError("backlash.value", "-1 mm", allowed="0..9 mm")
        for _ in range(1000):
            alive()
            time.sleep(0.005)
        return {"kind": "file", "number": export.number}


class Page:
    """A client with all that it was told."""

    def __init__(self, worker: jobs.Worker, **how: Any) -> None:
        self.told: list[dict[str, Any]] = []
        self.log: list[Any] = []
        self.worker = worker
        self.desk: Slow | None = None
        self.client = jobs.Client(lambda: self._made(how), self.post)
        worker.add(self.client)  # type: ignore[arg-type]

    def _made(self, how: dict[str, Any]) -> Any:
        gate = how.pop("gate", None)
        self.desk = Slow(self.post, self.log, **how)
        self.desk.gate = gate
        return self.desk

    def post(self, name: str, message: dict[str, object]) -> None:
        self.told.append(message)

    def want(self, number: int) -> None:
        self.client.want(Show(kind="show", number=number))
        self.worker.wake()

    def wait_for(self, kind: str, number: int) -> dict[str, Any]:
        return until(
            lambda: next(
                (m for m in list(self.told) if (m["kind"], m["number"]) == (kind, number)), None
            )
        )


def until(found: Callable[[], Any], seconds: float = 10.0) -> Any:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if (value := found()) is not None and value is not False:
            return value
        time.sleep(0.002)
    raise AssertionError("it did not come")


@pytest.fixture
def worker() -> Iterator[jobs.Worker]:
    one = jobs.Worker()
    one.start()
    yield one
    one.end()
    one.join(5.0)
    assert not one.is_alive()


def test_the_newest_wish_wins(worker: jobs.Worker) -> None:
    gate = threading.Event()
    page = Page(worker, gate=gate)
    page.want(1)
    until(lambda: ("begun", 1) in page.log)
    for number in range(2, 11):
        page.want(number)
    gate.set()
    page.wait_for("done", 10)
    assert [number for words, number in page.log if words == "begun"] == [1, 10]
    assert [number for words, number in page.log if words == "finished"] == [10]
    assert page.log.index(("ended", 1)) < page.log.index(("begun", 10))
    assert [m["number"] for m in page.told] == [10]


def test_no_wish_is_lost_between_two_threads(worker: jobs.Worker) -> None:
    """Thousands of wishes as fast as they go, from another thread: the last one is answered."""
    page = Page(worker, steps=1)
    for number in range(1, 5001):
        if number != 666:
            page.want(number)
    page.wait_for("done", 5000)
    page.want(6000)
    page.wait_for("done", 6000)


def test_two_pages_in_turn(worker: jobs.Worker) -> None:
    """A step each: neither waits until the other's long job is done."""
    gate = threading.Event()
    one, two = Page(worker, gate=gate, steps=50), Page(worker, gate=gate, steps=50)
    log: list[Any] = []
    one.log = two.log = log
    one.want(1)
    two.want(2)
    until(lambda: ("begun", 1) in log or ("begun", 2) in log)
    gate.set()
    one.wait_for("done", 1)
    two.wait_for("done", 2)
    steps = [number for number, _ in log if number in (1, 2)]
    first = steps.index(steps[0] ^ 3)  # where the other has begun
    both = steps[first : first + 60]
    assert all(a != b for a, b in pairwise(both))


def test_a_fault_is_told_in_one_line_and_the_work_goes_on(
    worker: jobs.Worker, capsys: pytest.CaptureFixture[str]
) -> None:
    page = Page(worker)
    page.want(666)
    rows = page.wait_for("refused", 666)["rows"]
    (row,) = rows
    assert row["field"] == ""
    assert row["words"].split(": ")[1] == "ZeroDivisionError"
    assert "\n" not in row["words"]
    assert capsys.readouterr().err == "error: ZeroDivisionError: a fault over two lines\n"
    page.want(22)
    rows = page.wait_for("refused", 22)["rows"]
    assert rows == [{"field": "speed", "words": "speed: got -1 rpm; allowed 0..9 rpm"}]
    page.want(3)
    page.wait_for("done", 3)


def test_a_refused_file_leaves_the_pictures_alone(worker: jobs.Worker) -> None:
    gate = threading.Event()
    page = Page(worker, gate=gate)
    page.want(1)
    until(lambda: ("begun", 1) in page.log)
    page.client.want(Export(kind="export", number=7, what="case"))
    gate.set()
    assert page.wait_for("refused", 7)["rows"][0]["field"] == "backlash.value"
    page.wait_for("done", 1)


def test_files_wait_in_a_short_row_and_stop_ends_them(worker: jobs.Worker) -> None:
    page = Page(worker)
    for number in range(2 + jobs.MOST_EXPORTS):
        page.client.want(Export(kind="export", number=number, what="report"))
    last = 1 + jobs.MOST_EXPORTS
    assert "wait" in page.wait_for("refused", last)["rows"][0]["words"]
    worker.wake()
    until(lambda: len(page.client.exports) < jobs.MOST_EXPORTS)
    page.client.stop()
    page.want(90)
    page.wait_for("done", 90)
    assert not any(m["kind"] == "file" for m in page.told)


def test_stop_ends_what_is_worked_at(worker: jobs.Worker) -> None:
    gate = threading.Event()
    page = Page(worker, gate=gate)
    page.want(1)
    until(lambda: ("begun", 1) in page.log)
    page.client.stop()
    gate.set()
    worker.wake()
    until(lambda: ("ended", 1) in page.log)
    assert ("finished", 1) not in page.log
    assert page.told == []


@pytest.mark.parametrize("busy", [True, False])
def test_nothing_is_kept_of_a_closed_page(worker: jobs.Worker, busy: bool) -> None:
    """Its generator is closed, in the middle of its work too; its desk is nobody's any more."""
    gate = threading.Event()
    page = Page(worker, gate=gate)
    page.want(1)
    log = page.log
    until(lambda: ("begun", 1) in log)
    if not busy:
        gate.set()
        page.wait_for("done", 1)
    kept = [weakref.ref(page.client), weakref.ref(page.desk)]
    page.client.closed = True
    gate.set()
    worker.wake()
    until(lambda: ("ended", 1) in log)
    assert (("finished", 1) in log) is not busy
    del page
    until(lambda: gc.collect() >= 0 and all(one() is None for one in kept))


def test_a_page_that_cannot_be_made_is_told_once(worker: jobs.Worker) -> None:
    """And takes no processor time afterwards."""

    def unmade() -> Any:
        raise InputError("case", "no gears")

    told: list[Any] = []
    client = jobs.Client(unmade, lambda name, message: told.append(message))
    worker.add(client)
    worker.wake()
    until(lambda: told)
    time.sleep(0.05)
    assert [m["rows"][0]["words"] for m in told] == ["case: got no gears"]
    assert client.closed


def test_the_end_of_the_server_ends_the_work() -> None:
    worker = jobs.Worker()
    worker.start()
    gate = threading.Event()
    page = Page(worker, gate=gate)
    page.want(1)
    until(lambda: ("begun", 1) in page.log)
    worker.end()
    gate.set()
    worker.join(5.0)
    assert not worker.is_alive()
    with pytest.raises(Stopped):
        page.client.require(1)
