"""Every public value equals its copies: all that a room hands out, found by looking."""

import copy
import dataclasses
import enum
import importlib
import inspect
import json
import math
import pickle
import pkgutil

import numpy as np
import pytest

import stepwell as sw
from stepwell.base import Advised
from stepwell.base.value import ByValue, ReadOnly, deep_equal
from stepwell.design import Impossible, MapView, design, reprogram
from stepwell.files import DesignError, Presets, loads
from stepwell.kernels.entry import Entry
from stepwell.lab import LabError
from stepwell.mechanism import SlipError
from stepwell.sequences import Unreachable

COPIES = [lambda v: pickle.loads(pickle.dumps(v)), copy.copy, copy.deepcopy]
ROOMS = [
    room.name
    for room in pkgutil.iter_modules(sw.__path__)
    # What an account holds is made for one report of a value, which is compared itself.
    if room.ispkg and room.name not in ("accounts", "base", "cli", "concave", "__pycache__")
]


def public_classes() -> list[type]:
    """Every class that a room lists among its names."""
    classes: dict[type, None] = {}
    for room in ["", *ROOMS]:
        module = importlib.import_module(f"stepwell.{room}".rstrip("."))
        for name in getattr(module, "__all__", ()):
            thing = getattr(module, name)
            if inspect.isclass(thing) and thing.__module__.startswith("stepwell"):
                classes[thing] = None
    return list(classes)


CLASSES = public_classes()
VALUES = [one for one in CLASSES if dataclasses.is_dataclass(one)]


def filled(kind: type, changed: str = "") -> object:
    """A value of the class whose fields hold arrays and what is no number, unchecked."""
    if kind is sw.Sequence:  # its hash is that of its text
        return sw.Sequence("01" if changed == "first" else "00", (((changed == "changes", 1),),))
    value = object.__new__(kind)
    for i, field in enumerate(dataclasses.fields(kind)):
        other = float(field.name == changed)
        held = (float("nan"), f"{i}", np.array([1.0, float("nan"), i + other]))
        kept = ReadOnly({"all": held}) if i % 2 else held
        object.__setattr__(value, field.name, kept)
    return value


def test_every_public_class_is_a_value_an_error_or_a_name():
    others = [
        one
        for one in CLASSES
        if not issubclass(one, ByValue | enum.Enum | BaseException | tuple)
        # A function, a view of a dataset, a dictionary, and an environment, which has a state.
        and one not in (Entry, MapView, Presets)
        and one.__name__ != "RobotEnv"
    ]
    assert others == []
    assert len(VALUES) > 70


@pytest.mark.parametrize("kind", VALUES, ids=lambda kind: f"{kind.__module__}.{kind.__name__}")
def test_a_value_equals_its_copies_and_no_value_with_another_field(kind):
    value = filled(kind)
    for copied in COPIES:
        again = copied(value)
        assert again == value
        assert (again != value) is False
        assert hash(again) == hash(value)
    for field in dataclasses.fields(kind):
        assert (filled(kind, field.name) != value) == field.compare


LEG = sw.preset("paper-forward")
RESULTS = {
    "chain": lambda: LEG,
    "path": lambda: LEG.path([0.0, 0.03, 0.01]),
    "cycle": LEG.cycle,
    "sequence": lambda: LEG.cycle().sequence,
    "graph": LEG.graph,
    "reading": lambda: LEG.graph().reading,
    "program": lambda: LEG.program("01"),
    "yield": lambda: LEG.yields(samples=50),
    "margin": LEG.margin,
    "reprogramming": lambda: reprogram(LEG, None, "inner.p"),
    "no reprogramming": lambda: reprogram(LEG, None, "inner.p", reach=0.0001),
    "design": lambda: design("00>10>11>01>00", samples=50),
    "robot": lambda: sw.preset("robot-antennas"),
}


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_equals_its_copies_and_what_the_same_call_gives_again(name):
    result = RESULTS[name]()
    # Looked at or not, it is the same result.
    _ = [getattr(result, key) for key in ("stroke", "snaps", "interval") if hasattr(result, key)]
    assert RESULTS[name]() == result
    for copied in COPIES:
        assert copied(result) == result


def test_results_of_other_chains_are_other_results():
    other = sw.preset("paper-backward")
    assert LEG.cycle() != other.cycle()
    assert LEG.graph() != other.graph()
    assert LEG.yields(samples=50) != LEG.yields(samples=50, seed=1)
    assert LEG.path([0.0, 0.03]) != LEG.path([0.0, 0.031])


def test_an_unpickled_path_has_the_same_samples_to_the_last_bit():
    path = LEG.cycle().path
    again = pickle.loads(pickle.dumps(path))
    for name in ("drive", "travel", "force", "energy", "residual"):
        assert np.array_equal(getattr(again, name), getattr(path, name))


def test_equal_values_are_one_key():
    cycles = {LEG.cycle(): "first"}
    cycles[pickle.loads(pickle.dumps(LEG.cycle()))] = "second"
    assert list(cycles.values()) == ["second"]


def test_a_sequence_and_its_text_are_one_key():
    sequence = LEG.cycle().sequence
    assert sequence == str(sequence)
    assert {sequence: 1}[str(sequence)] == 1


@pytest.mark.parametrize(
    ("a", "b", "equal"),
    [
        (np.array([1.0, math.nan]), np.array([1.0, math.nan]), True),
        (np.array([1.0]), np.array([[1.0]]), False),
        (np.array([1.0]), np.array([True]), False),
        (np.array([1.0]), 1.0, False),
        (np.array([None, math.nan], object), np.array([None, math.nan], object), True),
        ((1.0, [math.nan]), (1.0, [math.nan]), True),
        ((1.0,), [1.0], False),
        ({"a": np.zeros(2)}, {"a": np.zeros(2)}, True),
        ({"a": np.zeros(2)}, {"b": np.zeros(2)}, False),
        (0.0, -0.0, True),
        (math.nan, 0.0, False),
    ],
)
def test_what_holds_arrays_is_compared_number_by_number(a, b, equal):
    assert deep_equal(a, b) == deep_equal(b, a) == equal


def refused(kind, ask) -> Exception:
    with pytest.raises(kind) as caught:
        ask()
    return caught.value


ERRORS = {
    DesignError: lambda: refused(DesignError, lambda: loads("[chain]").subject),
    SlipError: lambda: refused(SlipError, lambda: sw.Cell(sw.Band((-10, 0), (10, 0)))),
    Impossible: lambda: Impossible("00>11", "why", proved=True, region=[np.zeros((2, 2))]),
    LabError: lambda: LabError("a.txt", "is none."),
    Unreachable: lambda: Unreachable("no way", proved=True),
}


@pytest.mark.parametrize("kind", [one for one in CLASSES if issubclass(one, Advised)])
def test_an_outcome_is_its_word_everywhere_and_has_advice(kind):
    for one in kind:
        assert one == one.value == json.loads(json.dumps(one)) == f"{one}"
        assert pickle.loads(pickle.dumps(one)) is one
        assert len(one.advice) > 20


@pytest.mark.parametrize("kind", ERRORS)
def test_an_error_comes_out_of_a_pickle_with_all_that_it_holds(kind):
    error = ERRORS[kind]()
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is kind
    assert str(again) == str(error)
    assert deep_equal(vars(again), vars(error))
