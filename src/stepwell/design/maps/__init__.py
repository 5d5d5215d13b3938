"""What a chain does for all values of two parameters, and the curves between."""

from stepwell.design.maps.boundaries import boundaries
from stepwell.design.maps.parameter_map import (
    ParameterBoundary,
    parameter_boundaries,
    parameter_map,
)
from stepwell.design.maps.transition_map import transition_map

__all__ = [
    "ParameterBoundary",
    "boundaries",
    "parameter_boundaries",
    "parameter_map",
    "transition_map",
]
