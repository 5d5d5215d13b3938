"""Phrases and sections that several kinds of results share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from stepwell.accounts.account import Level, Notes, Section, Warned
from stepwell.accounts.assumptions import assumptions
from stepwell.accounts.head import About
from stepwell.base import Quantity, counted, number, told_in
from stepwell.mechanism import Chain

if TYPE_CHECKING:
    from stepwell.statics import Tie

# Of longer chains states are not written out in a line, and no change is followed to its end.
LONGEST_IN_A_LINE = 12
# The states of a chain are as many as its cells, each as long: past this only orders are given.
LONGEST_SPELLED_OUT = 64
_MOST_DRIVES = 6


def cells_of(chain: Chain) -> str:
    """How many cells a chain has."""
    return f"{counted(len(chain), 'cell')}, innermost first"


def listed(items: Sequence[str], most: int = LONGEST_IN_A_LINE) -> str:
    """Names in a line, the first of many."""
    return ", ".join(items[:most]) + f" and {len(items) - most} more" * (len(items) > most)


def turning_points(points: Sequence[float], chain: Chain) -> str:
    """Turning points of the drive, in SI, in a line."""
    unit, factor = told_in(chain.drive_unit)
    shown = " → ".join(number(point * factor) for point in points[:LONGEST_IN_A_LINE])
    left = len(points) - LONGEST_IN_A_LINE
    return f"{shown} {Quantity('', unit).sign}" + f" and {left} more" * (left > 0)


def degenerate(ties: Iterable[Tie], chain: Chain | None) -> Warned:
    """The warning of ties, see `tie_notes`."""
    return Warned(
        "Too close to call",
        "The model cannot tell which of these happens; a real mechanism will decide.",
        tie_notes(ties, chain),
    )


def calibration(about: About) -> Section:
    """What the recordings gave that a design was calibrated on."""
    given = about.calibrated
    heading = "Bands, weight and friction as calibrated"
    if given is None:
        return Section(heading, [])
    return Section(f"{heading} on {given.data}", [Notes(given.summary)])


def assumed(chain: Chain, *more: str) -> Section:
    """What the numbers of a chain assume; terminals have `more` alone, which is of the result."""
    found = [Notes(assumptions(chain), Level.PAGE), Notes([one for one in more if one])]
    return Section("Assumptions", found)


def tie_notes(ties: Iterable[Tie], chain: Chain | None) -> list[str]:
    """Advice on ties, once for the same cells and for cells that are alike.

    Args:
        ties: in the order in which they are met.
        chain: whose they are; None where it is not known, and then no cells are alike.

    Returns:
        A note for each: the advice on the first tie, and where the others are.
    """
    alike = {} if chain is None else _alike(chain)
    groups: dict[tuple[frozenset[int], int], list[Tie]] = {}
    for tie in ties:
        cells = frozenset(alike.get(cell, cell) for cell in tie.cells)
        groups.setdefault((cells, len(tie.cells)), []).append(tie)
    return [_note(group, chain) for group in groups.values()]


def _alike(chain: Chain) -> dict[int, int]:
    """For each cell the innermost one that is the same but for its name."""
    bare = [replace(cell, name="") for cell in chain.cells]
    first: dict[object, int] = {}
    return {i: first.setdefault(cell, i) for i, cell in enumerate(bare)}


def _note(group: list[Tie], chain: Chain | None) -> str:
    first = group[0]
    unit, factor = told_in(chain.drive_unit if chain else "m")
    # A rounding error is no other place, and has no sign.
    drives = dict.fromkeys(f"{round(tie.drive * factor, 6) + 0.0:.6g}" for tie in group)
    others = list(drives)[1:]
    cells = dict.fromkeys(cell for tie in group for cell in tie.cells)
    note = first.advice
    if set(cells) != set(first.cells) and chain is not None:
        note += f" So it is with all of {', '.join(chain.names[c] for c in sorted(cells))}, alike"
        note += " as they are" + (", also" if others else ".")
    elif others:
        note += " So it is also"
    if others:
        more = len(others) - _MOST_DRIVES
        note += f" at {', '.join(others[:_MOST_DRIVES])} {unit}"
        note += f" and {more} places more." if more > 0 else "."
    return note
