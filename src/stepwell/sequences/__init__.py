"""What the motion of a chain means: states, sequences, pathways, cycles, graphs, programs."""

from typing import TYPE_CHECKING, Any

from stepwell.sequences.cycle import Cycle, cycle
from stepwell.sequences.node import Node, Transition, TransitionKind
from stepwell.sequences.pathway import Pathway
from stepwell.sequences.program import Program, Turn, Unreachable

from stepwell.sequences._plan import program  # isort: skip - after the module of that name
from stepwell.sequences.sequence import Sequence

if TYPE_CHECKING:
    from stepwell.sequences.transition_graph import TransitionGraph, graph

__all__ = [
    "Cycle",
    "Node",
    "Pathway",
    "Program",
    "Sequence",
    "Transition",
    "TransitionGraph",
    "TransitionKind",
    "Turn",
    "Unreachable",
    "cycle",
    "graph",
    "program",
]


def __getattr__(name: str) -> Any:
    # networkx opens with the first graph, not with the first cycle.
    if name in ("TransitionGraph", "graph"):
        from stepwell.sequences import transition_graph

        return getattr(transition_graph, name)
    raise AttributeError(f"module 'stepwell.sequences' has no attribute {name!r}")
