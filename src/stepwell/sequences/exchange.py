"""Import and export of transition graphs: JSON, GraphML, DOT."""

import json
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields
from typing import Any, TypeVar

import numpy as np

from stepwell.base import InputError, Quantity, display_unit, grouped, plain
from stepwell.sequences.nodes import Node, Transition, TransitionKind
from stepwell.sequences.transition_graph import TransitionGraph, measure_of
from stepwell.statics import Tie

Row = dict[str, Any]
Read = TypeVar("Read")
Value = TypeVar("Value", Node, Transition, Tie)
# Unit suffixes of keys, by name of a field.
Endings = Mapping[str, str]


def endings(unit: str) -> Endings:
    """Unit suffixes of the keys, in a graph with this unit of drives."""
    measure = measure_of(unit)
    units = {_DRIVES: unit, _FORCES: measure.force_unit, _TRAVELS: measure.travel_unit}
    symbols = {name: own for names, own in units.items() for name in names} | {"released": "J"}
    spelled = {name: own.replace("³", "3").replace(" ", "") for name, own in symbols.items()}
    return {name: f"_{own}" if own else "" for name, own in spelled.items()}


def drives_text(unit: str, drives: Iterable[float], between: str = " to ") -> str:
    """Text of drives in display units (mm, N ...), or bare numbers."""
    shown_unit, factor = display_unit(unit)
    sign = Quantity("drive", shown_unit).sign
    return f"{between.join(f'{drive * factor:.4g}' for drive in drives)} {sign}".rstrip()


def _row(value: Node | Transition | Tie, ends: Endings) -> Row:
    row: Row = {}
    for part in fields(value):
        held = getattr(value, part.name)
        if isinstance(held, TransitionKind):
            held = held.name.lower()
        key = part.name + ends.get(part.name, "")
        row[key] = list(held) if isinstance(held, tuple) else held
    return row


def graph_of(data: Row) -> TransitionGraph:
    """The graph of these rows, or ValueError with the place of a wrong key or value."""
    unit = str(data.get("drive_unit") or "")
    ends = endings(unit)
    nodes = list(_parsed_values(Node, data, "nodes", ends))
    ways = [
        (
            *_read_at_place(lambda row: (row["from"], row["to"]), data["edges"][k], f"edges[{k}]"),
            way,
        )
        for k, way in enumerate(_parsed_values(Transition, data, "edges", ends))
    ]
    ties = tuple(_parsed_values(Tie, data, "ties", ends))
    return TransitionGraph.of(
        nodes, ways, **_read_at_place(_graph_fields, data, "graph"), ties=ties, unit=unit
    )


def _parsed_values(kind: type[Value], data: Row, key: str, ends: Endings) -> Iterator[Value]:
    rows = data.get(key)
    if not isinstance(rows, list):
        raise InputError(f"graph: {key}: must be a list, not {type(rows).__name__}.")

    def value_of(row: Row) -> Value:
        held = {part.name: row[part.name + ends.get(part.name, "")] for part in fields(kind)}
        return kind(**{name: _READ[name](x) if name in _READ else x for name, x in held.items()})

    for k, row in enumerate(rows):
        yield _read_at_place(value_of, row, f"{key}[{k}]")


def _read_at_place(how: Callable[[Row], Read], row: Row, place: str) -> Read:
    try:
        return how(row)
    except KeyError as error:
        raise InputError(f"{place}: {error} is missing or unknown.") from None
    except (TypeError, ValueError, AttributeError) as error:
        raise InputError(f"{place}: {error}.") from None


def _graph_fields(data: Row) -> Row:
    known: Row = {key: data[key] for key in ("actuator", "start", "method")}
    known |= {"chain": None, "names": tuple(data["cells"])}
    if "switching_fields" in data:
        known["fields"] = np.array(data["switching_fields"], float)
    return known


def _number(value: Any) -> float:
    """The number, with one and the same NaN for missing values, so that such values are equal."""
    return math.nan if value is None or math.isnan(value) else float(value)


# Fields of nodes, transitions and ties in the unit of drives, of forces and of travels, and the
# conversions of fields that are not text.
_DRIVES, _FORCES = ("low", "high", "drive"), ("force_low", "force_high")
_TRAVELS = ("travel_low", "travel_high")
_READ: dict[str, Callable[[Any], Any]] = {
    **dict.fromkeys((*_DRIVES, *_FORCES, "released"), _number),
    **dict.fromkeys(_TRAVELS, lambda travels: tuple(map(_number, travels))),
    **dict.fromkeys(("branch", "direction"), int),
    "cells": lambda cells: tuple(map(int, cells)),
    "kind": {kind.name.lower(): kind for kind in TransitionKind}.__getitem__,
    "tie": bool,
}


_FORMAT = "stepwell transition graph 1"
# What GraphML holds as JSON.
_LISTS = ("cells", "ties", "switching_fields")


def _rows(graph: TransitionGraph) -> Row:
    ends = endings(graph.unit)
    data = {
        "format": _FORMAT,
        "cells": list(graph.names),
        "actuator": graph.actuator,
        "drive_unit": graph.unit,
        "start": graph.start,
        "method": graph.method,
        "ties": [_row(tie, ends) for tie in graph.ties],
        "nodes": [_row(node, ends) for node in graph.nodes],
        "edges": [{"from": a, "to": b, **_row(t, ends)} for a, b, t in graph.transitions()],
    }
    if graph.fields is not None:
        data["switching_fields"] = graph.fields.tolist()
    return data


def record(graph: TransitionGraph) -> Row:
    """The graph as data for JSON, described at `to_json`."""
    return plain(_rows(graph))


def to_json(graph: TransitionGraph) -> str:
    """The graph as JSON, from which `from_json` makes the same nodes and edges again.

    One object, all numbers in SI:

        format      "stepwell transition graph 1"
        cells       names of the cells, inner first
        actuator    "stroke", "force", "spring of 53 N/m" or "field"
        drive_unit  "m", "N", or "" for bare numbers; below, _X stands for _m, _N or nothing; of
                    other chains "m³" (_m3), "Pa", "rad" or "N m" (_Nm), and so for _m and _N below
        start       the state that the graph began with, or null for all
        method      method that computed it
        ties        list of {drive_X, cells, advice}
        nodes       list of {label, state, low_X, high_X, force_low_N, force_high_N,
                    travel_low_m, travel_high_m, branch}; travels are lists, one number a cell
        edges       list of {from, to, kind, direction, drive_X, cells, released_J, tie}, one for
                    each transition; kind is "snap" or "switch", direction 1 or -1, cells are
                    counted from 0
        switching_fields   only in graphs made of them: a list of 2^N lists

    A number that is not known is null.
    """
    return json.dumps(record(graph), indent=1, allow_nan=False)


def from_json(text: str) -> TransitionGraph:
    """The graph that `to_json` wrote, without a chain; other text raises ValueError."""
    try:
        data = json.loads(text)
    except json.JSONDecodeError as error:
        raise InputError(f"graph: is not JSON: {error}.") from None
    return graph_of(checked_format(data, "to_json"))


def checked_format(data: Any, writer: str) -> Row:
    """The data, if `record` returned them, or ValueError; `writer` is what should have written."""
    if not isinstance(data, dict) or data.get("format") != _FORMAT:
        given = data.get("format") if isinstance(data, dict) else type(data).__name__
        raise InputError(f"graph: format = {given!r}: must be {_FORMAT!r}, as {writer} writes it.")
    return data


def to_graphml(graph: TransitionGraph) -> str:
    """The graph as GraphML, for Gephi, yEd, igraph and others.

    Keys are those of `to_json`, one edge for each transition. Lists are text: travels and cells
    with spaces between, names and ties as JSON.
    """
    import networkx as nx

    data = _rows(graph)
    nodes, edges = data.pop("nodes"), data.pop("edges")
    data["start"] = data["start"] or ""
    multigraph = nx.MultiDiGraph()
    multigraph.graph.update(data | {key: json.dumps(data[key]) for key in _LISTS if key in data})
    for row in map(_with_lists_as_text, nodes):
        multigraph.add_node(row.pop("label"), **row)
    for row in map(_with_lists_as_text, edges):
        multigraph.add_edge(row.pop("from"), row.pop("to"), **row)
    return "\n".join(nx.generate_graphml(multigraph)) + "\n"


def from_graphml(text: str) -> TransitionGraph:
    """The graph that `to_graphml` wrote, without a chain; other text raises ValueError."""
    import networkx as nx

    try:
        multigraph = nx.parse_graphml(text, force_multigraph=True)
    except (nx.NetworkXError, SyntaxError) as error:
        raise InputError(f"graph: is not GraphML: {error}.") from None
    data = checked_format(dict(multigraph.graph), "to_graphml")
    data |= {key: json.loads(data[key]) for key in _LISTS if key in data}
    data["start"] = data.get("start") or None
    data["nodes"] = [
        {"label": label, **_with_text_as_lists(row)} for label, row in multigraph.nodes(data=True)
    ]
    data["edges"] = [
        {"from": a, "to": b, **_with_text_as_lists(row)}
        for a, b, row in multigraph.edges(data=True)
    ]
    return graph_of(data)


def _with_lists_as_text(row: Row) -> Row:
    return {
        key: " ".join(map(repr, value)) if isinstance(value, list) else value
        for key, value in row.items()
    }


def _with_text_as_lists(row: Row) -> Row:
    lists = {"cells": int, "travel": float}
    listed: Row = {}
    for key, value in row.items():
        kind = lists.get(key.partition("_")[0])
        listed[key] = [kind(word) for word in str(value).split()] if kind else value
    return listed


_KEPT = re.compile(r'stepwell="((?:[^"\\]|\\.)*)"')


def to_dot(graph: TransitionGraph) -> str:
    """The graph in the DOT language, for Graphviz.

    Vertices with equally many cells at 1 stand in one row, all at 0 at the bottom; cells in a later
    phase count more. A rising drive is drawn solid, a falling one dashed, a snap bold; every edge
    has its drive in mm, N and such. What `to_json` writes of the graph, each node and each edge
    stands in an attribute `stepwell`, which Graphviz ignores and `from_dot` reads.
    """
    data = record(graph)
    nodes, edges = data.pop("nodes"), data.pop("edges")
    lines = [
        "digraph stepwell {",
        f"  graph [stepwell={_quoted_row(data)}];",
        "  rankdir=BT;",
        '  node [shape=box, fontname="monospace"];',
    ]
    for node, row in zip(graph.nodes, nodes, strict=True):
        label = node.label
        style = "solid" if node.is_vertex else "dotted"
        text = _quoted(f"{label}\n{drives_text(graph.unit, (node.low, node.high))}")
        kept = _quoted_row(row)
        lines.append(f"  {_quoted(label)} [label={text}, style={style}, stepwell={kept}];")
    rows = grouped((graph.node(label).level, _quoted(label)) for label in graph.vertices)
    lines += [f"  {{ rank=same; {'; '.join(row)}; }}" for row in rows.values()]
    for (a, b, t), row in zip(graph.transitions(), edges, strict=True):
        style = "solid" if t.direction > 0 else "dashed"
        if t.kind is TransitionKind.SNAP:
            style += ",bold"
        text = _quoted(drives_text(graph.unit, [t.drive]))
        way = f"{_quoted(a)} -> {_quoted(b)}"
        lines.append(f'  {way} [label={text}, style="{style}", stepwell={_quoted_row(row)}];')
    return "\n".join([*lines, "}"]) + "\n"


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


def from_dot(text: str) -> TransitionGraph:
    """The graph that `to_dot` wrote, without a chain; other text raises ValueError."""
    try:
        rows = [json.loads(_unquoted(kept)) for kept in _KEPT.findall(text)]
    except json.JSONDecodeError as error:
        raise InputError(f"graph: is not DOT as to_dot writes it: {error}.") from None
    if not rows:
        raise InputError(
            "graph: is not DOT as to_dot writes it, with an attribute `stepwell` on every node and "
            "edge; DOT of other programs contains no drives and travels."
        )
    data, *others = rows
    nodes = [row for row in others if "label" in row]
    edges = [row for row in others if "label" not in row]
    return graph_of(checked_format(data, "to_dot") | {"nodes": nodes, "edges": edges})


def _quoted_row(row: Row) -> str:
    return _quoted(json.dumps(row, allow_nan=False))


def _unquoted(text: str) -> str:
    return re.sub(r"\\(.)", lambda match: {"n": "\n"}.get(match[1], match[1]), text)
