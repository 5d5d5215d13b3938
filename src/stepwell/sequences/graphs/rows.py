"""Graphs as rows of plain values, with units in the keys, and back."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import fields
from functools import partial
from typing import Any, TypeVar

import networkx as nx
import numpy as np

from stepwell.base import InputError, told_in
from stepwell.sequences.graphs.node import Node, Transition, TransitionKind
from stepwell.sequences.graphs.transition_graph import TransitionGraph, join
from stepwell.statics import Tie

Row = dict[str, Any]
Read = TypeVar("Read")
Value = TypeVar("Value", Node, Transition, Tie)


def suffix(graph: TransitionGraph) -> str:
    """What a key of a drive ends with: its unit."""
    return f"_{graph.unit}" if graph.unit else ""


def drives_text(unit: str, drives: Iterable[float], between: str = " to ") -> str:
    """Drives as people read them, in mm, N or bare."""
    shown, factor = told_in(unit)
    return f"{between.join(f'{drive * factor:.4g}' for drive in drives)} {shown}".rstrip()


def row_of(value: Node | Transition | Tie, x: str) -> Row:
    """A value as a row; x is the suffix."""
    row: Row = {}
    for part in fields(value):
        held = getattr(value, part.name)
        if isinstance(held, TransitionKind):
            held = held.name.lower()
        row[_key(part.name, x)] = list(held) if isinstance(held, tuple) else held
    return row


def graph_of(data: Row) -> TransitionGraph:
    """The graph of these rows.

    Raises:
        ValueError: a row without a key, or with a value that is none, and where.
    """
    found = TransitionGraph()
    x = f"_{data['drive_unit']}" if data.get("drive_unit") else ""
    for node in _values(Node, data, "nodes", x):
        found.add_node(node.label, node=node)
    for k, transition in enumerate(_values(Transition, data, "edges", x)):
        a, b = _read(lambda row, _: (row["from"], row["to"]), data["edges"][k], x, f"edges[{k}]")
        if a not in found or b not in found:
            raise InputError(f"edges[{k}]: leads from {a!r} to {b!r}; one of them is no node.")
        join(found, a, b, transition)
    ties = tuple(_values(Tie, data, "ties", x))
    found.graph.update(_read(_about, data, x, "graph"), ties=ties)
    return nx.freeze(found)


def _values(kind: type[Value], data: Row, key: str, x: str) -> Iterator[Value]:
    rows = data.get(key)
    if not isinstance(rows, list):
        raise InputError(f"graph: {key}: must be a list, not {type(rows).__name__}.")
    for k, row in enumerate(rows):
        yield _read(partial(_value_of, kind), row, x, f"{key}[{k}]")


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


def _value_of(kind: type[Value], row: Row, x: str) -> Value:
    held: list[Any] = []
    for part in fields(kind):
        told = row[_key(part.name, x)]
        held.append(_READ[part.name](told) if part.name in _READ else told)
    return kind(*held)


def _key(name: str, x: str) -> str:
    return name + (x if name in _DRIVES else _UNITS.get(name, ""))


def _number(value: Any) -> float:
    """One NaN for all, so that values which hold it are equal."""
    return math.nan if value is None or math.isnan(value) else float(value)


def _numbers(values: Any) -> tuple[float, ...]:
    return tuple(map(_number, values))


# Of the fields of nodes, transitions and ties: those in the unit of drives, the units of others,
# and how all that are no words are read.
_DRIVES, _FORCES, _TRAVELS = (
    ("low", "high", "drive"),
    ("force_low", "force_high"),
    ("travel_low", "travel_high"),
)
_UNITS = dict.fromkeys(_FORCES, "_N") | dict.fromkeys(_TRAVELS, "_m") | {"released": "_J"}
_READ: dict[str, Callable[[Any], Any]] = {
    **dict.fromkeys((*_DRIVES, *_FORCES, "released"), _number),
    **dict.fromkeys(_TRAVELS, _numbers),
    **dict.fromkeys(("branch", "direction"), int),
    "cells": lambda cells: tuple(map(int, cells)),
    "kind": {kind.name.lower(): kind for kind in TransitionKind}.__getitem__,
    "tie": bool,
}
