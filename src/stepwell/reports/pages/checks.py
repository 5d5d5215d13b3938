"""The page of a verdict on a design."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from stepwell.base import counted, percent
from stepwell.reports.pages import parts, words
from stepwell.results import (
    assumptions,
    check_record,
    killer_words,
    measure_words,
    pull_words,
    verdict_words,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stepwell.design import Check


def check_page(
    found: Check,
    drawn: Mapping[str, Figure],
    replay: str,
    calibrated: Mapping[str, Any] | None = None,
) -> str:
    """The page of a verdict, the verdict first.

    Args:
        found: what `design.check` returns.
        drawn: figures by caption; none where what draws them is not installed.
        replay: its motion as a page, if it has one.
        calibrated: what is told of the recordings that were folded in; None for none.

    Returns:
        HTML text.
    """
    chain, told = found.chain, check_record(found)
    measure = measure_words(told, chain)
    killer = parts.sentence(killer_words(told, chain))
    return parts.page(
        chain.title or "A design",
        f"{counted(len(chain), 'cell')}, innermost first. Wanted: {words.arrows(found.wanted)}.",
        parts.sentence(verdict_words(told)),
        [words.built(found.yield_), words.arrows(killer)],
        {
            "Do what is wanted": percent(found.yield_.share),
            "Surely between": " and ".join(map(percent, found.yield_.interval)),
            "Pull": pull_words(told, chain),
        },
        [
            parts.part(
                "What to measure next",
                parts.paragraph(f"Measure {measure}." if measure else ""),
            ),
            parts.part("What those built do", parts.pictures(drawn)),
            parts.part("See it move", parts.motion(replay, found.wanted) if replay else ""),
            parts.part(
                "Out of the ordinary",
                parts.listed([parts.sentence(line) for line in found.oddities]),
            ),
            parts.calibration(calibrated),
            parts.part(
                "What the numbers assume",
                parts.listed([*assumptions(chain), parts.sentence(found.yield_.assumptions)]),
            ),
        ],
        parts.warned(
            "Too close to call.",
            "The model cannot tell which of these happens; a real mechanism will decide.",
            told["ties"],
        ),
    )
