"""Maps over parameters, yields, and what counts most."""

from stepwell.figures.maps.margins import margins
from stepwell.figures.maps.tornado import Effect, Sensitivity, tornado
from stepwell.figures.maps.transition_map import transition_map
from stepwell.figures.maps.yield_bars import yield_bars
