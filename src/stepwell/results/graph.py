"""A transition graph's reading as plain numbers with the unit in every name."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from stepwell.base import plain as finite
from stepwell.results.head import head
from stepwell.results.ties import tie_notes

if TYPE_CHECKING:
    from stepwell.sequences import TransitionGraph
    from stepwell.sequences.memory import Accumulator, Latch, Loop, ReturnPointMemory

GRAPH_SCHEMA = "stepwell.graph/1"


def graph_record(graph: TransitionGraph, *, design: str | None = None) -> dict[str, Any]:
    """What a transition graph says in the terms of the field, as JSON can hold it.

    Args:
        graph: any.
        design: text of its design file, for the hash of it; written anew by default.

    Returns:
        The record that docs/commands.md describes; drives in mm, or in N under force control.
    """
    reading, in_unit = graph.reading, _Unit(graph)
    loops = reading.sub_loops
    gardens = reading.garden_of_eden
    return {
        **head(GRAPH_SCHEMA, design or graph.chain),
        "title": graph.chain.title if graph.chain else "",
        "actuator": graph.actuator,
        "cells": list(graph.names),
        "method": graph.method,
        "vertices": len(graph.vertices),
        "nodes": len(graph),
        "branches": reading.branches,
        "main_loop": in_unit.loop(reading.main_loop),
        "sub_loop_count": reading.sub_loop_count,
        "sub_loops": None if loops is None else [in_unit.loop(loop) for loop in loops],
        "garden_of_eden": None if gardens is None else list(gardens),
        "unreachable": list(reading.unreachable),
        "return_point_memory": in_unit.memory(reading.return_point_memory),
        "scrambling": [
            {
                "first_two": list(pair.cells),
                "direction": _way(pair.direction),
                "in_order_from": pair.i_first,
                "in_other_order_from": pair.j_first,
                "by_hand": not pair.reachable,
            }
            for pair in reading.scrambling
        ],
        "accumulators": [in_unit.accumulator(one) for one in reading.counting.accumulators],
        "accumulators_all": reading.counting.exhaustive,
        "latches": [in_unit.latch(one) for one in reading.latches],
        "ties": tie_notes(graph.ties, graph.chain),
    }


def _way(direction: int) -> str:
    return "loading" if direction > 0 else "unloading"


class _Unit:
    """Drives of a graph in the unit in which they are told."""

    def __init__(self, graph: TransitionGraph):
        self.name, self.factor = ("mm", 1e3) if graph.unit == "m" else (graph.unit or "1", 1.0)

    def drive(self, name: str, value: float) -> dict[str, float | None]:
        return {f"{name}_{self.name}": finite(value, self.factor)}

    def drives(self, name: str, values: Iterable[float]) -> dict[str, list[float | None]]:
        return {f"{name}_{self.name}": [finite(value, self.factor) for value in values]}

    def loop(self, loop: Loop) -> dict[str, Any]:
        ends = self.drive("low", loop.low) | self.drive("high", loop.high)
        return {"up": list(loop.up), "down": list(loop.down), **ends}

    def memory(self, memory: ReturnPointMemory) -> dict[str, Any]:
        lapse = memory.witness
        if lapse is None:
            return {"holds": True}
        turns = self.drives("turning_points", lapse.turns)
        return {"holds": False, **turns, "first": lapse.first, "later": lapse.later}

    def accumulator(self, one: Accumulator) -> dict[str, Any]:
        return {
            "states": list(one.states),
            "transient": one.transient,
            "period": one.period,
            "direction": _way(one.direction),
            **self.drive("low", one.low),
            **self.drive("high", one.high),
            **self.drive("slack", one.slack),
            "set_by_hand": one.by_hand,
            **self.drives("turning_points", one.turns),
        }

    def latch(self, latch: Latch) -> dict[str, Any]:
        return {
            "left": list(latch.nodes),
            "ways": [
                {"from": a, "to": b, "direction": _way(t.direction), **self.drive("drive", t.drive)}
                for a, b, t in latch.ways
            ],
        }
