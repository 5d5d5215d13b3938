"""A card as HTML that suits light and dark notebooks."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from typing import Any

from stepwell.base import Columns, Quantity, Schema, headed, printable, record, shown

# Lines of a table, facts and letters of a sentence; all else is in the value itself.
_ROWS, _LETTERS = 8, 1000

# No colour of its own but a grey that shows on white and on black: text keeps the notebook's.
_LINE = "rgba(128,128,128,0.45)"
_CARD = (
    f"border:1px solid {_LINE};border-radius:6px;padding:0.6em 0.9em;margin:0.3em 0;"
    "display:inline-block;max-width:100%;box-sizing:border-box;overflow-x:auto;line-height:1.45"
)
_CELL = "padding:0.15em 1.1em 0.15em 0;border:0;background:none;vertical-align:top;text-align:"
_FAINT = "opacity:0.7;font-weight:normal"


@dataclass(frozen=True)
class Card:
    """What a card says.

    Args:
        title: what it is.
        says: a sentence each.
        facts: numbers with their units, by what they are called.
        columns, rows: a small table, of records.
        more: of what there are more rows, such as "cells"; the card says how many.
    """

    title: str
    says: Sequence[str] = ()
    facts: Mapping[str, str] = field(default_factory=dict)
    columns: Columns = ()
    rows: Sequence[Mapping[str, Any]] = ()
    more: str = "rows"


def facts(schema: Schema, value: Any, **given: Any) -> dict[str, str]:
    """What a schema tells of a value, by names in words; what there is none of is left out."""
    told = record(schema, value, **given)
    return {
        (q.head or q.name.replace("_", " ")): text_of(q, told[q.key])
        for q in schema
        if told[q.key] not in (None, "", [])
    }


def text_of(quantity: Quantity, told: Any) -> str:
    """A number of a record with its unit."""
    return f"{quantity.text(told)} {quantity.sign}".strip()


def html(card: Card) -> str:
    """The card as HTML: inline styles, no script, nothing fetched, all text escaped."""
    parts = [f"<strong>{_safe(card.title)}</strong>"]
    says = (_capital(_short(text)) for text in card.says if text)
    parts += [f'<div style="max-width:52em">{_safe(text)}</div>' for text in says]
    if card.facts:
        rows = (
            f'<tr style="background:none"><th scope="row" style="{_CELL}left;{_FAINT}">'
            f'{_safe(headed(name))}</th><td style="{_CELL}left">{_safe(_short(text))}</td></tr>'
            for name, text in card.facts.items()
        )
        parts.append(_table("", rows))
    columns = shown(card.columns)
    if columns and card.rows:
        sides = ["right" if column.numeric else "left" for column in columns]
        heads = (
            f'<th scope="col" style="{_CELL}{side};white-space:nowrap;{_FAINT}">'
            f"{_safe(headed(column.heading))}</th>"
            for column, side in zip(columns, sides, strict=True)
        )
        rows = (
            '<tr style="background:none">'
            + "".join(
                f'<td style="{_CELL}{side};white-space:nowrap;font-variant-numeric:tabular-nums">'
                f"{_safe(_short(column.cell(row)))}</td>"
                for column, side in zip(columns, sides, strict=True)
            )
            + "</tr>"
            for row in card.rows[:_ROWS]
        )
        parts.append(_table(f'<tr style="background:none">{"".join(heads)}</tr>', rows))
        left = len(card.rows) - _ROWS
        if left > 0:
            parts.append(f'<div style="{_FAINT}">and {left} more of the {_safe(card.more)}</div>')
    return f'<div style="{_CARD}">{"".join(parts)}</div>'


def _table(head: str, rows: Iterable[str]) -> str:
    above = f'<thead style="border-bottom:1px solid {_LINE}">{head}</thead>' if head else ""
    return (
        '<table style="border-collapse:collapse;border:0;margin:0.4em 0 0.1em;font-size:inherit">'
        f"{above}<tbody>{''.join(rows)}</tbody></table>"
    )


def _safe(text: str) -> str:
    return escape(printable(text))


def _short(text: str) -> str:
    return text if len(text) <= _LETTERS else f"{text[:_LETTERS]}…"


def _capital(text: str) -> str:
    # A key, such as foot.below_mm, begins as it is written.
    first = text.split(maxsplit=1)[:1]
    return text[:1].upper() + text[1:] if first and first[0].replace("-", "").isalpha() else text
