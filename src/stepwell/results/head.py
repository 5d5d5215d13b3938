"""What results say of themselves: schema, what they were computed from and with, and ties."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from stepwell.base import __version__, told_in, versions
from stepwell.files import digest
from stepwell.mechanism import Chain
from stepwell.statics import Tie

if TYPE_CHECKING:
    from stepwell.robot import Robot

_MOST_DRIVES = 6


def head(
    schema: str, design: str | Chain | Robot | None, seed: int | None = None, *packages: str
) -> dict[str, Any]:
    """The first names of every record, so that a result can be matched with its design.

    Args:
        schema: of the record.
        design: text of the design file, or what such a file is written for.
        seed: of the draws; None where nothing is drawn.
        packages: that took part, besides NumPy, SciPy and Numba.

    Returns:
        `schema`, `stepwell`, `versions`, `design_sha256` (None of a design that no file can
        hold) and `seed`.
    """
    if design is not None and not isinstance(design, str):
        from stepwell.files import dumps

        try:
            design = dumps(design)
        except ValueError:
            design = None
    return {
        "schema": schema,
        "stepwell": __version__,
        "versions": versions(*packages),
        "design_sha256": None if design is None else digest(design),
        "seed": seed,
    }


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
