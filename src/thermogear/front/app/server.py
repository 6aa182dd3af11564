"""The server: five served names, one websocket, this machine alone."""

from __future__ import annotations

import asyncio
import contextlib
import json
import socket
import time
import webbrowser
from collections.abc import AsyncIterator, Awaitable, Callable, MutableMapping
from importlib.resources import files
from typing import Any

import uvicorn
from starlette.applications import Starlette
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from thermogear.base.errors import InputError
from thermogear.front.app import guard
from thermogear.front.app.desk import Desk, hello
from thermogear.front.app.given import Given
from thermogear.front.app.jobs import Client, Worker
from thermogear.front.app.wire import MOST_BYTES, Stop, read

ADDRESS = "127.0.0.1"
MOST_CLIENTS = 16
MOST_A_SECOND = 200
"""Messages of one page; a page sends one a frame at most."""
TRY_LATER, TOO_MUCH, NOT_TEXT = 1013, 1008, 1003

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Any]]
Send = Callable[[Any], Awaitable[None]]


class Guarded:
    """Lets through who may speak: own host, own page, token; adds the headers of safety."""

    def __init__(self, app: Any, token: str) -> None:
        self.app, self.token = app, token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        host = guard.header(scope["headers"], "host")
        status = self._refused(scope, host)
        if status and scope["type"] == "websocket":
            await receive()
            # before a websocket is accepted, closing it is answered with 403
            await send({"type": "websocket.close", "code": TOO_MUCH})
            return

        async def sent(message: Any) -> None:
            if message["type"] == "http.response.start":
                extra = {**guard.HEADERS, "Content-Security-Policy": guard.POLICY.format(
                    host=host if guard.own_host(host) else ADDRESS)}  # fmt: skip
                message["headers"] = [
                    *message.get("headers", []),
                    *((k.lower().encode(), v.encode()) for k, v in extra.items()),
                ]
            await send(message)

        if status:
            words = {400: "not this machine's name\n", 403: "the address lacks its token\n"}
            await PlainTextResponse(words[status], status)(scope, receive, sent)
            return
        await self.app(scope, receive, sent)

    def _refused(self, scope: Scope, host: str | None) -> int:
        if not guard.own_host(host):
            return 400
        if scope["type"] == "websocket":
            origin = guard.header(scope["headers"], "origin")
            if not guard.own_origin(origin, host):
                return 403
        return 0 if guard.knows(scope["query_string"], self.token) else 403


class Outbox:
    """What a page has not been sent yet: the newest of each name, in the order of their coming."""

    def __init__(self) -> None:
        self.loop = asyncio.get_running_loop()
        self.waiting: dict[str, str] = {}
        self.there = asyncio.Event()

    def post(self, name: str, message: dict[str, object]) -> None:
        """From any thread."""
        text = json.dumps(message, ensure_ascii=False, allow_nan=False)
        with contextlib.suppress(RuntimeError):  # the loop has ended, and the page with it
            self.loop.call_soon_threadsafe(self._put, name, text)

    def _put(self, name: str, text: str) -> None:
        self.waiting.pop(name, None)
        self.waiting[name] = text
        self.there.set()

    async def send_all(self, socket_: WebSocket) -> None:
        """Send what comes, until cancelled or the page is gone."""
        with contextlib.suppress(WebSocketDisconnect, RuntimeError):
            while True:
                await self.there.wait()
                self.there.clear()
                while self.waiting:
                    await socket_.send_text(self.waiting.pop(next(iter(self.waiting))))


class App:
    """The pages and the websocket for one :class:`Given`."""

    def __init__(self, given: Given, token: str) -> None:
        self.given, self.token = given, token
        self.worker = Worker()
        self.open = 0

    def asgi(self) -> Guarded:
        names = {
            "/": ("text/html", _text("app.html").replace("TOKEN", self.token)),
            "/app.js": ("text/javascript", _script()),
            "/app.css": ("text/css", _style()),
            "/schema.json": ("application/json", _schema()),
            "/icon.svg": ("image/svg+xml", _text("icon.svg")),
        }
        routes: list[Any] = [Route(name, _served(*said)) for name, said in names.items()]
        routes.append(WebSocketRoute("/talk", self.talk))
        app = Starlette(routes=routes, lifespan=self._lifespan)
        app.router.redirect_slashes = False  # a name that is not served is not there
        return Guarded(app, self.token)

    @contextlib.asynccontextmanager
    async def _lifespan(self, _: Starlette) -> AsyncIterator[None]:
        self.worker.start()
        yield
        self.worker.end()

    async def talk(self, socket_: WebSocket) -> None:
        """One open page, from its opening to its end; nothing of it stays."""
        if self.open >= MOST_CLIENTS:
            await socket_.accept()
            await socket_.close(TRY_LATER, f"{MOST_CLIENTS} pages are open; close one")
            return
        await socket_.accept()
        self.open += 1
        outbox = Outbox()
        client = Client(lambda: self._desk(outbox), outbox.post)
        sending = asyncio.create_task(outbox.send_all(socket_))
        self.worker.add(client)
        self.worker.wake()
        try:
            await self._listen(socket_, client)
        except (WebSocketDisconnect, RuntimeError):
            pass
        finally:
            client.closed = True
            self.open -= 1
            sending.cancel()
            self.worker.wake()
            with contextlib.suppress(asyncio.CancelledError):
                await sending

    def _desk(self, outbox: Outbox) -> Desk:
        outbox.post("hello", hello(self.given))
        return Desk(self.given, outbox.post)

    async def _listen(self, socket_: WebSocket, client: Client) -> None:
        count, since = 0, time.monotonic()
        while True:
            received = await socket_.receive()
            if received["type"] == "websocket.disconnect":
                return
            text = received.get("text")
            if text is None:
                await socket_.close(NOT_TEXT, "messages are text")
                return
            now = time.monotonic()
            count, since = (1, now) if now - since > 1.0 else (count + 1, since)
            if count > MOST_A_SECOND:
                await socket_.close(TOO_MUCH, "too many messages")
                return
            try:
                message = read(text)
            except InputError as error:
                row = {"field": error.field, "words": str(error)}
                client.post("refused", {"kind": "refused", "number": -1, "rows": [row]})
                continue
            if isinstance(message, Stop):
                client.stop()
            else:
                client.want(message)
            self.worker.wake()


def _served(kind: str, text: str) -> Callable[[Any], Awaitable[Response]]:
    async def answer(_: Any) -> Response:
        return Response(text, media_type=kind)

    return answer


def _text(name: str) -> str:
    return (files("thermogear.front.app") / "page" / name).read_text("utf-8")


def _script() -> str:
    from thermogear.views.moving import script_of

    return script_of(_text("app.js"))


def _style() -> str:
    from thermogear.views.moving import sheet
    from thermogear.views.page import style

    return "\n".join((style(), str(sheet()), _text("app.css")))


def _schema() -> str:
    from thermogear.case.schema import json_schema

    return json.dumps(json_schema(), ensure_ascii=False)


# --- serving ------------------------------------------------------------------------------------


def bound(port: int | None, *, usual: int) -> socket.socket:
    """A listening socket of this machine alone: at ``port``, or at the usual or any free one."""
    for wanted in (usual, 0) if port is None else (port,):
        one = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        one.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            one.bind((ADDRESS, wanted))
            one.listen(128)  # now, so that a second start cannot take the same port
        except OSError as error:
            one.close()
            if port is not None:
                raise InputError(
                    "--port", port, why=str(error.strerror), fix="leave it out for a free one"
                ) from error
            continue
        return one
    raise InputError("--port", usual, why="no port is free on this machine")


def server_of(app: App) -> uvicorn.Server:
    """What serves ``app``; its limits are those of one person's page."""
    config = uvicorn.Config(
        app.asgi(), log_config=None, access_log=False, http="h11", ws="websockets-sansio",
        ws_max_size=MOST_BYTES, ws_ping_interval=20.0, server_header=False, date_header=False,
        timeout_graceful_shutdown=1, limit_concurrency=4 * MOST_CLIENTS, lifespan="on",
    )  # fmt: skip
    return uvicorn.Server(config)


def serve(given: Given, listening: socket.socket, token: str, *, browser: bool) -> None:
    """Serve until Ctrl+C."""
    app = App(given, token)
    server = server_of(app)
    if browser:
        webbrowser.open(f"http://{ADDRESS}:{listening.getsockname()[1]}/?token={token}")
    with contextlib.suppress(KeyboardInterrupt):
        asyncio.run(server.serve(sockets=[listening]))
    app.worker.end()
