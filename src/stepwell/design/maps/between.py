"""What changes between two cycles, in words."""

from itertools import combinations

from stepwell.design.plane import BoundaryKind
from stepwell.sequences import Sequence

# Longest chain whose sequences are written out, and pairs of cells that are named.
_SHORT = 4
_NAMED = 3


def between(a: Sequence, b: Sequence, names: tuple[str, ...]) -> tuple[BoundaryKind, str]:
    """The kind of boundary between two sequences of one chain, and what changes across it.

    Cells that change places are named; sequences of up to four cells are written out.
    """
    first, second = a.orders, b.orders
    both = f"{a} | {b}" if len(names) <= _SHORT else ""
    if first is None or second is None:
        return BoundaryKind.PATHWAY, both or _parting(a, b)
    loading, unloading = (_swapped(first[k], second[k], names) for k in (0, 1))
    if loading == unloading:
        words = f"{loading} change places while loading and unloading"
    else:
        ways = (("loading", loading), ("unloading", unloading))
        words = ", ".join(f"{who} change places while {way}" for way, who in ways if who)
    kind = BoundaryKind.PATHWAY
    if not unloading:
        kind = BoundaryKind.LOADING_ORDER
    elif not loading:
        kind = BoundaryKind.UNLOADING_ORDER
    return kind, f"{words}: {both}" if both else words


def _swapped(a: tuple[int, ...], b: tuple[int, ...], names: tuple[str, ...]) -> str:
    """Pairs of cells that come in another order in b, in words; empty if none do."""
    place = {cell: k for k, cell in enumerate(b)}
    pairs = [(i, j) for i, j in combinations(a, 2) if place[i] > place[j]]
    words = [f"{names[min(i, j)]} and {names[max(i, j)]}" for i, j in pairs[:_NAMED]]
    more = f" and {len(pairs) - _NAMED} more pairs" if len(pairs) > _NAMED else ""
    return ", ".join(words) + more


def _parting(a: Sequence, b: Sequence) -> str:
    """The state after which two sequences differ, and where each goes from there."""
    for k, state in enumerate(a.states):
        ahead = [s.states[k + 1] if k + 1 < len(s) else "its end" for s in (a, b)]
        if ahead[0] != ahead[1]:
            return f"from {state} to {ahead[0]} | to {ahead[1]}"
    return "nothing"
