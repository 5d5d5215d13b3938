"""Checks of what is asked about a chain: its actuator, its states."""

import math
from dataclasses import replace

from stepwell.base import InputError
from stepwell.mechanism import Chain
from stepwell.statics import read_state

Drive = str | float | None


def driven(chain: Chain, drive: Drive) -> Chain:
    """The chain with the actuator named by `drive`."""
    if drive is None:
        return chain
    if isinstance(drive, str):
        if drive not in ("stroke", "force"):
            raise InputError(
                f"drive = {drive!r}: must be 'stroke', 'force', or the stiffness of the actuator "
                f"[N/m]."
            )
        return replace(chain, actuator_stiffness=math.inf if drive == "stroke" else 0.0)
    return replace(chain, actuator_stiffness=drive)


def refuse_friction(chain: Chain) -> None:
    """Raise ValueError where a cell has friction."""
    for name, cell in zip(chain.names, chain.cells, strict=True):
        if cell.friction > 0:
            raise InputError(
                f"{name} has friction {cell.friction:.4g} N: a chain with friction stops wherever "
                f"it is turned back, so it has no finite graph. Leave friction out to see the "
                f"graph, and ask chain.program() for a program, which searches with friction."
            )


def checked_state(chain: Chain, name: str, state: str) -> str:
    """The state, if the chain can have it; raises ValueError otherwise."""
    read_state(chain, name, state)
    return state
