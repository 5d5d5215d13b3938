"""The process that answers panels: imported there alone, with all packages and machine code.

The server starts it in advance. Each worker is a copy of one process that has imported this file,
or imports it at its start where processes cannot be copied.
"""

import gc
import os
import signal
from contextlib import suppress
from importlib import import_module
from multiprocessing.connection import Connection
from time import monotonic

from stepwell.kernels import stay
from stepwell.studio.aside import answered, report_error, warm
from stepwell.studio.ask import Ask, View
from stepwell.studio.message import Message, partial_answer, progress_message

# Panels whose packages are imported once for all workers.
_USED = "designs", "maps", "motion", "targets"
# Seconds between two reports of progress.
_EVERY = 0.1


def work(pipe: Connection, nice: int) -> None:
    """Answer one message after another until the studio ends.

    Args:
        pipe: to the server.
        nice: by how much the priority is lower than that of the server.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the studio handles Ctrl-C and ends this process
    if hasattr(os, "nice"):
        os.nice(nice)
    with suppress(EOFError, OSError):
        while True:
            _answer(pipe.recv(), pipe)


def _answer(message: Message, pipe: Connection) -> None:
    reported_at = monotonic()

    def report(done: float, total: float) -> None:
        nonlocal reported_at
        now = monotonic()
        if now - reported_at >= _EVERY:
            reported_at = now
            pipe.send((False, progress_message(message.type, message.seq, done, total)))

    def show(view: View) -> None:
        pipe.send((False, partial_answer(message.type, message.seq, view)))

    pipe.send((True, answered(message, Ask(message.ask, report, show, message.studies))))


def _load() -> None:
    """Import all packages, and load compiled code before the first drag."""
    try:
        stay()
        warm()
        for name in _USED:
            import_module(f"stepwell.studio.panels.{name}")
    except Exception as error:  # the first answer is slower
        report_error(error)
    # What is imported stays: a collection in the middle of a drag does not look through it.
    gc.freeze()


_load()
