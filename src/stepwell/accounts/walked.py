"""A walk through a transition graph that has too many states to be listed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from stepwell.accounts.account import Account, Fact, Section, Table
from stepwell.accounts.graph import shape_of
from stepwell.accounts.head import About
from stepwell.accounts.shape import Shape
from stepwell.accounts.words import LONGEST_IN_A_LINE, degenerate, listed, tie_notes
from stepwell.base import Column, Columns, Quantity, Schema

if TYPE_CHECKING:
    from stepwell.sequences import Walked

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


def walked_account(walked: Walked, about: About | None = None) -> Account:
    """What is reported of a walk."""
    graph, count = walked.graph, "all" if walked.whole else "the first"
    readable = len(graph.names) <= LONGEST_IN_A_LINE
    begin = walked.start
    if not readable:
        begin = "all cells at 0" if walked.start == graph.zero else "the start"
    found = Account(
        walked,
        graph.chain.title or "Transition graph",
        "implicit_graph/2",
        implicit_graph_schema(shape_of(graph)),
        answer=graph.summary,
        about=about or About(graph.chain),
        facts=[Fact(name, text) for name, text in graph.facts.items()],
        warnings=[degenerate(graph.ties, graph.chain)],
    )
    heading = f"A walk from {begin}: {count} {len(walked.steps)} nodes, those near by first"
    table = Table(_columns(walked), found.rows("walk"), more="nodes")
    return replace(found, sections=[Section(heading, [table])])


def _columns(walked: Walked) -> Columns:
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
