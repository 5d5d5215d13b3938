"""Records that kernels pass by reference instead of array by array."""

import hashlib
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.datamodel import models
from numba.core.imputils import impl_ret_borrowed, lower_getattr_generic
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import NativeValue, intrinsic, register_model, typeof_impl, unbox

from stepwell.kernels.fingerprint import is_record


class Reference(types.Type):
    """Type of a pointer to a record: its class, and the types of its fields."""

    def __init__(self, kind: type, held: tuple[types.Type, ...]) -> None:
        self.kind, self.held = kind, held
        # The name is part of every symbol: short, and different for other arrays.
        named = f"{kind.__module__}.{kind.__qualname__}{held}"
        super().__init__(f"{kind.__name__}.{hashlib.sha256(named.encode()).hexdigest()[:12]}")

    def place(self, field: str) -> int:
        """The number of a field."""
        fields: tuple[str, ...] = self.kind._fields  # type: ignore[attr-defined]
        return fields.index(field)


_typeof_tuple: Any = typeof_impl.dispatch(tuple)


@typeof_impl.register(tuple)
def _typeof(value: tuple[Any, ...], c: Any) -> Any:
    if not is_record(type(value)):
        return _typeof_tuple(value, c)
    return Reference(type(value), tuple(typeof_impl(item, c) for item in value))


@register_model(Reference)
class _Model(models.PrimitiveModel):
    """A pointer to the values; a record in a record is a pointer in turn."""

    def __init__(self, manager: Any, kind: Reference) -> None:
        held = [manager[one].get_value_type() for one in kind.held]
        super().__init__(manager, kind, ir.LiteralStructType(held).as_pointer())


@infer_getattr
class _Fields(AttributeTemplate):
    key = Reference

    def generic_resolve(self, record: Reference, field: str) -> types.Type | None:
        if field not in record.kind._fields:  # type: ignore[attr-defined]
            return None
        return record.held[record.place(field)]


@lower_getattr_generic(Reference)
def _get(context: Any, builder: Any, record: Reference, where: Any, field: str) -> Any:
    place = record.place(field)
    value = builder.load(cgutils.gep_inbounds(builder, where, 0, place))
    return impl_ret_borrowed(context, builder, record.held[place], value)


def _frame_memory(context: Any, builder: Any, record: Reference) -> Any:
    """Memory for a record in the frame of the function that is being compiled."""
    return cgutils.alloca_once(builder, context.get_value_type(record).pointee)


@unbox(Reference)
def _unbox(record: Reference, value: Any, c: Any) -> NativeValue:
    where = _frame_memory(c.context, c.builder, record)
    failed: Any = cgutils.false_bit
    cleanups = []
    for place, kind in enumerate(record.held):
        native = c.unbox(kind, c.pyapi.tuple_getitem(value, place))
        c.builder.store(native.value, cgutils.gep_inbounds(c.builder, where, 0, place))
        failed = c.builder.or_(failed, native.is_error)
        cleanups.append((place, kind, native.cleanup))

    def cleanup() -> None:
        for place, kind, own in cleanups:
            if own is not None:
                own()
            if c.context.enable_nrt:
                held = c.builder.load(cgutils.gep_inbounds(c.builder, where, 0, place))
                c.context.nrt.decref(c.builder, kind, held)

    return NativeValue(where, is_error=failed, cleanup=cleanup)


def record_maker(kind: type) -> Any:
    """Intrinsic that makes a record of a class in compiled code.

    The record ends with the function that makes it, which therefore may not return it.
    """

    @intrinsic
    def make(typingctx: Any, *values: Any) -> Any:
        record = Reference(kind, tuple(values))

        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            where = _frame_memory(context, builder, record)
            for place, value in enumerate(cgutils.unpack_tuple(builder, args[0])):
                builder.store(value, cgutils.gep_inbounds(builder, where, 0, place))
            return where

        return record(types.StarArgTuple(values)), generate

    return make
