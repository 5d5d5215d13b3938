"""Search in the transition graphs of an atlas, and their boundaries in the design space."""

import re
from collections.abc import Callable
from operator import attrgetter
from pathlib import Path
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, InputError, Ints, nearest_word
from stepwell.concave import DECIDED, classed, closed_graph
from stepwell.studies.blocks import DRIVES, packed
from stepwell.studies.designs import IndependentBlocks
from stepwell.studies.graph_classes import Atlas, GraphClass, canonical, name_of
from stepwell.studies.store import Study

# Designs along each line, and number of bisections of the interval with the boundary: to 3·10⁻⁵ of
# the line. Closer to a boundary the engine would find a tie.
_STEPS, _HALVES = 32, 10


class ClassBoundary(NamedTuple):
    """Boundary to another transition graph along one parameter of a graph's most robust design.

    Attributes:
        graph_class: name of the graph class.
        parameter: the changed parameter; all others are constant.
        value: its value just past the boundary [SI]; within micrometres if several cells move
            together in a landing.
        step: signed change from the design to that value [SI].
        beyond: name of the graph past the boundary, in the atlas or not.
    """

    graph_class: str
    parameter: str
    value: float
    step: float
    beyond: str


def class_boundaries(study: Study, atlas: Atlas) -> tuple[ClassBoundary, ...]:
    """Nearest boundaries of every transition graph of an atlas, along each varied parameter.

    Each parameter of the most robust design is changed alone, down and up to the ends of the space,
    until the closed form gives another graph. A graph within less than 1/32 of that range may be
    missed. Boundaries without a closed form are left out. The order is that of the atlas, then of
    the space, down before up. A study without an atlas raises a `ValueError`.
    """
    designs = study.designs
    if not isinstance(designs, IndependentBlocks):
        raise InputError(f"{study.folder}: must contain an atlas, but contains {study!r}.")
    drive = DRIVES[atlas.drive]
    numbers = packed(atlas.chain, [axis.name for axis in atlas.axes])
    starts = np.array(
        [designs.space.points(m.design, m.design + 1)[0] for m in atlas.graph_classes]
    )
    # A line for every graph, parameter and end of the space.
    graph_classes, axes, ends = (
        each.ravel()
        for each in np.indices((len(atlas.graph_classes), len(atlas.axes), 2), dtype=np.int64)
    )
    reach = np.array([(axis.low, axis.high) for axis in atlas.axes])
    far = reach[axes, ends] - starts[graph_classes, axes]

    def graphs(ways: Ints, shares: Floats) -> tuple[Ints, np.ndarray]:
        """Key of the graph at a fraction of each line, and whether it is in closed form."""
        points = starts[graph_classes[ways]]
        points[np.arange(len(ways)), axes[ways]] += shares * far[ways]
        key, _, _, decided = classed(numbers.at(points), drive)
        return key, decided == DECIDED

    own, _, _, _ = classed(numbers.at(starts), drive)
    all_ways, shares = np.arange(len(far)), np.arange(1, _STEPS + 1) / _STEPS
    key, decided = graphs(np.repeat(all_ways, _STEPS), np.tile(shares, len(far)))
    key, decided = (one.reshape(len(far), _STEPS) for one in (key, decided))
    other = (key != own[graph_classes][:, None]) | ~decided
    first = np.argmax(other, axis=1)
    # Past a point without a closed form, the graph is unknown.
    ways = np.flatnonzero(other.any(axis=1) & decided[all_ways, first] & (far != 0.0))
    high = shares[first[ways]]
    low = high - 1.0 / _STEPS
    for _ in range(_HALVES):
        half = 0.5 * (low + high)
        key, decided = graphs(ways, half)
        ways, key = ways[decided], key[decided]
        low, high, half = low[decided], high[decided], half[decided]
        same = key == own[graph_classes[ways]]
        low, high = np.where(same, half, low), np.where(same, high, half)
    past = starts[graph_classes[ways]]
    past[np.arange(len(ways)), axes[ways]] += high * far[ways]
    key, _ = graphs(ways, high)
    names: dict[int, str] = {}
    for one, cells in zip(key.tolist(), numbers.at(past), strict=True):
        if one not in names:
            names[one] = name_of(canonical(closed_graph(cells, drive), len(atlas.chain)))
    return tuple(
        ClassBoundary(
            atlas.graph_classes[graph_classes[way]].name,
            atlas.axes[axes[way]].name,
            float(starts[graph_classes[way], axes[way]] + share * far[way]),
            float(share * far[way]),
            names[one],
        )
        for way, share, one in zip(ways, high, key.tolist(), strict=True)
    )


# The atlas in the package: 300,000 designs of three of the paper's cells, made by
# `stepwell atlas build --cells 3 --designs 3e5 --out three.zarr`.
THREE = Path(__file__).with_name("three.zarr")

_WORDS = {"one": 1, "two": 2, "three": 3, "four": 4, "five": 5}

# Phrases of a query.
QUERIES: dict[str, Callable[[GraphClass], bool]] = {
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


def find(atlas: Atlas, query: str, least: float = 0.0) -> tuple[GraphClass, ...]:
    """Transition graphs that satisfy a query, the highest yield first.

    Args:
        query: phrases joined by "and", each optionally after "not": those of `QUERIES`, "counts to
            two" ("by hand" too), a cycle such as "00>10>11>01>00" with cells numbered in loading
            order, or a name.
        least: least yield, compared with the lower end of its interval.

    Raises:
        ValueError: an unknown phrase; the error suggests the nearest known one.
    """
    matches = [one for one in atlas.graph_classes if one.kept.low >= least]
    for holds in understood(query):
        matches = list(filter(holds, matches))
    return tuple(
        sorted(matches, key=lambda one: (-one.kept.estimate, -one.fraction.estimate, one.name))
    )


def understood(query: str) -> list[Callable[[GraphClass], bool]]:
    """Conditions of a query on a graph; arguments and errors are those of `find`."""
    return [_asked(one) for one in re.split(r"\s+and\s+|\s*,\s*", query.strip())]


def _asked(phrase: str) -> Callable[[GraphClass], bool]:
    phrase = " ".join(phrase.lower().split())
    if phrase.startswith("not "):
        holds = _asked(phrase[4:])
        return lambda graph_class: not holds(graph_class)
    if phrase in QUERIES:
        return QUERIES[phrase]
    if re.fullmatch(r"[01]+(>[01]+)+", phrase):
        return lambda graph_class: graph_class.cycle == phrase
    if re.fullmatch(r"[0-9a-f]{8}", phrase):
        return lambda graph_class: graph_class.name == phrase
    if counts := _COUNTS.fullmatch(phrase):
        word, by_hand = counts.groups()
        counter = attrgetter("counts_by_hand" if by_hand else "counts")
        if number := _WORDS.get(word) or (int(word) if word.isdecimal() else 0):
            return lambda graph_class: counter(graph_class) >= number
    near = nearest_word(phrase, QUERIES)
    guess = f" Did you mean {near!r}?" if near else ""
    raise InputError(
        f"{phrase!r}: must be a cycle such as 00>10>11>01>00, a name, counts to two, or one of "
        f"{', '.join(QUERIES)}.{guess}"
    )
