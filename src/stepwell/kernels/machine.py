"""Machine code of kernels: looked up on disk, else made by a process of its own."""

import builtins
import hashlib
import pickle
from types import FunctionType
from typing import Any

import numba
from numba.core import cgutils, types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, CompileResult
from numba.core.serialize import dumps
from numba.extending import intrinsic

from stepwell.kernels import compiler, store
from stepwell.kernels.fingerprint import is_leaf, kernel_of, names_of, stem

_MADE: dict[FunctionType, Any] = {}
_LENT: dict[FunctionType, Any] = {}


def lent(function: FunctionType) -> Any:
    """Numba's dispatcher of an entry, whose arrays belong to the Python code that calls it.

    Python holds them until the entry returns, and an entry returns numbers alone: so no kernel has
    to count references to them. Counting is an atomic operation each time that a record of arrays
    is passed on, which took four fifths of the time of a chain of two cells.
    """
    if function not in _LENT:
        code = function.__code__
        names = code.co_varnames[: code.co_argcount]
        scope: dict[str, Any] = {"inner": machine(function), "lend": _lend}
        handed = ", ".join(f"lend({name})" for name in names)
        exec(f"def made({', '.join(names)}): return inner({handed})", scope)
        made = scope["made"]
        made.__name__, made.__qualname__ = (f"lent_{function.__name__.strip('_')}",) * 2
        made.__module__, made.__defaults__ = function.__module__, function.__defaults__
        options: dict[str, Any] = {"error_model": "numpy", "nogil": True}
        dispatcher: Any = numba.njit(**options, pipeline_class=_Whole)(made)
        if hasattr(dispatcher, "_cache"):
            dispatcher._cache = _Kept(function, "whole")
        _LENT[function] = dispatcher
    return _LENT[function]


class _Whole(Compiler):
    """Compiles an entry with all kernels that it calls as one program.

    Numba keeps every kernel as others may call it, with all arrays of a record among its arguments,
    some 400 numbers, whatever it uses of them. What only this entry calls need not be kept so: then
    LLVM passes on what is used. That halves the time of a chain of a few cells.
    """

    def __init__(self, typing: Any, target: Any, library: Any, *rest: Any) -> None:
        assert library is None
        whole = _Library(target.codegen(), "entry")
        whole.enable_object_caching()
        super().__init__(typing, target, whole, *rest)


class _Library(JITCodeLibrary):
    def _optimize_final_module(self) -> None:
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage.name == "linkonce_odr":
                function.linkage = "internal"
        super()._optimize_final_module()


def _without_owner(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    """The same arrays, with nothing to count references in."""
    if isinstance(kind, types.Array):
        array = context.make_array(kind)(context, builder, value=value)
        array.meminfo = cgutils.get_null_value(array.meminfo.type)
        array.parent = cgutils.get_null_value(array.parent.type)
        return array._getvalue()
    if isinstance(kind, types.BaseTuple):
        members: Any = kind
        parts = zip(members, cgutils.unpack_tuple(builder, value), strict=True)
        made = [_without_owner(context, builder, *part) for part in parts]
        return context.make_tuple(builder, kind, made)
    return value


@intrinsic
def _lend(typing: Any, value: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return _without_owner(context, builder, signature.args[0], arguments[0])

    return value(value), generate


def machine(function: FunctionType) -> Any:
    """Numba's dispatcher of a kernel, with dispatchers in place of the kernels that it calls."""
    if function not in _MADE:
        names = names_of(function.__code__) & function.__globals__.keys()
        scope: dict[str, Any] = {"__builtins__": builtins, "__name__": function.__module__}
        for name in names:
            value = function.__globals__[name]
            inner = kernel_of(value)
            scope[name] = value if inner is None else machine(inner)
        bound = FunctionType(function.__code__, scope, function.__name__, function.__defaults__)
        bound.__qualname__, bound.__module__ = function.__qualname__, function.__module__
        options: dict[str, Any] = {"error_model": "numpy", "nogil": True}
        # An option that Numba does not list: whether references are counted.
        options["_nrt"] = not is_leaf(function)
        dispatcher: Any = numba.njit(**options)(bound)
        if hasattr(dispatcher, "_cache"):  # not where Numba itself is switched off
            dispatcher._cache = _Kept(function)
        _MADE[function] = dispatcher
    return _MADE[function]


class _Kept:
    """What Numba asks for compiled code before it compiles, and hands it to afterwards."""

    cache_path = None

    def __init__(self, function: FunctionType, how: str = "") -> None:
        self.function, self.how = function, how

    def _name(self, sig: Any, context: Any) -> str:
        key = f"{self.how} {_kinds(sig)} {context.codegen().magic_tuple()}".encode()
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
            # Whole, and yet not what this Numba can read.
            store.say(f"the compiled kernel {name} cannot be used ({error}); it is made again.")
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        if not data.library.has_dynamic_globals and not data.lifted:
            store.write(self._name(sig, data.target_context), dumps(data._reduce()))

    def enable(self) -> None:
        pass

    def disable(self) -> None:
        pass

    def flush(self) -> None:
        pass


def _kinds(sig: Any) -> tuple[Any, ...]:
    """The types of the arguments; Numba hands them over with the result's type or without."""
    return tuple(getattr(sig, "args", sig))
