"""The studio: an interactive page on this machine, and its server."""

from typing import TYPE_CHECKING

from stepwell.base import late

if TYPE_CHECKING:
    from stepwell.studio.server import serve
    from stepwell.studio.standalone import as_iframe, replay

__all__ = ["as_iframe", "replay", "serve"]

# A replay needs no server, and a server starts before the first replay is written.
_LATE = {"server": ("serve",), "standalone": ("as_iframe", "replay")}
__getattr__, __dir__ = late(__name__, _LATE, __all__)
