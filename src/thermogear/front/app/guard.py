"""Who may speak to the server: this machine's own page with the token, and nobody else."""

from __future__ import annotations

import hmac
import re
import secrets
from collections.abc import Iterable
from urllib.parse import parse_qs

HOST = re.compile(r"(?:127\.0\.0\.1|localhost|\[::1\])(?::([0-9]{1,5}))?", re.ASCII | re.IGNORECASE)
"""Names by which this machine calls itself; an SSH tunnel may have any port."""
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "connect-src 'self' ws://{host}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
HEADERS = {
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "X-Frame-Options": "DENY",
}


def new_token() -> str:
    """128 random bits as text for an address."""
    return secrets.token_hex(16)


def header(headers: Iterable[tuple[bytes, bytes]], name: str) -> str | None:
    """The one header called so, None without it or where it comes twice."""
    found = [value for key, value in headers if key.lower() == name.encode()]
    return found[0].decode("latin-1") if len(found) == 1 else None


def own_host(host: str | None) -> bool:
    """Whether a Host header names this machine, with or without a port."""
    found = HOST.fullmatch(host or "")
    return found is not None and int(found[1] or 80) < 65_536


def own_origin(origin: str | None, host: str | None) -> bool:
    """Whether a websocket was opened by a page of this very server."""
    return own_host(host) and origin is not None and origin.lower() == f"http://{host}".lower()


def knows(query: bytes, token: str) -> bool:
    """Whether a query holds the token, compared in constant time."""
    given = parse_qs(query.decode("latin-1")).get("token", [])
    return len(given) == 1 and hmac.compare_digest(given[0].encode(), token.encode())
