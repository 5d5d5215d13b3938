"""Parallel calls in processes of this machine or on a Dask cluster."""

import logging
import multiprocessing
import os
import signal
from collections import deque
from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import suppress
from itertools import islice
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any

from stepwell.base import StepwellError, need

# After this number of deaths of its process, a call fails.
DEATHS = 3
# Calls queued per thread of a cluster, and timeout of a scheduler's answer.
_AHEAD, _PATIENCE = 3, "10s"
_COMING = 60  # timeout of the first worker [s]


class WorkerError(StepwellError, RuntimeError):
    """A call whose process died every time, or an unreachable cluster."""


def mapped(
    call: Callable[..., Any], tasks: Iterable[Sequence[Any]], workers: int
) -> Generator[tuple[Sequence[Any], Exception | None]]:
    """Make calls in separate processes, and yield each when it ends with its exception or None.

    Args:
        call: importable function; its result is discarded.
        tasks: its arguments; read only as fast as the processes need them.
        workers: number of processes; 0 makes the calls in this process.
    """
    if workers == 0:
        yield from _here(call, tasks)
        return
    # Calls with the number of deaths of their process.
    left, dead = ((task, 0) for task in tasks), deque[tuple[Sequence[Any], int]]()
    busy: dict[Connection, tuple[BaseProcess, Sequence[Any], int]] = {}
    idle: list[tuple[BaseProcess, Connection]] = []
    try:
        while True:
            while len(busy) < workers and (more := dead.popleft() if dead else next(left, None)):
                process, pipe = idle.pop() if idle else _begun(call)
                task, deaths = more
                with suppress(OSError):  # the death of the process is handled below
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
                    raised = WorkerError(
                        f"its process died {DEATHS} times ({_exit_text(process)})."
                    )
                else:
                    idle.append((process, pipe))
                yield task, raised
    finally:
        _end([*idle, *((process, pipe) for pipe, (process, _, _) in busy.items())])


def _begun(call: Callable[..., Any]) -> tuple[BaseProcess, Connection]:
    apart = multiprocessing.get_context("spawn")
    ours, theirs = apart.Pipe()
    process = apart.Process(target=_work, args=(theirs, call), daemon=True)
    process.start()
    theirs.close()
    return process, ours


def _end(processes: Iterable[tuple[BaseProcess, Connection]]) -> None:
    for process, pipe in processes:
        pipe.close()
        process.kill()
        process.join()


def _here(
    call: Callable[..., Any], tasks: Iterable[Sequence[Any]]
) -> Generator[tuple[Sequence[Any], Exception | None]]:
    for task in tasks:
        try:
            call(*task)
        except Exception as error:
            yield task, error
        else:
            yield task, None


def mapped_on(
    address: str, call: Callable[..., Any], tasks: Iterable[Sequence[Any]]
) -> Generator[tuple[Sequence[Any], Exception | None]]:
    """Make calls on a Dask cluster, and yield each when it ends with its exception or None.

    A call whose worker dies is repeated on another one, as often as the scheduler allows.

    Args:
        address: of the scheduler, such as tcp://10.0.0.1:8786.
        call: function that the workers can import.
        tasks: its arguments; a few per thread are queued.

    Raises:
        WorkerError: no scheduler answers at the address, or the connection is lost.
        ExtraError: the extra cluster is not installed.
    """
    client = _client(address)
    from distributed import KilledWorker, as_completed

    with client:
        left, going = iter(tasks), dict[Any, Sequence[Any]]()
        ended = as_completed(loop=client.loop)
        while True:
            try:
                for task in islice(left, max(_room(client, address) - len(going), 0)):
                    future = client.submit(call, *task, pure=False)
                    going[future.key] = task
                    ended.add(future)
                if not going:
                    return
                future: Any = next(ended)
                gone = future.cancelled()
                raised = None if gone else future.exception()
            except (OSError, TimeoutError) as error:
                raise WorkerError(f"{address}: the scheduler does not answer ({error}).") from None
            if gone:
                raise WorkerError(f"{address}: the scheduler does not answer, or was shut down.")
            task = going.pop(future.key)
            if isinstance(raised, KilledWorker):
                raised = WorkerError(f"its worker died repeatedly ({raised}).")
            yield task, raised


def _client(address: str) -> Any:
    need("cluster")
    from distributed import Client

    # A lost connection is reported by the caller in one line.
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
    try:
        return Client(address, timeout=_PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        raise WorkerError(f"{address}: no Dask scheduler answers there ({error}).") from None


def _room(client: Any, address: str) -> int:
    """Largest number of queued calls; raises an error if no worker connects."""
    if not client.nthreads():
        try:
            client.wait_for_workers(1, timeout=_COMING)
        except TimeoutError:
            raise WorkerError(f"{address}: no worker connected within {_COMING} s.") from None
    return _AHEAD * max(sum(client.nthreads().values()), 1)


def dashboard(address: str) -> str:
    """Address of a Dask cluster's dashboard; errors are those of `mapped_on`."""
    with _client(address) as client:
        return client.dashboard_link or "none"


def _exit_text(process: BaseProcess) -> str:
    code = process.exitcode or 0
    if code < 0:
        return f"signal {-code}, {signal.Signals(-code).name}"
    return f"exit status {code}"


def _work(pipe: Connection, call: Callable[..., Any]) -> None:
    """Make one call after another until the pipe is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent handles Ctrl-C and ends this process
    # Each process has one core; threads of libraries would compete with the other processes.
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
    """The error, or its text if it cannot be pickled."""
    import pickle

    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return StepwellError(f"{type(error).__name__}: {error}")
    return error
