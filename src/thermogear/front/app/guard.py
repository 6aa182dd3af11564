"""Who may speak to the server: this machine's own page with the token, and nobody else."""

from __future__ import annotations

import hmac
import secrets
from collections.abc import Iterable
from urllib.parse import parse_qs, urlsplit

NAMES = frozenset({"127.0.0.1", "localhost", "[::1]"})
"""Hosts by which this machine calls itself; an SSH tunnel may have any port."""
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
    if not host:
        return False
    name, colon, port = host.rpartition(":")
    if not colon or host.endswith("]"):
        name, port = host, "80"
    return name.lower() in NAMES and port.isascii() and port.isdigit() and int(port) < 65_536


def own_origin(origin: str | None, host: str | None) -> bool:
    """Whether a websocket was opened by a page of this very server."""
    if not origin or not own_host(host):
        return False
    parts = urlsplit(origin)
    return parts.scheme == "http" and parts.netloc.lower() == str(host).lower() and not parts.path


def knows(query: bytes, token: str) -> bool:
    """Whether a query holds the token, compared in constant time."""
    given = parse_qs(query.decode("latin-1")).get("token", [])
    return len(given) == 1 and hmac.compare_digest(given[0].encode(), token.encode())
