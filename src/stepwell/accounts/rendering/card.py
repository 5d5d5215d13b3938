"""An account as a card: HTML that suits light and dark notebooks."""

from collections.abc import Iterable, Sequence
from html import escape

from stepwell.accounts.parts import Account, Level, Notes, RecordTable, Row, Text
from stepwell.base import headed, printable, shown

# Rows of a table and letters of a sentence; all else is in the value itself.
_ROWS, _LETTERS = 8, 1000

# No colour of its own but a grey that shows on white and on black: text keeps the notebook's.
_LINE = "rgba(128,128,128,0.45)"
_CARD = (
    f"border:1px solid {_LINE};border-radius:6px;padding:0.6em 0.9em;margin:0.3em 0;"
    "display:inline-block;max-width:100%;box-sizing:border-box;overflow-x:auto;line-height:1.45"
)
_CELL = "padding:0.15em 1.1em 0.15em 0;border:0;background:none;vertical-align:top;text-align:"
_FAINT = "opacity:0.7;font-weight:normal"


def card(account: Account) -> str:
    """What a notebook shows of a result.

    Args:
        account: of the result.

    Returns:
        HTML with inline styles: no script, nothing fetched, all text escaped.
    """
    parts = [f"<strong>{_safe(account.title)}</strong>"]
    parts += map(_sentence, filter(None, (account.answer, account.origin)))
    parts += [_sentence(line) for warned in account.warnings for line in warned.lines]
    rows = (
        f'<tr style="background:none"><th scope="row" style="{_CELL}left;{_FAINT}">'
        f'{_safe(headed(label))}</th><td style="{_CELL}left">{_safe(_short(text))}</td></tr>'
        for label, text in account.known(Level.CARD).items()
    )
    parts.append(_rows("", rows))
    for section in account.sections:
        for part in section.within(Level.CARD):
            if isinstance(part, RecordTable):
                parts.append(_table(part, account.rows(part)))
            elif isinstance(part, Text) and part.text:
                parts.append(_sentence(part.text))
            elif isinstance(part, Notes):
                parts += map(_sentence, part.lines)
    return f'<div style="{_CARD}">{"".join(parts)}</div>'


def _sentence(text: str) -> str:
    return f'<div style="max-width:52em">{_safe(headed(_short(text)))}</div>'


def _table(table: RecordTable, rows: Sequence[Row]) -> str:
    columns = shown(table.columns)
    if not columns or not rows:
        return ""
    sides = ["right" if column.numeric else "left" for column in columns]
    heads = (
        f'<th scope="col" style="{_CELL}{side};white-space:nowrap;{_FAINT}">'
        f"{_safe(headed(column.heading))}</th>"
        for column, side in zip(columns, sides, strict=True)
    )
    body = (
        '<tr style="background:none">'
        + "".join(
            f'<td style="{_CELL}{side};white-space:nowrap;font-variant-numeric:tabular-nums">'
            f"{_safe(_short(column.cell(row)))}</td>"
            for column, side in zip(columns, sides, strict=True)
        )
        + "</tr>"
        for row in rows[:_ROWS]
    )
    found = _rows(f'<tr style="background:none">{"".join(heads)}</tr>', body)
    left = len(rows) - _ROWS
    more = f'<div style="{_FAINT}">and {left} more of the {_safe(table.more)}</div>'
    return found + more * (left > 0)


def _rows(head: str, rows: Iterable[str]) -> str:
    body = "".join(rows)
    if not body:
        return ""
    above = f'<thead style="border-bottom:1px solid {_LINE}">{head}</thead>' if head else ""
    return (
        '<table style="border-collapse:collapse;border:0;margin:0.4em 0 0.1em;font-size:inherit">'
        f"{above}<tbody>{body}</tbody></table>"
    )


def _safe(text: str) -> str:
    return escape(printable(text))


def _short(text: str) -> str:
    return text if len(text) <= _LETTERS else f"{text[:_LETTERS]}…"
