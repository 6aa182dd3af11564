"""Whose numbers count: code and environment of a worker against those of the store."""

from __future__ import annotations

import asyncio
import concurrent.futures
import pickle
import time
import warnings
from collections.abc import Callable, Coroutine
from typing import Any

import pytest

from thermogear.base.errors import InputError, WorkerWarning
from thermogear.results import fingerprint
from thermogear.results import workers as crew

GOOD, OTHER = "tcp://1.2.3.4:1", "tcp://1.2.3.4:2"


class Scheduler:
    """What the crew asks a cluster's client for, computed in this process."""

    def __init__(self, answers: dict[str, object]) -> None:
        self.answers, self.status, self.scheduler = answers, "running", self
        self.address = "tcp://1.2.3.4:8786"
        self.asked: list[str] = []
        self.handed: list[list[str]] = []
        self.slow: dict[str, float] = {}

    def nthreads(self) -> dict[str, int]:
        return dict.fromkeys(self.answers, 1)

    def scheduler_info(self) -> dict[str, dict[str, dict[str, str]]]:
        return {"workers": {a: {"name": f"w{a[-1]}"} for a in self.answers}}

    async def _run(self, _: object, workers: list[str], **__: object) -> dict[str, object]:
        self.asked += workers
        await asyncio.sleep(self.slow.get(workers[0], 0.0))
        return {a: self.answers[a] for a in workers}

    def sync(self, question: Callable[[], Coroutine[Any, Any, object]]) -> object:
        return asyncio.run(question())


def introduced(**changes: str) -> dict[str, object]:
    found = crew.introduced()
    return {**found, **changes}


@pytest.mark.parametrize(
    ("answer", "why"),
    [
        (
            introduced(code="0.0.9+0123456789abcdef"),
            "its code is 0.0.9+0123456789abcdef, the store's",
        ),
        (
            introduced() | {"environment": fingerprint.environment() | {"numpy": "1.0"}},
            "its environment.numpy is 1.0, the store's",
        ),
        (
            introduced() | {"environment": fingerprint.environment() | {"blas": "MKL"}},
            "its environment.blas is MKL, the store's",
        ),
        (Exception("ModuleNotFoundError(\"No module named 'thermogear'\")"), "cannot import therm"),
        (Exception("AttributeError('introduced')"), "it does not know this version's questions"),
        (None, "it does not know this version's questions"),
    ],
)
def test_a_worker_that_differs_is_refused_by_name_and_once(answer: object, why: str) -> None:
    one = crew.Crew(Scheduler({GOOD: introduced(), OTHER: answer}))
    with pytest.warns(WorkerWarning, match=r"^worker w2 \(tcp://1.2.3.4:2\) is refused: ") as said:
        one.look()
    assert why in str(said[0].message)
    assert list(one.good) == [GOOD]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        one.look()
    assert one.client.asked == [GOOD, OTHER]
    one.require()


@pytest.mark.parametrize(
    "address",
    [
        "tls://10.0.0.7:8786",
        "TLS://10.0.0.7:8786",
        "wss://10.0.0.7:8786",
        "ws://127.0.0.1:1",
        "tcp://127.0.0.1:8786",
        "[::1]:8786",
        "localhost:1",
        "inproc://a",
        "inproc://10.0.0.1/7/1",
    ],
)
def test_a_private_scheduler_is_taken(address: str) -> None:
    crew.require_private(address)


@pytest.mark.parametrize(
    ("address", "scheme"),
    [
        ("tcp://10.0.0.7:8786", "tcp"),
        ("node7:8786", "tcp"),
        ("tcp://[fe80::1]:8786", "tcp"),
        ("TCP://10.0.0.1:8786", "tcp"),
        ("ws://192.0.2.2:18799", "ws"),
        ("inproc://10.0.0.1:8786", "inproc"),
        ("ucx://10.0.0.1:8786", "ucx"),
    ],
)
def test_a_scheduler_that_strangers_may_reach_is_refused(address: str, scheme: str) -> None:
    with pytest.raises(InputError, match=rf"over plain {scheme} whoever reaches it runs code as"):
        crew.require_private(address)


def test_an_encrypted_cluster_needs_certificates_before_anyone_is_asked() -> None:
    pytest.importorskip("distributed")
    begun = time.monotonic()
    with (
        pytest.raises(InputError, match=r"dask's certificates are not configured; set distributed"),
        crew.cluster("tls://127.0.0.1:1"),
    ):
        pass
    assert time.monotonic() - begun < 5.0


def test_a_worker_that_does_not_answer_holds_nobody_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crew, "_ASKED", 0.05)
    scheduler = Scheduler({GOOD: introduced(), OTHER: introduced()})
    scheduler.slow[OTHER] = 5.0
    one = crew.Crew(scheduler)
    begun = time.monotonic()
    one.look()
    one.look()
    assert time.monotonic() - begun < 2.0
    assert (list(one.good), one.refused, one.silent) == ([GOOD], {}, 1)
    assert scheduler.asked == [GOOD, OTHER]


def test_a_worker_that_dies_while_it_is_asked_is_asked_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scheduler = Scheduler({GOOD: OSError("gone")})
    one = crew.Crew(scheduler)
    one.look()
    assert (one.good, one.refused) == ({}, {})
    monkeypatch.setattr(one, "_later", {})
    scheduler.answers[GOOD] = introduced()
    one.look()
    assert one.good == {GOOD: 1}


def test_a_cluster_of_none_but_refused_workers_ends_within_seconds(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(crew, "GRACE", 0.0)
    one = crew.Crew(Scheduler({OTHER: Exception("ModuleNotFoundError('thermogear')")}))
    with pytest.warns(WorkerWarning):
        one.look()
    with pytest.raises(InputError, match=r"none of its workers can be believed \(w2 .*cannot imp"):
        one.require()


@pytest.mark.parametrize("error", [OSError("closed"), concurrent.futures.CancelledError("lost")])
def test_a_scheduler_that_is_lost_is_one_line(error: Exception) -> None:
    scheduler = Scheduler({GOOD: introduced()})
    one = crew.Crew(scheduler)

    def fails() -> None:
        raise error

    with pytest.raises(InputError, match="it is lost; what is done is stored; start it and its"):
        one.ask(fails)
    scheduler.status = "connecting"
    begun = time.monotonic()
    with pytest.raises(InputError, match="it is lost"):
        one.look()
    assert time.monotonic() - begun < 1.0


class Answers(Scheduler):
    """A cluster whose second worker answers as another version would."""

    def __init__(self) -> None:
        super().__init__({GOOD: introduced()})
        self.bad = True

    def submit(self, function, *words, workers, **_):  # type: ignore[no-untyped-def]
        self.handed.append(workers)
        future: concurrent.futures.Future[object] = concurrent.futures.Future()
        answer = function(*words)
        if self.bad:
            self.bad = False
            answer["by"]["code"] = "0.0.9+other"
            self.answers[OTHER] = introduced()
        future.set_result(answer)
        return future

    def who_has(self, futures: list[object]) -> dict[str, list[str]]:
        return {"chunk": [OTHER]}


def test_an_answer_that_differs_does_not_count_and_is_computed_again() -> None:
    from store_trials import small_plan

    plan = small_plan(6, 6)
    cluster = Answers()
    with pytest.warns(WorkerWarning, match=r"w2 .*its code is 0\.0\.9\+other"):
        found = list(crew.computed_on(cluster, plan, [(0, 0)], lambda key: {}))
    assert [key for key, _ in found] == [(0, 0)]
    assert len(cluster.handed) == 2
    assert cluster.handed[-1] == [GOOD]
    own = crew.compute_chunk(pickle.dumps(plan), (0, 0), None)["arrays"]
    for name, values in own.items():
        assert values.tobytes() == found[0][1][name].tobytes()


def test_the_fingerprint_names_what_rounds() -> None:
    found = fingerprint.environment()
    assert {"machine", "blas", "lapack", "vectors", "libc", "numpy", "scipy"} <= set(found)
    assert all(found.values())


def test_a_store_of_another_kind_of_machine_says_what_differs(
    tmp_path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from store_trials import small_plan

    from thermogear.results import store

    plan = small_plan(6, 6)
    with store.Store(tmp_path / "s", plan):
        pass
    other = fingerprint.environment() | {"blas": "scipy-openblas 0.3.31 (SkylakeX)"}
    monkeypatch.setattr(store, "environment", lambda: other)
    message = (
        r"^environment\.blas: got scipy-openblas 0\.3\.31 \(SkylakeX\); allowed .* was begun with"
    )
    with pytest.raises(InputError, match=message), store.Store(tmp_path / "s", plan):
        pass
