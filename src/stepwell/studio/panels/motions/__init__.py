"""What the page asks of a chain's motion: its cycle, its margins, its graph, its programs."""

from stepwell.studio.panels.motions._drawn import arrays_of, cells_of, drawn, events_of
from stepwell.studio.panels.motions._motion import motion_of
from stepwell.studio.panels.motions.evaluate import answer as evaluated
from stepwell.studio.panels.motions.program import program_of
