"""What a chain does for all values of two parameters, and the curves between."""

from stepwell.design.maps.boundaries import boundaries, parameter_boundaries
from stepwell.design.maps.parameter_map import parameter_map, transition_map
from stepwell.design.maps.view import MapView
