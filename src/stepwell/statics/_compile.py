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
    # does. After an edit or an update in place that would run old physics, so a room's cache
    # goes whenever a source is not the one it was made from: its own, or one of a room above.
    sources = sorted(p for room in ("mechanism", "statics") for p in _kernels(room))
    _keep_only_if_made_from("statics", sources)
    _keep_only_if_made_from("design", [*sources, *sorted(_kernels("design"))])


def _keep_only_if_made_from(room: str, sources: list[Path]) -> None:
    cache = _PACKAGE / room / "__pycache__"
    stamp = cache / "kernels.stamp"
    now = "\n".join(f"{p.name} {p.stat().st_size} {p.stat().st_mtime_ns}" for p in sources)
    with contextlib.suppress(OSError):
        if stamp.exists() and stamp.read_text() == now:
            return
        for index in cache.glob("*.nbi"):
            index.unlink(missing_ok=True)
        cache.mkdir(exist_ok=True)
        stamp.write_text(now)


def _kernels(room: str) -> list[Path]:
    """The source files of a room that hold kernels or their formulas."""
    if room == "mechanism":
        return [_PACKAGE / room / "_geometry.py"]
    marks = ("@kernel", "@numba", "= kernel(")
    return [
        p for p in (_PACKAGE / room).glob("*.py") if any(m in p.read_text("utf-8") for m in marks)
    ]


_forget_stale_machine_code()


def kernel(function: F) -> F:
    """Compile `function` at its first call and keep the machine code on disk."""
    return cast(F, numba.njit(cache=True, error_model="numpy", nogil=True)(function))
