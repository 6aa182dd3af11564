"""A local app in a process of its own, and ways to speak to it, for the attempts at it."""

from __future__ import annotations

import base64
import json
import os
import secrets
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from websockets.sync.client import ClientConnection, connect

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "trials" / "records" / "attacks.md"
SERVED = ("/", "/app.js", "/app.css", "/schema.json", "/icon.svg")
PATIENCE = 60.0
"""Seconds for an answer; a server that compiles its kernels first needs some."""
Headers = Sequence[tuple[str, str]]


# --- a server in a process of its own, and ways to speak to it ------------------------------------


class Local:
    """``thermogear app`` in a process of its own, from its first line to its end."""

    def __init__(self, *words: str) -> None:
        begin = [sys.executable, "-m", "thermogear", "app", "--no-browser"]
        self.process = subprocess.Popen(
            [*begin, *words],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=os.environ | {"OPENBLAS_NUM_THREADS": "1"},
        )
        assert self.process.stdout is not None
        self.address = self.process.stdout.readline().strip()
        place, _, self.token = self.address.partition("/?token=")
        self.host = place.removeprefix("http://")
        self.port = int(self.host.rpartition(":")[2] or 0)

    def end(self) -> str:
        """What it said to the error stream; it ends as at Ctrl+C."""
        self.process.send_signal(2)
        return self.process.communicate(timeout=20)[1]

    def seconds(self) -> float:
        """Processor time used so far."""
        words = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")

    def megabytes(self, name: str = "VmRSS") -> float:
        """Memory it holds, or held at most: VmHWM."""
        text = Path(f"/proc/{self.process.pid}/status").read_text()
        return next(int(one.split()[1]) / 1024 for one in text.splitlines() if name in one)

    def talk(self, **more: Any) -> Any:
        """A page's websocket, to be opened as a context."""
        address = f"ws://{self.host}/talk?token={self.token}"
        more = {"origin": f"http://{self.host}", "max_size": None, "compression": None} | more
        return connect(address, **more)


@contextmanager
def local(*words: str) -> Iterator[Local]:
    """A server for as long as the block runs."""
    server = Local(*words)
    try:
        yield server
    finally:
        if server.process.poll() is None:
            server.end()


@dataclass(frozen=True)
class Answer:
    """Of a request: ``status`` 0 where the server closed without a word."""

    status: int
    headers: dict[str, str]
    body: bytes


def raw(server: Local, request: bytes) -> Answer:
    """What comes back for these very bytes."""
    with socket.create_connection(("127.0.0.1", server.port), timeout=PATIENCE) as one:
        one.sendall(request)
        found = b""
        with suppress(ConnectionResetError):
            while piece := one.recv(65536):
                found += piece
                if found.startswith(b"HTTP/1.1 101"):
                    break
    head, _, body = found.partition(b"\r\n\r\n")
    first, *lines = head.decode("latin-1").split("\r\n")
    pairs = (line.partition(": ") for line in lines)
    status = int(first.split()[1]) if first else 0
    return Answer(status, {key.lower(): value for key, _, value in pairs}, body)


def ask(
    server: Local,
    target: str | None = None,
    *,
    method: str = "GET",
    headers: Headers | None = None,
    version: str = "1.1",
) -> Answer:
    """A request of one's own making; ``{t}`` in the target is the token."""
    path = (f"/?token={server.token}" if target is None else target).replace("{t}", server.token)
    said = [("Host", server.host)] if headers is None else headers
    lines = [f"{method} {path} HTTP/{version}", *(f"{k}: {v}" for k, v in said)]
    return raw(server, "\r\n".join([*lines, "Connection: close", "", ""]).encode("latin-1"))


def opened(server: Local, headers: Headers, target: str = "/talk?token={t}") -> int:
    """The status of a websocket's opening; 101: it is open."""
    key = base64.b64encode(secrets.token_bytes(16)).decode()
    own = [("Sec-WebSocket-Key", key), ("Sec-WebSocket-Version", "13"), ("Upgrade", "websocket")]
    path = target.replace("{t}", server.token)
    lines = [f"GET {path} HTTP/1.1", *(f"{k}: {v}" for k, v in [*headers, *own])]
    request = "\r\n".join([*lines, "Connection: Upgrade", "", ""]).encode("latin-1")
    return raw(server, request).status


def heard(page: ClientConnection, *kinds: str, patience: float = PATIENCE) -> dict[str, Any]:
    """The next message of one of these kinds."""
    until = time.monotonic() + patience
    while True:
        message = json.loads(page.recv(timeout=max(0.01, until - time.monotonic())))
        if message["kind"] in kinds:
            return message  # type: ignore[no-any-return]


def show(number: int, **more: Any) -> str:
    """A message that asks for a state."""
    return json.dumps({"kind": "show", "number": number, "parts": []} | more)


def changed(*changes: tuple[str, str]) -> dict[str, Any]:
    return {"changes": changes}


@dataclass(frozen=True)
class Attempt:
    """One thing to try: ``expected`` is what must come back from ``trying`` it."""

    group: str
    words: str
    expected: str
    trying: Callable[[Local], str]
