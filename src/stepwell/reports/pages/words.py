"""What a chain does, and how nearly it does something else, in sentences."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from stepwell.base import Measure, number, percent, told_in
from stepwell.statics import EventKind

if TYPE_CHECKING:
    from stepwell.design import Survival, Yield
    from stepwell.sequences import Cycle

# More names than these are not read, nor longer sequences in a sentence; of longer chains nobody
# asks what they become.
_MOST_NAMES, _MOST_LETTERS, MOST_SPELLED = 6, 60, 12
_DRIVEN = {
    Measure.TRAVEL: "Pulled out and let back",
    Measure.VOLUME: "Filled and emptied",
    Measure.ANGLE: "Turned and let back",
}
_TIMES = {0: "never snaps", 1: "snaps once", 2: "snaps twice"}


def arrows(sequence: str) -> str:
    """A sequence of states as it is read."""
    return sequence.replace(">", " → ")


def motion(cycle: Cycle) -> str:
    """What a chain does in a full cycle."""
    chain, snaps = cycle.chain, sum(e.kind is EventKind.SNAP for e in cycle.events)
    way = _DRIVEN[chain.measure]
    if len(str(cycle.sequence)) <= _MOST_LETTERS:
        way += f", it goes {arrows(str(cycle.sequence))}"
    else:
        way += f", it goes through {len(cycle.sequence)} states"
    lost = f"{number(cycle.dissipated * 1e3, 3)} mJ" if cycle.dissipated > 0 else "no energy"
    often = _TIMES.get(snaps, f"snaps {snaps} times")
    orders = ""
    if len(chain) > 1:
        out, back = (
            _order(one, chain.names) for one in (cycle.loading_order, cycle.unloading_order)
        )
        orders = f" On the way out {out}; on the way back {back}."
    return f"{way}.{orders} It {often}, and a cycle loses {lost}."


def _order(cells: Sequence[int], names: Sequence[str]) -> str:
    first, *others = [names[i] for i in cells[:_MOST_NAMES]] or ["nothing"]
    more = " and so on" * (len(cells) > _MOST_NAMES)
    return f"{first} moves first" + "".join(f", then {name}" for name in others) + more


def built(found: Yield | Survival, what: str = "do this") -> str:
    """How many of those built do what is wanted, which `what` tells."""
    low, high = map(percent, found.interval)
    count = f"{found.n:,}".replace(",", "\N{THIN SPACE}")
    return (
        f"Built {count} times by chance within {_tolerances(found)}, {percent(found.share)} "
        f"{what} (with 95 % confidence {low} to {high})."
    )


def _tolerances(found: Yield | Survival) -> str:
    given, chain = found.tolerances, found.chain
    levers = len(chain.elements) < len(chain)
    what = "bands" if levers else f"{chain.measure.force}s"
    told = [
        f"anchors ±{number(given.anchor * 1e3)} mm" if given.anchor and levers else "",
        f"{what} ±{number(given.stiffness * 100)} %" if given.stiffness else "",
        f"levers ±{number(given.lever * 1e3)} mm" if given.lever and levers else "",
        f"travels ±{number(given.travel * 100)} %" if given.travel and chain.elements else "",
    ]
    if given.friction:
        unit, factor = told_in(chain.measure.force_unit)
        told.append(f"friction up to {number(given.friction * factor)} {unit}")
    return " and ".join(", ".join(filter(None, told)).rsplit(", ", 1)) or "no tolerance"
