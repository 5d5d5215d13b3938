"""Graphs as rows of plain values, with units in the keys, and back."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields
from functools import partial
from typing import Any, TypeVar

import numpy as np

from stepwell.base import InputError, Quantity, told_in
from stepwell.sequences.graphs.node import Node, Transition, TransitionKind
from stepwell.sequences.graphs.transition_graph import TransitionGraph, measure_of
from stepwell.statics import Tie

Row = dict[str, Any]
Read = TypeVar("Read")
Value = TypeVar("Value", Node, Transition, Tie)


# By name of a field: what its key ends with.
Endings = Mapping[str, str]


def endings(unit: str) -> Endings:
    """The units with which keys end, in a graph whose drives have this one."""
    measure = measure_of(unit)
    units = {_DRIVES: unit, _FORCES: measure.force_unit, _TRAVELS: measure.travel_unit}
    found = {name: _ending(told) for names, told in units.items() for name in names}
    return found | {"released": "_J"}


def _ending(unit: str) -> str:
    return f"_{unit.replace('³', '3').replace(' ', '')}" if unit else ""


def drives_text(unit: str, drives: Iterable[float], between: str = " to ") -> str:
    """Drives as people read them, in mm, N and such, or bare."""
    told, factor = told_in(unit)
    sign = Quantity("drive", told).sign
    return f"{between.join(f'{drive * factor:.4g}' for drive in drives)} {sign}".rstrip()


def row_of(value: Node | Transition | Tie, ends: Endings) -> Row:
    """A value as a row."""
    row: Row = {}
    for part in fields(value):
        held = getattr(value, part.name)
        if isinstance(held, TransitionKind):
            held = held.name.lower()
        row[_key(part.name, ends)] = list(held) if isinstance(held, tuple) else held
    return row


def graph_of(data: Row) -> TransitionGraph:
    """The graph of these rows.

    Raises:
        ValueError: a row without a key, or with a value that is none, and where.
    """
    unit = str(data.get("drive_unit") or "")
    ends = endings(unit)
    nodes = list(_values(Node, data, "nodes", ends))
    ways = [
        (*_read(lambda row: (row["from"], row["to"]), data["edges"][k], f"edges[{k}]"), way)
        for k, way in enumerate(_values(Transition, data, "edges", ends))
    ]
    ties = tuple(_values(Tie, data, "ties", ends))
    return TransitionGraph.of(nodes, ways, **_read(_about, data, "graph"), ties=ties, unit=unit)


def _values(kind: type[Value], data: Row, key: str, ends: Endings) -> Iterator[Value]:
    rows = data.get(key)
    if not isinstance(rows, list):
        raise InputError(f"graph: {key}: must be a list, not {type(rows).__name__}.")
    for k, row in enumerate(rows):
        yield _read(partial(_value_of, kind, ends), row, f"{key}[{k}]")


def _read(how: Callable[[Row], Read], row: Row, place: str) -> Read:
    try:
        return how(row)
    except KeyError as error:
        raise InputError(f"{place}: knows no {error}.") from None
    except (TypeError, ValueError, AttributeError) as error:
        raise InputError(f"{place}: {error}.") from None


def _about(data: Row) -> Row:
    known: Row = {key: data[key] for key in ("actuator", "start", "method")}
    known |= {"chain": None, "names": tuple(data["cells"])}
    if "switching_fields" in data:
        known["fields"] = np.array(data["switching_fields"], float)
    return known


def _value_of(kind: type[Value], ends: Endings, row: Row) -> Value:
    held: list[Any] = []
    for part in fields(kind):
        told = row[_key(part.name, ends)]
        held.append(_READ[part.name](told) if part.name in _READ else told)
    return kind(*held)


def _key(name: str, ends: Endings) -> str:
    return name + ends.get(name, "")


def _number(value: Any) -> float:
    """One NaN for all, so that values which hold it are equal."""
    return math.nan if value is None or math.isnan(value) else float(value)


def _numbers(values: Any) -> tuple[float, ...]:
    return tuple(map(_number, values))


# Of the fields of nodes, transitions and ties: those in the unit of drives, of forces and of
# travels, and how all that are no words are read.
_DRIVES, _FORCES, _TRAVELS = (
    ("low", "high", "drive"),
    ("force_low", "force_high"),
    ("travel_low", "travel_high"),
)
_READ: dict[str, Callable[[Any], Any]] = {
    **dict.fromkeys((*_DRIVES, *_FORCES, "released"), _number),
    **dict.fromkeys(_TRAVELS, _numbers),
    **dict.fromkeys(("branch", "direction"), int),
    "cells": lambda cells: tuple(map(int, cells)),
    "kind": {kind.name.lower(): kind for kind in TransitionKind}.__getitem__,
    "tie": bool,
}
