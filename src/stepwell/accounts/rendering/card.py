"""An account as a card: HTML that suits light and dark notebooks."""

from collections.abc import Callable, Iterable, Sequence
from html import escape

from stepwell.accounts.head import Row
from stepwell.accounts.parts import CARD, Account, RecordTable, lines_of
from stepwell.base import headed, printable, shown

# Most rows of a table and letters of a sentence.
_ROWS, _LETTERS = 8, 1000

# No colour of its own but a grey that shows on white and on black: text keeps the notebook's.
_LINE = "rgba(128,128,128,0.45)"
_CARD = (
    f"border:1px solid {_LINE};border-radius:6px;padding:0.6em 0.9em;margin:0.3em 0;"
    "display:inline-block;max-width:100%;box-sizing:border-box;overflow-x:auto;line-height:1.45"
)
_CELL = "padding:0.15em 1.1em 0.15em 0;border:0;background:none;vertical-align:top;text-align:"
_FAINT = "opacity:0.7;font-weight:normal"
_NUMBERS = "white-space:nowrap;font-variant-numeric:tabular-nums"
_ROW = '<tr style="background:none">'


def card(account: Account) -> str:
    """What a notebook shows of a result: HTML with inline styles, no script, all text escaped."""
    facts = (
        f'<th scope="row" style="{_CELL}left;{_FAINT}">{_safe(headed(label))}</th>'
        f'<td style="{_CELL}left">{_short(text)}</td>'
        for label, text in account.known(CARD).items()
    )
    warnings = (line for warned in account.warnings for line in warned.lines)
    html = [
        f"<strong>{_safe(account.title)}</strong>",
        *map(_sentence, filter(None, (account.answer, account.origin, *warnings))),
        _rows("", facts),
    ]
    for _, parts in account.within(CARD):
        for part in parts:
            html += map(_sentence, lines_of(part))
            if isinstance(part, RecordTable):
                html.append(_table(part, account.rows(part)))
    return f'<div style="{_CARD}">{"".join(html)}</div>'


def _sentence(text: str) -> str:
    return f'<div style="max-width:52em">{_short(text, headed)}</div>'


def _table(table: RecordTable, rows: Sequence[Row]) -> str:
    columns = shown(table.columns)
    if not columns or not rows:
        return ""
    sides = [(one, _CELL + ("right" if one.numeric else "left")) for one in columns]
    heads = (
        f'<th scope="col" style="{style};white-space:nowrap;{_FAINT}">'
        f"{_safe(headed(column.heading))}</th>"
        for column, style in sides
    )
    cells = (
        (f'<td style="{style};{_NUMBERS}">{_short(one.cell(row))}</td>' for one, style in sides)
        for row in rows[:_ROWS]
    )
    left = len(rows) - _ROWS
    more = f'<div style="{_FAINT}">and {left} more of the {_safe(table.more)}</div>'
    return _rows("".join(heads), map("".join, cells)) + more * (left > 0)


def _rows(head: str, rows: Iterable[str]) -> str:
    body = "".join(f"{_ROW}{row}</tr>" for row in rows)
    if not body:
        return ""
    line = f'<thead style="border-bottom:1px solid {_LINE}">{_ROW}{head}</tr></thead>'
    return (
        '<table style="border-collapse:collapse;border:0;margin:0.4em 0 0.1em;font-size:inherit">'
        f"{line if head else ''}<tbody>{body}</tbody></table>"
    )


def _safe(text: str) -> str:
    return escape(printable(text))


def _short(text: str, form: Callable[[str], str] = str) -> str:
    return _safe(form(text if len(text) <= _LETTERS else f"{text[:_LETTERS]}…"))
