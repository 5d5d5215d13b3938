"""Accounts: what is reported of each result, once; as JSON, on a terminal, as a card, as a page."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from stepwell.accounts.account import Account, Level
from stepwell.accounts.assumptions import actuator_words, assumptions, simulation_assumptions
from stepwell.accounts.card import card
from stepwell.accounts.head import CALIBRATED, About, Calibrated, head
from stepwell.accounts.page import Drawn, Image, page
from stepwell.accounts.terminal import (
    Line,
    escaped,
    facts,
    folded,
    heading,
    paragraph,
    prose,
    records,
    table,
    terminal,
)
from stepwell.base import InputError, of_kind

if TYPE_CHECKING:
    from stepwell.accounts.json_schema import schema_kinds, schema_of
    from stepwell.accounts.words import tie_notes

__all__ = [
    "About",
    "Account",
    "account",
    "card",
    "card_of",
    "page",
    "schema_kinds",
    "schema_of",
    "terminal",
]

# Which file has the account of a class.
ACCOUNTS: dict[str, str] = {
    "Arena": "robot",
    "AsBuilt": "lab.as_built",
    "BandFit": "lab.band",
    "BandTest": "lab.band",
    "Batch": "lab.read",
    "Calibration": "lab.calibrate",
    "Atlas": "atlas",
    "Cell": "chain",
    "CellTest": "lab.compare",
    "Chain": "chain",
    "Check": "check",
    "Convergence": "convergence",
    "Comparison": "lab.compare",
    "Cycle": "run",
    "Design": "design",
    "Element": "chain",
    "Event": "events",
    "ImplicitGraph": "graph",
    "Impossible": "design",
    "Installation": "doctor",
    "Landing": "events",
    "MapView": "map",
    "Margin": "changes",
    "Maze": "maze",
    "MemoryReading": "graph",
    "PairTest": "lab.compare",
    "Path": "run",
    "Prediction": "robot",
    "Presets": "presets",
    "Program": "program",
    "Recording": "lab.read",
    "Reprogramming": "reprogram",
    "Robot": "robot",
    "Robustness": "design",
    "Run": "run",
    "Sequence": "graph",
    "Status": "study",
    "Survival": "survival",
    "Sweep": "sweep",
    "TransitionGraph": "graph",
    "Unreachable": "program",
    "Walk": "walk",
    "Verdicts": "paper",
    "Walked": "walked",
    "Yield": "yields",
}


def account(value: Any, about: About | None = None, **options: Any) -> Account:
    """What is reported of a result.

    Args:
        value: a result, such as a `Check`.
        about: the design file and the recordings that it was computed from.
        options: of the kind of result, such as `borders` of an atlas.

    Raises:
        ValueError: there is no account of such a value.
    """
    file = of_kind(ACCOUNTS, value)
    if file is None:
        raise InputError(f"{type(value).__name__}: must be one of {', '.join(ACCOUNTS)}.")
    return import_module(f"stepwell.accounts.{file}").account(value, about, **options)


def card_of(value: Any) -> str:
    """What a notebook shows of a value: the card of its account, or what it prints.

    Args:
        value: any of the package.

    Returns:
        HTML with inline styles, for light and dark notebooks alike.
    """
    if of_kind(ACCOUNTS, value) is not None:
        return card(account(value))
    name, text = type(value).__name__, repr(value)
    inside = text.removeprefix(f"{name}(")
    return card(Account(value, name, answer=inside.removesuffix(")") if inside != text else text))


# These open NumPy and the rooms below, without which `stepwell doctor` reports what is missing.
# A name here must differ from that of its file, which becomes an attribute once it is imported.
_LATE = {
    "schema_kinds": "json_schema",
    "schema_of": "json_schema",
    "tie_notes": "words",
}


def __getattr__(name: str) -> Any:
    if name in _LATE:
        return getattr(import_module(f"stepwell.accounts.{_LATE[name]}"), name)
    raise AttributeError(f"module 'stepwell.accounts' has no attribute {name!r}")
