"""One thread that computes for every open page: the newest wish of each, a slice at a time."""

from __future__ import annotations

import threading
import warnings
from collections import deque
from collections.abc import Callable, Generator
from typing import TYPE_CHECKING

from thermogear.base.errors import InputErrors, ThermogearError, ValidityWarning
from thermogear.base.plan import Stopped
from thermogear.front.app.wire import Export, Post, Show
from thermogear.front.lines import say

if TYPE_CHECKING:
    from thermogear.front.app.desk import Desk

MOST_EXPORTS = 4


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

    def want(self, message: Show | Export) -> None:
        if isinstance(message, Show):
            self.wanted = message
        elif len(self.exports) < MOST_EXPORTS:
            self.exports.append(message)
        else:
            row = {"field": "", "words": "wait for the files asked for before"}
            self.post("refused", {"kind": "refused", "number": message.number, "rows": [row]})

    def stop(self) -> None:
        """Drop what is wanted and what is worked at."""
        self.wanted, self.at = None, -1

    def require(self, number: int) -> None:
        """Raise where the work on ``number`` is of no use any more."""
        if self.closed or number != self.at or (self.wanted and self.wanted.number != number):
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
        with warnings.catch_warnings():
            # what limits a state is told once with it, and not for each of its parts
            warnings.simplefilter("ignore", ValidityWarning)
            while (client := self._next()) is not None:
                self._step(client)

    def _next(self) -> Client | None:
        with self._there:
            while not self._ending:
                for one in list(self._clients):
                    if one.closed and one.working is None:
                        self._clients.remove(one)
                for _ in range(len(self._clients)):
                    self._clients.rotate(-1)
                    if self._clients[-1].busy:
                        return self._clients[-1]
                self._there.wait()
            return None

    def _step(self, client: Client) -> None:
        """One step for a client; every error of it is told to its page, and the work goes on."""
        number = client.at
        try:
            if client.desk is None:
                client.desk = client.make()
            if client.closed or client.wanted or client.at < 0:
                self._leave(client)
            if client.closed:
                return
            if client.wanted:
                show, client.wanted = client.wanted, None
                client.at = show.number
                client.working = client.desk.show(show, _alive(client, show.number))
            if client.exports:
                export = client.exports.popleft()
                number = export.number
                client.post(f"file {export.what}", client.desk.export(export))
                return
            number = client.at
            if client.working is not None:
                next(client.working)
        except StopIteration:
            client.working = None
            client.post("done", {"kind": "done", "number": number})
        except Stopped:
            client.working = None
        except ThermogearError as error:
            client.working = None
            told = error.errors if isinstance(error, InputErrors) else (error,)
            rows = [{"field": getattr(one, "field", ""), "words": str(one)} for one in told]
            client.post("refused", {"kind": "refused", "number": number, "rows": rows})
        except Exception as error:  # the worker must outlive any fault of a job
            client.working = None
            words = f"{type(error).__name__}: {error}"
            say("error", words)
            row = {"field": "", "words": f"not computed: {words}"}
            client.post("refused", {"kind": "refused", "number": number, "rows": [row]})

    @staticmethod
    def _leave(client: Client) -> None:
        if client.working is not None:
            client.working.close()
            client.working = None


def _alive(client: Client, number: int) -> Callable[[], None]:
    return lambda: client.require(number)
