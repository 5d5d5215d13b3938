"""Accounts: what is reported of each result, once; as JSON, on a terminal, as a card, as a page."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from stepwell.accounts.account import Account, Level
from stepwell.accounts.assumptions import actuator_words, assumptions, simulation_assumptions
from stepwell.accounts.card import card
from stepwell.accounts.head import CALIBRATED, About, Calibrated, head
from stepwell.accounts.json_schema import schema_kinds, schema_of
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
from stepwell.accounts.words import tie_notes
from stepwell.base import InputError, of_kind

__all__ = ["About", "Account", "account", "card", "page", "schema_kinds", "schema_of", "terminal"]

# Which file has the account of a class.
ACCOUNTS: dict[str, str] = {
    "Arena": "robot",
    "AsBuilt": "lab.as_built",
    "BandFit": "lab.band",
    "BandTest": "lab.band",
    "Batch": "lab.read",
    "Calibration": "lab.calibrate",
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
    "Landing": "events",
    "MapView": "map",
    "Margin": "changes",
    "Maze": "maze",
    "MemoryReading": "graph",
    "PairTest": "lab.compare",
    "Path": "run",
    "Prediction": "robot",
    "Program": "program",
    "Recording": "lab.read",
    "Reprogramming": "reprogram",
    "Robot": "robot",
    "Robustness": "design",
    "Run": "run",
    "Sequence": "graph",
    "Survival": "survival",
    "Sweep": "sweep",
    "TransitionGraph": "graph",
    "Unreachable": "program",
    "Walk": "walk",
    "Walked": "walked",
    "Yield": "yields",
}


def has_account(value: Any) -> bool:
    """Whether there is an account of a value."""
    return of_kind(ACCOUNTS, value) is not None


def account(value: Any, about: About | None = None) -> Account:
    """What is reported of a result.

    Args:
        value: a result, such as a `Check`.
        about: the design file and the recordings that it was computed from.

    Raises:
        ValueError: there is no account of such a value.
    """
    file = of_kind(ACCOUNTS, value)
    if file is None:
        raise InputError(f"{type(value).__name__}: must be one of {', '.join(ACCOUNTS)}.")
    return import_module(f"stepwell.accounts.{file}").account(value, about)
