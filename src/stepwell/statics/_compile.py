"""How every kernel is compiled: once, cached on disk, IEEE division."""

import contextlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., Any])

_PACKAGE = Path(__file__).parents[1]


def _forget_stale_machine_code() -> None:
    # Numba renews a cached kernel when its own file changes, not when a kernel that it calls
    # does. After an edit or an update in place that would run old physics, so the cache goes
    # whenever any source of the package is not the one it was made from.
    stamp = _PACKAGE / "statics" / "__pycache__" / "kernels.stamp"
    sources = sorted(p for room in ("mechanism", "statics", "design") for p in _files(room))
    now = "\n".join(f"{p.name} {p.stat().st_size} {p.stat().st_mtime_ns}" for p in sources)
    with contextlib.suppress(OSError):
        if stamp.exists() and stamp.read_text() == now:
            return
        for room in ("statics", "design"):
            for index in (_PACKAGE / room / "__pycache__").glob("*.nbi"):
                index.unlink(missing_ok=True)
        stamp.parent.mkdir(exist_ok=True)
        stamp.write_text(now)


def _files(room: str) -> list[Path]:
    """The source files of a room that may hold kernels or their formulas."""
    return [*(_PACKAGE / room).glob("_*.py"), *(_PACKAGE / room).glob("concave.py")]


_forget_stale_machine_code()


def kernel(function: F) -> F:
    """Compile `function` at its first call and keep the machine code on disk."""
    return cast(F, numba.njit(cache=True, error_model="numpy")(function))
