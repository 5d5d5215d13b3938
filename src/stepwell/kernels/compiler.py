"""Compilation of kernels in a separate process."""

import atexit
import gc
import json
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from types import FunctionType
from typing import Any

from stepwell.kernels import store

# Longest time that a compiler waits for another one.
_LONGEST = 120.0  # s
_START = (
    "import json, sys; sys.path[:] = json.loads(sys.argv[1]); "
    "from stepwell.kernels.compiler import main; main()"
)
_working: "list[subprocess.Popen[bytes]]" = []
# Whether to compile in this process: in the compiler itself, and if it cannot be started.
here = False


def begin(function: FunctionType, kinds: bytes) -> bool:
    """Start compiling a kernel for a kind of arguments in the background; returns whether it began.

    This process may end meanwhile; kernels that are still missing are compiled next time.
    """
    _working[:] = [process for process in _working if process.poll() is None]
    if _working or not _possible():
        return False
    process = _started(function, kinds, background=True)
    if process is not None:
        _working.append(process)
    return process is not None


@atexit.register
def _detach_compilers() -> None:
    """Detach running compilers, so that Python does not warn about them."""
    for process in _working:
        process.returncode = process.poll() or 0


def compile_elsewhere(function: FunctionType, kinds: bytes) -> bool:
    """Compile one kernel for one kind of arguments in another process; returns whether it did."""
    global here
    if not _possible():
        return False
    process = _started(function, kinds, background=False)
    if process is None:
        here = True
        return False
    try:
        try:
            process.wait(1.0)
        except subprocess.TimeoutExpired:
            store.notice(
                f"compiling {function.__name__.strip('_')}, once; kept in {store.folder()}"
            )
            while True:
                with suppress(subprocess.TimeoutExpired):
                    process.wait(0.1)
                    break
    except BaseException:
        process.kill()
        process.wait()
        raise
    if process.returncode == -signal.SIGINT:
        raise KeyboardInterrupt
    # If the other process fails, this one compiles.
    here = process.returncode != 0
    return not here


def _possible() -> bool:
    frozen = getattr(sys, "frozen", False)
    return not here and bool(sys.executable) and not frozen and store.folder() is not None


def _started(
    function: FunctionType, kinds: bytes, *, background: bool
) -> "subprocess.Popen[bytes] | None":
    place = store.folder()
    assert place is not None
    order = pickle.dumps((str(place), background, function.__module__, function.__name__, kinds))
    # The same import path as that of this process.
    path = json.dumps([str(folder) or os.getcwd() for folder in sys.path])
    # In the background it does not receive the Ctrl-C that ends its parent.
    apart = 0
    if background and sys.platform == "win32":
        apart = subprocess.CREATE_NEW_PROCESS_GROUP | subprocess.DETACHED_PROCESS
    try:
        process = subprocess.Popen(
            [sys.executable, "-c", _START, path],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            cwd=place,
            start_new_session=background,
            creationflags=apart,
        )
    except OSError:
        return None
    assert process.stdin is not None
    # If it has ended already, its exit status contains the reason.
    with suppress(OSError), process.stdin:
        process.stdin.write(order)
    return process


def main() -> None:
    """Compile the kernel that is named on standard input."""
    global here
    place, background, module, name, kinds = pickle.load(sys.stdin.buffer)
    here = True
    # Garbage collection is a tenth of the work, and this process ends soon.
    gc.disable()
    store.keep_in(Path(place))
    if not background:
        # Ctrl-C ends it at once; there is nothing to tidy up.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    with _one_at_a_time(Path(place)):
        _compile(module, name, kinds)


def _compile(module: str, name: str, kinds: bytes) -> None:
    from stepwell.kernels.fingerprint import kernel_of
    from stepwell.kernels.machine import machine

    numba: Any = import_module("numba")
    function = kernel_of(getattr(import_module(module), name))
    assert function is not None, name
    given = pickle.loads(kinds)
    kinds_of = (k if isinstance(k, numba.types.Type) else numba.typeof(k) for k in given)
    machine(function).compile(tuple(kinds_of))


@contextmanager
def _one_at_a_time(place: Path) -> Iterator[None]:
    """Wait while another process compiles, possibly the same kernel."""
    from filelock import FileLock, Timeout

    lock = FileLock(place / "compiling", timeout=_LONGEST, fallback_to_soft=False)
    # Without locks, and after that time, a kernel may be compiled twice, which does no harm.
    with suppress(OSError, NotImplementedError, Timeout):
        lock.acquire()
    try:
        yield
    finally:
        lock.release()
