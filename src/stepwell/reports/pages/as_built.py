"""The page of a first build."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from stepwell.base import counted, number, percent
from stepwell.lab import KNOWN, MOVE, holes_told
from stepwell.reports.pages import parts

if TYPE_CHECKING:
    from stepwell.lab import AsBuilt

_ASSUMED = (
    "Parts vary each by itself within the tolerances; an anchor is now and then in the hole beside "
    "its own. What was seen is weighed by its doubt alone.",
    "Of anchors a motion knows q - p alone: p is taken as drawn, and q has what both are off.",
    "Several builds explain the same motion; where nothing was told of a number, its mean is that "
    "of all that may be.",
)


def as_built_page(found: AsBuilt, record: Mapping[str, Any]) -> str:
    """The page of a build.

    Args:
        found: what `lab.as_built` returns.
        record: the same as `lab.as_built_record` tells it.

    Returns:
        HTML text.
    """
    drawing = found.drawing
    best = found.moves[0] if found.moves else None
    wider = f", {number(found.wider)} times as far off as first thought" * (found.wider > 1)
    return parts.page(
        drawing.title or "A first build",
        f"{counted(len(drawing), 'cell')}, innermost first. Wanted: {found.wanted}".replace(
            ">", " → "
        ),
        parts.sentence(str(best) if best else "Leave its anchors"),
        [parts.sentence(record["advice"])],
        {
            "Do it as they are": percent(found.share),
            "After the move": "" if best is None else percent(best.share),
            "Of builds at random move so": f"{percent(found.agreeing)}{wider}",
            "Holes": holes_told(record),
        },
        [
            parts.part(
                "Moves of anchors",
                parts.table(MOVE, record["moves"], "The best, and how many then do it."),
            ),
            parts.part(
                "As built",
                parts.table(
                    KNOWN,
                    record["known"],
                    "Means and standard deviations, and those before.",
                ),
            ),
            parts.part("What the numbers assume", parts.listed(_ASSUMED)),
        ],
    )
