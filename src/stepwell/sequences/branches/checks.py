"""Checks of what is asked about a chain: its actuator, its states."""

import math
from dataclasses import replace

from stepwell.base import InputError, Quantity, told_in
from stepwell.mechanism import Chain

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
    told, factor = told_in(chain.measure.force_unit)
    sign = Quantity("friction", told).sign
    for name, cell in zip(chain.names, chain.cells, strict=True):
        if cell.friction > 0:
            raise InputError(
                f"{name} has friction {cell.friction * factor:.4g} {sign}: a chain with friction stops wherever "
                f"it is turned back, so it has no finite graph. Leave friction out to see the "
                f"graph, and ask chain.program() for a program, which searches with friction."
            )


def checked_state(chain: Chain, name: str, state: str) -> str:
    """The state, if it names a phase of every cell; raises ValueError otherwise."""
    digits = "" if chain.elements else " 0 or 1"
    must = f"{name} = {state!r}: must be {len(chain)} characters{digits}, inner cell first"
    if len(state) != len(chain):
        raise InputError(f"{must}.")
    for cell, digit, last in zip(chain.names, state, chain.last_state, strict=True):
        if digit not in "0123456789"[: int(last) + 1]:
            allowed = f", and {cell} has phases 0 to {last}" if chain.elements else ""
            raise InputError(f"{must}{allowed}.")
    return state
