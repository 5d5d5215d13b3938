"""Hoppers, and their simulated jumps, each computed once."""

from dataclasses import replace
from functools import cache
from typing import Any

import stepwell as sw
from stepwell.robot import Hopper
from stepwell.simulation import Jump


def hopper(name: str = "hopper", **changes: Any) -> Hopper:
    """A shipped hopper with other fields."""
    return replace(sw.load(f"preset:{name}"), **changes)


@cache
def jumped(name: str = "hopper", jumps: int = 1, task: str = "jump") -> Jump:
    """A shipped hopper that has done its task."""
    return sw.simulation.jump(hopper(name, task=task), jumps)
