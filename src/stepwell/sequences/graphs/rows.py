"""Graphs as rows of plain values, with units in the keys, and back."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any, TypeVar

import networkx as nx
import numpy as np

from stepwell.base import InputError
from stepwell.sequences.graphs.node import Node, Transition, TransitionKind
from stepwell.sequences.graphs.transition_graph import TransitionGraph
from stepwell.statics import Tie

_KINDS = {kind.name.lower(): kind for kind in TransitionKind}

Row = dict[str, Any]
Read = TypeVar("Read")


def suffix(graph: TransitionGraph) -> str:
    """What a key of a drive ends with: its unit."""
    return f"_{graph.unit}" if graph.unit else ""


def transitions(graph: TransitionGraph) -> Iterator[tuple[str, str, Transition]]:
    """Every (from, to, transition)."""
    for a, b, together in graph.edges(data="transitions"):
        for transition in together:
            yield a, b, transition


def tie_row(tie: Tie, x: str) -> Row:
    """A tie; x is the suffix."""
    return {f"drive{x}": tie.drive, "cells": list(tie.cells), "advice": tie.advice}


def node_row(node: Node, x: str) -> Row:
    """A node."""
    return {
        "label": node.label,
        "state": node.state,
        f"low{x}": node.low,
        f"high{x}": node.high,
        "force_low_N": node.force_low,
        "force_high_N": node.force_high,
        "travel_low_m": list(node.travel_low),
        "travel_high_m": list(node.travel_high),
        "branch": node.branch,
    }


def edge_row(a: str, b: str, transition: Transition, x: str) -> Row:
    """A transition."""
    return {
        "from": a,
        "to": b,
        "kind": transition.kind.name.lower(),
        "direction": transition.direction,
        f"drive{x}": transition.drive,
        "cells": list(transition.cells),
        "released_J": transition.released,
        "tie": transition.tie,
    }


def graph_of(data: Row) -> TransitionGraph:
    """The graph of these rows.

    Raises:
        ValueError: a row without a key, or with a value that is none, and where.
    """
    found = TransitionGraph()
    x = f"_{data['drive_unit']}" if data.get("drive_unit") else ""
    for k, row in enumerate(_rows(data, "nodes")):
        node = _read(_node_of, row, x, f"nodes[{k}]")
        found.add_node(node.label, node=node)
    for k, row in enumerate(_rows(data, "edges")):
        a, b, transition = _read(_edge_of, row, x, f"edges[{k}]")
        if a not in found or b not in found:
            raise InputError(f"edges[{k}]: leads from {a!r} to {b!r}; one of them is no node.")
        others = found.edges[a, b]["transitions"] if found.has_edge(a, b) else ()
        found.add_edge(a, b, transitions=(*others, transition))
    ties = (_read(_tie_of, row, x, f"ties[{k}]") for k, row in enumerate(_rows(data, "ties")))
    found.graph.update(_read(_about, data, x, "graph"), ties=tuple(ties))
    return nx.freeze(found)


def _rows(data: Row, key: str) -> list[Row]:
    rows = data.get(key)
    if not isinstance(rows, list):
        raise InputError(f"graph: {key}: must be a list, not {type(rows).__name__}.")
    return rows


def _read(how: Callable[[Row, str], Read], row: Row, x: str, place: str) -> Read:
    try:
        return how(row, x)
    except KeyError as error:
        raise InputError(f"{place}: knows no {error}.") from None
    except (TypeError, ValueError, AttributeError) as error:
        raise InputError(f"{place}: {error}.") from None


def _about(data: Row, x: str) -> Row:
    known: Row = {key: data[key] for key in ("actuator", "start", "method")}
    known |= {"chain": None, "names": tuple(data["cells"]), "unit": x.removeprefix("_")}
    if "switching_fields" in data:
        known["fields"] = np.array(data["switching_fields"], float)
    return known


def _tie_of(row: Row, x: str) -> Tie:
    return Tie(_number(row[f"drive{x}"]), tuple(map(int, row["cells"])), row["advice"])


def _node_of(row: Row, x: str) -> Node:
    return Node(
        row["label"],
        row["state"],
        _number(row[f"low{x}"]),
        _number(row[f"high{x}"]),
        _number(row["force_low_N"]),
        _number(row["force_high_N"]),
        tuple(map(_number, row["travel_low_m"])),
        tuple(map(_number, row["travel_high_m"])),
        int(row["branch"]),
    )


def _edge_of(row: Row, x: str) -> tuple[str, str, Transition]:
    transition = Transition(
        _KINDS[row["kind"]],
        int(row["direction"]),
        _number(row[f"drive{x}"]),
        tuple(map(int, row["cells"])),
        _number(row["released_J"]),
        bool(row["tie"]),
    )
    return row["from"], row["to"], transition


def _number(value: Any) -> float:
    """One NaN for all, so that values which hold it are equal."""
    return math.nan if value is None or math.isnan(value) else float(value)
