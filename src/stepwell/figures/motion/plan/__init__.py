"""A path in time: its strokes one after the other, and what is seen of it at each instant."""

from stepwell.figures.motion.plan.instants import Instant, instants
from stepwell.figures.motion.plan.strokes import (
    StrokePlan,
    Window,
    draw_plan,
    limits,
    plan_of,
    windows_of,
)
