"""The transition graph of a chain, and graphs as files of other programs."""

from stepwell.sequences.graphs.exchange import (
    from_dot,
    from_graphml,
    from_json,
    to_dot,
    to_graphml,
    to_json,
)
from stepwell.sequences.graphs.fields import from_switching_fields, switching_fields
from stepwell.sequences.graphs.implicit_graph import ImplicitGraph, Step, Walked, implicit_graph
from stepwell.sequences.graphs.mesostates import (
    Atlas,
    Mesostates,
    Routes,
    atlas,
)
from stepwell.sequences.graphs.node import Node, Transition, TransitionKind
from stepwell.sequences.graphs.rows import drives_text
from stepwell.sequences.graphs.transition_graph import TransitionGraph, graph
