"""What the motion of a chain means: states, sequences, pathways, cycles, graphs, programs."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from stepwell.sequences.cycle import Cycle, cycle
from stepwell.sequences.node import Node, Transition, TransitionKind
from stepwell.sequences.pathway import Pathway
from stepwell.sequences.program import Program, Turn, Unreachable

from stepwell.sequences._plan import program  # isort: skip - after the module of that name
from stepwell.sequences.sequence import Sequence

if TYPE_CHECKING:
    from stepwell.sequences.counting import Accumulator, Counting
    from stepwell.sequences.dot import from_dot, to_dot
    from stepwell.sequences.exchange import from_graphml, from_json, to_graphml, to_json
    from stepwell.sequences.fields import from_switching_fields, switching_fields
    from stepwell.sequences.latches import Latch
    from stepwell.sequences.loops import Loop
    from stepwell.sequences.memory import Forgetting, ReturnPointMemory
    from stepwell.sequences.reading import Reading, read
    from stepwell.sequences.scrambling import Scrambling
    from stepwell.sequences.transition_graph import TransitionGraph, graph

# networkx opens with the first graph, not with the first cycle.
_DOORS = {
    "Accumulator": "counting",
    "Counting": "counting",
    "Forgetting": "memory",
    "Latch": "latches",
    "Loop": "loops",
    "Reading": "reading",
    "ReturnPointMemory": "memory",
    "Scrambling": "scrambling",
    "TransitionGraph": "transition_graph",
    "from_dot": "dot",
    "from_graphml": "exchange",
    "from_json": "exchange",
    "from_switching_fields": "fields",
    "graph": "transition_graph",
    "read": "reading",
    "switching_fields": "fields",
    "to_dot": "dot",
    "to_graphml": "exchange",
    "to_json": "exchange",
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
