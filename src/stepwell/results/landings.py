"""Whether snaps land alike for other mobilities, as plain numbers and in the words for them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from stepwell.base import Column, Columns, Quantity, Schema, in_measure, number, record
from stepwell.mechanism import Chain

if TYPE_CHECKING:
    from stepwell.statics import Landing, Path

# Every landing of these is checked unasked; that of more cells takes its time.
MOST_CHECKED = 8
NOT_CHECKED = "not checked for other mobilities"


def checked(path: Path, ratio: float | None = None) -> tuple[Landing, ...]:
    """What `Path.landings` finds within a ratio of mobilities.

    Args:
        path: whose snaps they are.
        ratio: None takes the usual one, and checks no chain of more than MOST_CHECKED cells.
    """
    if ratio is None:
        return path.landings() if len(path.chain) <= MOST_CHECKED else ()
    return path.landings(ratio)


def landing_schema(chain: Chain) -> Schema:
    """What is told of the landing of a snap of a chain."""
    folds = any(len(element.laws) > 1 for element in chain.elements)
    place = (
        Quantity("state"),
        Quantity("travel", "mm"),
        *([Quantity("sheet")] if folds else []),
        Quantity("mobility"),
        Quantity("share"),
    )
    place = in_measure(place, chain.measure)
    return (
        Quantity("holds"),
        Quantity("ratio"),
        Quantity("proof"),
        Quantity("samples"),
        Quantity(
            "elsewhere", read=lambda landing: [record(place, one) for one in landing.elsewhere]
        ),
    )


def landings_told(events: Sequence[Mapping[str, Any]]) -> str:
    """In a line, how many snaps of these records land alike for other mobilities."""
    snaps = [event for event in events if event["kind"] == "snap"]
    found = [event["landing"] for event in snaps if event["landing"] is not None]
    if not snaps:
        return ""
    if not found:
        return NOT_CHECKED
    holding = [one for one in found if one["holds"]]
    apart = f"for mobilities up to {number(found[0]['ratio'])} apart"
    if not holding:
        return f"no snap lands in one place {apart}"
    proved = sum(one["proof"] is not None for one in holding)
    tried = f"in all of {max(one['samples'] for one in holding)} samples"
    how = tried if proved == 0 else f"{proved} proved, {len(holding) - proved} {tried}"
    how = "proved" if proved == len(holding) else how
    many = f"{len(holding)} of {len(found)} hold" if len(holding) < len(found) else "all hold"
    return f"{many if found[1:] else 'holds'} {apart}: {how}"


def elsewhere_rows(events: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Every other place where one of these snaps lands, with the snap."""
    return [
        {**event, **place}
        for event in events
        if event["landing"] is not None
        for place in event["landing"]["elsewhere"]
    ]


def elsewhere_columns(chain: Chain, event: Schema) -> Columns:
    """The columns of a table of them; `event` is what is told of a snap."""
    told = {q.attribute: q for q in event}
    return (
        told["direction"],
        told["stroke"],
        Column("lands elsewhere if", lambda row: _condition(row["mobility"], chain.names)),
        Column("in state", lambda row: row["state"]),
        Column("samples", lambda row: f"{100 * row['share']:.0f} %", True),
    )


def _condition(mobility: Sequence[float], names: Sequence[str]) -> str:
    """Factors beside the given mobilities in words, such as "outer is 7 times faster"."""
    least, most = min(mobility), max(mobility)
    fast = [name for name, factor in zip(names, mobility, strict=True) if factor > least]
    slow = [name for name, factor in zip(names, mobility, strict=True) if factor < most]
    times = f"{number(most / least, 3)} times"
    # Cells between the fastest and the slowest are on both lists.
    if len(fast) == 1:
        return f"{fast[0]} is {times} faster"
    if len(slow) == 1:
        return f"{slow[0]} is {times} slower"
    factors = (f"{name} {number(x / least, 3)}" for name, x in zip(names, mobility, strict=True))
    return f"as fast as {', '.join(factors)}"
