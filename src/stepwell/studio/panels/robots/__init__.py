"""What the page asks of robots: where they stand, what they will do, and what they did."""

from stepwell.studio.panels.robots._arena import maze_asked, walk_asked
from stepwell.studio.panels.robots._walked import walked
from stepwell.studio.panels.robots._walking import walking
