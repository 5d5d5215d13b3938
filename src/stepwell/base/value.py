"""Equality and hashes of values, arrays included."""

import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, TypeGuard

from stepwell.base.shown import Shown, brief

if TYPE_CHECKING:
    import numpy as np


class ByValue(Shown):
    """A frozen dataclass that equals another if all their fields are equal.

    Arrays are compared number by number, and NaN equals NaN: a result equals its copy, its
    unpickled copy, and the result of the same call. Equal values have equal hashes. To be used with
    `@dataclass(frozen=True, eq=False)`; with `repr=False` too, its representation is `brief`.
    """

    __slots__ = ()

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return self is other or deep_equal(_held(self), _held(other))

    def __hash__(self) -> int:
        return hash((type(self).__qualname__, _digest(_held(self, hashed=True))))

    def __repr__(self):
        return brief(self)


class ReadOnly(Mapping[str, Any]):
    """An immutable mapping that can be copied and pickled."""

    __slots__ = ("_held",)

    def __init__(self, held: Mapping[str, Any]):
        self._held = dict(held)

    def __getitem__(self, key: str) -> Any:
        return self._held[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._held)

    def __len__(self) -> int:
        return len(self._held)

    def __repr__(self):
        return repr(self._held)


def deep_equal(a: Any, b: Any) -> bool:
    """Whether two values of any kind are equal, arrays and containers of arrays included."""
    if a is b:
        return True
    if is_array(a) or is_array(b):
        return _same_arrays(a, b)
    if isinstance(a, float) and isinstance(b, float):
        return a == b or (math.isnan(a) and math.isnan(b))
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return _same_mappings(a, b)
    if type(a) is not type(b):
        return bool(a == b)
    if isinstance(a, tuple | list):
        return len(a) == len(b) and all(map(deep_equal, a, b))
    if is_dataclass(a) and not isinstance(a, ByValue):
        return deep_equal(_held(a), _held(b))
    return bool(a == b)


def is_array(value: Any) -> "TypeGuard[np.ndarray[Any, Any]]":
    """Whether it is an array of NumPy, tested without the slow import of NumPy."""
    numpy = sys.modules.get("numpy")
    return numpy is not None and isinstance(value, numpy.ndarray)


def _same_mappings(a: Mapping[Any, Any], b: Mapping[Any, Any]) -> bool:
    return a.keys() == b.keys() and all(deep_equal(a[key], b[key]) for key in a)


def _same_arrays(a: Any, b: Any) -> bool:
    if not (is_array(a) and is_array(b)):
        return False
    if a.shape != b.shape or a.dtype.kind != b.dtype.kind:
        return False
    if a.dtype.kind == "O":
        return all(map(deep_equal, a.ravel(), b.ravel()))
    import numpy as np

    return np.array_equal(a, b, equal_nan=a.dtype.kind in "fc")


def _held(value: Any, *, hashed: bool = False) -> tuple[Any, ...]:
    """The values of the fields that are compared."""
    return tuple([getattr(value, name) for name in _compared(type(value), hashed)])


@cache
def _compared(kind: Any, hashed: bool) -> tuple[str, ...]:
    count = (one for one in fields(kind) if one.compare and not (hashed and one.hash is False))
    return tuple(one.name for one in count)


def _digest(value: Any) -> Any:
    """A hashable digest, equal for equal values."""
    if isinstance(value, float):
        return "nan" if math.isnan(value) else value
    if is_array(value):
        return value.shape
    if isinstance(value, Mapping):
        return len(value)
    if isinstance(value, Sequence) and not isinstance(value, str | bytes):
        return tuple(map(_digest, value))
    try:
        return hash(value)
    except TypeError:
        return type(value).__qualname__
