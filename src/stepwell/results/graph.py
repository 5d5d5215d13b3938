"""A transition graph's reading as plain numbers with the unit in every name."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from stepwell.base import Quantity, Schema, record, told_in
from stepwell.results.head import head, tie_notes

if TYPE_CHECKING:
    from stepwell.sequences import TransitionGraph
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
        **head("stepwell.graph/1", design or graph.chain),
        "title": graph.chain.title if graph.chain else "",
        "actuator": graph.actuator,
        "cells": list(graph.names),
        "method": graph.method,
        "vertices": len(graph.vertices),
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
