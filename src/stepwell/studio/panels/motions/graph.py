"""The transition graph of a chain: where it can stand, and what leads from there to elsewhere."""

from __future__ import annotations

from stepwell.base import InputError, told_in
from stepwell.sequences import to_dot
from stepwell.studio.panels.motions._drawn import units_of
from stepwell.studio.wire import Ask, Design, View

# More states than these cells have cannot be seen, and are counted by `stepwell graph`.
_MOST_CELLS = 8


def answer(design: Design, ask: Ask) -> View:
    """Nodes and edges, their drives in the unit of `units`, and the graph in DOT."""
    ask.close()
    chain = design.chain
    if len(chain) > _MOST_CELLS:
        raise InputError(
            f"the graph of {len(chain)} cells has too many states to be seen: at most "
            f"{_MOST_CELLS} cells are drawn; `stepwell graph` counts them."
        )
    graph = chain.graph()
    drive, reached = told_in(chain.drive_unit)[1], graph.reachable()
    nodes = list(graph.nodes)
    return View(
        {
            "units": units_of(chain),
            "dot": to_dot(graph),
            "nodes": [
                {
                    "state": node.state,
                    "label": node.label,
                    "low_mm": node.low * drive,
                    "high_mm": node.high * drive,
                    "reached": node.label in reached,
                }
                for node in nodes
            ],
            "edges": [
                {
                    "from": node.label,
                    "to": way[0],
                    "kind": way[1].kind.name.lower(),
                    "direction": direction,
                    "drive_mm": way[1].drive * drive,
                }
                for node in nodes
                for direction in (1, -1)
                if (way := graph.transition(node.label, direction)) is not None
            ],
        }
    )
