"""Machines of an atlas by what they do, and their neighbours in the space of designs."""

import re
from collections.abc import Callable
from operator import attrgetter
from pathlib import Path
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, InputError, Ints, nearest_word
from stepwell.concave import TOLD, classed, closed_graph
from stepwell.studies.blocks import DRIVES, packed
from stepwell.studies.designs import IndependentBlocks
from stepwell.studies.machines import Atlas, Machine, canonical, name_of
from stepwell.studies.store import Study

# Designs on every way, and how often the piece with the border is halved: to 3·10⁻⁵ of the way.
# Nearer to a border the engine would see a tie.
_STEPS, _HALVES = 32, 10


class Border(NamedTuple):
    """Where a machine becomes another one as one number of its most robust design is changed.

    Attributes:
        machine: its name.
        parameter: the number, all others staying.
        value: where it is another one already, just past the border, in SI; to some micrometres
            where a snap lands by a flow of several cells.
        step: from the design to there, in SI; its sign says which way.
        beyond: name of the machine that begins there, one of the atlas or not.
    """

    machine: str
    parameter: str
    value: float
    step: float
    beyond: str


def borders(study: Study, found: Atlas) -> tuple[Border, ...]:
    """The neighbours of every machine of the atlas of a store: what one small change makes of it.

    From its most robust design every number that varies is changed by itself, down and up to the
    ends of the space, until closed form tells another graph. A machine that takes up less than a
    thirty-second of such a way may be passed over. Where closed form does not tell what lies at a
    border, nothing is said. The order is of the atlas, then of the space, down before up.
    A `ValueError` refuses a study of no atlas.
    """
    designs = study.designs
    if not isinstance(designs, IndependentBlocks):
        raise InputError(f"{study.folder}: holds no atlas, but {study!r}.")
    drive = DRIVES[found.drive]
    numbers = packed(found.chain, [axis.name for axis in found.axes])
    starts = np.array([designs.space.points(m.design, m.design + 1)[0] for m in found.machines])
    # A way for every machine, number and end of the space.
    machines, axes, ends = (
        each.ravel()
        for each in np.indices((len(found.machines), len(found.axes), 2), dtype=np.int64)
    )
    reach = np.array([(axis.low, axis.high) for axis in found.axes])
    far = reach[axes, ends] - starts[machines, axes]

    def graphs(ways: Ints, shares: Floats) -> tuple[Ints, np.ndarray]:
        """The key of the graph at a share of each of these ways, and whether it is told."""
        points = starts[machines[ways]]
        points[np.arange(len(ways)), axes[ways]] += shares * far[ways]
        key, _, _, told = classed(numbers.at(points), drive)
        return key, told == TOLD

    own, _, _, _ = classed(numbers.at(starts), drive)
    all_ways, shares = np.arange(len(far)), np.arange(1, _STEPS + 1) / _STEPS
    key, told = graphs(np.repeat(all_ways, _STEPS), np.tile(shares, len(far)))
    key, told = (one.reshape(len(far), _STEPS) for one in (key, told))
    other = (key != own[machines][:, None]) | ~told
    first = np.argmax(other, axis=1)
    # Behind what is not told may be anything.
    ways = np.flatnonzero(other.any(axis=1) & told[all_ways, first] & (far != 0.0))
    high = shares[first[ways]]
    low = high - 1.0 / _STEPS
    for _ in range(_HALVES):
        half = 0.5 * (low + high)
        key, told = graphs(ways, half)
        ways, key = ways[told], key[told]
        low, high, half = low[told], high[told], half[told]
        same = key == own[machines[ways]]
        low, high = np.where(same, half, low), np.where(same, high, half)
    past = starts[machines[ways]]
    past[np.arange(len(ways)), axes[ways]] += high * far[ways]
    key, _ = graphs(ways, high)
    names: dict[int, str] = {}
    for one, cells in zip(key.tolist(), numbers.at(past), strict=True):
        if one not in names:
            names[one] = name_of(canonical(closed_graph(cells, drive), len(found.chain)))
    return tuple(
        Border(
            found.machines[machines[way]].name,
            found.axes[axes[way]].name,
            float(starts[machines[way], axes[way]] + share * far[way]),
            float(share * far[way]),
            names[one],
        )
        for way, share, one in zip(ways, high, key.tolist(), strict=True)
    )


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
        query: phrases of `QUERIES`, "counts to two" and the like ("by hand" too), a cycle such as
            "00>10>11>01>00" with cells numbered as they load, or a name; several with "and", each
            with "not" before it or without.
        least: yield that a machine must have, by the lower end of its interval.

    Raises:
        ValueError: a phrase that means nothing here; the text names the nearest.
    """
    found = [one for one in atlas.machines if one.kept.low >= least]
    for holds in understood(query):
        found = list(filter(holds, found))
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
        counter = attrgetter("counts_by_hand" if by_hand else "counts")
        if number := _WORDS.get(word) or (int(word) if word.isdecimal() else 0):
            return lambda machine: counter(machine) >= number
    near = nearest_word(phrase, QUERIES)
    guess = f" Did you mean {near!r}?" if near else ""
    raise InputError(
        f"{phrase!r}: must be a cycle such as 00>10>11>01>00, a name, counts to two, or one of "
        f"{', '.join(QUERIES)}.{guess}"
    )
