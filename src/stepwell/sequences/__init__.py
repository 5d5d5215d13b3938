"""What the motion of a chain means: states, sequences, pathways, cycles, graphs, programs."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from stepwell.sequences.branches import element_of
from stepwell.sequences.cycles import IMPOSSIBLE, UNSOLVED, Cycle, Cycles, Pathway, cycle, cycles_of
from stepwell.sequences.programs import Program, ProgramMethod, Turn, Unreachable, turn_schema

from stepwell.sequences.programs import program  # isort: skip - after the module of that name
from stepwell.sequences.cycles import Sequence

if TYPE_CHECKING:
    from stepwell.sequences.graphs import (
        ImplicitGraph,
        Node,
        Step,
        Transition,
        TransitionGraph,
        TransitionKind,
        Walked,
        from_dot,
        from_graphml,
        from_json,
        from_switching_fields,
        graph,
        implicit_graph,
        switching_fields,
        to_dot,
        to_graphml,
        to_json,
    )
    from stepwell.sequences.memory import (
        Accumulator,
        Counting,
        Forgetting,
        Latch,
        Loop,
        MemoryReading,
        ReturnPointMemory,
        Scrambling,
        read_memory,
    )

__all__ = [
    "Accumulator",
    "Counting",
    "Cycle",
    "Cycles",
    "Forgetting",
    "IMPOSSIBLE",
    "ImplicitGraph",
    "Latch",
    "Loop",
    "Node",
    "Pathway",
    "Program",
    "ProgramMethod",
    "MemoryReading",
    "ReturnPointMemory",
    "Scrambling",
    "Sequence",
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
    "from_dot",
    "from_graphml",
    "from_json",
    "from_switching_fields",
    "graph",
    "implicit_graph",
    "program",
    "read_memory",
    "switching_fields",
    "to_dot",
    "to_graphml",
    "to_json",
    "turn_schema",
]


def __getattr__(name: str) -> Any:
    # networkx opens with the first graph, not with the first cycle.
    for folder in ("graphs", "memory") if name in __all__ else ():
        offered = vars(import_module(f"stepwell.sequences.{folder}"))
        if name in offered:
            return offered[name]
    raise AttributeError(f"module 'stepwell.sequences' has no attribute {name!r}")
