"""How far a number can go before an answer changes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cache, partial

from stepwell.base import bisected

HALVINGS = 8


def changes(
    answer: Callable[[float], str], values: Sequence[float], halvings: int = HALVINGS
) -> Iterator[tuple[float, str]]:
    """Every value along `values` at which the answer changes, with the answer just past it.

    Looks at each value in turn and then halves the stretch in which the answer changes; a change
    that is undone between two neighbouring values goes unseen.

    Args:
        answer: what to ask at a value.
        values: where to look, in order; the first one is where to start from.
        halvings: of the stretch between two of them.
    """
    ask = cache(answer)

    def same(known: str, value: float) -> bool:
        return ask(value) == known

    known, before = ask(values[0]), values[0]
    for value in values[1:]:
        while not same(known, value):
            before = bisected(partial(same, known), before, value, halvings)[1]
            known = ask(before)
            yield before, known
        before = value
