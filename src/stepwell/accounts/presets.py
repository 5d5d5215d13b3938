"""The designs that come with Stepwell."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stepwell.accounts.account import Account, Level, Section, Table
from stepwell.accounts.head import About
from stepwell.base import Quantity, Schema, counted, record

if TYPE_CHECKING:
    from stepwell.accounts.shape import Shape
    from stepwell.files import Presets

_PRESET: Schema = (
    Quantity("name", head="name", read=lambda one: one[0]),
    Quantity("title", head="title", read=lambda one: one[1]),
)


def presets_schema(_shape: Shape | None = None) -> Schema:
    """What is reported of the designs that come with Stepwell."""
    return (Quantity("presets", read=lambda found: found.items(), holds=[_PRESET]),)


def presets_account(found: Presets, about: About | None = None) -> Account:
    """What is reported of the designs that come with Stepwell."""
    rows = [record(_PRESET, one) for one in found.items()]
    table = Table(_PRESET, lambda: rows, most=None, more="designs", level=Level.CARD)
    return Account(
        found,
        "Designs that come with Stepwell",
        "presets/1",
        presets_schema(),
        answer=counted(len(found), "design"),
        computed=False,
        sections=(Section("Names and titles", [table]),),
    )
