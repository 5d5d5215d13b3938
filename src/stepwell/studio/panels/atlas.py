"""Map of an atlas: its transition graphs, their neighbours, and the results of a search."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import networkx as nx
import numpy as np

from stepwell import accounts, base, files, studies
from stepwell.studio.ask import Ask, PageDesign, View
from stepwell.studio.stores import store_named

# As fractions of the picture's width: radii of the rarest and of the most frequent graph class,
# the gap between two, and the picture's height.
_LEAST, _LARGEST, _ROOM, _TALL = 0.019, 0.05, 0.012, 0.64
# Larger graphs use a spring layout, which is faster.
_MANY, _PUSHES = 120, 400


def placed(
    chart: studies.Atlas, near: Sequence[studies.ClassBoundary], shown: Sequence[studies.GraphClass]
) -> dict[str, tuple[float, float, float]]:
    """Centre and radius of each graph class in a picture of width 1 and height 0.64.

    Distances grow with the change of a parameter between two classes, radii with their frequency.
    """
    span = {axis.name: axis.high - axis.low for axis in chart.axes}
    names = [one.name for one in shown]
    graph = nx.Graph()
    graph.add_nodes_from(names)
    for one in near:
        if one.graph_class in graph and one.beyond in graph:
            far = 0.15 + abs(one.step) / span[one.parameter]
            known = graph.get_edge_data(one.graph_class, one.beyond, {"far": far})["far"]
            graph.add_edge(one.graph_class, one.beyond, far=min(far, known))
    # Parts without known neighbours are placed next to each other.
    parts = [min(part, key=names.index) for part in nx.connected_components(graph)]
    for other in parts[1:]:
        graph.add_edge(parts[0], other, far=1.5)
    if len(names) <= _MANY:
        spots = nx.kamada_kawai_layout(graph, weight="far")
    else:
        spots = nx.spring_layout(graph, weight=None, seed=0)
    at = np.array([spots[name] for name in names], float).reshape(-1, 2)
    sizes = np.array([one.fraction.estimate for one in shown])
    radius = _LEAST + (_LARGEST - _LEAST) * np.sqrt(sizes / (sizes.max(initial=0.0) or 1.0))
    at = _apart(_fitted(at, radius), radius)
    return dict(zip(names, map(tuple, np.column_stack([at, radius]).tolist()), strict=True))


def _fitted(at: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Positions scaled to the picture, with the longest axis horizontal."""
    if len(at) < 2:
        return np.full((len(at), 2), [0.5, _TALL / 2])
    axes = np.linalg.svd(at - at.mean(axis=0), full_matrices=False)[2]
    at = (at - at.mean(axis=0)) @ axes.T
    low, high = at.min(axis=0), at.max(axis=0)
    size = np.array([1.0, _TALL]) - 2 * radius.max() - 2 * _ROOM
    share = (at - low) / np.where(high > low, high - low, 1.0)
    return radius.max() + _ROOM + share * size


def _apart(at: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Positions moved apart until no circles overlap, in at most `_PUSHES` steps."""
    reach = radius[:, None] + radius[None, :] + _ROOM
    edge = radius[:, None] + _ROOM / 2
    for _ in range(_PUSHES):
        apart = at[:, None] - at[None, :]
        distance = np.hypot(apart[..., 0], apart[..., 1])
        np.fill_diagonal(distance, np.inf)
        over = np.maximum(reach - distance, 0.0)
        if not np.any(over > 1e-6):
            break
        # Two at the same position move apart along a fixed direction.
        length = np.maximum(distance, 1e-9)[..., None]
        way = np.where(distance[..., None] > 1e-9, apart / length, [1.0, 0.5])
        at = at + 0.5 * np.sum(over[..., None] * way, axis=1)
        at = np.clip(at, edge, np.array([1.0, _TALL]) - edge)
    return at


_LONGEST, _MOST = 400, 300


def answer_atlas(_design: PageDesign, ask: Ask) -> View:
    """The record of `stepwell atlas show --json`, with positions, designs and transitions.

    With a `query`, only the names of the results of `stepwell atlas find`. `name` is that of a
    store, or "" for the atlas in Stepwell.
    """
    base.need("studies")
    name, query = ask.text("name", 200), ask.text("query", _LONGEST, "")
    least = ask.number("yield_percent", 0.0, 100.0, 0.0)
    ask.close()
    store = store_named(ask, name) if name else studies.THREE
    if query:
        studies.understood(query)  # or refused at once
    chart, near = _charted(store, ask)
    if query:
        graph_classes = studies.find(chart, query, least / 100)
        return View({"query": query, "matches": [one.name for one in graph_classes]})
    shown = chart.graph_classes[:_MOST]
    names = {one.name for one in shown}
    among = [one for one in near if {one.graph_class, one.beyond} <= names]
    record = accounts.account(chart, graph_classes=shown, class_boundaries=among).record
    places = placed(chart, near, shown)
    for class_record, graph_class in zip(record["graph_classes"], shown, strict=True):
        class_record["design_tables"] = files.tables_in(files.dumps(graph_class.chain))
        class_record["x"], class_record["y"], class_record["radius"] = places[graph_class.name]
        class_record["ways"] = [
            {"from": a, "to": b, "direction": way, "snaps": snaps}
            for a, b, way, snaps in sorted(graph_class.ways)
        ]
    del record["schema"], record["cycles"]
    return View({**record, "name": name, "phrases": [*studies.QUERIES]})


# The last charts, by store and finished chunks, for repeated requests.
_KNOWN: dict[Any, tuple[studies.Atlas, tuple[studies.ClassBoundary, ...]]] = {}
_KEPT = 3


def _charted(store: Path, ask: Ask) -> tuple[studies.Atlas, tuple[studies.ClassBoundary, ...]]:
    study = studies.opened(store)
    key = str(store), study.identity, tuple(study.done_chunks())
    if key not in _KNOWN:
        chart = studies.charted(study, progress=ask.report)
        while len(_KNOWN) >= _KEPT:
            _KNOWN.pop(next(iter(_KNOWN)))
        _KNOWN[key] = chart, studies.class_boundaries(study, chart)
    return _KNOWN[key]
