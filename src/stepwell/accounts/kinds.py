"""The function that returns the account of a class, and the schema of each kind of record."""

import re
from contextlib import suppress
from dataclasses import replace
from importlib import import_module
from operator import attrgetter
from typing import Any

from stepwell.accounts.head import About, DesignShape
from stepwell.accounts.parts import Account
from stepwell.accounts.rendering.card import card
from stepwell.base import InputError, of_kind

# For each file of this folder: the classes with an account, each by the function with the name of
# the class, and the kinds of records, with the version of their names.
FILES = {
    "atlas": ("Atlas", "atlas/2"),
    "builds.chain": ("Build", "build/1"),
    "builds.robot": ("RobotBuild", "robot_build/1"),
    "chain": ("Cell Chain Element", ""),
    "box_proofs": (
        "MarginProof ProvedDesign ProvedImpossible ToleranceProof",
        "proved_design/1 proved_margin/1",
    ),
    "changes": ("Margin", "margin/1"),
    "check": ("Check", "check/2"),
    "design": (
        "Design Impossible Reprogramming TappedDesign",
        "design/2 reprogram/2 tapped_design/1",
    ),
    "graph": (
        "ImplicitGraph MemoryReading Sequence TransitionGraph Walked",
        "graph/2 implicit_graph/2",
    ),
    "lab.as_built": ("AsBuilt", "lab.as_built/2"),
    "lab.band": ("BandFit BandTest", "lab.band/2"),
    "lab.calibrate": ("Calibration", "lab.calibrate/2"),
    "lab.copy_test": ("CopyTest", "check_copy/1"),
    "lab.compare": ("CellTest ChainTest Comparison PairTest", "lab.compare/2"),
    "lab.read": ("Batch MeasuredElement Recording", "lab.element/1 lab.read/1"),
    "machine": ("Realisation", "machine/1"),
    "map": ("MapView", "map/3"),
    "package": ("Installation Presets Verdicts", "doctor/1 folder/1 paper/1 presets/1"),
    "proof": ("PathProof ProvedRun", "proved_run/1"),
    "robots.behaviour": ("CompiledRobot", "compile/1"),
    "robots.jump_design": ("JumpDesign", "jump_design/1"),
    "robots.jumps": ("Hopper Jump", "jump/1"),
    "robots.robot": ("Arena AssumedRanges Prediction Robot", "ranges/1 robot/1"),
    "robots.walks": ("Convergence Maze Sweep Walk", "convergence/1 maze/1 sweep/1 walk/1"),
    "run": ("Cycle Path Program Run Unreachable", "program/2 run/2"),
    "study": ("Status", "study/1"),
    "yields": ("Survival Yield", "survival/2 yield/2"),
}
_INNER_CAPITAL = re.compile(r"\B(?=[A-Z])")
ACCOUNTS = {
    name: f"{file}:{_INNER_CAPITAL.sub('_', name).lower()}_account"
    for file, (names, _) in FILES.items()
    for name in names.split()
}
# Values of which a notebook shows their text.
ACCOUNTS |= dict.fromkeys(("Event", "Landing", "Robustness"), "kinds:text_account")
KINDS = {kind: file for file, (_, kinds) in FILES.items() for kind in kinds.split()}


def schema_at(kind: str) -> Any:
    """The schema of a kind of record: MAP of its file for "map/3", or its function of a shape."""
    file = import_module(f"stepwell.accounts.{KINDS[kind]}")
    name = kind.partition("/")[0].rpartition(".")[2]
    return getattr(file, f"{name}_schema", None) or getattr(file, name.upper())


def account(value: Any, about: About | None = None, **options: Any) -> Account:
    """The report on a result.

    Args:
        value: a result, such as a `Check`.
        about: the design file and the recordings from which it was computed.
        options: of the kind of result, such as `class_boundaries` of an atlas.

    Raises:
        ValueError: there is no account of such a value.
    """
    place = of_kind(ACCOUNTS, value)
    if place is None:
        raise InputError(f"{type(value).__name__}: must be one of {', '.join(sorted(ACCOUNTS))}.")
    design = _design(value)
    about = about or About(design)
    file, _, function = place.partition(":")
    make = getattr(import_module(f"stepwell.accounts.{file}"), function)
    report: Account = make(value, about, **options)
    schema = report.schema or (schema_at(report.kind) if report.kind else ())
    schema = schema(DesignShape.of(design)) if callable(schema) else schema
    return replace(report, about=about, schema=schema)


def text_account(value: Any, about: About) -> Account:
    """What a notebook shows of a value that is described by its text."""
    return Account(value, type(value).__name__, answer=" ".join(str(value).splitlines()))


def _design(value: Any) -> Any:
    """The chain, the robot or the text from which a result was computed, if it has one."""
    for place in ("drawing", "hopper", "chain", "robot", "walk.robot", "graph.chain", "study.text"):
        with suppress(AttributeError):
            return attrgetter(place)(value)
    return None


def card_of(value: Any) -> str:
    """The card of any value, for light and dark notebooks: of its account, or of its text."""
    if of_kind(ACCOUNTS, value) is not None:
        return card(account(value))
    name, text = type(value).__name__, repr(value)
    inside = text.removeprefix(f"{name}(")
    return card(Account(value, name, answer=inside.removesuffix(")") if inside != text else text))
