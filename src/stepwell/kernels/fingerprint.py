"""Fingerprints of kernels: a hash of their code, of all that they call, and of constants."""

import hashlib
import sys
from collections.abc import Callable
from functools import cache
from importlib.metadata import version
from pathlib import Path
from platform import machine, processor
from types import CodeType, FunctionType, ModuleType
from typing import Any, TypeVar, cast

import numpy as np

F = TypeVar("F", bound=Callable[..., Any])
R = TypeVar("R", bound=type)

_KERNELS: set[FunctionType] = set()
LEAVES: set[FunctionType] = set()
CALLED: set[FunctionType] = set()
_RECORDS: set[type] = set()


def kernel(function: F) -> F:
    """Mark a function as one that can be compiled into its callers; returns it unchanged."""
    _KERNELS.add(cast(FunctionType, function))
    return function


def leaf(function: F) -> F:
    """Mark a kernel that makes no array and calls only leaves: compiled without reference counts.

    Machine code counts references to every array that it gets or takes out of a record, with an
    atomic operation each, which costs more than the arithmetic of a few cells. A kernel that makes
    no array owns none, so it need not count.
    """
    LEAVES.add(cast(FunctionType, function))
    return kernel(function)


def called(function: F) -> F:
    """Mark a kernel that Python calls: its machine code accepts Python values."""
    CALLED.add(cast(FunctionType, function))
    return kernel(function)


def record(kind: R) -> R:
    """Mark a named tuple that kernels get by reference; returns it unchanged.

    Machine code passes an array as seven numbers or more, so a chain of some 30 arrays was 300
    numbers, copied at every call. A leaf may make such a record for its callees, but not return
    one: it ends with the leaf that made it.
    """
    _RECORDS.add(kind)
    return kind


def is_record(kind: Any) -> bool:
    """Whether a class is marked as a record."""
    return isinstance(kind, type) and kind in _RECORDS


def kernel_of(value: Any) -> FunctionType | None:
    """The function behind a kernel or an entry, or None for anything else."""
    function = getattr(value, "function", value)
    return function if isinstance(function, FunctionType) and function in _KERNELS else None


def named_by(function: FunctionType) -> dict[str, Any]:
    """Every value that a function names outside itself, by its name.

    Values in a module of this package have names such as "geometry.sine_at"; modules in it have no
    names, so machine code cannot use values two levels away.
    """
    names = _names(function.__code__)
    values: dict[str, Any] = {}
    for name in names & function.__globals__.keys():
        value = function.__globals__[name]
        if isinstance(value, ModuleType) and _is_ours(value):
            inside = {one: getattr(value, one) for one in names & vars(value).keys()}
            values |= {
                f"{name}.{one}": inner
                for one, inner in inside.items()
                if not isinstance(inner, ModuleType)
            }
        else:
            values[name] = value
    return values


def _is_ours(module: ModuleType) -> bool:
    return module.__name__.partition(".")[0] == __name__.partition(".")[0]


def _names(code: CodeType) -> set[str]:
    """Names and attributes that code reads, inner functions included."""
    names = set(code.co_names)
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            names |= _names(inner)
    return names


def fingerprint(function: FunctionType, known: dict[FunctionType, str] | None = None) -> str:
    """A hash of everything that determines the machine code of a kernel, as 32 hex digits.

    It includes byte code and constants of the kernel and of every kernel that it calls, the values
    of the globals that they read, the versions of Python, Numba and NumPy, and the kind of
    processor. It includes no times and no paths: the same formulas have the same fingerprint in
    every installation. Anything that is neither a kernel nor a constant raises TypeError.
    """
    known = {} if known is None else known
    if function not in known:
        known[function] = "itself"
        # The machine code names the modules of what it was made from.
        parts = [_surroundings(), f"{function.__module__} {function.__qualname__}"]
        parts += [_code(function.__code__), repr(function.__defaults__)]
        parts.append(f"{function in LEAVES} {function in CALLED}")
        named = sorted(named_by(function).items())
        parts += [f"{name} = {_value(value, known)}" for name, value in named]
        known[function] = hashlib.sha256("\n".join(parts).encode()).hexdigest()[:32]
    return known[function]


def stem(function: FunctionType) -> str:
    """First part of the names of a kernel's files."""
    return f"{function.__name__.strip('_')}-{fingerprint(function)}"


def _code(code: CodeType) -> str:
    constants = [_code(c) if isinstance(c, CodeType) else _constant(c) for c in code.co_consts]
    names = (code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars)
    return f"{code.co_name} {code.co_argcount} {code.co_code.hex()} {names} {constants}"


def _constant(value: Any) -> str:
    return repr(sorted(map(repr, value))) if isinstance(value, frozenset) else repr(value)


def _value(value: Any, known: dict[FunctionType, str]) -> str:
    function = kernel_of(value)
    if function is not None:
        return fingerprint(function, known)
    if isinstance(value, np.ndarray):
        return f"{value.dtype} {value.shape} {hashlib.sha256(value.tobytes()).hexdigest()}"
    if isinstance(value, ModuleType):
        return value.__name__
    if isinstance(value, type):
        fields = getattr(value, "_fields", "")
        return f"{value.__module__}.{value.__qualname__} {fields} {is_record(value)}"
    if isinstance(value, (bool, int, float, str, tuple, type(None))):
        return repr(value)
    if not isinstance(value, FunctionType) and hasattr(value, "__name__"):
        return str(value.__name__)  # something built into Python or NumPy
    raise TypeError(
        f"a kernel uses {value!r}: it may use kernels, entries, numbers, arrays and named tuples."
    )


@cache
def _surroundings() -> str:
    from stepwell.base import __version__

    versions = [f"{name} {version(name)}" for name in ("numba", "llvmlite", "numpy")]
    return f"stepwell {__version__} {sys.implementation.cache_tag} {versions} {_processor()}"


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8", errors="replace").splitlines()
        traits = [line for line in lines if line.startswith(("model name", "flags", "Features"))]
        return f"{machine()} {sorted(set(traits))}"
    except OSError:
        return f"{machine()} {processor()}"
