"""A motion as one HTML file that plays anywhere, without a server."""

from stepwell.studio.replay.page import replay

__all__ = ["replay"]
