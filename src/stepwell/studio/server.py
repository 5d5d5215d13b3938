"""The server of the studio: files of the page and one socket, on this machine only."""

import asyncio
import gzip
import hashlib
import os
import secrets
import socket
from collections.abc import AsyncIterator, Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager
from functools import cache
from importlib import import_module
from importlib.resources import files
from pathlib import Path
from typing import Any

import platformdirs

from stepwell.base import need
from stepwell.kernels import interpret
from stepwell.studio.aside import Workers, prepare, warm
from stepwell.studio.guard import App, Guard, kept_token
from stepwell.studio.message import LONGEST_MESSAGE
from stepwell.studio.session import Session
from stepwell.studio.stores import end_studies

HOST = "127.0.0.1"
# Browser storage depends on the port: with a fixed port the page finds the last design.
USUAL_PORT = 7473
_TYPES = {
    "html": "text/html; charset=utf-8",
    "js": "text/javascript; charset=utf-8",
    "css": "text/css; charset=utf-8",
    "svg": "image/svg+xml",
    "png": "image/png",
    "woff2": "font/woff2",
}
# Time limit of the shutdown [s].
_PATIENCE = 1


def serve(
    design: dict[str, Any] | None = None,
    *,
    port: int | None = None,
    studies: str | os.PathLike[str] | None = None,
    opened: Callable[[str], None] | None = None,
) -> None:
    """Serve the studio until it is interrupted.

    Args:
        design: tables of the design that the page shows first; the gallery by default.
        port: of 127.0.0.1, 0 for any free one; by default 7473, or any if that is in use.
        studies: the folder of studies; by default a folder of this user.
        opened: called with the page's address as soon as the server answers.

    Raises:
        ExtraError: the packages of the extra `studio` are not installed.
        OSError: the port is taken.
    """
    uvicorn = _needed("uvicorn")
    _needed("websockets")
    with _listening(port) as listening:
        own = int(listening.getsockname()[1])
        # A free port that was taken in place of the usual one is another one next time.
        token = kept_token(own) if own in (port, USUAL_PORT) else secrets.token_urlsafe(24)

        def ready() -> None:
            if opened is not None:
                opened(f"http://{HOST}:{own}/?token={token}")

        config = uvicorn.Config(
            application(own, token, design, ready, studies),
            ws="websockets-sansio",
            ws_max_size=LONGEST_MESSAGE,
            ws_per_message_deflate=False,
            lifespan="on",
            log_level="critical",
            access_log=False,
            server_header=False,
            timeout_graceful_shutdown=_PATIENCE,
        )
        uvicorn.Server(config).run(sockets=[listening])


def _listening(port: int | None) -> socket.socket:
    try:
        return socket.create_server((HOST, USUAL_PORT if port is None else port), backlog=64)
    except OSError:
        if port is not None:
            raise
        return socket.create_server((HOST, 0), backlog=64)


def application(
    port: int,
    token: str,
    design: dict[str, Any] | None = None,
    ready: Callable[[], None] = lambda: None,
    studies: str | os.PathLike[str] | None = None,
) -> App:
    """The studio as an ASGI application; `ready` is called once it can answer."""
    applications = _needed("starlette.applications")
    responses, routing = _needed("starlette.responses"), _needed("starlette.routing")
    threads, workers = ThreadPoolExecutor(1, "studio"), Workers()
    kept = Path(studies).absolute() if studies is not None else usual_studies()

    @asynccontextmanager
    async def lifespan(_app: Any) -> AsyncIterator[None]:
        # Machine code is for workers: loading it here would delay an answer by seconds.
        for first in (interpret, warm, prepare):
            threads.submit(first)
        ready()
        yield
        await asyncio.to_thread(end_studies)
        workers.close()
        threads.shutdown(wait=False, cancel_futures=True)

    async def talk(websocket: Any) -> None:
        await websocket.accept()
        await _talked(websocket, Session(websocket.send_bytes, threads, workers, design, kept))

    def route(path: str, name: str) -> Any:
        kind, tag = _TYPES[name.rpartition(".")[2]], f'W/"{_digest(held[name])}"'

        async def page(request: Any) -> Any:
            # A browser keeps the file and asks whether it is still this one.
            headers = {"etag": tag, "vary": "accept-encoding"}
            if tag in request.headers.get("if-none-match", ""):
                return responses.Response(status_code=304, headers=headers)
            body = held[name]
            if "gzip" in request.headers.get("accept-encoding", ""):
                headers["content-encoding"], body = "gzip", _compressed(body)
            return responses.Response(body, headers=headers, media_type=kind)

        return routing.Route(path, page)

    # The files are read at the start: no path of a request is ever opened.
    held = page_files()
    routes = [route(f"/{name}", name) for name in held]
    routes += [route("/", "index.html")] if "index.html" in held else []
    routes.append(routing.WebSocketRoute("/socket", talk))
    return Guard(applications.Starlette(routes=routes, lifespan=lifespan), port, token)


def usual_studies() -> Path:
    """The default folder of studies."""
    return platformdirs.user_data_path("stepwell") / "studies"


def page_files() -> dict[str, bytes]:
    """The files of the page by name."""
    folder = files("stepwell.studio") / "page"
    held = folder.iterdir() if folder.is_dir() else ()
    return {one.name: one.read_bytes() for one in held if one.name.rpartition(".")[2] in _TYPES}


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:20]


@cache
def _compressed(data: bytes) -> bytes:
    return gzip.compress(data, 6, mtime=0)


async def _talked(websocket: Any, session: Session) -> None:
    """Receive and answer messages until the page closes."""
    gone = _needed("starlette.websockets").WebSocketDisconnect
    answering = asyncio.create_task(session.answer())
    try:
        while True:
            hearing = asyncio.create_task(websocket.receive())
            await asyncio.wait({hearing, answering}, return_when=asyncio.FIRST_COMPLETED)
            if answering.done():
                hearing.cancel()
                break
            message = hearing.result()
            if message["type"] == "websocket.disconnect":
                break
            text = message.get("text")
            if text is None:
                text = (message.get("bytes") or b"").decode("utf-8", "replace")
            if len(text.encode("utf-8", "replace")) > LONGEST_MESSAGE:
                await websocket.close(1009)
                break
            await session.hear(text)
    except (gone, OSError, RuntimeError):  # the page was closed during the answer
        pass
    finally:
        answering.cancel()
        await asyncio.gather(answering, return_exceptions=True)


def _needed(name: str) -> Any:
    """A module of the extra, or an error with the command that installs it."""
    need("studio")
    return import_module(name)
