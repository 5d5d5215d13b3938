"""Maps over parameters, yields, and what counts most."""

from stepwell.figures.maps.margin_bars import margin_bars
from stepwell.figures.maps.tornado import Effect, Sensitivity, tornado
from stepwell.figures.maps.transition_map import transition_map
from stepwell.figures.maps.yield_bars import yield_bars
