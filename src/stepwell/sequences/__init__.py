"""What the motion of a chain means: states, sequences, pathways, cycles, graphs, programs."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from stepwell.sequences.cycles.cycle import Cycle, cycle
from stepwell.sequences.cycles.pathway import Pathway
from stepwell.sequences.graphs.node import Node, Transition, TransitionKind
from stepwell.sequences.programs.program import Program, Turn, Unreachable

from stepwell.sequences.programs.plan import program  # isort: skip - after the module of that name
from stepwell.sequences.cycles.sequence import Sequence

if TYPE_CHECKING:
    from stepwell.sequences.graphs.dot import from_dot, to_dot
    from stepwell.sequences.graphs.exchange import from_graphml, from_json, to_graphml, to_json
    from stepwell.sequences.graphs.fields import from_switching_fields, switching_fields
    from stepwell.sequences.graphs.transition_graph import TransitionGraph, graph
    from stepwell.sequences.memory.counting import Accumulator, Counting
    from stepwell.sequences.memory.latches import Latch
    from stepwell.sequences.memory.loops import Loop
    from stepwell.sequences.memory.reading import Reading, read
    from stepwell.sequences.memory.return_point import Forgetting, ReturnPointMemory
    from stepwell.sequences.memory.scrambling import Scrambling

# networkx opens with the first graph, not with the first cycle.
_DOORS = {
    "Accumulator": "memory.counting",
    "Counting": "memory.counting",
    "Forgetting": "memory.return_point",
    "Latch": "memory.latches",
    "Loop": "memory.loops",
    "Reading": "memory.reading",
    "ReturnPointMemory": "memory.return_point",
    "Scrambling": "memory.scrambling",
    "TransitionGraph": "graphs.transition_graph",
    "from_dot": "graphs.dot",
    "from_graphml": "graphs.exchange",
    "from_json": "graphs.exchange",
    "from_switching_fields": "graphs.fields",
    "graph": "graphs.transition_graph",
    "read": "memory.reading",
    "switching_fields": "graphs.fields",
    "to_dot": "graphs.dot",
    "to_graphml": "graphs.exchange",
    "to_json": "graphs.exchange",
}

__all__ = [
    "Accumulator",
    "Counting",
    "Cycle",
    "Forgetting",
    "Latch",
    "Loop",
    "Node",
    "Pathway",
    "Program",
    "Reading",
    "ReturnPointMemory",
    "Scrambling",
    "Sequence",
    "Transition",
    "TransitionGraph",
    "TransitionKind",
    "Turn",
    "Unreachable",
    "cycle",
    "from_dot",
    "from_graphml",
    "from_json",
    "from_switching_fields",
    "graph",
    "program",
    "read",
    "switching_fields",
    "to_dot",
    "to_graphml",
    "to_json",
]


def __getattr__(name: str) -> Any:
    if name in _DOORS:
        return getattr(import_module(f"stepwell.sequences.{_DOORS[name]}"), name)
    raise AttributeError(f"module 'stepwell.sequences' has no attribute {name!r}")
