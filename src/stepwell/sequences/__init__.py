"""What the motion of a chain means: states, sequences, pathways, cycles, graphs, programs."""

from typing import TYPE_CHECKING

from stepwell.base import late
from stepwell.sequences.branches import Branches, checked_state, element_of
from stepwell.sequences.cycles import (
    IMPOSSIBLE,
    UNSOLVED,
    Cycle,
    Cycles,
    Pathway,
    Sequence,
    cycle,
    cycles_of,
)
from stepwell.sequences.planning import program
from stepwell.sequences.programs import (
    Program,
    ProgramMethod,
    Turn,
    Unreachable,
    state_after,
    turn_schema,
)

if TYPE_CHECKING:
    from stepwell.sequences.counting import Accumulator, Counting
    from stepwell.sequences.exchange import (
        from_dot,
        from_graphml,
        from_json,
        to_dot,
        to_graphml,
        to_json,
    )
    from stepwell.sequences.fields import from_switching_fields, switching_fields
    from stepwell.sequences.implicit import ImplicitGraph, Step, Walked, implicit_graph
    from stepwell.sequences.machines import Machine, Pump
    from stepwell.sequences.memory import Forgetting, Latch, Loop, ReturnPointMemory, Scrambling
    from stepwell.sequences.nodes import Node, Transition, TransitionKind
    from stepwell.sequences.reading import MemoryReading, read_memory
    from stepwell.sequences.responses import (
        Exchange,
        Realisation,
        Reply,
        Span,
        exchanging_program,
        realisations,
        realise,
    )
    from stepwell.sequences.transition_graph import TransitionGraph, graph

__all__ = [
    "Accumulator",
    "Counting",
    "Cycle",
    "Cycles",
    "Exchange",
    "Forgetting",
    "IMPOSSIBLE",
    "ImplicitGraph",
    "Latch",
    "Loop",
    "Machine",
    "Node",
    "Pathway",
    "Program",
    "ProgramMethod",
    "Pump",
    "MemoryReading",
    "Realisation",
    "Reply",
    "ReturnPointMemory",
    "Scrambling",
    "Sequence",
    "Span",
    "Step",
    "Transition",
    "TransitionGraph",
    "TransitionKind",
    "Turn",
    "UNSOLVED",
    "Unreachable",
    "Walked",
    "cycle",
    "cycles_of",
    "exchanging_program",
    "from_dot",
    "from_graphml",
    "from_json",
    "from_switching_fields",
    "graph",
    "implicit_graph",
    "program",
    "read_memory",
    "realisations",
    "realise",
    "state_after",
    "switching_fields",
    "to_dot",
    "to_graphml",
    "to_json",
    "turn_schema",
]

# networkx opens with the first graph, not with the first cycle.
_LATE = {
    "counting": ("Accumulator", "Counting"),
    "exchange": ("from_dot", "from_graphml", "from_json", "to_dot", "to_graphml", "to_json"),
    "fields": ("from_switching_fields", "switching_fields"),
    "implicit": ("ImplicitGraph", "Step", "Walked", "implicit_graph"),
    "machines": ("Machine", "Pump"),
    "memory": ("Forgetting", "Latch", "Loop", "ReturnPointMemory", "Scrambling"),
    "nodes": ("Node", "Transition", "TransitionKind"),
    "reading": ("MemoryReading", "read_memory"),
    "responses": (
        "Exchange",
        "Realisation",
        "Reply",
        "Span",
        "exchanging_program",
        "realisations",
        "realise",
    ),
    "transition_graph": ("TransitionGraph", "graph"),
}


__getattr__, __dir__ = late(__name__, _LATE, __all__)
