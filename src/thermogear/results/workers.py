"""The workers of a cluster: who may compute for a store, who is refused by name, who is lost.

A worker's numbers count where its code and its environment are those the store was begun with:
it is asked for both before it is given work, and says both with every answer.
"""

from __future__ import annotations

import asyncio
import functools
import ipaddress
import logging
import pickle
import queue
import time
import warnings
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import CancelledError
from contextlib import contextmanager
from typing import Any

from thermogear import __version__
from thermogear.base.errors import InputError, WorkerWarning, of_extra
from thermogear.base.plan import Arrays, Key, Plan, Queue, checked, keep_going
from thermogear.base.progress import duration
from thermogear.results.fingerprint import code_version, environment
from thermogear.results.store import first_difference

ANSWER = 10.0
"""Seconds until a scheduler that does not answer is none."""
PAUSE = 5.0
"""Seconds after which a cluster is asked for its workers again."""

PATIENCE = 300.0
"""Seconds that a cluster may be without workers."""

GRACE = 10.0
"""Seconds that a cluster may have none but workers that are refused."""

_ENCRYPTED = ("tls", "wss")
"""Schemes of dask whose connections are encrypted."""

_ASKED, _LATER = 20.0, 30.0
"""Seconds that a worker has to say who it is, and after which it is asked again."""


# --- on the worker -------------------------------------------------------------------------------


def introduced() -> dict[str, Any]:
    """What whoever runs this computes with, in the words of a store's manifest."""
    return {"code": code_version(), "environment": environment()}


@functools.lru_cache(maxsize=2)
def _unpacked(plan: bytes) -> Plan:
    return pickle.loads(plan)  # type: ignore[no-any-return]


def compute_chunk(plan: bytes, key: Key, before: Arrays | None) -> dict[str, Any]:
    """One chunk of the pickled ``plan`` on whatever worker this runs, and what it computes with."""
    work = _unpacked(plan)
    arrays = checked(work, key, work.compute(key, before, keep_going))
    return {"by": introduced(), "arrays": arrays}


# --- on the machine that writes ------------------------------------------------------------------


def require_private(scheduler: str) -> None:
    """InputError where ``scheduler`` is reached in the clear on another machine.

    Such a scheduler takes code from whoever reaches its port and runs it as the user that started
    it; ``tls://`` and ``wss://`` ask both sides for certificates, a loopback address is the
    machine's own, and ``inproc:`` without a port this process's.
    """
    scheme, _, place = scheduler.rpartition("://")
    host = place.rpartition(":")[0].strip("[]")
    if scheme.lower() not in _ENCRYPTED and host and not (host == "localhost" or _loopback(host)):
        raise InputError(
            "scheduler",
            scheduler,
            allowed="tls://HOST:PORT, or tcp:// on this machine (127.0.0.1)",
            why=f"over plain {scheme.lower() or 'tcp'} whoever reaches it runs code as its user",
            fix="use an SSH tunnel or tls://; --insecure on a network that is yours alone",
        )


def _loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


@contextmanager
def cluster(scheduler: str) -> Iterator[Any]:
    """A client of the cluster at ``scheduler``; refused where none answers."""
    distributed = of_extra(
        "distributed", "cluster", field="scheduler", got=scheduler, use="a cluster"
    )
    if not scheduler.startswith("inproc:") and not scheduler.rpartition(":")[2].isdecimal():
        raise InputError(
            "scheduler", scheduler, allowed="tcp://HOST:PORT", why="the port is missing"
        )
    if scheduler.lower().startswith(tuple(f"{scheme}://" for scheme in _ENCRYPTED)):
        known = distributed.security.Security().get_connection_args("client")
        if not known.get("ssl_context"):
            raise InputError(
                "scheduler",
                scheduler,
                why="dask's certificates are not configured",
                fix="set distributed.comm.tls.ca-file, .client.cert and .client.key in dask's "
                "configuration, or DASK_DISTRIBUTED__COMM__TLS__CA_FILE and so on",
            )
    # what a cluster logs when it dies is said in one line of ours
    handlers = logging.getLogger("distributed").handlers
    levels = [handler.level for handler in handlers]
    for handler in handlers:
        handler.setLevel(logging.CRITICAL + 1)
    try:
        try:
            client = distributed.Client(scheduler, timeout=ANSWER, set_as_default=False)
        except (OSError, ValueError, TimeoutError) as error:
            why = f"no dask scheduler answers there ({type(error).__name__})"
            raise InputError("scheduler", scheduler, why=why) from None
        try:
            yield client
        finally:
            client.close(timeout=2)
    finally:
        for handler, level in zip(handlers, levels, strict=False):
            handler.setLevel(level)


class Crew:
    """The workers of the cluster of ``client``."""

    def __init__(self, client: Any) -> None:
        self.client = client
        self.address: str = client.scheduler.address
        self.mine = introduced()
        self.good: dict[str, int] = {}
        self.refused: dict[str, str] = {}
        self.silent = 0
        self._later: dict[str, float] = {}
        self._looked = -PAUSE
        self._alone = time.monotonic()

    def ask(self, question: Callable[..., Any], *words: Any, **options: Any) -> Any:
        """A call to the cluster; InputError where the scheduler is gone."""
        try:
            if self.client.status == "running":
                return question(*words, **options)
        except (OSError, CancelledError) as error:
            # a call that had its own time limit says nothing of the scheduler
            if isinstance(error, TimeoutError) and self.client.status == "running":
                raise
        raise InputError(
            "scheduler",
            self.address,
            why="it is lost; what is done is stored",
            fix="start it and its workers again and give the same command",
        ) from None

    def look(self) -> None:
        """Learn who is there, and of everyone new whether its numbers can count."""
        self._looked = time.monotonic()
        threads = self.ask(self.client.nthreads)
        self.good = {a: threads[a] for a in self.good if a in threads}
        self.refused = {a: why for a, why in self.refused.items() if a in threads}
        new = [a for a in threads if a not in self.good and a not in self.refused]
        self.silent = len(new)
        for address, answer in self._introductions(new).items():
            if isinstance(answer, OSError):
                continue  # it dies, or will be asked again
            self.silent -= 1
            why = self.difference(answer)
            if why is None:
                self.good[address] = threads[address]
            else:
                self.refuse(address, why)
        if self.good:
            self._alone = time.monotonic()

    def _introductions(self, addresses: list[str]) -> dict[str, Any]:
        """What each worker answers; an OSError where it does not in time, or dies."""
        now = time.monotonic()
        asked = [a for a in addresses if self._later.get(a, 0.0) <= now]
        client = self.client

        async def one(address: str) -> Any:
            try:
                # a client's own `run` waits for the slowest worker, and has no time limit
                question = client._run(introduced, workers=[address], on_error="return")
                return (await asyncio.wait_for(question, _ASKED))[address]
            except (OSError, TimeoutError, KeyError) as error:
                self._later[address] = time.monotonic() + _LATER
                return OSError(str(error))

        async def everyone() -> list[Any]:
            return await asyncio.gather(*map(one, asked))

        return {} if not asked else dict(zip(asked, self.ask(client.sync, everyone), strict=True))

    def difference(self, answer: object) -> str | None:
        """Why the worker that answers so is not to be believed; None where it is."""
        if isinstance(answer, dict):
            found = first_difference(self.mine, answer)
            if found is None:
                return None
            field, own, its = found
            return f"its {field} is {its}, the store's {own}"
        text = " ".join(str(answer).split())[:160]
        if "ModuleNotFoundError" in text or "ImportError" in text:
            return f"it cannot import thermogear {__version__} ({text})"
        return f"it does not know this version's questions ({text})"

    def refuse(self, address: str, why: str) -> None:
        """Take no answer of this worker, and say so once."""
        self.good.pop(address, None)
        if address not in self.refused:
            self.refused[address] = why
            text = f"worker {self._name(address)} is refused: {why}"
            warnings.warn(text, WorkerWarning, stacklevel=2)

    def _name(self, address: str) -> str:
        """Address and the name that whoever started the worker gave it."""
        known = self.ask(self.client.scheduler_info)["workers"].get(address, {})
        name = known.get("name", address)
        return address if name == address else f"{name} ({address})"

    def due(self) -> bool:
        """Whether it is time to look again."""
        return time.monotonic() - self._looked >= PAUSE

    def require(self) -> None:
        """Refuse to wait for ever for workers."""
        if self.good:
            return
        alone = time.monotonic() - self._alone
        names = "; ".join(f"{self._name(a)}: {why}" for a, why in list(self.refused.items())[:3])
        if names and not self.silent and alone >= min(GRACE, PATIENCE):
            raise InputError(
                "scheduler",
                self.address,
                why=f"none of its workers can be believed ({names}); what is done is stored",
                fix=f"start workers with thermogear {__version__} as it is here, and give the same "
                "command",
            )
        if alone >= PATIENCE:
            raise InputError(
                "scheduler",
                self.address,
                why=f"it has had no worker{' that answers' if self.silent else ''} for "
                f"{duration(alone)}; what is done is stored",
                fix="start workers and give the same command",
            )


class _Errands:
    """Chunks on their way to the workers of ``crew`` and back; ``load`` gives those needed."""

    def __init__(
        self, crew: Crew, plan: Plan, wanted: list[Key], load: Callable[[Key], Arrays]
    ) -> None:
        self.crew = crew
        self.waiting = Queue(plan, wanted)
        self.running: dict[Any, tuple[Key, frozenset[str]]] = {}
        self._plan, self._load = pickle.dumps(plan), load
        self._ready: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._sent = 0

    def send(self) -> None:
        """A few chunks ahead of the workers: enough to keep them busy, few enough to hold."""
        crew, client = self.crew, self.crew.client
        room = 3 * sum(crew.good.values()) - len(self.running)
        for key, need in self.waiting.take(room):
            allowed = frozenset(crew.good)
            self._sent += 1
            future = crew.ask(
                client.submit,
                compute_chunk,
                self._plan,
                key,
                None if need is None else self._load(need),
                workers=sorted(allowed),
                allow_other_workers=False,
                pure=False,
                retries=5,
                key=f"chunk-{key}-{self._sent}-{id(self)}",
            )
            self.running[future] = key, allowed
            future.add_done_callback(self._ready.put)

    def look(self) -> None:
        """Learn who is there; what was given to those who are gone waits again."""
        self.crew.look()
        for future, (key, allowed) in list(self.running.items()):
            if not allowed & self.crew.good.keys():
                del self.running[future]
                self.crew.ask(future.cancel)
                self.waiting.back(key)

    def answer(self) -> tuple[Key, Arrays] | None:
        """The next chunk that is computed and counts; None where none has come in a while."""
        future = self._next()
        if future is None:
            return None
        try:
            answer = self.crew.ask(future.result, timeout=PAUSE)
        except TimeoutError:
            self._ready.put(future)
            if self.crew.due():
                self.look()
            return None
        except Exception as error:
            if type(error).__name__ != "KilledWorker":
                raise
            key = self.running[future][0]
            text = f"several workers died of the chunk {key}; what is done is stored"
            raise InputError("scheduler", self.crew.address, why=text) from None
        key, _ = self.running.pop(future)
        why = self.crew.difference(answer.get("by") if isinstance(answer, dict) else answer)
        if why is None:
            return key, answer["arrays"]
        for addresses in self.crew.ask(self.crew.client.who_has, [future]).values():
            for one in addresses:
                self.crew.refuse(one, why)
        self.waiting.back(key)
        return None

    def _next(self) -> Any:
        """The next future that has ended and was not taken back, else None."""
        try:
            future = self._ready.get(timeout=min(PAUSE, 1.0 if self.running else 0.2))
        except queue.Empty:
            self.crew.ask(str)
            return None
        return future if future in self.running else None


def computed_on(
    client: Any, plan: Plan, wanted: list[Key], load: Callable[[Key], Arrays]
) -> Generator[tuple[Key, Arrays], None, None]:
    """:func:`thermogear.base.plan.computed` on the dask cluster of ``client``.

    Chunks of a worker that dies, or whose answer does not count, are computed by another one.
    """
    errands = _Errands(Crew(client), plan, wanted, load)
    while errands.running or errands.waiting:
        if errands.crew.due():
            errands.look()
        errands.send()
        errands.crew.require()
        found = errands.answer()
        if found is not None:
            # whoever takes the chunk stores it before a chunk that needs it is sent
            yield found
            errands.waiting.there(found[0])
