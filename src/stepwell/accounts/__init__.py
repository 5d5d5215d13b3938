"""Accounts: what is reported of each result, once; as JSON, on a terminal, as a card, as a page."""

from typing import TYPE_CHECKING

from stepwell.accounts.head import About, Calibrated, head
from stepwell.accounts.kinds import account, card_of
from stepwell.accounts.parts import Account
from stepwell.accounts.rendering.card import card
from stepwell.accounts.rendering.page import FigurePair, Image, page
from stepwell.accounts.rendering.terminal import (
    Line,
    escaped,
    folded,
    heading,
    paragraph,
    table,
    terminal,
)
from stepwell.base import late

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
    "rendering.json_schema": ("schema_kinds", "schema_of"),
    "words": ("assumptions", "simulation_assumptions", "tie_notes"),
}

__getattr__, __dir__ = late(__name__, _LATE, __all__)
