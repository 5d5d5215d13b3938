"""One HTML page that tells what a design does, how sure that is and what it assumes."""

from __future__ import annotations

import base64
import re
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from importlib.resources import files
from string import Template
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell.base import Column, Columns, __version__, number, shown
from stepwell.mechanism import Cell, Chain, Element
from stepwell.results import (
    assumptions,
    cell_schema,
    change_columns,
    cycle_schema,
    elsewhere_of,
    elsewhere_rows,
    event_columns,
    landings_told,
    nearest_changes,
    run_record,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stepwell.design import Margin
    from stepwell.sequences import Cycle
    from stepwell.statics import Landing

# Longer tables help nobody; the path's CSV has everything.
_MOST_ROWS = 200
_LONGEST_SEQUENCE = 2000
_MINUS = re.compile(r"(?<![^\s(])-(?=\d)")


def report(
    cycle: Cycle,
    margin: Margin | None,
    figures: Mapping[str, Figure],
    source: str | None = None,
    landings: Sequence[Landing] | None = None,
) -> str:
    """The results of one design as a self-contained page.

    Nothing in it is fetched or run: styles are inline, figures are embedded, there is no script.

    Args:
        cycle: what the design does.
        margin: how far it is from doing something else; None where that was not computed.
        figures: what to show, in this order, by caption.
        source: the design file's name, for the head of the page.
        landings: as for `results.run_record`.

    Returns:
        HTML text.
    """
    chain, record = cycle.chain, run_record(cycle, margin, landings)
    page = Template((files("stepwell.reports") / "report.html").read_text("utf-8"))
    origin = f"Design file {source}" if source else "A design made in Python"
    return page.substitute(
        version=escape(__version__),
        title=escape(chain.title or source or "Untitled chain"),
        origin=escape(f"{origin}. {len(chain)} cell{'s' * (len(chain) != 1)}, innermost first."),
        sequence=escape(_sequence(cycle).replace(">", " → ")),
        meaning=escape(_meaning(cycle)),
        numbers=_numbers(chain, record),
        warnings=_warnings(record["ties"]),
        figures="\n".join(_figure(caption, figure) for caption, figure in figures.items()),
        cells=_cells(chain, record["cells"]),
        events=_events(chain, record["events"]) + _landings(chain, record),
        margin=_margin(chain, margin, record["margin"]),
        assumptions="\n".join(f"<li>{escape(line)}</li>" for line in assumptions(chain)),
    )


def _sequence(cycle: Cycle) -> str:
    sequence = cycle.sequence
    if len(sequence) * len(cycle.chain) <= _LONGEST_SEQUENCE:
        return str(sequence)
    return f"{len(sequence)} states of {len(cycle.chain)} cells"


def _meaning(cycle: Cycle) -> str:
    names = cycle.chain.names

    def order(cells: Sequence[int]) -> str:
        return ", ".join(names[i] for i in cells[:12]) + ", …" * (len(cells) > 12)

    pathway = f"Pathway {cycle.pathway.label}. " if cycle.pathway is not None else ""
    return (
        f"{pathway}Cells load in the order {order(cycle.loading_order)}, and unload in the order "
        f"{order(cycle.unloading_order)}."
    )


def _numbers(chain: Chain, record: dict[str, Any]) -> str:
    measure = chain.measure
    dissipated, peak, full, *driven = (f"{q.cell(record)} {q.sign}" for q in cycle_schema(chain))
    found = [
        ("Snaps", str(sum(event["kind"] == "snap" for event in record["events"]))),
        (f"Peak actuator {measure.force}", peak),
        ("Dissipated in a cycle", dissipated),
        *([("Driven", *driven)] if driven else [(f"Full {measure.stroke}", full)]),
    ]
    if record["margin"] is not None:
        changes = nearest_changes(chain, record["margin"]["changes"])
        kinds = ["anchor"] if _has_levers(chain) else list(changes)
        nearest = next((changes[kind] for kind in kinds if kind in changes), "none within reach")
        found.append(("Nearest other sequence", nearest))
    return "\n".join(
        f"<div><dt>{escape(name)}</dt><dd>{escape(_minus(value))}</dd></div>"
        for name, value in found
    )


def _warnings(ties: list[str]) -> str:
    if not ties:
        return ""
    items = "".join(f"<li>{escape(text)}</li>" for text in ties)
    return (
        '<div class="warning" role="note"><strong>Too close to call.</strong> The model cannot '
        f"tell which of these happens; a real mechanism will decide.<ul>{items}</ul></div>"
    )


def _figure(caption: str, figure: Figure) -> str:
    from stepwell.figures import svg

    # An image, not inline markup: two SVGs on one page would share their ids.
    data = base64.b64encode(svg(figure).encode()).decode()
    width, height = (round(96 * inches) for inches in figure.get_size_inches())
    wide = ' class="wide"' if width > 400 else ""
    text = escape(caption)
    return (
        f'<figure{wide}><img alt="{text}" width="{width}" height="{height}" '
        f'src="data:image/svg+xml;base64,{data}"><figcaption>{text}</figcaption></figure>'
    )


def _cells(chain: Chain, records: list[dict[str, Any]]) -> str:
    rows = [row | {"bands": _bands(cell)} for row, cell in zip(records, chain.cells, strict=True)]
    bands = Column("bands: anchors, stiffness k, rest length", lambda row: row["bands"])
    name, *others = shown(cell_schema(chain))
    about = (
        "F0 and F1 are the forces along travel at state 0 and state 1, k the stiffness of the "
        "cell's stiffest band, r its lever, the peak θmax, where its energy is largest."
    )
    if chain.elements:
        words = chain.measure
        about = (
            f"A phase is a stretch of {words.travel} in which a cell can stand under a prescribed "
            f"{words.force}; it goes up to the next phase, and back down, at these. It is stable "
            f"in the phases in which it stands without any {words.force}."
        )
        if any(element.error_band for element in chain.elements):
            about += " ±: how far measured points lie from the curve at most."
    return _table([name, *([bands] if _has_levers(chain) else []), *others], rows, about)


def _has_levers(chain: Chain) -> bool:
    return len(chain.elements) < len(chain)


def _bands(cell: Cell | Element) -> str:
    if isinstance(cell, Element):
        return ""
    return "; ".join(
        "p ({}, {}) mm, q ({}, {}) mm, {} N/m, {} mm".format(
            *(number(at * 1e3) for at in (*band.p, *band.q)),
            number(band.stiffness),
            number(band.rest_length * 1e3),
        )
        for band in cell.bands
    )


def _events(chain: Chain, events: list[dict[str, Any]]) -> str:
    arriving = "in another phase" if chain.elements else "at a stop"
    stroke = chain.measure.stroke
    jump = "a jump that no stroke can stop" if stroke == "stroke" else f"a jump at a fixed {stroke}"
    about = (
        f"A switch is a cell arriving {arriving}; a snap is {jump}. "
        f"{stroke.capitalize()}s are exact, not read off a grid."
    )
    return _table(event_columns(chain, page=True), events, about)


def _landings(chain: Chain, record: dict[str, Any]) -> str:
    told = landings_told(record["landings"])
    elsewhere = elsewhere_rows(record["landings"], record["events"])
    text = f"<p>Landings: {escape(told)}.</p>" if told else ""
    if not elsewhere:
        return text
    about = (
        "The same snaps with other mobilities of the cells: where else they land, the mobilities "
        "nearest to those given that were found to lead there, and how many of the samples do."
    )
    return text + _table(elsewhere_of(chain), elsewhere, about)


def _margin(chain: Chain, margin: Margin | None, record: dict[str, Any] | None) -> str:
    if margin is None or record is None:
        return "<p>Not computed.</p>"
    distances = [change.distance for change in margin.changes]
    changes = [record["changes"][k] for k in np.argsort(distances, kind="stable")]
    how = (
        "exact: every change is in closed form"
        if margin.method == "exact"
        else f"searched with the engine. {margin.resolution}"
    )
    gap = (
        f" The smallest gap between two F0 or two F1 is {number(record['gap_over_kr'])} times k r "
        f"of the innermost cell."
        if record["gap_over_kr"] is not None
        else ""
    )
    reach = f"; anchors were moved by up to {number(record['reach_mm'])} mm"
    about = (
        f"The smallest change of one thing at a time that gives another sequence ({how})"
        f"{reach if _has_levers(chain) else ''}.{gap}"
    )
    return _table(change_columns(chain, changes), changes, about)


def _table(columns: Columns, rows: list[dict[str, Any]], about: str) -> str:
    if len(rows) > _MOST_ROWS:
        about += f" The first {_MOST_ROWS} of {len(rows)} are shown."

    def line(tag: str, values: Iterable[str]) -> str:
        made = (
            f"<{tag}{'' if one.numeric else ' class=left'}>{escape(value)}</{tag.split()[0]}>"
            for one, value in zip(columns, values, strict=True)
        )
        return f"<tr>{''.join(made)}</tr>"

    head = line("th scope=col", (one.heading[:1].upper() + one.heading[1:] for one in columns))
    body = "\n".join(line("td", (_cell(one, row) for one in columns)) for row in rows[:_MOST_ROWS])
    return (
        f'<div class="scroll"><table><caption>{escape(about)}</caption>'
        f"<thead>{head}</thead>\n<tbody>{body}</tbody></table></div>"
    )


def _cell(column: Any, row: dict[str, Any]) -> str:
    # A name keeps its hyphens.
    words = not (column.numeric or isinstance(column, Column))
    return column.cell(row) if words else _minus(column.cell(row))


def _minus(text: str) -> str:
    return _MINUS.sub("\N{MINUS SIGN}", text)
