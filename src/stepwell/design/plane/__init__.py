"""Curves in a plane of two parameters: traced, narrowed, made smooth, cut."""

from stepwell.design.plane.boundary import RESOLVED, Boundary, BoundaryKind, Method
from stepwell.design.plane.box import Box
from stepwell.design.plane.implicit import Level, curves
from stepwell.design.plane.polyline import narrowed, parted, smoothed
from stepwell.design.plane.search import searched
from stepwell.design.plane.trace import trace
