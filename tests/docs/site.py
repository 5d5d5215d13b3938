"""The built pages: what is linked on each, and a server that shows them on this machine."""

import posixpath
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from html.parser import HTMLParser
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit


class Read(HTMLParser):
    """The places of a page that can be linked to, its links, and what it loads by itself."""

    def __init__(self, file: Path):
        super().__init__()
        self.places: set[str] = set()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.silent: list[str] = []
        self.feed(file.read_text("utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        told = {name: value or "" for name, value in attrs}
        self.places |= {told[name] for name in ("id", "name") if name in told}
        if tag == "a" and "href" in told:
            self.links.append(told["href"])
        if tag == "link" and told.get("rel") not in ("prev", "next", "canonical"):
            self.loads.append(told["href"])
        self.loads += [told[name] for name in ("src", "poster", "data") if told.get(name)]
        self.loads += [one.split()[0] for one in told.get("srcset", "").split(",") if one.strip()]
        if tag == "img" and "alt" not in told:
            self.silent.append(told.get("src", "?"))


@cache
def read(file: Path) -> Read:
    """A page that does not change any more, read once."""
    return Read(file)


def outside(link: str) -> bool:
    """Whether a link leaves the site."""
    parts = urlsplit(link)
    return bool(parts.scheme or parts.netloc)


def lost(site: Path, root: str = "/") -> list[str]:
    """Links, anchors and files of a built site that lead nowhere, as "page: link".

    `root` is the path of the site on its server.
    """
    files = {file.relative_to(site).as_posix() for file in site.rglob("*") if file.is_file()}
    pages = {name: read(site / name) for name in files if name.endswith(".html")}
    found = []
    for name, page in pages.items():
        for link in [*page.links, *page.loads]:
            parts = urlsplit(link)
            if outside(link):
                continue
            path = unquote(parts.path)
            start = "" if path.startswith(root) else posixpath.dirname(name)
            inside = path.removeprefix(root)
            target = posixpath.normpath(posixpath.join(start, inside)) if path else name
            if target not in files:
                target = posixpath.normpath(posixpath.join(target, "index.html"))
            there = target in files
            if there and parts.fragment and target in pages:
                there = unquote(parts.fragment) in pages[target].places
            if not there:
                found.append(f"{name}: {link}")
    return found


@contextmanager
def shown(site: Path, root: str = "/") -> Iterator[str]:
    """The address at which a folder is served while this lasts, to this machine alone.

    The folder has the path `root` on the server. Any other address has the page 404.html.
    """

    class Handler(SimpleHTTPRequestHandler):
        def __init__(self, *options: Any):
            super().__init__(*options, directory=str(site))

        def translate_path(self, path: str) -> str:
            inside = path.startswith(root)
            return super().translate_path(path.removeprefix(root)) if inside else ""

        def send_error(
            self, code: int, message: str | None = None, explain: str | None = None
        ) -> None:
            page = (site / "404.html").read_bytes()
            self.send_response(code)
            self.send_header("Content-Type", "text/html")
            self.send_header("Content-Length", str(len(page)))
            self.end_headers()
            self.wfile.write(page)

        def log_message(self, format: str, *args: Any) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        try:
            yield f"http://127.0.0.1:{server.server_port}{root}"
        finally:
            server.shutdown()
