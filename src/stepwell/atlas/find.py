"""Machines of an atlas by what they do."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

from stepwell.atlas.atlas import Atlas, Machine
from stepwell.base import InputError, nearest_word

# The atlas that comes with Stepwell: 300,000 designs of three of the paper's cells, as
# `stepwell atlas build --cells 3 --designs 3e5 --out three.zarr` makes it.
THREE = Path(__file__).with_name("three.zarr")

_WORDS = {"one": 1, "two": 2, "three": 3, "four": 4, "five": 5}

# What can be asked, and what it means.
QUERIES: dict[str, Callable[[Machine], bool]] = {
    "counts": lambda m: m.counts > 0,
    "counts by hand": lambda m: m.counts_by_hand > 0,
    "remembers": lambda m: m.remembers,
    "forgets": lambda m: not m.remembers,
    "scrambles": lambda m: m.scrambled > 0,
    "latches": lambda m: m.latches > 0,
    "has a garden": lambda m: m.gardens > 0,
    "never snaps": lambda m: m.snaps == 0,
    "snaps": lambda m: m.snaps > 0,
    "reaches every state": lambda m: m.reached == m.states,
    "has loops": lambda m: m.sub_loops > 0,
}
_COUNTS = re.compile(r"counts to (\w+)( by hand)?")


def find(atlas: Atlas, query: str, least: float = 0.0) -> tuple[Machine, ...]:
    """The machines that do all that is asked, the highest yield first.

    Args:
        atlas: in which they are looked for.
        query: phrases of `QUERIES`, "counts to two" and the like ("by hand" too), a cycle such as
            "00>10>11>01>00" with cells numbered as they load, or a name; several with "and", each
            with "not" before it or without.
        least: yield that a machine must have, by the lower end of its interval.

    Raises:
        ValueError: a phrase that means nothing here; the text names the nearest.
    """
    wanted = understood(query)
    found = [
        one
        for one in atlas.machines
        if all(holds(one) for holds in wanted) and one.kept.low >= least
    ]
    return tuple(sorted(found, key=lambda one: (-one.kept.share, -one.share.share, one.name)))


def understood(query: str) -> list[Callable[[Machine], bool]]:
    """What a query asks of a machine; arguments and errors as for `find`."""
    return [_asked(one) for one in re.split(r"\s+and\s+|\s*,\s*", query.strip())]


def _asked(phrase: str) -> Callable[[Machine], bool]:
    phrase = " ".join(phrase.lower().split())
    if phrase.startswith("not "):
        holds = _asked(phrase[4:])
        return lambda machine: not holds(machine)
    if phrase in QUERIES:
        return QUERIES[phrase]
    if re.fullmatch(r"[01]+(>[01]+)+", phrase):
        return lambda machine: machine.cycle == phrase
    if re.fullmatch(r"[0-9a-f]{8}", phrase):
        return lambda machine: machine.name == phrase
    if counts := _COUNTS.fullmatch(phrase):
        word, by_hand = counts.groups()
        number = _WORDS.get(word) or (int(word) if word.isdecimal() else 0)
        if number:
            if by_hand:
                return lambda machine: machine.counts_by_hand >= number
            return lambda machine: machine.counts >= number
    near = nearest_word(phrase, QUERIES)
    guess = f" Did you mean {near!r}?" if near else ""
    raise InputError(
        f"{phrase!r}: must be a cycle such as 00>10>11>01>00, a name, counts to two, or one of "
        f"{', '.join(QUERIES)}.{guess}"
    )
