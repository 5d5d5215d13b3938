"""Transition graphs: loops, memory, scrambling, latches; a walk through the largest ones."""

from functools import partial
from operator import itemgetter
from typing import Any

from stepwell.accounts.events import way
from stepwell.accounts.head import About, DesignShape, Row, keys
from stepwell.accounts.parts import Account, Fact, RecordTable, Text
from stepwell.accounts.words import LONGEST_IN_A_LINE, degenerate, scattered, tie_notes
from stepwell.base import Column, Columns, Quantity, Schema, counted, join_first, read_off
from stepwell.sequences import ImplicitGraph, MemoryReading, Sequence, TransitionGraph, Walked

# Letters of the longest sequence that a card spells out.
_MOST_LETTERS = 1000
_TIES = keys(ties=([str], lambda graph: tie_notes(graph.ties, graph.chain)))
_DIRECTION = Quantity("direction", read=way)
_SCRAMBLING: Schema = (
    *keys(first_two=([int], "cells")),
    _DIRECTION,
    *keys(in_order_from=(str, "i_first"), in_other_order_from=(str, "j_first")),
    *keys(by_hand=(bool, lambda pair: not pair.reachable)),
)
_FEW = 4  # cells of a row
_MOST_IN_ANSWER = 60  # letters of a loop
# What is shown of a cell that has moved; of a cell with two phases the name is enough.
_PLACE = {"01": "", "11": "", **{f"-{last}": " in transit" for last in "123456789"}}


def graph_schema(shape: DesignShape) -> Schema:
    """What is reported of a graph; drives are those of its actuator."""
    unit = shape.drive
    loop = keys(up=[str], down=[str], low=unit, high=unit)

    def witness(name: str) -> Any:
        return lambda memory: memory.witness and getattr(memory.witness, name)

    # A counterexample, if the graph has no return-point memory.
    memory = (
        *keys(holds=bool),
        Quantity("turning_points", unit, read=witness("turns"), holds=[float], missing=True),
        *keys(first=(str | None, witness("first")), later=(str | None, witness("later"))),
    )
    # Cycles with a transient or a period of two or more.
    accumulator = (
        *keys(states=[str], transient=int, period=int),
        _DIRECTION,
        *keys(low=unit, high=unit, slack=unit, set_by_hand=(bool, "by_hand")),
        Quantity("turning_points", unit, read="turns", holds=[float]),
    )
    leaving = (
        Quantity("from", read=itemgetter(0)),
        *keys(to=(str, itemgetter(1)), direction=(str, lambda one: way(one[2]))),
        *keys(drive=(unit, lambda one: one[2].drive)),
    )
    reading = (
        *keys(branches=int, main_loop=loop, sub_loop_count=int),
        Quantity("sub_loops", holds=[loop], missing=True),
        Quantity("garden_of_eden", holds=[str], missing=True),
        *keys(unreachable=[str], return_point_memory=memory, scrambling=[_SCRAMBLING]),
        *keys(accumulators=([accumulator], "counting.accumulators")),
        *keys(accumulators_all=(bool, "counting.exhaustive")),
        *keys(latches=[keys(left=([str], "nodes"), ways=[leaving])]),
    )
    return (
        *keys(title=(str, lambda graph: graph.chain.title if graph.chain else "")),
        *keys(actuator=str, cells=([str], "names"), method=str),
        *keys(vertices=(int, lambda graph: len(graph.nodes.vertices)), nodes=(int, len)),
        *read_off(reading, "reading"),
        *_TIES,
    )


def shape_of(graph: TransitionGraph | ImplicitGraph) -> DesignShape:
    """The shape of a graph's chain; its own actuator may prescribe another thing."""
    chain = graph.chain
    shape = DesignShape() if chain is None else DesignShape.of(chain)
    return shape._replace(force_driven=graph.unit == shape.measure.force_unit)


def sequence_account(value: Sequence, about: About) -> Account:
    """What a notebook shows of a sequence."""
    spelled = len(value.first) * len(value) <= _MOST_LETTERS
    text = str(value) if spelled else repr(value)
    return Account(value, f"Sequence of {len(value)} states", answer=text)


def implicit_graph_account(value: ImplicitGraph, about: About) -> Account:
    """What a notebook shows of a graph whose states are not listed."""
    facts = [Fact(*one) for one in value.facts.items()]
    return Account(value, _title(value), answer=value.summary, facts=facts)


def _title(graph: TransitionGraph | ImplicitGraph) -> str:
    chain = graph.chain
    return f"Transition graph of {chain.title}" if chain and chain.title else "Transition graph"


def transition_graph_account(value: TransitionGraph | MemoryReading, about: About) -> Account:
    """What is reported of a graph, or of what is read off it."""
    graph = value.graph if isinstance(value, MemoryReading) else value
    known, answer = graph.reading.facts, graph.reading.summary
    if len(loop := known["main loop"]) <= _MOST_IN_ANSWER:
        known = {"graph": answer, **known}
        del known["main loop"]
        answer = f"main loop {loop}, {counted(graph.reading.sub_loop_count, 'sub-loop')}"
    facts = [Fact(*one) for one in known.items()]
    sections = {"Nodes": Text(f"{len(graph)} nodes, {graph.transition_count} transitions.")}
    ties = [degenerate(graph.ties, graph.chain), scattered(graph.chain)]
    schema = graph_schema(shape_of(graph))
    return Account(graph, _title(graph), "graph/2", answer, facts, sections, ties, schema=schema)


memory_reading_account = transition_graph_account


def implicit_graph_schema(shape: DesignShape) -> Schema:
    """What is reported of a walk."""

    def count(attribute: str) -> tuple[Any, Any]:
        # Python writes no whole number of more than 4300 digits.
        def written(graph: ImplicitGraph) -> int | None:
            number = getattr(graph, attribute)
            return None if number is None or number.bit_length() > 14_000 else number

        return int | None, written

    to = (
        *keys(to=(str, itemgetter(0)), kind=(str, lambda one: one[1].kind.name.lower())),
        *keys(drive=(shape.drive, lambda one: one[1].drive)),
        *keys(cells=([int], lambda one: one[1].cells)),
        *keys(released=("mJ", lambda one: one[1].released)),
    )
    step = (
        *keys(label=(str, "node.label"), low=(shape.drive, "node.low")),
        *keys(high=(shape.drive, "node.high")),
        Quantity("up", holds=to, missing=True),
        Quantity("down", holds=to, missing=True),
    )
    graph = (
        *keys(title=(str, "chain.title"), actuator=str, cells=([str], "names"), method=str),
        *keys(vertices=count("vertex_count"), transitions=count("transition_count")),
        *keys(reached=count("reached_count"), sub_loop_count=count("sub_loop_count")),
        *keys(garden_of_eden_count=count("garden_count")),
    )
    return (
        *read_off(graph, "graph"),
        *keys(start=str, walk=([step], "steps"), walk_whole=(bool, "whole")),
        *read_off(_TIES, "graph"),
    )


def walked_account(walked: Walked, about: About) -> Account:
    """What is reported of a walk."""
    graph, count = walked.graph, "all" if walked.whole else "the first"
    begin = walked.start
    if len(graph.names) > LONGEST_IN_A_LINE:
        begin = "all cells at 0" if walked.start == graph.zero else "the start"
    heading = f"A walk from {begin}: {count} {len(walked.steps)} nodes, nearest first"
    title, schema = graph.chain.title or "Transition graph", implicit_graph_schema(shape_of(graph))
    facts = [Fact(*one) for one in graph.facts.items()]
    sections = {heading: RecordTable(_walked_columns(walked), "walk", more="nodes")}
    ties = [degenerate(graph.ties, graph.chain), scattered(graph.chain)]
    answer = graph.summary
    return Account(walked, title, "implicit_graph/2", answer, facts, sections, ties, schema=schema)


def _walked_columns(walked: Walked) -> Columns:
    names, unit = walked.graph.names, shape_of(walked.graph).drive
    readable = len(names) <= LONGEST_IN_A_LINE
    number = {step.node.label: k for k, step in enumerate(walked.steps, 1)}
    last_state = walked.graph.chain.last_state

    def state(row: Row) -> str:
        if readable:
            return row["label"]
        cells = zip(names, row["label"], walked.start, last_state, strict=False)
        moved = [
            name + _PLACE.get(at + last, f" at {at}") for name, at, was, last in cells if at != was
        ]
        return join_first(moved, _FEW) or "nothing"

    def leads(direction: str, row: Row) -> str:
        if (step := row[direction]) is None:
            return ""
        to, cells = number.get(step["to"]), [names[cell] for cell in step["cells"]]
        return join_first(cells, _FEW) + (f" → {to}" if to else "")

    return (
        Column("node", lambda row: str(number[row["label"]]), True),
        Column("state" if readable else "unlike the start", state),
        Quantity("low", unit, "from"),
        Quantity("high", unit, "to"),
        Column("up", partial(leads, "up")),
        Column("down", partial(leads, "down")),
    )
