"""A transition graph in the terms of the field: loops, memory, scrambling, latches."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stepwell.accounts.account import Account, Fact, Section, Text
from stepwell.accounts.head import About
from stepwell.accounts.shape import Shape
from stepwell.accounts.words import degenerate, tie_notes
from stepwell.base import Quantity, Schema

if TYPE_CHECKING:
    from stepwell.sequences import ImplicitGraph, MemoryReading, Sequence, TransitionGraph

# Letters of the longest sequence that a card spells out.
_MOST_LETTERS = 1000


def graph_schema(shape: Shape) -> Schema:
    """What is reported of a graph; drives are those of its actuator."""
    unit = shape.drive
    loop = (
        Quantity("up", holds=[str]),
        Quantity("down", holds=[str]),
        Quantity("low", unit),
        Quantity("high", unit),
    )
    return (
        Quantity("title", read=lambda graph: graph.chain.title if graph.chain else ""),
        Quantity("actuator"),
        Quantity("cells", read="names", holds=[str]),
        Quantity("method"),
        Quantity("vertices", read=lambda graph: len(graph.nodes.vertices), holds=int),
        Quantity("nodes", read=len, holds=int),
        Quantity("branches", read="reading.branches", holds=int),
        Quantity("main_loop", read="reading.main_loop", holds=loop),
        Quantity("sub_loop_count", read="reading.sub_loop_count", holds=int),
        Quantity("sub_loops", read="reading.sub_loops", holds=[loop], missing=True),
        Quantity("garden_of_eden", read="reading.garden_of_eden", holds=[str], missing=True),
        Quantity("unreachable", read="reading.unreachable", holds=[str]),
        Quantity("return_point_memory", read="reading.return_point_memory", holds=_memory(unit)),
        Quantity("scrambling", read="reading.scrambling", holds=[_SCRAMBLING]),
        Quantity("accumulators", read="reading.counting.accumulators", holds=[_accumulator(unit)]),
        Quantity("accumulators_all", read="reading.counting.exhaustive", holds=bool),
        Quantity("latches", read="reading.latches", holds=[_latch(unit)]),
        Quantity("ties", read=lambda graph: tie_notes(graph.ties, graph.chain), holds=[str]),
    )


_DIRECTION = Quantity("direction", read=lambda one: "loading" if one.direction > 0 else "unloading")
_SCRAMBLING: Schema = (
    Quantity("first_two", read="cells", holds=[int]),
    _DIRECTION,
    Quantity("in_order_from", read="i_first"),
    Quantity("in_other_order_from", read="j_first"),
    Quantity("by_hand", read=lambda pair: not pair.reachable, holds=bool),
)


def _memory(unit: str) -> Schema:
    """Whether turning points are remembered, and turning points with which they are not."""

    def of(name: str):
        return lambda memory: memory.witness and getattr(memory.witness, name)

    return (
        Quantity("holds", holds=bool),
        Quantity("turning_points", unit, read=of("turns"), holds=[float], missing=True),
        Quantity("first", read=of("first"), missing=True),
        Quantity("later", read=of("later"), missing=True),
    )


def _accumulator(unit: str) -> Schema:
    """Cycles that take two or more until they repeat."""
    return (
        Quantity("states", holds=[str]),
        Quantity("transient", holds=int),
        Quantity("period", holds=int),
        _DIRECTION,
        Quantity("low", unit),
        Quantity("high", unit),
        Quantity("slack", unit),
        Quantity("set_by_hand", read="by_hand", holds=bool),
        Quantity("turning_points", unit, read="turns", holds=[float]),
    )


def _latch(unit: str) -> Schema:
    ways = (
        Quantity("from", read=lambda way: way[0]),
        Quantity("to", read=lambda way: way[1]),
        Quantity("direction", read=lambda way: _DIRECTION.of(way[2])),
        Quantity("drive", unit, read=lambda way: way[2].drive),
    )
    return Quantity("left", read="nodes", holds=[str]), Quantity("ways", holds=[ways])


def shape_of(graph: TransitionGraph | ImplicitGraph) -> Shape:
    """The shape of a graph's chain; its own actuator may prescribe another thing."""
    chain = graph.chain
    shape = Shape() if chain is None else Shape.of(chain)
    return shape._replace(force_driven=graph.unit == shape.measure.force_unit)


def sequence_account(value: Sequence, about: About | None = None) -> Account:
    """What a notebook shows of a sequence."""
    spelled = len(value.first) * len(value) <= _MOST_LETTERS
    text = str(value) if spelled else repr(value)
    return Account(value, f"Sequence of {len(value)} states", answer=text)


def implicit_graph_account(value: ImplicitGraph, about: About | None = None) -> Account:
    """What a notebook shows of a graph whose states are not listed."""
    facts = [Fact(name, text) for name, text in value.facts.items()]
    return Account(value, _title(value), answer=value.summary, facts=facts)


def reading_account(value: MemoryReading, about: About | None = None) -> Account:
    """What is reported of a graph, given what is read off it."""
    return graph_account(value.graph, about)


def _title(graph: TransitionGraph | ImplicitGraph) -> str:
    chain = graph.chain
    return f"Transition graph of {chain.title}" if chain and chain.title else "Transition graph"


def graph_account(value: TransitionGraph, about: About | None = None) -> Account:
    """What is reported of a graph."""
    chain, reading = value.chain, value.reading
    counts = f"{len(value)} nodes, {value.transition_count} transitions."
    return Account(
        value,
        _title(value),
        "graph/2",
        graph_schema(shape_of(value)),
        answer=reading.summary,
        about=about or About(chain),
        facts=[Fact(name, text) for name, text in reading.facts.items()],
        warnings=[degenerate(value.ties, chain)],
        sections=[Section("Nodes", [Text(counts)])],
    )
