"""Calls spread over processes of this machine; a process that dies takes one call with it."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any

from stepwell.base import StepwellError

# A call whose process dies so often is what kills it.
DEATHS = 3


class WorkerError(StepwellError):
    """A call whose process died every time."""


def mapped(
    call: Callable[..., Any], tasks: Iterable[Sequence[Any]], workers: int
) -> Iterator[tuple[Sequence[Any], Exception | None]]:
    """Make calls in processes of their own, and tell each as it ends.

    Args:
        call: importable; what it returns is not told.
        tasks: its arguments; as many are waiting as there are processes, and no more.
        workers: processes at once, 1 or more.

    Yields:
        The arguments of a call that has ended, and what it raised.
    """
    apart = multiprocessing.get_context("spawn")
    left, dead = iter(tasks), deque[tuple[Sequence[Any], int]]()
    busy: dict[Connection, tuple[BaseProcess, Sequence[Any], int]] = {}
    idle: list[tuple[BaseProcess, Connection]] = []

    def begun() -> tuple[BaseProcess, Connection]:
        ours, theirs = apart.Pipe()
        process = apart.Process(target=_work, args=(theirs, call), daemon=True)
        process.start()
        theirs.close()
        return process, ours

    def after() -> tuple[Sequence[Any], int] | None:
        if dead:
            return dead.popleft()
        task = next(left, None)
        return None if task is None else (task, 0)

    try:
        while True:
            while len(busy) < workers and (more := after()) is not None:
                process, pipe = idle.pop() if idle else begun()
                task, deaths = more
                with suppress(OSError):  # its end is heard below
                    pipe.send(tuple(task))
                busy[pipe] = process, task, deaths
            if not busy:
                return
            for pipe in wait(list(busy)):
                assert isinstance(pipe, Connection)
                process, task, deaths = busy.pop(pipe)
                try:
                    raised = pipe.recv()
                except (EOFError, OSError):
                    process.join()
                    pipe.close()
                    if deaths + 1 < DEATHS:
                        dead.append((task, deaths + 1))
                        continue
                    raised = WorkerError(f"its process died {DEATHS} times ({_told(process)}).")
                else:
                    idle.append((process, pipe))
                yield task, raised
    finally:
        for process, pipe in [*idle, *((one, pipe) for pipe, (one, _, _) in busy.items())]:
            pipe.close()
            process.kill()
            process.join()


def _told(process: BaseProcess) -> str:
    code = process.exitcode or 0
    if code < 0:
        return f"signal {-code}, {signal.Signals(-code).name}"
    return f"exit status {code}"


def _work(pipe: Connection, call: Callable[..., Any]) -> None:
    """Make one call after another until nobody asks any more."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for who asked, who then ends this
    # Each process has one core; libraries that start threads would take those of the others.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    with suppress(EOFError, OSError):
        while True:
            task = pipe.recv()
            try:
                call(*task)
            except Exception as error:
                pipe.send(_sendable(error))
            else:
                pipe.send(None)


def _sendable(error: Exception) -> Exception:
    """The error, or its words where it cannot leave its process."""
    import pickle

    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return StepwellError(f"{type(error).__name__}: {error}")
    return error
