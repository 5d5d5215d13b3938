"""Transition graphs, drawn."""

from stepwell.figures.graphs.transition_graph import small_graph, transition_graph
