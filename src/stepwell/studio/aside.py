"""Panels by type of message, their answers as bytes, and a separate process for long ones."""

import asyncio
import json
import multiprocessing
import os
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from time import monotonic
from typing import Any

from stepwell.base import StepwellError
from stepwell.crash import reported
from stepwell.studio.ask import Ask, PageDesign, View
from stepwell.studio.message import (
    Message,
    Refusal,
    packed,
    partial_answer,
    problems_of,
    progress_message,
    refusal_message,
)

# For every type of message the file in `panels` with the function `answer_<type>`.
FILES = {
    "atlas": ("atlas",),
    "designs": ("export", "gallery", "open", "replay", "text", "thumbnails"),
    "maps": ("border", "jump", "map", "map_followed", "parameters"),
    "motion": ("cells", "evaluate", "graph", "margin", "program"),
    "recordings": ("measured",),
    "robots": ("arena", "arenas", "maze", "predict", "robot", "robot_numbers", "walk"),
    "studies": (
        *("studies", "study", "study_begin", "study_csv"),
        *("study_design", "study_estimate", "study_stop"),
    ),
    "targets": ("wish", "yield"),
}
_PANELS = {kind: file for file, kinds in FILES.items() for kind in kinds}
# Panels in a separate process: `ask.report` reports progress, and the page can cancel them.
LONG = {
    *("atlas", "export", "map_followed", "margin", "maze", "measured", "predict", "replay"),
    *("study", "study_csv", "study_design", "study_estimate", "thumbnails", "walk", "wish"),
    "yield",
}
_BROKEN = (
    "The studio failed on this. Its terminal names a file to report it with; go back to the last "
    "good state and on from there."
)
# What long answers need, imported once for all of them.
_USED = "stepwell.design", "stepwell.accounts", "scipy.stats", "scipy.optimize", "xarray", "numba"
# Seconds between two reports of progress.
_EVERY = 0.1


def types() -> tuple[str, ...]:
    """The type of every panel, in order."""
    return tuple(sorted(_PANELS))


def answer(kind: str, design: PageDesign, ask: Ask) -> View:
    """The answer of a panel; its file is imported at the first request."""
    panels = import_module(f"stepwell.studio.panels.{_PANELS[kind]}")
    return getattr(panels, f"answer_{kind}")(design, ask)


def answered(message: Message, ask: Ask | None = None) -> bytes:
    """The answer of a panel to a message, or all problems of the message.

    `ask` has functions that report progress; without it there are none.
    """
    design = PageDesign(message.design, message.leg)
    ask = ask or Ask(message.ask, studies=message.studies)
    try:
        return packed(message.type, message.seq, answer(message.type, design, ask))
    except StepwellError as error:
        return refusal_message(message.type, message.seq, problems_of(error))
    except Exception as error:  # a bug must not end the session
        asked = {"type": message.type, "ask": dict(message.ask), "design": message.design}
        report_error(error, json.dumps(asked, default=str))
        return refusal_message(message.type, message.seq, [Refusal("", _BROKEN)])


def report_error(error: Exception, asked: str = "") -> None:
    """Write one line about an unexpected error, and a report with the request."""
    if sys.stderr is not None:
        sys.stderr.write(f"{reported(error, ['studio'], asked)}\n")


class WorkerProcess:
    """One process at a time; it starts with the first work and stays warm for the next."""

    def __init__(self) -> None:
        self._process: BaseProcess | None = None
        self._pipe: Connection | None = None

    async def run(self, message: Message, report: Callable[[bytes], None]) -> bytes | None:
        """The answer to a message, None if the work was ended; `report` is called with progress."""
        pipe = self._started()
        try:
            pipe.send(message)
            while True:
                last, data = await asyncio.to_thread(pipe.recv)
                if last:
                    return data
                report(data)
        except (EOFError, OSError):
            self.end()
            return None

    def end(self) -> None:
        """End the process at once."""
        process, self._process = self._process, None
        if process is not None:
            process.kill()
            process.join()

    def _started(self) -> Connection:
        if self._process is not None and self._process.is_alive() and self._pipe is not None:
            return self._pipe
        apart = _apart()
        ours, theirs = apart.Pipe()
        process: BaseProcess = apart.Process(target=work, args=(theirs,), daemon=True)
        process.start()
        self._process, self._pipe = process, ours
        theirs.close()
        return ours


def prepare() -> None:
    """Start the imports of the process from which long work is forked."""
    if "forkserver" in multiprocessing.get_all_start_methods():
        _apart()
        from multiprocessing import forkserver

        forkserver.ensure_running()


def _apart() -> Any:
    # A fork of this process would copy locked locks of its threads: if possible, start
    # from a process without threads that has imported all packages.
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    apart = multiprocessing.get_context("forkserver")
    apart.set_forkserver_preload([__name__, *_USED])
    return apart


def work(pipe: Connection) -> None:
    """Answer one message after another until the studio ends; runs in the process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the studio handles Ctrl-C and ends this process
    if hasattr(os, "nice"):
        os.nice(5)  # answers to a drag have priority
    with suppress(EOFError, OSError):
        while True:
            message: Message = pipe.recv()
            reported_at = monotonic()

            def report(done: float, total: float, message: Message = message) -> None:
                nonlocal reported_at
                now = monotonic()
                if now - reported_at >= _EVERY:
                    reported_at = now
                    pipe.send((False, progress_message(message.type, message.seq, done, total)))

            def show(view: View, message: Message = message) -> None:
                pipe.send((False, partial_answer(message.type, message.seq, view)))

            pipe.send((True, answered(message, Ask(message.ask, report, show, message.studies))))
