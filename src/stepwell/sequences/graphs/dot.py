"""Transition graphs in the DOT language, drawn by Graphviz and read back."""

from __future__ import annotations

import json
import re

from stepwell.base import InputError
from stepwell.sequences.graphs.exchange import ours, record
from stepwell.sequences.graphs.node import TransitionKind
from stepwell.sequences.graphs.rows import Row, drives_text, graph_of, transitions
from stepwell.sequences.graphs.transition_graph import TransitionGraph

_KEPT = re.compile(r'stepwell="((?:[^"\\]|\\.)*)"')


def to_dot(graph: TransitionGraph) -> str:
    """The graph in the DOT language, for Graphviz.

    Vertices with equally many cells at 1 stand in one row, all at 0 at the bottom. A rising drive
    is drawn solid, a falling one dashed, a snap bold; every edge tells its drive in mm or N. What
    `to_json` writes of the graph, of each node and of each edge stands in an attribute
    `stepwell`, which Graphviz passes over and `from_dot` reads.
    """
    data = record(graph)
    nodes, edges = data.pop("nodes"), data.pop("edges")
    lines = [
        "digraph stepwell {",
        f"  graph [stepwell={_kept(data)}];",
        "  rankdir=BT;",
        '  node [shape=box, fontname="monospace"];',
    ]
    for label, row in zip(graph, nodes, strict=True):
        node = graph.node(label)
        style = "solid" if node.is_vertex else "dotted"
        text = _quoted(f"{label}\n{drives_text(graph.unit, (node.low, node.high))}")
        kept = _kept(row)
        lines.append(f"  {_quoted(label)} [label={text}, style={style}, stepwell={kept}];")
    rows: dict[int, list[str]] = {}
    for label in graph.vertices:
        rows.setdefault(graph.node(label).state.count("1"), []).append(_quoted(label))
    lines += [f"  {{ rank=same; {'; '.join(row)}; }}" for row in rows.values()]
    for (a, b, t), row in zip(transitions(graph), edges, strict=True):
        style = "solid" if t.direction > 0 else "dashed"
        if t.kind is TransitionKind.SNAP:
            style += ",bold"
        text = _quoted(drives_text(graph.unit, [t.drive]))
        way = f"{_quoted(a)} -> {_quoted(b)}"
        lines.append(f'  {way} [label={text}, style="{style}", stepwell={_kept(row)}];')
    return "\n".join([*lines, "}"]) + "\n"


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


def from_dot(text: str) -> TransitionGraph:
    """The graph that `to_dot` wrote; it knows no chain.

    Raises:
        ValueError: other text, with what is wrong and where.
    """
    try:
        rows = [json.loads(_unquoted(kept)) for kept in _KEPT.findall(text)]
    except json.JSONDecodeError as error:
        raise InputError(f"graph: is not DOT as to_dot writes it: {error}.") from None
    if not rows:
        raise InputError(
            "graph: is not DOT as to_dot writes it, with an attribute `stepwell` on every node and "
            "edge; DOT of other programs says nothing of drives and travels."
        )
    data, *others = rows
    nodes = [row for row in others if "label" in row]
    edges = [row for row in others if "label" not in row]
    return graph_of(ours(data, "to_dot") | {"nodes": nodes, "edges": edges})


def _kept(row: Row) -> str:
    return _quoted(json.dumps(row, allow_nan=False))


def _unquoted(text: str) -> str:
    return re.sub(r"\\(.)", lambda found: {"n": "\n"}.get(found[1], found[1]), text)
