"""Who may speak to the app, and what nobody can make it do: each line at the real server."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("uvicorn")
pytest.importorskip("websockets")
if sys.platform != "linux":
    pytest.skip("processor time and memory are read from /proc", allow_module_level=True)

from local_app import ROOT, trial

from thermogear.front.app import guard, server

PACKAGE = Path(server.__file__).parent
ATTEMPTS = trial.attempts()
POLICY = {
    "default-src": "'none'", "script-src": "'self'", "style-src": "'self'",
    "img-src": "'self' data:", "base-uri": "'none'", "form-action": "'none'",
    "frame-ancestors": "'none'",
}  # fmt: skip


@pytest.fixture(scope="module")
def app() -> Iterator[Any]:
    with trial.local("rig") as one:
        yield one


@pytest.mark.slow
@pytest.mark.parametrize("one", ATTEMPTS, ids=[f"{a.group}: {a.words}"[:90] for a in ATTEMPTS])
def test_an_attempt_gets_what_it_should(app: Any, one: Any) -> None:
    assert one.trying(app) == one.expected


def test_who_has_the_token_and_the_names_is_served(app: Any) -> None:
    """The five names, and the websocket, also where the machine is called localhost."""
    kinds = {path: trial.ask(app, path + "?token={t}") for path in trial.SERVED}
    assert {one.status for one in kinds.values()} == {200}
    assert [one.headers["content-type"].partition(";")[0] for one in kinds.values()] == [
        "text/html", "text/javascript", "text/css", "application/json", "image/svg+xml",
    ]  # fmt: skip
    for name in ("127.0.0.1", "localhost", "LOCALHOST", "[::1]"):
        host = f"{name}:{app.port}"
        own = [("Host", host), ("Origin", f"http://{host.lower()}")]
        assert trial.opened(app, own) == 101
        assert trial.ask(app, headers=[("Host", host)]).status == 200


def test_the_token_has_128_bits_and_is_another_one_each_time(app: Any) -> None:
    tokens = {guard.new_token() for _ in range(1000)}
    assert len(tokens) == 1000
    assert all(re.fullmatch(r"[0-9a-f]{32}", one) for one in (*tokens, app.token))
    # every one of the 128 bits is 0 in some and 1 in others
    numbers = [int(one, 16) for one in tokens]
    assert all(0 < sum(n >> k & 1 for n in numbers) < 1000 for k in range(128))


def test_every_answer_has_the_headers_of_safety(app: Any) -> None:
    """Also refusals; the policy lets the page load from itself alone."""
    answers = [
        *(trial.ask(app, path + "?token={t}") for path in trial.SERVED),
        trial.ask(app, "/"),
        trial.ask(app, "/none?token={t}"),
        trial.ask(app, headers=[("Host", "evil.example")]),
        trial.ask(app, method="POST"),
    ]
    assert [one.status for one in answers[5:]] == [403, 404, 400, 405]
    for one in answers:
        assert one.headers["cache-control"] == "no-store"
        assert one.headers["x-content-type-options"] == "nosniff"
        assert one.headers["referrer-policy"] == "no-referrer"
        assert "access-control-allow-origin" not in one.headers
        assert "set-cookie" not in one.headers
        assert "server" not in one.headers
        said = dict(
            part.strip().split(" ", 1) for part in one.headers["content-security-policy"].split(";")
        )
        assert {name: said[name] for name in POLICY} == POLICY
        assert "unsafe" not in " ".join(said.values())
    assert f"ws://{app.host}" in answers[0].headers["content-security-policy"]
    assert "evil" not in answers[7].headers["content-security-policy"]


def test_a_second_start_takes_another_port() -> None:
    first = server.bound(None, usual=(server_port := _free()))
    second = server.bound(None, usual=server_port)
    with first, second:
        names = {one.getsockname() for one in (first, second)}
        assert len(names) == 2
        assert {name for name, _ in names} == {"127.0.0.1"}
        assert first.getsockname()[1] == server_port


def _free() -> int:
    with server.bound(None, usual=0) as one:
        return int(one.getsockname()[1])


def test_the_sources_have_no_way_to_run_what_comes() -> None:
    forbidden = re.compile(
        r"\b(pickle|eval|exec|marshal|shelve|subprocess|os\.system|__import__)\b"
    )
    for path in (*PACKAGE.rglob("*.py"), PACKAGE.parent / "app_command.py"):
        assert not forbidden.search(path.read_text("utf-8")), path.name


def test_the_page_sets_text_as_text() -> None:
    """In the page's own script, and in what it is built on."""
    forbidden = re.compile(
        r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\b|new\s+Function"
        r"|setTimeout\(\s*[\"'`]|setAttribute\(\s*[\"']on|createContextualFragment|DOMParser|srcdoc"
    )
    own = [path for path in (ROOT / "src" / "thermogear").rglob("*.js") if "uplot" not in
           path.name.lower()]  # fmt: skip
    assert PACKAGE / "page" / "app.js" in own
    for path in own:
        assert not forbidden.search(path.read_text("utf-8")), path.name
    page = (PACKAGE / "page" / "app.html").read_text("utf-8")
    assert not re.search(r"\son\w+=|<script>|style=|https?://", page)


def test_what_was_tried_left_no_trace_at_the_terminal(app: Any) -> None:
    """The last of the file: the server ends as at Ctrl+C, and has told of no fault of its own."""
    said = app.end()
    assert app.process.returncode == 0
    assert "ASGI" not in said
    assert "error:" not in said
    assert "retrieved" not in said
