"""Solid parts of a mechanism, and the files for cutting and assembling them."""

from stepwell.build.contour import Contour
from stepwell.build.part import Hole, Part

__all__ = ["Contour", "Hole", "Part"]
