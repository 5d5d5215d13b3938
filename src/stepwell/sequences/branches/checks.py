"""Checks of what is asked about a chain: its actuator, its states."""

import math
from dataclasses import replace

from stepwell.base import InputError, amount
from stepwell.mechanism import Chain
from stepwell.statics import read_state

Drive = str | float | None


def driven(chain: Chain, drive: Drive) -> Chain:
    """The chain with the actuator named by `drive`."""
    if drive is None:
        return chain
    if isinstance(drive, str):
        measure = chain.measure
        known = {"stroke": math.inf, "force": 0.0, measure.stroke: math.inf, measure.force: 0.0}
        if drive not in known:
            raise InputError(
                f"drive = {drive!r}: must be {measure.stroke!r}, {measure.force!r}, or the "
                f"stiffness of the actuator [{measure.stiffness_unit}]."
            )
        return replace(chain, actuator_stiffness=known[drive])
    return replace(chain, actuator_stiffness=drive)


def refuse_friction(chain: Chain) -> None:
    """Raise ValueError where a cell has friction."""
    for name, cell in zip(chain.names, chain.cells, strict=True):
        if cell.friction > 0:
            friction = amount(cell.friction, chain.measure.force_unit)
            raise InputError(
                f"{name} has friction {friction}: a chain with friction stops wherever "
                f"it is turned back, so it has no finite graph. Leave friction out to see the "
                f"graph, and ask chain.program() for a program, which searches with friction."
            )


def checked_state(chain: Chain, name: str, state: str) -> str:
    """The state, if the chain can have it; raises ValueError otherwise."""
    read_state(chain, name, state)
    return state
