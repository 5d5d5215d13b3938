"""The page of a run: what a design does, how nearly it does something else, how surely."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell.base import Column, counted, number, percent, shown
from stepwell.design import judged
from stepwell.mechanism import Cell, Chain, Element
from stepwell.reports.pages import parts, words
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

    from stepwell.design import Margin, Yield
    from stepwell.sequences import Cycle
    from stepwell.statics import Landing

_LONGEST_SEQUENCE = 100
_NOT_BUILT = "Not computed here: the command stepwell yield counts them."
_NOT_PLAYED = (
    "The motion is not played here: the command stepwell replay writes it as a page of its own."
)


def report(
    cycle: Cycle,
    margin: Margin | None,
    figures: Mapping[str, Figure],
    source: str | None = None,
    landings: Sequence[Landing] | None = None,
    *,
    narrow: Mapping[str, Figure] | None = None,
    margins: Mapping[str, Figure] | None = None,
    built: Yield | None = None,
    built_as: Mapping[str, Figure] | None = None,
    replay: str = "",
) -> str:
    """The results of one design as a self-contained page.

    Nothing in it is fetched: styles are inline and figures are embedded. Nothing in it is run but
    the replay, in a frame of its own that reaches neither the page nor any address.

    Args:
        cycle: what the design does.
        margin: how far it is from doing something else; None where that was not computed.
        figures: what to show, in this order, by caption.
        source: the design file's name, for the head of the page.
        landings: as for `results.run_record`.
        narrow: those of the figures that a phone shows in another form, by the same caption.
        margins, built_as: figures of the margin and of the yield, by caption.
        built: how many of those built do it; None where that was not computed.
        replay: the motion, as of `studio.replay`; none by default.

    Returns:
        HTML text.
    """
    chain, record = cycle.chain, run_record(cycle, margin, landings)
    title = chain.title or source or "Untitled chain"
    origin = f"Design file {source}" if source else "A design made in Python"
    said = words.motion(cycle)
    pathway = f" The pathway is {cycle.pathway.label}." if cycle.pathway is not None else ""
    other = words.otherwise(margin, tied=bool(record["ties"]))
    return parts.page(
        title,
        f"{origin}. {counted(len(chain), 'cell')}, innermost first.",
        _sequence(cycle),
        [said + pathway, other],
        _numbers(chain, record, built),
        [
            parts.part(
                "How nearly it does something else",
                parts.pictures(margins),
                _margin(chain, margin, record["margin"]),
            ),
            parts.part(
                "How many of those built do it",
                parts.paragraph(words.built(built) if built else _NOT_BUILT),
                parts.pictures(built_as),
                parts.paragraph(parts.sentence(built.assumptions) if built else "", "quiet"),
            ),
            parts.part(
                "See it move",
                parts.motion(replay, title) if replay else parts.paragraph(_NOT_PLAYED),
            ),
            parts.part("Figures", parts.pictures(figures, narrow)),
            parts.part("Cells", _cells(chain, record["cells"])),
            parts.part(
                "Switches and snaps",
                _events(chain, record["events"]) + _landings(chain, record),
            ),
            parts.part("What the numbers assume", parts.listed(assumptions(chain))),
        ],
        parts.warned(
            "Too close to call.",
            "The model cannot tell which of these happens; a real mechanism will decide.",
            record["ties"],
        ),
    )


def _sequence(cycle: Cycle) -> str:
    sequence = cycle.sequence
    if len(sequence) * len(cycle.chain) <= _LONGEST_SEQUENCE:
        return str(sequence)
    return f"{len(sequence)} states of {len(cycle.chain)} cells"


def _numbers(chain: Chain, record: dict[str, Any], built: Yield | None) -> dict[str, str]:
    measure = chain.measure
    dissipated, peak, full, *driven = (f"{q.cell(record)} {q.sign}" for q in cycle_schema(chain))
    verdict = ""
    if built is not None:
        verdict = judged(does_it=True, tied=bool(record["ties"]), interval=built.interval).value
    found = {
        "Verdict, built as usual": verdict,
        "Snaps": str(sum(event["kind"] == "snap" for event in record["events"])),
        f"Peak actuator {measure.force}": peak,
        "Lost in a cycle": dissipated,
    }
    found |= {"Driven": driven[0]} if driven else {f"Full {measure.stroke}": full}
    if record["margin"] is not None:
        changes = nearest_changes(chain, record["margin"]["changes"])
        kinds = ["anchor"] if _has_levers(chain) else list(changes)
        nearest = next((changes[kind] for kind in kinds if kind in changes), "none within reach")
        found["Nearest other sequence"] = nearest
    if built is not None:
        found["Of those built do it"] = percent(built.share)
    return found


def _cells(chain: Chain, records: list[dict[str, Any]]) -> str:
    rows = [row | {"bands": _bands(cell)} for row, cell in zip(records, chain.cells, strict=True)]
    bands = Column("bands: anchors, stiffness k, rest length", lambda row: row["bands"])
    name, *others = shown(cell_schema(chain))
    about = (
        "F0 and F1 are the forces along travel at state 0 and state 1, k the stiffness of the "
        "cell's stiffest band, r its lever, the peak θmax, where its energy is largest."
    )
    if chain.elements:
        travel, _, force = chain.measure.words
        about = (
            f"A phase is a stretch of {travel} in which a cell can stand under a prescribed "
            f"{force}; it goes up to the next phase, and back down, at these. It is stable in the "
            f"phases in which it stands without any {force}."
        )
        if any(element.error_band for element in chain.elements):
            about += " ±: how far measured points lie from the curve at most."
    return parts.table([name, *([bands] if _has_levers(chain) else []), *others], rows, about)


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
    return parts.table(event_columns(chain, page=True), events, about)


def _landings(chain: Chain, record: dict[str, Any]) -> str:
    told = landings_told(record["landings"])
    elsewhere = elsewhere_rows(record["landings"], record["events"])
    text = parts.paragraph(f"Landings: {told}." if told else "")
    if not elsewhere:
        return text
    about = (
        "The same snaps with other mobilities of the cells: where else they land, the mobilities "
        "nearest to those given that were found to lead there, and how many of the samples do."
    )
    return text + parts.table(elsewhere_of(chain), elsewhere, about)


def _margin(chain: Chain, margin: Margin | None, record: dict[str, Any] | None) -> str:
    if margin is None or record is None:
        return parts.paragraph("Not computed.")
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
    return parts.table(change_columns(chain, changes), changes, about)
