"""Results as plain numbers with the unit in every name, for other programs to read."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from stepwell.mechanism import Cell, Chain
from stepwell.results.head import head
from stepwell.results.ties import tie_notes

if TYPE_CHECKING:
    from stepwell.design import Change, Margin
    from stepwell.sequences import Cycle
    from stepwell.statics import Event

RUN_SCHEMA = "stepwell.run/1"
# The states of a chain are as many as its cells, each as long: past this only orders are told.
LONGEST_SPELLED_OUT = 64
# What a design becomes past each of its changes takes a cycle a change: longer chains are told
# the distances alone.
LONGEST_BECOMING = 12


def run_record(cycle: Cycle, margin: Margin, *, design: str | None = None) -> dict[str, Any]:
    """What a design does, as JSON can hold it: finite numbers, text, lists and None.

    Args:
        cycle: the design's cycle.
        margin: how far the design is from doing something else.
        design: text of its design file, for the hash of it; written anew by default.

    Returns:
        The record that docs/commands.md describes, in mm, deg, N and mJ.
    """
    chain = cycle.chain
    spelled = len(chain) <= LONGEST_SPELLED_OUT
    becoming = len(chain) <= LONGEST_BECOMING
    return {
        **head(RUN_SCHEMA, design or chain),
        "title": chain.title,
        "actuator": actuator_record(chain),
        "cells": [_cell(cell, name) for cell, name in zip(chain.cells, chain.names, strict=True)],
        "sequence": str(cycle.sequence) if spelled else None,
        "pathway": cycle.pathway.name.lower() if cycle.pathway else None,
        "loading_order": list(cycle.loading_order),
        "unloading_order": list(cycle.unloading_order),
        "events": [event_record(event, chain) for event in cycle.events],
        "dissipated_mJ": finite(cycle.dissipated, 1e3),
        "peak_force_N": finite(cycle.peak_force),
        "full_stroke_mm": finite(chain.full_stroke, 1e3),
        "margin": {
            "method": margin.method,
            "reach_mm": finite(margin.reach, 1e3),
            "gap_over_kr": finite(margin.gap),
            "changes": [_change(change, becoming) for change in margin.changes],
        },
        "ties": tie_notes(cycle.degenerate, chain),
    }


def force_scale(cell: Cell) -> float:
    """k r [N] of a cell, with k of its stiffest band: what its forces are compared with."""
    return max(band.stiffness for band in cell.bands) * cell.lever


def finite(value: float, factor: float = 1.0) -> float | None:
    """`value` in another unit; None where it is infinite or no number."""
    scaled = float(value) * factor
    return scaled if math.isfinite(scaled) else None


def told_drive(chain: Chain) -> tuple[str, float]:
    """Unit in which users are told the drive of a chain, and how many of it make one in SI."""
    return ("N", 1.0) if chain.actuator_stiffness == 0 else ("mm", 1e3)


def actuator_record(chain: Chain) -> dict[str, Any]:
    """What the actuator of a chain prescribes, and its stiffness."""
    stiffness = chain.actuator_stiffness
    control = "stroke" if math.isinf(stiffness) else "spring" if stiffness else "force"
    return {"control": control, "stiffness_N_per_m": finite(stiffness)}


def _cell(cell: Cell, name: str) -> dict[str, Any]:
    scale = force_scale(cell)
    return {
        "name": name,
        "F0_N": finite(cell.force_0),
        "F1_N": finite(cell.force_1),
        "F0_over_kr": finite(cell.force_0 / scale),
        "F1_over_kr": finite(cell.force_1 / scale),
        "full_travel_mm": finite(cell.full_travel, 1e3),
        "peak_angle_deg": finite(math.degrees(cell.peak_angle)),
        "barrier_mJ": finite(cell.barrier, 1e3),
        "bistable": bool(cell.is_bistable),
    }


def event_record(event: Event, chain: Chain) -> dict[str, Any]:
    """A switch or a snap of a chain."""
    by_force = chain.actuator_stiffness == 0
    return {
        "kind": event.kind.name.lower(),
        "cause": event.cause.name.lower(),
        "direction": "loading" if event.direction > 0 else "unloading",
        "drive_N" if by_force else "drive_mm": finite(event.drive, 1.0 if by_force else 1e3),
        "stroke_mm": finite(event.stroke, 1e3),
        "cells": list(event.cells),
        "before_mm": [finite(travel, 1e3) for travel in event.before],
        "after_mm": [finite(travel, 1e3) for travel in event.after],
        "force_before_N": finite(event.force_before),
        "force_after_N": finite(event.force_after),
        "released_mJ": finite(event.released, 1e3),
        "arrivals": [{"cell": cell, "state": state} for cell, state in event.arrivals],
        "tie": bool(event.tie),
    }


def _change(change: Change, becoming: bool) -> dict[str, Any]:
    known: dict[str, Any] = {
        "cell": change.cell,
        "parameter": change.parameter,
        "method": change.method,
    }
    if isinstance(change.move, tuple):
        known |= {
            "distance_mm": finite(change.distance, 1e3),
            "move_mm": [finite(part, 1e3) for part in change.move],
        }
    else:
        known |= {
            "distance_percent": finite(change.distance, 100.0),
            "move_percent": finite(change.move, 100.0),
        }
    return known | {"becomes": change.becomes or None if becoming else None}
