"""Panels by type of message, their answers as bytes, and a separate process for long ones."""

import asyncio
import json
import multiprocessing
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from importlib import import_module
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any

from stepwell.base import StepwellError
from stepwell.crash import reported
from stepwell.files import preset_text, tables_in
from stepwell.studio.ask import Ask, PageDesign, View
from stepwell.studio.message import Message, Refusal, packed, problems_of, refusal_message

# For every type of message the file in `panels` with the function `answer_<type>`.
FILES = {
    "atlas": ("atlas",),
    "designs": ("export", "gallery", "open", "replay", "text", "thumbnails"),
    "maps": ("border", "jump", "map", "map_followed", "parameters"),
    "motion": ("cells", "evaluate", "graph", "limits", "margin", "program"),
    "parts": ("build", "parts", "parts_files"),
    "recordings": ("element", "measured"),
    "robots": ("arena", "arenas", "maze", "predict", "robot", "robot_numbers", "walk"),
    "robot_parts": ("robot_parts",),
    "studies": (
        *("studies", "study", "study_begin", "study_csv"),
        *("study_design", "study_estimate", "study_stop"),
    ),
    "targets": ("wish", "yield"),
}
_PANELS = {kind: file for file, kinds in FILES.items() for kind in kinds}
# Panels that each have a process of their own, which the page can cancel; `ask.report` reports
# progress. All others take milliseconds.
LONG = {
    *("atlas", "border", "build", "element", "export", "graph", "jump", "map", "map_followed"),
    *("margin", "maze", "measured", "parts_files", "predict", "program", "replay", "robot_parts"),
    *("study", "study_csv", "study_design", "study_estimate", "thumbnails", "walk", "wish"),
    "yield",
}
# Panels whose processes belong to the server.
OWN = {"studies", "study_begin", "study_stop"}
_BROKEN = (
    "The studio failed on this. Its terminal names a file to report it with; go back to the last "
    "good state and on from there."
)


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


def broken(message: Message) -> bytes:
    """The answer to a message whose process ended by itself."""
    return refusal_message(message.type, message.seq, [Refusal("", _BROKEN)])


def typical() -> Message:
    """A first request such as pages send; its answer imports packages in advance."""
    # A dictionary, because the default of `ask` cannot be sent to a process.
    return Message("evaluate", 0, tables_in(preset_text("paper-forward")), {})


def warm() -> None:
    """Answer a typical first request."""
    answered(typical())


class WorkerProcess:
    """One process at a time; it starts with the first work and stays warm for the next.

    `nice` lowers its priority, so that answers to a drag come first.
    """

    def __init__(self, nice: int = 5) -> None:
        self._nice = nice
        self._process: BaseProcess | None = None
        self._pipe: Connection | None = None
        # Starting a process and waiting for it block a thread.
        self._thread = ThreadPoolExecutor(1, "worker")
        self._ended = self._works = False

    @property
    def waits(self) -> bool:
        """Whether the process is there and has nothing to do."""
        return not self._works and self._alive() is not None

    async def run(self, message: Message, report: Callable[[bytes], None]) -> bytes | None:
        """The answer to a message, None if the work was ended; `report` is called with progress."""
        loop = asyncio.get_running_loop()
        self._ended, self._works = False, True
        try:
            pipe = self._alive()
            if pipe is None:
                pipe = await loop.run_in_executor(self._thread, self._started)
            if self._ended:  # meanwhile
                self.end()
                return None
            pipe.send(message)
            while True:
                last, data = await loop.run_in_executor(self._thread, pipe.recv)
                if last:
                    self._works = False
                    return data
                report(data)
        except (EOFError, OSError):
            self.end()
            return None

    def end(self) -> None:
        """End the process at once."""
        self._ended = True
        process, self._process = self._process, None
        if process is not None:
            process.kill()
            process.join()

    def close(self) -> None:
        """End the process, and accept no more work."""
        self.end()
        self._thread.shutdown(wait=False, cancel_futures=True)

    def _alive(self) -> Connection | None:
        alive = self._process is not None and self._process.is_alive()
        return self._pipe if alive else None

    def _started(self) -> Connection:
        apart = _apart()
        ours, theirs = apart.Pipe()
        process: BaseProcess = apart.Process(target=_work, args=(theirs, self._nice), daemon=True)
        process.start()
        self._process, self._pipe = process, ours
        theirs.close()
        return ours


class Workers:
    """Processes that closed pages leave to the next one, for each type one that waits for work."""

    def __init__(self) -> None:
        self._kept: dict[str, WorkerProcess] = {}

    def take(self, kind: str, nice: int = 5) -> WorkerProcess:
        """A process for this type, with what the last page had it load."""
        return self._kept.pop(kind, None) or WorkerProcess(nice)

    def leave(self, kind: str, worker: WorkerProcess) -> None:
        """Keep the process if it waits, and end it otherwise."""
        if worker.waits and kind not in self._kept:
            self._kept[kind] = worker
        else:
            worker.close()

    def close(self) -> None:
        """End all."""
        while self._kept:
            self._kept.popitem()[1].close()


def prepare() -> None:
    """Start the process from which workers are forked, if there is one."""
    if "forkserver" in multiprocessing.get_all_start_methods():
        _apart()
        from multiprocessing import forkserver

        with suppress(OSError):  # without it the server answers
            forkserver.ensure_running()


_WORKER = "stepwell.studio.worker"


def _apart() -> Any:
    # A fork of this process would copy locked locks of its threads: if possible, start
    # from a process without threads that has imported all packages and loaded machine code.
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    apart = multiprocessing.get_context("forkserver")
    apart.set_forkserver_preload([_WORKER])
    return apart


def _work(pipe: Connection, nice: int) -> None:
    import_module(_WORKER).work(pipe, nice)
