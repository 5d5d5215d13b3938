"""Access control of the studio: only its own page may connect."""

import hmac
import os
import re
import secrets
from collections.abc import Awaitable, Callable, MutableMapping
from contextlib import suppress
from typing import Any
from urllib.parse import parse_qs

import platformdirs

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

_NAMES = ("127.0.0.1", "localhost")
_TOKEN = re.compile(r"[\w-]{20,100}")


class Guard:
    """Refuse requests with another host name, from another page, or without the token.

    A page of another site can send requests to this machine, but not with this Host (this detects
    DNS rebinding), and its WebSocket has another Origin. Without
    the token no socket opens.
    """

    def __init__(self, app: App, port: int, token: str):
        self._app = app
        self._hosts = {f"{name}:{port}" for name in _NAMES} | ({*_NAMES} if port == 80 else set())
        self._token = token.encode()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on and add security headers to its answer, or refuse it."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        host = _only(scope, b"host")
        known = host in self._hosts
        if scope["type"] == "websocket":
            if known and _only(scope, b"origin") == f"http://{host}" and self._invited(scope):
                await self._app(scope, receive, send)
            else:
                await receive()
                await send({"type": "websocket.close", "code": 1008})
            return

        async def with_headers(message: MutableMapping[str, Any]) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = [*message.get("headers", []), *_headers(host if known else "")]
            await send(message)

        if known:
            await self._app(scope, receive, with_headers)
            return
        await with_headers({"type": "http.response.start", "status": 421, "headers": _PLAIN})
        await send({"type": "http.response.body", "body": b"This is not the studio's address.\n"})

    def _invited(self, scope: Scope) -> bool:
        try:
            query = parse_qs(scope["query_string"].decode("ascii"), max_num_fields=4)
        except ValueError:
            return False
        said = query.get("token", [])
        return len(said) == 1 and hmac.compare_digest(said[0].encode(), self._token)


_PLAIN = [(b"content-type", b"text/plain; charset=utf-8")]


def _only(scope: Scope, name: bytes) -> str:
    """The value of a header that occurs once, or ""."""
    values = [value for key, value in scope["headers"] if key == name]
    return values[0].decode("latin-1") if len(values) == 1 else ""


def _headers(host: str) -> list[tuple[bytes, bytes]]:
    policy = (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
        f"font-src 'self'; connect-src 'self'{f' ws://{host}' if host else ''}; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
    headers = {
        "content-security-policy": policy,
        "x-content-type-options": "nosniff",
        "referrer-policy": "no-referrer",
        "cross-origin-opener-policy": "same-origin",
        "cross-origin-resource-policy": "same-origin",
        "cache-control": "no-cache",
    }
    return [(key.encode(), value.encode()) for key, value in headers.items()]


def kept_token(port: int) -> str:
    """The token of this user for a port, so that an open page reconnects after a restart.

    It is stored in the user's state folder, readable by this user only; if it cannot be stored or
    others could read it, the token is a new one.
    """
    file = platformdirs.user_state_path("stepwell") / "studio" / f"{port}.token"
    new = secrets.token_urlsafe(24)
    with suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        with suppress(FileExistsError), open(file, "x", opener=_private) as opened:
            opened.write(new)
        known = file.read_text("ascii", "replace").strip()
        private = os.name == "nt" or file.stat().st_mode & 0o077 == 0
        if private and _TOKEN.fullmatch(known):
            return known
    return new


def _private(path: str, flags: int) -> int:
    return os.open(path, flags, 0o600)
