"""Long computations in a separate process that can be ended at any time."""

import asyncio
import multiprocessing
import os
import signal
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from time import monotonic
from typing import Any

from stepwell.studio.answering import answered
from stepwell.studio.ask import Ask, View
from stepwell.studio.message import Message, partial_answer, progress_message

# What long answers need, imported once for all of them.
_USED = "stepwell.design", "stepwell.accounts", "scipy.stats", "scipy.optimize", "xarray", "numba"
# Seconds between two reports of progress.
_EVERY = 0.1


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
