"""What every page of results is made of: its head, figures, tables and motions as HTML."""

from __future__ import annotations

import base64
import re
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from importlib.resources import files
from string import Template
from typing import TYPE_CHECKING, Any

from stepwell.base import Column, Columns, __version__, headed, shown
from stepwell.studio.replay import embedded

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Longer tables help nobody; the files beside the page have everything.
MOST_ROWS = 200
# Tables and lists with more rows than this are shown when they are asked for.
_FOLDED = 24
# What is wider than this does not stand beside another figure [CSS px].
_WIDE = 400
# Below this width of the window a figure is shown as it is drawn for phones.
_PHONE = "(max-width: 40rem)"
_MINUS = re.compile(r"(?<![^\s(])-(?=\d)")


def page(
    title: str,
    origin: str,
    answer: str,
    said: Iterable[str],
    numbers: Mapping[str, str],
    body: Iterable[str],
    warnings: str = "",
) -> str:
    """A page of results that is complete in itself.

    Args:
        title: what it is about.
        origin: from what it was computed.
        answer: what a reader wants to know first, in a few words.
        said: the same in sentences.
        numbers: the few that matter, with their units, by name.
        body: parts, as `part` makes them.
        warnings: as `warned` makes them.

    Returns:
        HTML text; it loads nothing, and of itself it runs nothing.
    """
    template = Template((files("stepwell.reports.pages") / "page.html").read_text("utf-8"))
    return template.substitute(
        version=escape(__version__),
        title=escape(title),
        origin=escape(origin),
        answer=escape(minus(answer).replace(">", " → ")),
        said="\n".join(f'<p class="said">{escape(minus(text))}</p>' for text in said if text),
        numbers=_numbers(numbers),
        warnings=warnings,
        body="\n".join(body),
    )


def part(heading: str, *content: str) -> str:
    """A part of a page under its heading; nothing where it has no content."""
    inside = "\n".join(filter(None, content))
    return f"<section>\n<h2>{escape(heading)}</h2>\n{inside}\n</section>" if inside else ""


def paragraph(text: str, kind: str = "") -> str:
    """A paragraph of plain text; nothing of none."""
    mark = f' class="{kind}"' if kind else ""
    return f"<p{mark}>{escape(minus(text))}</p>" if text else ""


def calibration(calibrated: Mapping[str, Any] | None) -> str:
    """What recordings that were folded in have told; "" for none."""
    return part(
        "Bands, weight and friction as calibrated",
        listed([] if calibrated is None else calibrated["summary"]),
    )


def listed(lines: Iterable[str]) -> str:
    """Lines of plain text as a list; nothing of none."""
    items = [f"<li>{escape(minus(line))}</li>" for line in lines]
    if not items:
        return ""
    return _folded("\n".join(["<ul>", *items, "</ul>"]), len(items), "lines")


def verbatim(text: str, about: str) -> str:
    """Text to be copied as it is; `about` tells those who do not see it what it is."""
    return f'<pre tabindex="0" role="region" aria-label="{escape(about)}">{escape(text)}</pre>'


def warned(head: str, text: str, lines: Sequence[str]) -> str:
    """What a reader has to know before all else; nothing where there are no lines."""
    if not lines:
        return ""
    return (
        f'<div class="warning" role="note"><strong>{escape(head)}</strong> {escape(text)}'
        f"{listed(lines)}</div>"
    )


def figures(*drawn: str) -> str:
    """Figures as `figure` makes them, side by side where there is room."""
    shown = "\n".join(filter(None, drawn))
    return f'<div class="figures">\n{shown}\n</div>' if shown else ""


def pictures(drawn: Mapping[str, Figure] | None, narrow: Mapping[str, Figure] | None = None) -> str:
    """Figures by caption, those that a phone shows in another form by the same in `narrow`."""
    small = narrow or {}
    return figures(*(figure(text, one, small.get(text)) for text, one in (drawn or {}).items()))


def figure(caption: str, drawn: Figure, narrow: Figure | None = None) -> str:
    """A figure under which stands what it is.

    Args:
        caption: what it shows.
        drawn: as it is on a wide window and on paper.
        narrow: as it is on a phone; where there is none, a wide one is moved sideways there.
    """
    source, width, height = image_of(drawn)
    text, size = escape(caption), f'width="{width}" height="{height}"'
    image = f'<img alt="{text}" {size} src="{source}">'
    wide = ' class="wide"' if width > _WIDE else ""
    if wide and narrow is not None:
        other, across, tall = image_of(narrow)
        smaller = f'<source media="{_PHONE}" width="{across}" height="{tall}" srcset="{other}">'
        image = f"<picture>{smaller}{image}</picture>"
    elif wide:
        image = _scrolled(image, caption)
    return f"<figure{wide}>{image}<figcaption>{text}</figcaption></figure>"


def motion(replay: str, title: str) -> str:
    """A replay, which a page on paper cannot show.

    Args:
        replay: a page, as of `studio.replay`.
        title: what moves.
    """
    still = paragraph("On a screen, this page plays the motion here.", "paper quiet")
    return f"{embedded(replay, title)}\n{still}"


def table(schema: Columns, rows: Sequence[Mapping[str, Any]], about: str) -> str:
    """A table with what it tells above it, cut where nobody would read on; nothing without rows."""
    if not rows:
        return ""
    columns = shown(schema)
    if len(rows) > MOST_ROWS:
        about += f" The first {MOST_ROWS} of {len(rows)} are shown."

    heads = [escape(headed(one.heading)) for one in columns]
    kinds = ["" if one.numeric else ' class="left"' for one in columns]
    head = "".join(f'<th scope="col"{k}>{h}</th>' for h, k in zip(heads, kinds, strict=True))
    # On a phone a row is a list, and each of its numbers has its heading beside it.
    body = "\n".join(
        "".join(
            f'<td{kind} data-head="{head}">{escape(_cell(one, row))}</td>'
            for one, head, kind in zip(columns, heads, kinds, strict=True)
        ).join(("<tr>", "</tr>"))
        for row in rows[:MOST_ROWS]
    )
    inside = f"<table><thead><tr>{head}</tr></thead>\n<tbody>{body}</tbody></table>"
    whole = _scrolled(inside, about.partition(".")[0])
    return paragraph(about, "quiet") + _folded(whole, min(len(rows), MOST_ROWS), "rows")


def _folded(content: str, count: int, what: str) -> str:
    """Content that is shown when it is asked for, if it is long."""
    if count <= _FOLDED:
        return content
    return f"<details><summary>Show {count} {what}</summary>\n{content}\n</details>"


def minus(text: str) -> str:
    """Text whose negative numbers have a minus sign."""
    return _MINUS.sub("\N{MINUS SIGN}", text)


def sentence(text: str) -> str:
    """Words as a sentence."""
    return f"{text[:1].upper()}{text[1:]}{'' if text[-1:] in '.!?' else '.'}" if text else ""


def _numbers(numbers: Mapping[str, str]) -> str:
    found = [
        f"<div><dt>{escape(name)}</dt><dd>{escape(minus(value))}</dd></div>"
        for name, value in numbers.items()
        if value
    ]
    return "\n".join(["<dl>", *found, "</dl>"]) if found else ""


def _scrolled(content: str, about: str) -> str:
    """What may be wider than a phone: it is moved sideways by itself, with keys too."""
    region = f'class="scroll" role="region" tabindex="0" aria-label="{escape(about)}"'
    return f"<div {region}>{content}</div>"


def image_of(drawn: Figure) -> tuple[str, int, int]:
    """A figure as an address that holds all of it, with its width and height [CSS px]."""
    from stepwell.figures import svg

    # An image, not inline markup: two SVGs on one page would share their ids.
    data = base64.b64encode(svg(drawn).encode()).decode()
    width, height = (round(96 * inches) for inches in drawn.get_size_inches())
    return f"data:image/svg+xml;base64,{data}", width, height


def _cell(column: Any, row: Mapping[str, Any]) -> str:
    # A name keeps its hyphens.
    words = not (column.numeric or isinstance(column, Column))
    return column.cell(row) if words else minus(column.cell(row))
