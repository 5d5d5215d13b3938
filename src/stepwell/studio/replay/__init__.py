"""A motion as one HTML file that plays anywhere, without a server."""

from stepwell.studio.replay.page import embedded, replay

__all__ = ["embedded", "replay"]
