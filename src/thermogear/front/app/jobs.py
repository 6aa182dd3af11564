"""One thread that computes for every open page: the newest wish of each, a slice at a time."""

from __future__ import annotations

import threading
import warnings
from collections import deque
from collections.abc import Callable, Generator
from typing import TYPE_CHECKING, TypeVar

from thermogear.base.errors import InputErrors, ThermogearError, ValidityWarning
from thermogear.base.plan import Stopped
from thermogear.front.app.wire import Export, Post, Show
from thermogear.front.lines import one_line, say

if TYPE_CHECKING:
    from thermogear.front.app.desk import Desk

MOST_EXPORTS = 4
ANY = -1
"""Number of an answer to no message of its own."""
ENDED = object()
_T = TypeVar("_T")


class Client:
    """What one open page wants, and where its answers go.

    ``post`` may be called from any thread. A new :class:`Show` takes the place of the one before.
    """

    def __init__(self, make: Callable[[], Desk], post: Post) -> None:
        self.make, self.post = make, post
        self.desk: Desk | None = None
        self.closed = False
        self.wanted: Show | None = None
        self.exports: deque[Export] = deque()
        self.working: Generator[None, None, None] | None = None
        self.at = -1
        """Number of what is worked at."""
        self.stops = 0
        self._lock = threading.Lock()

    def want(self, message: Show | Export) -> None:
        with self._lock:
            if isinstance(message, Show):
                self.wanted = message
                return
            if len(self.exports) < MOST_EXPORTS:
                self.exports.append(message)
                return
        row = {"field": "", "words": "wait for the files asked for before"}
        self.post("refused", {"kind": "refused", "number": message.number, "rows": [row]})

    def stop(self) -> None:
        """Drop what is wanted and what is worked at."""
        with self._lock:
            self.wanted, self.at = None, -1
            self.exports.clear()
            self.stops += 1

    def take(self) -> Show | None:
        """What is wanted, which is what is worked at from now on."""
        with self._lock:
            show, self.wanted = self.wanted, None
            if show is not None:
                self.at = show.number
            return show

    def take_export(self) -> Export | None:
        with self._lock:
            return self.exports.popleft() if self.exports else None

    def require(self, number: int) -> None:
        """Raise where the work on ``number`` is of no use any more."""
        with self._lock:
            newer = self.wanted is not None and self.wanted.number != number
            if self.closed or number != self.at or newer:
                raise Stopped

    @property
    def busy(self) -> bool:
        waits = self.desk is None or self.wanted or self.exports
        return (not self.closed and bool(waits)) or self.working is not None


class Worker(threading.Thread):
    """Works for all clients in turn, a step each, so that none waits for another's long job."""

    def __init__(self) -> None:
        super().__init__(name="thermogear-app", daemon=True)
        self._clients: deque[Client] = deque()
        self._there = threading.Condition()
        self._ending = False

    def add(self, client: Client) -> None:
        with self._there:
            self._clients.append(client)

    def wake(self) -> None:
        with self._there:
            self._there.notify()

    def end(self) -> None:
        """End after the step at hand, which stops soon."""
        with self._there:
            self._ending = True
            for one in self._clients:
                one.closed = True
            self._there.notify()

    def run(self) -> None:
        with warnings.catch_warnings(action="ignore", category=ValidityWarning):
            # what limits a state is told once with it, and not for each of its parts
            while self._one_step():
                pass

    def _one_step(self) -> bool:
        """One step for the client whose turn it is; it is not held on to."""
        client = self._next()
        if client is not None:
            self._step(client)
        return client is not None

    def _next(self) -> Client | None:
        with self._there:
            while not self._ending:
                self._clients = deque(c for c in self._clients if not c.closed or c.working)
                for _ in range(len(self._clients)):
                    self._clients.rotate(-1)
                    if self._clients[-1].busy:
                        return self._clients[-1]
                self._there.wait()
            return None

    def _step(self, client: Client) -> None:
        if client.working is not None and (client.closed or client.wanted or client.at < 0):
            client.working.close()
            client.working = None
        if client.closed:
            return
        if client.desk is None:
            client.desk = _tried(client, ANY, client.make)
            client.closed = client.desk is None
            return
        desk = client.desk
        if (export := client.take_export()) is not None:
            _tried(client, export.number, lambda: _exported(client, desk, export))
            return
        if (show := client.take()) is not None:
            number = show.number
            client.working = desk.show(show, lambda: client.require(number))
        if (working := client.working) is None:
            return
        number = client.at
        ended = _tried(client, number, lambda: next(working, ENDED) is ENDED)
        if ended is not False:
            client.working = None
        if ended:
            client.post("done", {"kind": "done", "number": number})


def _exported(client: Client, desk: Desk, export: Export) -> None:
    stops = client.stops

    def alive() -> None:
        if client.closed or client.stops != stops:
            raise Stopped

    client.post(f"file {export.what}", desk.export(export, alive))


def _tried(client: Client, number: int, work: Callable[[], _T]) -> _T | None:
    """What ``work`` gives; None where it stopped, or failed, which its page is told."""
    try:
        return work()
    except Stopped:
        return None
    except ThermogearError as error:
        told = error.errors if isinstance(error, InputErrors) else (error,)
        rows = [{"field": getattr(one, "field", ""), "words": one_line(one)} for one in told]
    except Exception as error:  # the worker must outlive any fault of a job
        words = one_line(f"{type(error).__name__}: {error}")
        say("error", words)
        rows = [{"field": "", "words": f"not computed: {words}"}]
    client.post("refused", {"kind": "refused", "number": number, "rows": rows})
    return None
