"""Leaves: kernels that are compiled without counting references, and so may make no array."""

import ast
import inspect
import sys
from typing import Any, NamedTuple, get_args, get_origin, get_type_hints

import numpy as np
import pytest

import stepwell.statics.inertial
import stepwell.statics.landing_robustness
import stepwell.statics.run
import stepwell.statics.sorted_cycle  # noqa: F401
from facts import refuses
from stepwell.kernels import entry, fingerprint, kernel, leaf, record
from stepwell.kernels.machine import machine
from stepwell.mechanism import ends_of, geometry, phase
from stepwell.statics.following.follow import follow

LEAVES = sorted(fingerprint.LEAVES, key=lambda one: f"{one.__module__}.{one.__qualname__}")
MAKERS = {
    "empty", "zeros", "ones", "full", "copy", "sort", "argsort", "flatnonzero", "array", "arange",
    "concatenate", "where", "cumsum", "unique", "empty_like", "zeros_like",
}  # fmt: skip


def makes_an_array(tree: ast.AST) -> list[str]:
    """What in a function makes an array, or may: a maker called, an array copied into a slice."""
    calls = [
        ast.unparse(node)
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and getattr(node.func, "attr", "") in MAKERS
    ]
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Subscript):
            sliced = any(isinstance(part, ast.Slice) for part in ast.walk(node.targets[0].slice))
            if sliced and not _is_a_number(node.value):
                calls.append(ast.unparse(node))
    return calls


def _is_a_number(value: ast.AST) -> bool:
    return isinstance(value, (ast.Constant, ast.UnaryOp)) or ast.unparse(value) == "np.nan"


@pytest.mark.parametrize("one", LEAVES, ids=lambda one: one.__qualname__)
def test_no_leaf_makes_an_array_or_calls_what_does(one):
    assert not makes_an_array(ast.parse(inspect.getsource(one)))
    for inner in filter(None, map(fingerprint.kernel_of, fingerprint.named_by(one).values())):
        assert not makes_an_array(ast.parse(inspect.getsource(inner))), (one, inner)


NUMBERS = {int, float, bool, type(None)}


def is_of_numbers(kind: Any) -> bool:
    """Whether what a kernel returns holds no array."""
    if isinstance(kind, type) and hasattr(kind, "_fields"):
        return all(map(is_of_numbers, get_type_hints(kind).values()))
    return kind in NUMBERS or (
        get_origin(kind) is tuple and all(map(is_of_numbers, get_args(kind)))
    )


def test_no_kernel_that_counts_references_takes_arrays_from_a_leaf():
    # It would give back what was never counted, and the arrays would be freed while they are used:
    # that ended a process in "malloc(): unaligned tcache chunk detected".
    counted = fingerprint._KERNELS - fingerprint.LEAVES
    taken = [
        (one.__qualname__, inner.__qualname__)
        for one in counted
        if one.__module__.startswith("stepwell.")
        for value in fingerprint.named_by(one).values()
        if (inner := fingerprint.kernel_of(value)) in fingerprint.LEAVES
        and not is_of_numbers(get_type_hints(inner)["return"])
    ]
    assert taken == []


@leaf
def summed_up(values):
    total = 0.0
    for value in values:
        total += value
    return total


@fingerprint.called
@leaf
def doubled(values):
    return np.full(len(values), 2.0)


@fingerprint.called
@kernel
def handed_on(values):
    return summed_up(values) + summed_up(values[1:])


def test_a_leaf_is_compiled_and_gives_what_the_interpreter_gives():
    values = np.arange(5.0)
    assert machine(handed_on)(values) == handed_on(values) == 20.0


def test_only_an_entry_is_called_from_python_for_the_others_take_none_of_its_values():
    with refuses(TypeError, "summed_up", "entry"):
        machine(summed_up)


def test_whether_python_calls_a_kernel_is_in_its_fingerprint(monkeypatch):
    before = fingerprint.fingerprint(handed_on)
    monkeypatch.setattr(fingerprint, "CALLED", set())
    assert fingerprint.fingerprint(handed_on) != before


@pytest.mark.slow
def test_a_leaf_that_makes_an_array_is_not_compiled():
    with pytest.raises(Exception, match="nopython"):
        machine(doubled)(np.arange(5.0))


def test_whether_a_kernel_is_a_leaf_is_in_its_fingerprint(monkeypatch):
    before = fingerprint.fingerprint(handed_on)
    monkeypatch.setattr(fingerprint, "LEAVES", set())
    assert fingerprint.fingerprint(handed_on) != before


@record
class Inner(NamedTuple):
    numbers: Any
    wholes: Any


@record
class Outer(NamedTuple):
    inner: Inner
    factor: float
    table: Any


def outer(factor: float = 2.0) -> Outer:
    """A record of three arrays."""
    return Outer(Inner(np.arange(4.0), np.arange(3)), factor, np.ones((2, 3)))


@fingerprint.called
@leaf
def read(what):
    return what.factor * what.inner.numbers[2] + what.table.shape[1] + what.inner.wholes[1]


@leaf
def write(what, value):
    what.inner.numbers[2] = value
    what.table[1, 2] += value


@entry()
@leaf
def made_anew(what, times):
    total = 0.0
    for k in range(times):
        again = Outer(what.inner, what.factor * k, what.table)
        write(again, 1.0 + k)
        total += read(again)
    return total


@fingerprint.called
@kernel
def counted(what):
    mine = what.inner.numbers
    both = np.concatenate((mine, what.inner.numbers))
    write(what, both[1])
    return read(what) + np.sum(both)


@pytest.mark.parametrize("use", [read, made_anew.function, counted])
def test_a_record_is_read_and_written_where_it_is_in_machine_code_too(use):
    rest = (5,) if use is made_anew.function else ()
    plain, compiled = outer(), outer()
    assert machine(use)(compiled, *rest) == use(plain, *rest)
    for one, other in zip(plain.inner, compiled.inner, strict=True):
        assert np.array_equal(one, other)
    assert np.array_equal(plain.table, compiled.table)


@pytest.mark.parametrize("use", [read, counted])
def test_machine_code_gives_back_every_array_of_a_record(use):
    what, ready = outer(), machine(use)
    ready(what)
    arrays = what.inner.numbers, what.inner.wholes, what.table
    before = [sys.getrefcount(array) for array in arrays]
    for _ in range(100):
        ready(what)
    assert [sys.getrefcount(array) for array in arrays] == before


def test_no_kernel_returns_a_record_which_ends_with_the_kernel_that_made_it():
    returned = [
        one.__qualname__
        for one in fingerprint._KERNELS
        if one.__module__.startswith("stepwell.")
        and fingerprint.is_record(get_type_hints(one).get("return"))
    ]
    assert returned == []


@fingerprint.called
@kernel
def made_while_counting(what):
    again = Outer(what.inner, 2.0, np.ones((2, 3)))
    return read(again)


def test_a_kernel_that_counts_references_makes_no_record():
    with refuses(TypeError, "made_while_counting", "Outer", "leaf"):
        machine(made_while_counting)
    makers = [
        one.__qualname__
        for one in fingerprint._KERNELS - fingerprint.LEAVES
        if one.__module__.startswith("stepwell.")
        if any(map(fingerprint.is_record, fingerprint.named_by(one).values()))
    ]
    assert makers == []


def test_whether_a_named_tuple_is_a_record_is_in_a_fingerprint(monkeypatch):
    before = fingerprint.fingerprint(made_anew.function)
    monkeypatch.setattr(fingerprint, "_RECORDS", set())
    assert fingerprint.fingerprint(made_anew.function) != before


def test_what_a_kernel_names_by_its_module_is_in_its_fingerprint(monkeypatch):
    def prints():
        return [fingerprint.fingerprint(one.function) for one in (ends_of, follow)]

    before = prints()
    monkeypatch.setattr(phase, "LOW", phase.LOW + 1)
    assert all(now != then for now, then in zip(prints(), before, strict=True))
    monkeypatch.undo()
    monkeypatch.setattr(geometry, "sine_at", geometry.turn_at)
    assert prints()[0] == before[0] and prints()[1] != before[1]
