"""Curves in a plane of two parameters: traced, bisected, made smooth, cut."""

from stepwell.design.plane.bisect import bisected
from stepwell.design.plane.boundary import RESOLVED, Boundary, BoundaryKind
from stepwell.design.plane.box import Box
from stepwell.design.plane.implicit import Level, curves
from stepwell.design.plane.polyline import parted, smoothed
from stepwell.design.plane.search import searched
from stepwell.design.plane.trace import trace
