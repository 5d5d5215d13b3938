"""An account as a page: one HTML file that is complete in itself."""

import re
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from importlib.resources import files
from itertools import groupby
from string import Template
from typing import NamedTuple

from stepwell.accounts import parts
from stepwell.accounts.head import Row
from stepwell.base import Column, Quantity, __version__, headed, shown

# Longer tables are cut; the files in the same folder have all rows.
MOST_ROWS = 200
# Tables and lists with more rows than this are shown on demand.
_FOLDED = 24
# A longer fact has a line of its own [letters].
_SHORT = 36
# A wider figure has a line of its own [CSS px].
_WIDE = 400
# Below this width of the window the form for phones is shown.
_PHONE = "(max-width: 40rem)"
_STEP = re.compile(r"(?<=\w)>(?=\w)")
_MINUS = re.compile(r"(?<![^\s(])-(?=\d)")


class Image(NamedTuple):
    """A figure as an address that holds all of it, with its size in CSS px."""

    source: str
    width: int
    height: int


class FigurePair(NamedTuple):
    """A figure for a wide window and for paper, and one for phones if that differs."""

    wide: Image
    phone: Image | None = None


def page(
    account: parts.Account, pictures: Mapping[str, FigurePair] | None = None, motion: str = ""
) -> str:
    """What a page shows of a result.

    Args:
        account: of the result.
        pictures: its figures by name; others are left out.
        motion: its replay as HTML; "" without a replay.

    Returns:
        HTML text. It loads nothing, and runs nothing but the replay.
    """
    template = Template((files("stepwell.accounts.rendering") / "page.html").read_text("utf-8"))
    body: list[str] = []
    for heading, shown_parts in account.within(parts.PAGE):
        if inside := _section(account, shown_parts, pictures or {}, motion):
            body.append(f"<section>\n<h2>{escape(heading)}</h2>\n{inside}\n</section>")
    return template.substitute(
        version=escape(__version__),
        title=escape(account.title),
        origin=escape(account.origin),
        answer=escape(_arrows(_minus(_sentence(account.answer)))),
        facts=_facts(account.known(parts.PAGE)),
        warnings="\n".join(
            f'<div class="warning" role="note"><strong>{escape(one.heading)}.</strong> '
            f"{escape(one.text)}{_list(one.lines)}</div>"
            for one in account.warnings
            if one.lines
        ),
        body="\n".join(body),
    )


_Drawn = Mapping[str, FigurePair]


def _section(account: parts.Account, of: Iterable[parts.Part], drawn: _Drawn, motion: str) -> str:
    """The content of a section; figures in a row are side by side if there is room."""
    html: list[str] = []
    for kind, group in groupby(of, type):
        if kind is parts.Picture:
            known = (one for one in group if isinstance(one, parts.Picture) and one.name in drawn)
            figures = "\n".join(_figure(one.caption, drawn[one.name]) for one in known)
            html.append(f'<div class="figures">\n{figures}\n</div>' if figures else "")
        else:
            html += [_part(account, one, motion) for one in group]
    return "\n".join(filter(None, html))


def _part(account: parts.Account, part: parts.Part, motion: str) -> str:
    if isinstance(part, parts.RecordTable):
        return _table(part, account.rows(part))
    if isinstance(part, parts.Text):
        return _paragraph(parts.text_of(part))
    if isinstance(part, parts.Notes):
        return _list([_sentence(line) for line in part.lines])
    if isinstance(part, parts.Replay):
        still = _paragraph("On a screen, this page plays the motion here.", "paper quiet")
        return f"{motion}\n{still}" if motion else _paragraph(part.instead)
    assert isinstance(part, parts.Verbatim)
    label = f'<pre tabindex="0" role="region" aria-label="{escape(part.about)}">'
    return f"{label}{escape(part.text)}</pre>" if part.text else ""


def _paragraph(text: str, kind: str = "") -> str:
    mark = f' class="{kind}"' if kind else ""
    return f"<p{mark}>{escape(_minus(_sentence(text)))}</p>" if text else ""


def _list(lines: Iterable[str]) -> str:
    items = [f"<li>{escape(_minus(line))}</li>" for line in lines]
    return _folded("\n".join(["<ul>", *items, "</ul>"]), len(items), "lines") if items else ""


def _facts(texts: Mapping[str, str]) -> str:
    """Short facts as boxes, long ones as rows below."""
    kinds: dict[str, list[str]] = {"boxes": [], "rows": []}
    for label, text in texts.items():
        fact = f"<div><dt>{escape(label)}</dt><dd>{escape(_arrows(_minus(text)))}</dd></div>"
        kinds["boxes" if len(text) <= _SHORT else "rows"].append(fact)
    lists = (f'<dl class="{kind}">{"".join(facts)}</dl>' for kind, facts in kinds.items() if facts)
    return "\n".join(lists)


def _figure(caption: str, drawn: FigurePair) -> str:
    """A figure above its caption; without a form for phones, a wide one is scrolled there."""
    (source, width, height), phone = drawn
    text = escape(caption)
    image = f'<img alt="{text}" width="{width}" height="{height}" src="{source}">'
    if width <= _WIDE:
        return f"<figure>{image}<figcaption>{text}</figcaption></figure>"
    if phone is None:
        image = _scrolled(image, caption)
    else:
        size = f'width="{phone.width}" height="{phone.height}"'
        smaller = f'<source media="{_PHONE}" {size} srcset="{phone.source}">'
        image = f"<picture>{smaller}{image}</picture>"
    return f'<figure class="wide">{image}<figcaption>{text}</figcaption></figure>'


def _table(table: parts.RecordTable, rows: Sequence[Row]) -> str:
    if not rows:
        return ""
    columns, about = shown((*table.columns, *table.wide)), table.about
    if len(rows) > MOST_ROWS:
        about = f"{about} The first {MOST_ROWS} of {len(rows)} are shown.".strip()
    kinds = [
        (one, escape(headed(one.heading)), "" if one.numeric else ' class="left"')
        for one in columns
    ]
    heads = "".join(f'<th scope="col"{kind}>{head}</th>' for _, head, kind in kinds)
    # On a phone a row is a list, and each of its numbers has its heading in front of it.
    cells = (
        (
            f'<td{kind} data-head="{head}">{escape(_cell(one, row))}</td>'
            for one, head, kind in kinds
        )
        for row in rows[:MOST_ROWS]
    )
    body = "\n".join(f"<tr>{''.join(row)}</tr>" for row in cells)
    inside = f"<table><thead><tr>{heads}</tr></thead>\n<tbody>{body}</tbody></table>"
    whole = _scrolled(inside, about.partition(".")[0] or table.more)
    return _paragraph(about, "quiet") + _folded(whole, min(len(rows), MOST_ROWS), "rows")


def _cell(column: Quantity | Column, row: Row) -> str:
    # A name keeps its hyphens.
    words = not (column.numeric or isinstance(column, Column))
    return column.cell(row) if words else _minus(column.cell(row))


def _folded(content: str, count: int, what: str) -> str:
    """Content that is shown on demand if it is long."""
    if count <= _FOLDED:
        return content
    return f"<details><summary>Show {count} {what}</summary>\n{content}\n</details>"


def _scrolled(content: str, about: str) -> str:
    """Content that may be wider than a phone: it has its own scroll bar, with keys too."""
    region = f'class="scroll" role="region" tabindex="0" aria-label="{escape(about)}"'
    return f"<div {region}>{content}</div>"


def _minus(text: str) -> str:
    return _MINUS.sub("\N{MINUS SIGN}", text)


def _arrows(text: str) -> str:
    return _STEP.sub(" → ", text)


def _sentence(text: str) -> str:
    return f"{headed(text)}{'' if text[-1:] in '.!?' else '.'}" if text else ""
