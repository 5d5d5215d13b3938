"""Accounts: what is reported of each result, once; as JSON, on a terminal, as a card, as a page."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from stepwell.accounts.account import Account
from stepwell.accounts.head import About, Calibrated, head
from stepwell.accounts.kinds import account, card_of
from stepwell.accounts.rendering.card import card
from stepwell.accounts.rendering.page import Drawn, Image, page
from stepwell.accounts.rendering.terminal import (
    Line,
    escaped,
    folded,
    heading,
    paragraph,
    table,
    terminal,
)

if TYPE_CHECKING:
    from stepwell.accounts.rendering.json_schema import schema_kinds, schema_of
    from stepwell.accounts.words import assumptions, simulation_assumptions, tie_notes

__all__ = [
    "About",
    "Account",
    "account",
    "card",
    "card_of",
    "head",
    "page",
    "schema_kinds",
    "schema_of",
    "terminal",
    "tie_notes",
]

# These open NumPy and the rooms below, without which `stepwell doctor` reports what is missing.
_LATE = {
    "assumptions": "words",
    "schema_kinds": "rendering.json_schema",
    "schema_of": "rendering.json_schema",
    "simulation_assumptions": "words",
    "tie_notes": "words",
}


def __getattr__(name: str) -> Any:
    if name in _LATE:
        return getattr(import_module(f"stepwell.accounts.{_LATE[name]}"), name)
    raise AttributeError(f"module 'stepwell.accounts' has no attribute {name!r}")
