"""The compiler process: reads what is wanted, compiles it, keeps it."""

import os
import pickle
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import Any

from stepwell.kernels import compiler as _compiler, store


def main() -> None:
    """Compile what standard input asks for."""
    place, background, module, name, kinds = pickle.load(sys.stdin.buffer)
    _compiler.here = True
    store.keep_in(Path(place))
    if not background:
        # Ctrl-C ends it at once; there is nothing to tidy up.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        _compile(module, name, kinds)
        return
    with _signed(Path(place)) as alone:
        if alone:
            _compile(module, name, kinds)


def _compile(module: str, name: str, kinds: bytes) -> None:
    import numba

    from stepwell.kernels.fingerprint import kernel_of
    from stepwell.kernels.machine import machine

    function = kernel_of(getattr(import_module(module), name))
    assert function is not None, name
    machine(function).compile(tuple(_type(numba, kind) for kind in pickle.loads(kinds)))


def _type(numba: Any, kind: Any) -> Any:
    return kind if isinstance(kind, numba.types.Type) else numba.typeof(kind)


@contextmanager
def _signed(place: Path) -> Iterator[bool]:
    """Show that a background compiler is at work; whether there was none before."""
    sign = _compiler.sign_in(place)
    if _compiler.busy():
        yield False
        return
    with suppress(OSError):
        sign.write_text(str(os.getpid()))
    done = threading.Event()

    def show() -> None:
        while not done.wait(5.0):
            with suppress(OSError):
                os.utime(sign)

    threading.Thread(target=show, daemon=True).start()
    try:
        yield True
    finally:
        done.set()
        with suppress(OSError):
            sign.unlink()
