"""Transition graphs: loops, memory, scrambling, latches; of the largest ones, a walk."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

from stepwell.accounts.head import About, Shape
from stepwell.accounts.parts import Account, Fact, RecordTable, Section, Text
from stepwell.accounts.words import LONGEST_IN_A_LINE, degenerate, listed, tie_notes
from stepwell.base import Column, Columns, Quantity, Schema, quantities

if TYPE_CHECKING:
    from stepwell.sequences import ImplicitGraph, MemoryReading, Sequence, TransitionGraph, Walked


# Letters of the longest sequence that a card spells out.
_MOST_LETTERS = 1000


def graph_schema(shape: Shape) -> Schema:
    """What is reported of a graph; drives are those of its actuator."""
    unit = shape.drive
    loop = (*quantities(up=[str], down=[str]), Quantity("low", unit), Quantity("high", unit))
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
        *quantities(states=[str], transient=int, period=int),
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


def sequence_account(value: Sequence, about: About) -> Account:
    """What a notebook shows of a sequence."""
    spelled = len(value.first) * len(value) <= _MOST_LETTERS
    text = str(value) if spelled else repr(value)
    return Account(value, f"Sequence of {len(value)} states", answer=text)


def implicit_graph_account(value: ImplicitGraph, about: About) -> Account:
    """What a notebook shows of a graph whose states are not listed."""
    facts = [Fact(name, text) for name, text in value.facts.items()]
    return Account(value, _title(value), answer=value.summary, facts=facts)


def reading_account(value: MemoryReading, about: About) -> Account:
    """What is reported of a graph, given what is read off it."""
    return graph_account(value.graph, about)


def _title(graph: TransitionGraph | ImplicitGraph) -> str:
    chain = graph.chain
    return f"Transition graph of {chain.title}" if chain and chain.title else "Transition graph"


def graph_account(value: TransitionGraph, about: About) -> Account:
    """What is reported of a graph."""
    chain, reading = value.chain, value.reading
    counts = f"{len(value)} nodes, {value.transition_count} transitions."
    return Account(
        value,
        _title(value),
        "graph/2",
        graph_schema(shape_of(value)),
        answer=reading.summary,
        facts=[Fact(name, text) for name, text in reading.facts.items()],
        warnings=[degenerate(value.ties, chain)],
        sections=[Section("Nodes", Text(counts))],
    )


_FEW = 4  # cells of a row
# What is shown of a cell that has moved; where it has two phases, its name tells that it did.
_PLACE = {"01": "", "11": "", **{f"-{last}": " in transit" for last in "123456789"}}


def implicit_graph_schema(shape: Shape) -> Schema:
    """What is reported of a walk."""
    way = (
        Quantity("to", read=lambda way: way[0]),
        Quantity("kind", read=lambda way: way[1].kind.name.lower()),
        Quantity("drive", shape.drive, read=lambda way: way[1].drive),
        Quantity("cells", read=lambda way: way[1].cells, holds=[int]),
        Quantity("released", "mJ", read=lambda way: way[1].released),
    )
    step = (
        Quantity("label", read="node.label"),
        Quantity("low", shape.drive, "from", read="node.low"),
        Quantity("high", shape.drive, "to", read="node.high"),
        Quantity("up", holds=way, missing=True),
        Quantity("down", holds=way, missing=True),
    )
    counts = {
        "vertices": "vertex_count",
        "transitions": "transition_count",
        "reached": "reached_count",
        "sub_loop_count": "sub_loop_count",
        "garden_of_eden_count": "garden_count",
    }
    return (
        Quantity("title", read="graph.chain.title"),
        Quantity("actuator", read="graph.actuator"),
        Quantity("cells", read="graph.names", holds=[str]),
        Quantity("method", read="graph.method"),
        *(
            Quantity(name, read=partial(_count, attribute), holds=int, missing=True)
            for name, attribute in counts.items()
        ),
        Quantity("start"),
        Quantity("walk", read="steps", holds=[step]),
        Quantity("walk_whole", read="whole", holds=bool),
        Quantity("ties", read=lambda one: tie_notes(one.graph.ties, one.graph.chain), holds=[str]),
    )


def _count(attribute: str, walked: Walked) -> int | None:
    count = getattr(walked.graph, attribute)
    # Python writes no whole number of more than 4300 digits.
    return None if count is None or count.bit_length() > 14_000 else count


def walked_account(walked: Walked, about: About) -> Account:
    """What is reported of a walk."""
    graph, count = walked.graph, "all" if walked.whole else "the first"
    readable = len(graph.names) <= LONGEST_IN_A_LINE
    begin = walked.start
    if not readable:
        begin = "all cells at 0" if walked.start == graph.zero else "the start"
    heading = f"A walk from {begin}: {count} {len(walked.steps)} nodes, those near by first"
    return Account(
        walked,
        graph.chain.title or "Transition graph",
        "implicit_graph/2",
        implicit_graph_schema(shape_of(graph)),
        answer=graph.summary,
        facts=[Fact(name, text) for name, text in graph.facts.items()],
        warnings=[degenerate(graph.ties, graph.chain)],
        sections=[Section(heading, RecordTable(_walked_columns(walked), "walk", more="nodes"))],
    )


def _walked_columns(walked: Walked) -> Columns:
    names, unit = walked.graph.names, shape_of(walked.graph).drive
    readable = len(names) <= LONGEST_IN_A_LINE
    at = {step.node.label: k for k, step in enumerate(walked.steps, 1)}
    last_state = walked.graph.chain.last_state

    def state(row: Mapping[str, Any]) -> str:
        if readable:
            return row["label"]
        last = zip(names, row["label"], walked.start, last_state, strict=False)
        moved = [
            name + _PLACE.get(at + most, f" at {at}") for name, at, was, most in last if at != was
        ]
        return listed(moved, _FEW) or "nothing"

    def leads(way: str, row: Mapping[str, Any]) -> str:
        if row[way] is None:
            return ""
        to, cells = at.get(row[way]["to"]), [names[cell] for cell in row[way]["cells"]]
        return listed(cells, _FEW) + (f" → {to}" if to else "")

    return (
        Column("node", lambda row: str(at[row["label"]]), True),
        Column("state" if readable else "unlike the start", state),
        Quantity("low", unit, "from"),
        Quantity("high", unit, "to"),
        Column("up", partial(leads, "up")),
        Column("down", partial(leads, "down")),
    )
