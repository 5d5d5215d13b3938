"""Kernels that Python code calls: interpreted at first, compiled for long work."""

import functools
import os
import pickle
import sys
from collections.abc import Callable
from time import monotonic, thread_time
from types import FunctionType
from typing import Any, Generic, ParamSpec, TypeVar, cast

import numpy as np

from stepwell.base import SettingError
from stepwell.kernels.fingerprint import called, stem

P = ParamSpec("P")
R = TypeVar("R")

# Times of the processor: on a busy machine the wall clock also counts idle time.
# Total interpreted time of all entries after which the compiler is loaded, which machine code on
# disk needs too; loading it takes this long.
WORTH_LOADING = 0.5  # s
# Interpreted time after which an entry uses machine code on disk, if the compiler is loaded.
_WORTH_CHANGING = 0.1  # s
# Interpreted time after which an entry is compiled in the background.
_WORTH_COMPILING = 1.0  # s
# Expected time of one call above which it waits for the compiler.
_WORTH_WAITING = 5.0  # s
_LOOK_AGAIN = 0.25  # s
# A long-lived process uses machine code from the first call on.
_long_lived = False
# A process that must answer at once leaves machine code to another one.
_left_to_others = False
# Interpreted time of all entries [s].
_interpreted_for = 0.0

AUTO, INTERPRETED, COMPILED = "auto", "interpreted", "compiled"


def _requested_mode() -> str:
    named = os.environ.get("STEPWELL_KERNELS", AUTO)
    if named not in (AUTO, INTERPRETED, COMPILED):
        raise SettingError(
            f"STEPWELL_KERNELS = {named!r}: must be auto (the default), interpreted or compiled."
        )
    return INTERPRETED if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0") else named


class Entry(Generic[P, R]):
    """A kernel that Python code calls; see `entry`."""

    def __init__(self, function: Callable[P, R], seconds: float, of: tuple[str, ...]) -> None:
        functools.update_wrapper(self, function)
        self.function, self._kernel = called(function), cast(FunctionType, function)
        names = self._kernel.__code__.co_varnames
        self._seconds = seconds
        self._sized = [(names.index(a), b) for a, _, b in (name.partition(".") for name in of)]
        self._spent = 0.0
        self._machine: Callable[P, R] | None = None
        self._looked = self._asked = -np.inf
        self._tries, self._ready = 3, False

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        """The result of the function for these numbers and arrays."""
        global _interpreted_for
        if self._machine is not None:
            return self._machine(*args, **kwargs)
        if self._worth_compiling(*args):
            return self.compiled()(*args, **kwargs)
        begun = thread_time()
        try:
            # Machine code divides by zero as in IEEE arithmetic, without a warning.
            with np.errstate(all="ignore"):
                return _plain(self.function(*args, **kwargs))
        finally:
            seconds = thread_time() - begun
            self._spent += seconds
            _interpreted_for += seconds

    @property
    def interpreted(self) -> bool:
        """Whether it does not use machine code yet."""
        return self._machine is None

    def compiled(self) -> Callable[P, R]:
        """Its machine code, loaded or compiled at the first call."""
        if self._machine is None:
            from stepwell.kernels.machine import machine

            self._machine = made = machine(self._kernel)
            return made
        return self._machine

    def block(self, size: int, *args: Any) -> int:
        """Block size for `size` items with these arguments.

        All items for machine code; a fortieth for interpreted code, which takes turns and has to
        react to Ctrl-C.
        """
        if self._machine is None and self._worth_compiling(*args):
            self.compiled()
        return size if self._machine is not None else max(1, size // 40)

    def ready(self) -> bool:
        """Whether its machine code is on disk."""
        if not self._ready and monotonic() - self._looked > _LOOK_AGAIN:
            from stepwell.kernels import store

            self._looked = monotonic()
            self._ready = store.holds(stem(self._kernel))
        return self._ready

    def ask_for_machine_code(self, *args: Any) -> None:
        """Start to compile it for arguments like these in the background."""
        from stepwell.kernels import compiler as _compiler

        if self._tries == 0 or monotonic() - self._asked < _LOOK_AGAIN:
            return
        self._asked = monotonic()
        kinds = pickle.dumps(tuple(_example(value) for value in args))
        self._tries -= _compiler.begin(self._kernel, kinds)

    def _worth_compiling(self, *args: Any) -> bool:
        wanted = _requested_mode()
        if wanted != AUTO:
            return wanted == COMPILED
        if _left_to_others:
            return False
        price = self._seconds
        for place, field in self._sized:
            array = args[place]
            price *= (getattr(array, field) if field else array).size
        if not _long_lived:
            loaded = "stepwell.kernels.machine" in sys.modules
            spent, least = self._spent, _WORTH_CHANGING
            if not loaded:
                spent, least = _interpreted_for, WORTH_LOADING
            if spent + price < least:
                return False
        if price > _WORTH_WAITING or self.ready():
            return True
        if self._spent > _WORTH_COMPILING:
            self.ask_for_machine_code(*args)
        return False


def stay() -> None:
    """From now on use machine code that is on disk from the first call of every kernel."""
    global _long_lived
    _long_lived = True


def interpret() -> None:
    """From now on never wait for the compiler in this process."""
    global _left_to_others
    _left_to_others = True


def entry(seconds: float = 0.0, *of: str) -> Callable[[Callable[P, R]], Entry[P, R]]:
    """Mark a kernel as one that Python code calls.

    Its first calls are interpreted. It uses machine code on disk when entries have been interpreted
    for half a second of processor time, the time of loading the compiler. After a second it is
    compiled in the background. Interpreted and compiled, it gives the same bits.

    `seconds` is the interpreted time per element of the arrays `of`: arguments, or fields of them
    as in "laws.lever", whose sizes are multiplied. A call of more than a few seconds waits for the
    compiler.
    """
    return lambda function: Entry(function, seconds, of)


def _plain(result: Any) -> Any:
    """The result with Python numbers instead of NumPy's, as machine code returns them."""
    if isinstance(result, np.generic):
        return result.item()
    if type(result) is tuple:
        return tuple(_plain(value) for value in result)
    if result is None or isinstance(result, (bool, int, float)):
        return result
    # Machine code makes other results by running Python, where Ctrl-C would end the process.
    raise TypeError(f"an entry returns numbers and fills arrays, and not {type(result).__name__}.")


def _example(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return np.empty((0,) * value.ndim, value.dtype)
    if isinstance(value, tuple):
        values = [_example(item) for item in value]
        return type(value)(*values) if hasattr(value, "_fields") else tuple(values)
    return value
