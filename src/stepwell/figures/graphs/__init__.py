"""Transition graphs, drawn."""

from stepwell.figures.graphs.transition_graph import transition_graph
