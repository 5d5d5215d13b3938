"""Which card a value has."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from stepwell import accounts
from stepwell.base import of_kind
from stepwell.cards.designs import DESIGNS
from stepwell.cards.html import Card, html

_CARDS: dict[str, Callable[[Any], Card]] = {**DESIGNS}


def card(value: Any) -> str:
    """What a notebook shows of a value.

    Args:
        value: any of the package; of those that are a part of something else what they print.

    Returns:
        HTML with inline styles, for light and dark notebooks alike.
    """
    if accounts.has_account(value):
        return accounts.card(accounts.account(value))
    made = of_kind(_CARDS, value)
    return html(made(value) if made is not None else _printed(value))


def _printed(value: Any) -> Card:
    name, text = type(value).__name__, repr(value)
    inside = text.removeprefix(f"{name}(")
    return Card(name, [inside.removesuffix(")") if inside != text else text])
