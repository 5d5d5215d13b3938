"""What the page asks the other way round: maps of parameters, wishes, yields."""

from stepwell.studio.panels.inverse._plane import unit_of
