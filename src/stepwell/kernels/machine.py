"""Machine code of kernels: read from disk, else compiled by a separate process."""

import builtins
import hashlib
import pickle
from types import FunctionType, ModuleType
from typing import Any

import numba
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from stepwell.kernels import compiler, reference, store
from stepwell.kernels.fingerprint import CALLED, LEAVES, is_record, kernel_of, named_by, stem

_MADE: dict[FunctionType, Any] = {}


def machine(function: FunctionType) -> Any:
    """Numba's dispatcher of an entry; only an entry's code accepts Python values."""
    if function not in CALLED:
        raise TypeError(f"{function.__qualname__} is not an entry: only other kernels can call it.")
    return _dispatcher(function)


def _dispatcher(function: FunctionType) -> Any:
    """Numba's dispatcher of a kernel, with dispatchers in place of the kernels that it calls."""
    if function not in _MADE:
        scope: dict[str, Any] = {"__builtins__": builtins, "__name__": function.__module__}
        for name, value in named_by(function).items():
            module, _, inside = name.rpartition(".")
            place = vars(scope.setdefault(module, ModuleType(module))) if module else scope
            place[inside] = _machine_form(function, value)
        bound = FunctionType(function.__code__, scope, function.__name__, function.__defaults__)
        bound.__qualname__, bound.__module__ = function.__qualname__, function.__module__
        options: dict[str, Any] = {"error_model": "numpy", "nogil": True}
        # Wrappers for values of Python and of C are compiled only where they are used: for all
        # kernels they would take more than half as long as the rest.
        options |= {"no_cpython_wrapper": function not in CALLED, "no_cfunc_wrapper": True}
        # An option that Numba does not list: whether references are counted.
        options["_nrt"] = function not in LEAVES
        dispatcher: Any = numba.njit(**options)(bound)
        if hasattr(dispatcher, "_cache"):  # not where Numba itself is switched off
            dispatcher._cache = _CodeCache(function)
        _MADE[function] = dispatcher
    return _MADE[function]


def _machine_form(function: FunctionType, value: Any) -> Any:
    """Replacement in machine code for a value that the kernel names."""
    if is_record(value):
        if function not in LEAVES:
            raise TypeError(
                f"{function.__qualname__} makes the record {value.__name__}, which only a leaf "
                "may: the arrays of a kernel that counts references may be gone before the record."
            )
        return reference.record_maker(value)
    inner = kernel_of(value)
    return value if inner is None else _dispatcher(inner)


class _CodeCache:
    """Cache of compiled code with the interface that Numba expects."""

    cache_path = None

    def __init__(self, function: FunctionType) -> None:
        self.function = function

    def _name(self, sig: Any, context: Any) -> str:
        key = f"{_kinds(sig)} {context.codegen().magic_tuple()}".encode()
        return f"{stem(self.function)}-{hashlib.sha256(key).hexdigest()[:16]}"

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        target_context.refresh()
        name = self._name(sig, target_context)
        payload = store.read(name)
        if payload is None and compiler.compile_elsewhere(self.function, dumps(_kinds(sig))):
            payload = store.read(name)
        if payload is None:
            return None
        try:
            return CompileResult._rebuild(target_context, *pickle.loads(payload))
        except Exception as error:
            # Undamaged, but unreadable by this version of Numba.
            store.notice(f"the compiled kernel {name} cannot be used ({error}); it is made again.")
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        if not data.library.has_dynamic_globals and not data.lifted:
            store.write(self._name(sig, data.target_context), dumps(data._reduce()))

    def enable(self) -> None:
        pass

    disable = flush = enable


def _kinds(sig: Any) -> tuple[Any, ...]:
    """The types of the arguments; Numba passes them with or without the type of the result."""
    return tuple(getattr(sig, "args", sig))
