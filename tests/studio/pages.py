"""A page without a browser: it talks to a studio of its own process."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np
from websockets import Origin
from websockets.sync.client import ClientConnection, connect

from stepwell.files import preset_text, tables_in
from stepwell.studio.message import unpacked

FORWARD = tables_in(preset_text("paper-forward"))


class Studio(NamedTuple):
    """A running studio."""

    process: subprocess.Popen[str]
    host: str
    token: str


class Answer(NamedTuple):
    """What came back."""

    header: dict[str, Any]
    blocks: dict[str, np.ndarray[Any, Any]]


@contextmanager
def running(*arguments: str) -> Iterator[Studio]:
    """A studio on a free port."""
    command = [sys.executable, "-m", "stepwell", "studio", "--no-open", *arguments]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True
    )
    try:
        assert process.stdout is not None
        line = process.stdout.readline()
        match = re.fullmatch(r"http://(127\.0\.0\.1:\d+)/\?token=([\w-]{20,})\n", line)
        assert match, line
        yield Studio(process, match[1], match[2])
    finally:
        process.kill()
        process.communicate()


class Page:
    """One socket of a page."""

    def __init__(self, socket: ClientConnection):
        self.socket = socket
        self.seq = 0

    def send(self, kind: str, design: Any = None, **ask: Any) -> int:
        """Ask something; its number."""
        self.seq += 1
        message = {"v": 1, "type": kind, "seq": self.seq, "design": design, "ask": ask}
        self.socket.send(json.dumps(message))
        return self.seq

    def hear(self, timeout: float = 60) -> Answer:
        """The next answer."""
        data = self.socket.recv(timeout)
        assert isinstance(data, bytes)
        return Answer(*unpacked(data))

    def ask(self, kind: str, design: Any = None, **ask: Any) -> Answer:
        """Ask something, and wait for its last answer."""
        seq = self.send(kind, design, **ask)
        while True:
            answer = self.hear()
            assert answer.header["seq"] == seq
            if "progress" not in answer.header:
                return answer


@contextmanager
def opened(studio: Studio, *, origin: str | None = "", token: str = "") -> Iterator[Page]:
    """A page's socket; origin and token are the right ones by default."""
    header = Origin(f"http://{studio.host}") if origin == "" else origin and Origin(origin)
    address = f"ws://{studio.host}/socket?token={token or studio.token}"
    with connect(address, origin=header or None, max_size=None, proxy=None) as socket:
        yield Page(socket)


def long_chain(cells: int) -> dict[str, Any]:
    """Tables of lever cells that switch one after another, enough for a sorted cycle."""
    listed = [{"p_mm": [-10, 0], "q_mm": [10 + 10 * k / cells, 0]} for k in range(cells)]
    band = {"stiffness_N_per_m": 28.5, "rest_length_mm": 10}
    return {"chain": {"lever_mm": 16, "limit_deg": 45, "band": band, "cell": listed}}
