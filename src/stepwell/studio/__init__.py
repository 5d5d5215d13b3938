"""A page on this machine where a design is dragged and everything follows: the server behind it."""

from stepwell.studio.server import serve

__all__ = ["serve"]
