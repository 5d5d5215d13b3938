"""Studies in the server's own folder: begun, watched, stopped, opened."""

from stepwell.studio.panels.studies._folder import store_named
from stepwell.studio.panels.studies._running import end_studies
