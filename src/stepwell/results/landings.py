"""Whether snaps land alike for other mobilities, as plain numbers and in the words for them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from stepwell.base import (
    Column,
    Columns,
    Quantity,
    Schema,
    in_measure,
    number,
    percent_at_most,
    record,
)
from stepwell.mechanism import Chain
from stepwell.statics import EventKind

if TYPE_CHECKING:
    from stepwell.statics import Event, Landing, Path

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


def landing_records(
    landings: Sequence[Landing], events: Sequence[Event], chain: Chain
) -> list[dict[str, Any]] | None:
    """What is known of the landings of snaps, each with its number among the events.

    None where there are snaps and nothing was asked of them.
    """
    if not landings and any(event.kind is EventKind.SNAP for event in events):
        return None
    folds = any(len(element.laws) > 1 for element in chain.elements)
    place = in_measure(_ELSEWHERE if folds else _ELSEWHERE[:-1], chain.measure)
    found: list[dict[str, Any]] = []
    at = -1
    for landing in landings:
        at = events.index(landing.event, at + 1)
        elsewhere = [record(place, one) for one in landing.elsewhere]
        found.append({"event": at, **record(_LANDING, landing), "elsewhere": elsewhere})
    return found


_LANDING: Schema = (
    Quantity("holds"),
    Quantity("ratio"),
    Quantity("proof"),
    Quantity("corners"),
    Quantity("samples"),
    Quantity("bound"),
)
_ELSEWHERE: Schema = (
    Quantity("state", head="in state"),
    Quantity("travel", "mm"),
    Quantity("mobility"),
    Quantity("share"),
    Quantity("sheet"),
)


def landings_told(landings: Sequence[Mapping[str, Any]] | None) -> str:
    """In a line, how many landings hold for other mobilities; "" where there are no snaps."""
    if landings is None:
        return NOT_CHECKED
    if not landings:
        return ""
    holding = [one for one in landings if one["holds"]]
    ratios = f"for mobility ratios up to {number(landings[0]['ratio'])}"
    if not holding:
        return f"no landing holds {ratios}"
    sampled = [one for one in holding if one["proof"] is None]
    proved, parts = len(holding) - len(sampled), []
    if proved:
        parts.append(f"{proved} proved" if sampled else "proved")
    if sampled:
        most = percent_at_most(max(one["bound"] for one in sampled))
        least = min(one["samples"] for one in sampled)
        many = f"in {len(sampled)} " if proved or sampled[1:] else ""
        each = " each" if sampled[1:] else ""
        parts.append(
            f"{many}at most {most} of mobilities lead elsewhere (95 % confidence, {least} samples"
            f"{each})"
        )
    all_hold = len(holding) == len(landings)
    many = "all hold" if all_hold else f"{len(holding)} of {len(landings)} hold"
    return f"{many if landings[1:] else 'holds'} {ratios}: {', '.join(parts)}"


def elsewhere_rows(
    landings: Sequence[Mapping[str, Any]] | None, events: Sequence[Mapping[str, Any]]
) -> list[dict[str, Any]]:
    """Every other place where one of these snaps lands, with the snap."""
    return [
        {**events[landing["event"]], **place}
        for landing in landings or ()
        for place in landing["elsewhere"]
    ]


def elsewhere_columns(chain: Chain, event: Schema) -> Columns:
    """The columns of a table of them; `event` is what is told of a snap."""
    told = {q.attribute: q for q in event}
    return (
        told["direction"],
        told["stroke"],
        Column("lands elsewhere if", lambda row: _condition(row["mobility"], chain.names)),
        _ELSEWHERE[0],
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
