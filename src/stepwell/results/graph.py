"""A transition graph's reading as plain numbers with the unit in every name."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from stepwell.accounts import head, tie_notes
from stepwell.base import Quantity, Schema, record, told_in

if TYPE_CHECKING:
    from stepwell.sequences import ImplicitGraph, Transition, TransitionGraph
    from stepwell.sequences.memory import Latch, ReturnPointMemory

_DIRECTION = Quantity("direction", read=lambda one: "loading" if one.direction > 0 else "unloading")
SCRAMBLING: Schema = (
    Quantity("first_two", read="cells"),
    _DIRECTION,
    Quantity("in_order_from", read="i_first"),
    Quantity("in_other_order_from", read="j_first"),
    Quantity("by_hand", read=lambda pair: not pair.reachable),
)


def loop_schema(unit: str) -> Schema:
    """What is told of a loop; `unit` is that of the drive, as of those below."""
    return Quantity("up"), Quantity("down"), Quantity("low", unit), Quantity("high", unit)


def lapse_schema(unit: str) -> Schema:
    """What is told of turning points with which return-point memory fails."""
    turns = Quantity("turning_points", unit, read="turns")
    return turns, Quantity("first"), Quantity("later")


def accumulator_schema(unit: str) -> Schema:
    """What is told of cycles that take two or more to come into a rhythm."""
    return (
        Quantity("states"),
        Quantity("transient"),
        Quantity("period"),
        _DIRECTION,
        Quantity("low", unit),
        Quantity("high", unit),
        Quantity("slack", unit),
        Quantity("set_by_hand", read="by_hand"),
        Quantity("turning_points", unit, read="turns"),
    )


def graph_record(graph: TransitionGraph, *, design: str | None = None) -> dict[str, Any]:
    """What a transition graph says in the terms of the field, as docs/commands.md describes it."""
    reading = graph.reading
    unit, _ = told_in(graph.unit or "1")
    loop = partial(record, loop_schema(unit))
    loops, gardens = reading.sub_loops, reading.garden_of_eden
    return {
        **head("graph/1", design or graph.chain),
        "title": graph.chain.title if graph.chain else "",
        "actuator": graph.actuator,
        "cells": list(graph.names),
        "method": graph.method,
        "vertices": len(graph.nodes.vertices),
        "nodes": len(graph),
        "branches": reading.branches,
        "main_loop": loop(reading.main_loop),
        "sub_loop_count": reading.sub_loop_count,
        "sub_loops": None if loops is None else [loop(one) for one in loops],
        "garden_of_eden": None if gardens is None else list(gardens),
        "unreachable": list(reading.unreachable),
        "return_point_memory": _memory(reading.return_point_memory, unit),
        "scrambling": [record(SCRAMBLING, pair) for pair in reading.scrambling],
        "accumulators": [
            record(accumulator_schema(unit), one) for one in reading.counting.accumulators
        ],
        "accumulators_all": reading.counting.exhaustive,
        "latches": [_latch(one, unit) for one in reading.latches],
        "ties": tie_notes(graph.ties, graph.chain),
    }


def _memory(memory: ReturnPointMemory, unit: str) -> dict[str, Any]:
    if memory.witness is None:
        return {"holds": True}
    return {"holds": False, **record(lapse_schema(unit), memory.witness)}


def _latch(latch: Latch, unit: str) -> dict[str, Any]:
    told = (_DIRECTION, Quantity("drive", unit))
    ways = [{"from": a, "to": b, **record(told, way)} for a, b, way in latch.ways]
    return {"left": list(latch.nodes), "ways": ways}


# Nodes of a walk that show how it goes on.
WALKED = 24


def implicit_graph_record(
    graph: ImplicitGraph,
    *,
    start: str | None = None,
    most: int = WALKED,
    design: str | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> dict[str, Any]:
    """What a graph that is not listed says, as docs/commands.md describes it.

    Args:
        graph: of any chain.
        start: where the walk begins; all cells at 0 by default.
        most: nodes of the walk.
        design: text of the design file.
        progress: called with (done, total) nodes.
    """
    start = graph.zero if start is None else start
    unit, _ = told_in(graph.unit)
    ends = Quantity("low", unit), Quantity("high", unit)
    walk: list[dict[str, Any]] = []
    for done, node in enumerate(graph.walk(start, most=most)):
        if progress is not None:
            progress(done, most)
        up, down = (_way(graph.transition(node.label, way), unit) for way in (+1, -1))
        walk.append({"label": node.label} | record(ends, node) | {"up": up, "down": down})
    return {
        **head("implicit_graph/1", design or graph.chain),
        "title": graph.chain.title,
        "actuator": graph.actuator,
        "cells": list(graph.names),
        "method": graph.method,
        "vertices": _count(graph.vertex_count),
        "transitions": _count(graph.transition_count),
        "reached": _count(graph.reached_count),
        "sub_loop_count": _count(graph.sub_loop_count),
        "garden_of_eden_count": _count(graph.garden_count),
        "start": start,
        "walk": walk,
        "walk_whole": len(walk) < most,
        "ties": tie_notes(graph.ties, graph.chain),
    }


def _way(way: tuple[str, Transition] | None, unit: str) -> dict[str, Any] | None:
    if way is None:
        return None
    told = Quantity("drive", unit), Quantity("cells"), Quantity("released", "mJ")
    return {"to": way[0], "kind": way[1].kind.name.lower(), **record(told, way[1])}


def _count(count: int | None) -> int | None:
    # Python writes no whole number of more than 4300 digits.
    return None if count is None or count.bit_length() > 14_000 else count
