"""What a stranger may try with the app, each attempt at a real server: trials/records/attacks.md.

    python trials/attacks.py            the page anew, half a minute

The tests run the same list. Each attempt says what must come back; the page holds what came.
"""

from __future__ import annotations

import base64
import json
import secrets
import socket
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from importlib.metadata import files as packaged
from pathlib import Path
from typing import Any

from attacked import (
    PAGE,
    PATIENCE,
    SERVED,
    Attempt,
    Headers,
    Local,
    ask,
    changed,
    heard,
    local,
    opened,
    show,
)
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection

# --- the attempts ---------------------------------------------------------------------------------


def _status(words: str, group: str, expected: int, **request: Any) -> Attempt:
    return Attempt(group, words, str(expected), lambda server: str(ask(server, **request).status))


def other_addresses() -> list[str]:
    """Of this machine: another of the loopback, IPv6's, and that of its network."""
    found = ["127.0.0.2", "::1"]
    with suppress(OSError), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.connect(("192.0.2.1", 9))  # nothing is sent
        found.append(one.getsockname()[0])
    return [one for one in found if one != "127.0.0.1"]


def reached(address: str) -> Callable[[Local], str]:
    def trying(server: Local) -> str:
        try:
            socket.create_connection((address, server.port), timeout=5.0).close()
        except OSError:
            return "no connection"
        return "a connection"

    return trying


def of_listening() -> list[Attempt]:
    names = ["another loopback address", "IPv6's own address", "the network's address"]
    return [
        Attempt("Who may come", f"connect at {name}", "no connection", reached(address))
        for name, address in zip(names, other_addresses(), strict=False)
    ]


TOKENS = {
    "no token": "",
    "an empty token": "?token=",
    "a wrong token": "?token=" + "0" * 32,
    "half the token": "?token=HALF",
    "the token and a letter more": "?token={t}a",
    "the token twice": "?token={t}&token={t}",
    "the token and a wrong one": "?token={t}&token=0",
    "the token under another name": "?Token={t}",
    "a token of bytes that are no text": "?token=%ff%fe%00",
}


def of_tokens() -> list[Attempt]:
    def every(query: str) -> Callable[[Local], str]:
        def trying(server: Local) -> str:
            said = query.replace("HALF", server.token[:16])
            own = [("Host", server.host), ("Origin", f"http://{server.host}")]
            got = {ask(server, path + said).status for path in SERVED}
            return " ".join(map(str, sorted(got | {opened(server, own, "/talk" + said)})))

        return trying

    words = "for page, script, style, schema, icon and websocket"
    return [
        Attempt("The token", f"{name}, {words}", "403", every(query))
        for name, query in TOKENS.items()
    ]


def of_hosts() -> list[Attempt]:
    hosts = [
        "evil.example", "evil.example:PORT", "127.0.0.1.evil.example:PORT",
        "localhost.evil.example", "evil.example#127.0.0.1:PORT", "user@127.0.0.1:PORT",
        "127.0.0.1:PORT:PORT",
        "localhost:99999", "localhost:-1", "localhost:", "localhost:" + "9" * 5000, "0.0.0.0:PORT",
        "127.1:PORT", "2130706433:PORT", "[::1", "[::ffff:127.0.0.1]:PORT", "",
    ]  # fmt: skip

    def named(host: str) -> Callable[[Local], str]:
        def trying(server: Local) -> str:
            said = host.replace("PORT", str(server.port))
            own = [("Host", said), ("Origin", f"http://{said}")]
            web = opened(server, own)
            page = ask(server, headers=[("Host", said)]).status
            return f"{page}, websocket {web}"

        return trying

    def doubled(server: Local) -> str:
        twice = [("Host", server.host), ("Host", "evil.example")]
        return str(ask(server, headers=twice).status)

    def short(host: str) -> str:
        return host if len(host) < 40 else "localhost: and 5000 digits"

    found = [
        Attempt("The host", f"Host: {short(one)}", "400, websocket 403", named(one))
        for one in hosts
    ]
    return [
        *found,
        Attempt("The host", "two Host headers", "400", doubled),
        _status("no Host header", "The host", 400, headers=()),
        _status("no Host header, HTTP/1.0", "The host", 400, headers=(), version="1.0"),
    ]


def of_origins() -> list[Attempt]:
    origins: dict[str, Headers] = {
        "no Origin": (),
        "Origin: null": [("Origin", "null")],
        "Origin: http://evil.example": [("Origin", "http://evil.example")],
        "another port of this machine": [("Origin", "http://127.0.0.1:1")],
        "https in place of http": [("Origin", "https://HOST")],
        "file://": [("Origin", "file://")],
        "another name of this machine": [("Origin", "http://localhost:PORT")],
        "own address and a path": [("Origin", "http://HOST/x")],
        "own address and a question": [("Origin", "http://HOST?x")],
        "own address as a user's name": [("Origin", "http://HOST@evil.example")],
        "an address that cannot be read": [("Origin", "http://[::1")],
    }

    def trying(headers: Headers) -> Callable[[Local], str]:
        def of(server: Local) -> str:
            said = [
                (k, v.replace("HOST", server.host).replace("PORT", str(server.port)))
                for k, v in headers
            ]
            return str(opened(server, [("Host", server.host), *said]))

        return of

    group = "The websocket's origin"
    two = [("Origin", "http://HOST"), ("Origin", "null")]
    return [
        *(Attempt(group, words, "403", trying(one)) for words, one in origins.items()),
        Attempt(group, "two Origins, one of them right", "400", trying(two)),
    ]


PATHS = (
    "/../pyproject.toml", "/%2e%2e/pyproject.toml", "/..%2fpyproject.toml", "//", "//app.js",
    "/\\", "/..\\pyproject.toml", "/%5c..%5cpyproject.toml", "/app.js/..", "/app.js/", "/app.js%00",
    "/%00", "/etc/passwd", "//etc/passwd", "/file:///etc/passwd", "/app.py", "/page/app.html",
    "/APP.JS", "/app.html", "/.", "/talk", "/talk/", "/favicon.ico", "/%u002e%u002e/", "/app.js;x",
    "http://evil.example/app.js",
)  # fmt: skip


def of_paths() -> list[Attempt]:
    group = "Names that are not served"
    return [_status(f"GET {one}", group, 404, target=one + "?token={t}") for one in PATHS]


METHODS = ("POST", "PUT", "PATCH", "DELETE", "OPTIONS", "TRACE", "PROPFIND", "NONSENSE")


def of_methods() -> list[Attempt]:
    return [
        Attempt(
            "Methods",
            f"{one}, page and script",
            "405",
            lambda server, one=one: " ".join(  # type: ignore[misc]
                sorted({str(ask(server, f"{p}?token={{t}}", method=one).status) for p in SERVED})
            ),
        )
        for one in METHODS
    ]


def answered(text: str | bytes | Callable[[], str]) -> Callable[[Local], str]:
    """Send it, and then an honest wish: one line in return, and the wish fulfilled?"""

    def trying(server: Local) -> str:
        with server.talk() as page:
            heard(page, "hello")
            page.send(text() if callable(text) else text)
            found = heard(page, "refused", "done")
            page.send(show(77))
            while heard(page, "done")["number"] != 77:
                pass
        if found["kind"] == "done":
            return "done"
        rows = found["rows"]
        words = [row["words"] for row in rows]
        one = len(rows) == 1 and "\n" not in words[0] and 0 < len(words[0]) < 400
        internal = "not computed" in words[0]
        return "one line" if one and not internal else f"{len(rows)} lines: {words[0][:200]}"

    return trying


def of_messages() -> list[Attempt]:
    speeds = {"low": 200.0, "high": 5000.0, "count": 300}
    hostile: dict[str, str | Callable[[], str]] = {
        "[]": "[]", "{}": "{}", "null": "null", "7": "7", '"show"': '"show"', "nothing": "",
        "no JSON": "{kind: show}", "half a message": '{"kind":"show","number":',
        "100 000 brackets": lambda: "[" * 100_000,
        "100 000 nested tables": lambda: '{"a":' * 100_000,
        "an unknown kind": '{"kind":"shell","number":1}',
        "a kind twice as long as a book": lambda: json.dumps({"kind": "x" * 900_000, "number": 1}),
        "a field that is none": show(1, path="/etc/passwd"),
        "a field's name of 900 000 letters": lambda: show(1, **{"x" * 900_000: 1}),
        "a number of 5000 digits": '{"kind":"show","number":' + "9" * 5000 + "}",
        "a negative number": '{"kind":"show","number":-1}',
        "a number as text": '{"kind":"show","number":"one"}',
        "an unknown part": show(1, parts=["mesh", "shell"]),
        "10 000 parts": lambda: show(1, parts=["mesh"] * 10_000),
        "2001 speeds": show(1, speeds=speeds | {"count": 2001}),
        "10^18 speeds": show(1, speeds=speeds | {"count": 10**18}),
        "a speed of 10^-9 rpm": show(1, speeds=speeds | {"low": 1e-9}),
        "a speed of NaN": show(1, speeds=speeds | {"low": float("nan")}),
        "a speed of Infinity": show(1, speeds=speeds | {"high": float("inf")}),
        "a speed as text": show(1, speeds=speeds | {"high": "fast"}),
        "speeds the wrong way round": show(1, speeds={"low": 900, "high": 800, "count": 9},
                                           parts=["run-up"]),
        "a dial at NaN": show(1, state={"dials": {"speed": float("nan")}}),
        "a dial at 10^400": '{"kind":"show","number":1,"state":{"dials":{"speed":1e400}}}',
        "a dial at 10^300": show(1, state={"dials": {"speed": 1e300}}),
        "an unknown dial": show(1, state={"dials": {"__class__": 1.0}}),
        "401 changes": lambda: show(1, state=changed(*(("title", "x"),) * 401)),
        "a change of 100 001 letters": lambda: show(1, state=changed(("title", "x" * 100_001))),
        "a path of 121 letters": show(1, state=changed(("a" * 121, "1"))),
        "a path with dots alone": show(1, state=changed(("..", "1"))),
        "a path into Python": show(1, state=changed(("__class__.__init__", "1"))),
        "a path over two lines": show(1, state=changed(("gears\n.module", "1 mm"))),
        "half a surrogate": '{"kind":"show","number":1,"state":{"changes":[["title","\\ud800"]]}}',
        "a value of 50 000 brackets": lambda: show(
            1, state=changed(("gears.pinion.teeth", "[" * 50_000))),
        "a million mesh periods": show(1, state=changed(("simulation.periods", "1000000"))),
        "two million mesh periods thrown away": show(
            1, state=changed(("simulation.most_discarded", "2000000"))),
        "a grid of 65 536": show(1, state=changed(("grid.mesh_positions", "65536"))),
        "10 000 operating speeds": lambda: show(
            1, state=changed(("operating.speed", json.dumps(["9 rpm"] * 10_000)))),
        "a file of this machine as flanks": show(
            1, state=changed(("flanks.pinion", "/etc/passwd"))),
        "a backlash of -1 mm": show(1, state=changed(("backlash.value", "-1 mm"))),
        "an export of nothing": '{"kind":"export","number":1,"what":"shell"}',
        "an export of a case that cannot be": json.dumps(
            {"kind": "export", "number": 1, "what": "report",
             "state": changed(("backlash.value", "-1 mm"))}),
    }  # fmt: skip
    group = "Messages of a page that has the token"
    return [
        *(Attempt(group, words, "one line", answered(text)) for words, text in hostile.items()),
        Attempt(group, "gears of 2000 teeth", "done", answered(show(1, state=changed(
            ("gears.pinion.teeth", "2000"), ("gears.pinion.tip_diameter", ""),
            ("gears.wheel.teeth", "2000"), ("gears.wheel.tip_diameter", "")),
            parts=["mesh", "gap", "gears"]))),
        Attempt(group, "a message over 1 MiB", "closed with 1009", closed("x" * (2**20 + 1))),
        Attempt(group, "a message over 1 MiB in pieces", "closed with 1009",
                # the last piece is small: what a server that closes has not read resets the
                # connection, and its reason is lost on the way (1006)
                closed(["x" * 2**19, "x" * 2**19, "x"])),
        Attempt(group, "bytes in place of text", "closed with 1003", closed(b"\0\1")),
        Attempt(group, "a text that is no UTF-8", "closed with 1007", not_utf8),
    ]  # fmt: skip


def closed(message: str | bytes | list[str]) -> Callable[[Local], str]:
    """Send it; with which code is the websocket closed?"""

    def trying(server: Local) -> str:
        with server.talk() as page:
            with suppress(ConnectionClosed):
                page.send(message)
            return f"closed with {code_of(page)}"

    return trying


def not_utf8(server: Local) -> str:
    with server.talk() as page:
        page.send(b"\xff\xfe", text=True)
        return f"closed with {code_of(page)}"


def code_of(page: ClientConnection) -> int:
    """The code with which a server closes."""
    until = time.monotonic() + PATIENCE
    try:
        while time.monotonic() < until:
            page.recv(timeout=PATIENCE)
    except ConnectionClosed as end:
        return end.rcvd.code if end.rcvd else 1006
    return 0


def flood(server: Local) -> str:
    """Thousands of messages as fast as they go; another page is served meanwhile."""
    before = server.megabytes()
    with server.talk() as other, server.talk() as page:
        heard(other, "hello")
        with suppress(ConnectionClosed):
            for _ in range(5000):
                page.send('{"kind":"stop","number":1}')
        other.send(show(5))
        heard(other, "done")
        code = code_of(page)
    grown = server.megabytes() - before
    return f"closed with {code}" + (f", {grown:.0f} MB grown" if grown > 50 else "")


def silent(server: Local) -> str:
    """A page that asks without end and never reads: its answers must not pile up."""
    with server.talk() as other:
        heard(other, "hello")
        before = server.megabytes()
        with socket.create_connection(("127.0.0.1", server.port)) as page:
            page.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            page.sendall(_opening(server))
            page.recv(4096)
            for number in range(150):
                page.sendall(_frame(show(number, parts=["gears", "mesh"])))
                time.sleep(0.01)
            other.send(show(6))
            heard(other, "done")
            grown = server.megabytes() - before
    return "other pages served" + (f", {grown:.0f} MB grown" if grown > 50 else "")


def _opening(server: Local) -> bytes:
    key = base64.b64encode(secrets.token_bytes(16)).decode()
    return (
        f"GET /talk?token={server.token} HTTP/1.1\r\nHost: {server.host}\r\n"
        f"Origin: http://{server.host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n"
    ).encode()


def _frame(text: str) -> bytes:
    """A masked frame of text; the mask is zero."""
    data = text.encode()
    size = bytes([0x80 | len(data)]) if len(data) < 126 else b"\xfe" + len(data).to_bytes(2, "big")
    return b"\x81" + size + bytes(4) + data


def crowd(server: Local) -> str:
    """Seventeen pages, and an eighteenth after one has gone."""
    with ExitStack() as pages:
        for _ in range(15):
            pages.enter_context(server.talk())
        with server.talk(), server.talk() as one:
            code = code_of(one)
        time.sleep(0.2)
        with server.talk() as again:
            heard(again, "hello")
    return f"the 17th closed with {code}, one served after another has gone"


def vanished(server: Local) -> str:
    """A page that is torn away in the middle of a run-up."""
    speeds = {"low": 500.0, "high": 9000.0, "count": 2000}
    with server.talk(close_timeout=0.1) as page:
        heard(page, "hello")
        page.send(show(1, parts=["run-up"], speeds=speeds))
        heard(page, "progress", "part")
        page.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")
        page.socket.shutdown(socket.SHUT_RDWR)
    time.sleep(0.5)
    before = server.seconds()
    time.sleep(2.0)
    used = server.seconds() - before
    return "idle" if used < 0.1 else f"{used:.2f} s of processor time in 2 s"


def of_load() -> list[Attempt]:
    group = "Too much of it"
    return [
        Attempt(group, "5000 messages without a pause, another page open", "closed with 1008",
                flood),
        Attempt(group, "150 wishes of a page that never reads", "other pages served", silent),
        Attempt(group, "17 pages at once",
                "the 17th closed with 1013, one served after another has gone", crowd),
        Attempt(group, "a page torn away in the middle of a run-up: processor time afterwards",
                "idle", vanished),
    ]  # fmt: skip


def attempts() -> list[Attempt]:
    """All of them, the loud ones last."""
    return [
        *of_listening(), *of_tokens(), *of_hosts(), *of_origins(), *of_paths(), *of_methods(),
        *of_messages(), *of_load(),
    ]  # fmt: skip


# --- the page -------------------------------------------------------------------------------------

HEAD = """# What a stranger may try with the app

Made by `make trial NAME=attacks`: every attempt at a real server, `thermogear app rig`. The tests
run the same list. {count} attempts, {bad} of them with another answer than expected. What is
left to you: [What a stranger may try](../../docs/howto/app.md#what-a-stranger-may-try).

| attempt | expected | got |
|---|---|---|
"""


def page_of(rows: Sequence[tuple[Attempt, str]], sizes: Sequence[str]) -> str:
    """The page's text."""
    bad = sum(one.expected != got for one, got in rows)
    lines: list[str] = []
    last = ""
    for one, got in rows:
        if one.group != last:
            last = one.group
            lines.append(f"| **{last}** | | |")
        words = one.words.replace("\\", "\\\\").replace("|", "\\|").replace("`", "'")
        lines.append(f"| `{words}` | {one.expected} | {got} |")
    text = HEAD.format(count=len(rows), bad=bad) + "\n".join(lines)
    return text + "\n\n## Size\n\n" + "\n".join(f"- {one}" for one in sizes) + "\n"


def measured() -> list[str]:
    """Memory with one page and with seven, the bytes of the page, the web packages on disk."""
    wish = {"low": 500.0, "high": 4000.0, "count": 40}
    whole = show(1, parts=["mesh", "orbit", "gap", "gears", "run-up"], speeds=wish)
    found = []
    with local("rig") as server, ExitStack() as pages:
        found.append(f"memory before the first page: {server.megabytes():.0f} MB")
        for count in range(1, 8):
            page = pages.enter_context(server.talk())
            heard(page, "hello")
            page.send(whole)
            heard(page, "done", patience=300.0)
            if count in (1, 7):
                words = f"memory with {count} open, run-ups of {wish['count']:.0f} speeds shown"
                found.append(f"{words}: {server.megabytes():.0f} MB")
        sizes = {path: len(ask(server, path + "?token={t}").body) for path in SERVED}
    each = ", ".join(f"`{path}` {size / 1000:.1f}" for path, size in sizes.items())
    found.append(f"the page: {sum(sizes.values()) / 1000:.0f} kB in {len(sizes)} requests ({each})")
    names = ("starlette", "uvicorn", "websockets", "anyio", "h11", "idna")
    place = sum(
        Path(str(one.locate())).stat().st_size
        for name in names
        for one in packaged(name) or ()
        if Path(str(one.locate())).is_file() and "__pycache__" not in str(one)
    )
    found.append(f"{', '.join(names)} on disk: {place / 1e6:.1f} MB, compiled files left out")
    return found


def main() -> None:
    rows = []
    with local("rig") as server:
        for one in attempts():
            rows.append((one, one.trying(server)))
            mark = "" if rows[-1][1] == one.expected else f"   expected {one.expected}"
            print(f"{one.group}: {one.words[:60]}: {rows[-1][1]}{mark}", flush=True)
        said = server.end()
    print("said:", said)
    PAGE.write_text(page_of(rows, measured()), "utf-8")


if __name__ == "__main__":
    main()
