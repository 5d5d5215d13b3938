"""Designs found, and how surely they work, as plain numbers with the unit in every name."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from stepwell.mechanism import Chain
from stepwell.results.head import head
from stepwell.results.run import actuator_record, finite, told_drive

if TYPE_CHECKING:
    from stepwell.design import (
        Design,
        Impossible,
        Reprogramming,
        Robustness,
        Survival,
        Tolerances,
        Yield,
    )

DESIGN_SCHEMA = "stepwell.design/1"
YIELD_SCHEMA = "stepwell.yield/1"
SURVIVAL_SCHEMA = "stepwell.survival/1"
REPROGRAM_SCHEMA = "stepwell.reprogram/1"
# The states of a longer chain are too many to be listed.
MOST_CELLS = 12


def yield_record(found: Yield, *, design: str | None = None) -> dict[str, Any]:
    """How many built mechanisms do what is wanted, as JSON can hold it.

    Args:
        found: what `design.yields` returns.
        design: text of its design file, for the hash of it; written anew by default.

    Returns:
        The record that docs/commands.md describes.
    """
    return {
        **_about(YIELD_SCHEMA, found, design),
        **_yield(found),
    }


def survival_record(found: Survival, *, design: str | None = None) -> dict[str, Any]:
    """How many built mechanisms a stroke program brings where it should, as JSON can hold it.

    Args:
        found: what `design.survival` returns.
        design: text of its design file, for the hash of it; written anew by default.

    Returns:
        The record that docs/commands.md describes; turning points in mm, or in N under force
        control.
    """
    chain = found.chain
    unit, factor = told_drive(chain)
    return {
        **_about(SURVIVAL_SCHEMA, found, design),
        "from": found.start,
        "to": found.ends,
        f"turning_points_{unit}": [finite(point, factor) for point in found.turning_points],
        **_counted(found),
        "assumptions": found.assumptions,
    }


def design_record(found: Design) -> dict[str, Any]:
    """A design that does what is wanted, as JSON can hold it.

    Args:
        found: what `design.design` returns.

    Returns:
        The record that docs/commands.md describes, in mm and N.
    """
    chain = found.chain
    return {
        **_head(chain, found.yield_.seed, proved=found.proved),
        "reason": found.method,
        "sequence": found.sequence,
        "loading_order": list(found.loading),
        "unloading_order": list(found.unloading),
        "state_count": found.reached.count,
        "states": list(found.states) if len(chain) <= MOST_CELLS else None,
        "states_whole": found.reached.whole,
        "states_how": found.reached.how,
        "actuator": actuator_record(chain),
        "cells": _cells(chain),
        "holes_mm": None if found.holes is None else finite(found.holes, 1e3),
        "candidates": found.candidates,
        "robustness": None if found.robustness is None else _robustness(found.robustness),
        "yield": _yield(found.yield_),
        "assumptions": found.assumptions,
    }


def impossible_record(why: Impossible) -> dict[str, Any]:
    """That nothing allowed does what is wanted, as JSON can hold it.

    Args:
        why: what `design.design` raised.

    Returns:
        The record that docs/commands.md describes.
    """
    return {
        **_head(None, None, proved=why.proved),
        "reason": str(why),
        "largest_gap_N": finite(why.largest_gap),
        "gap_needed_N": finite(why.gap_needed),
    }


def reprogram_record(found: Reprogramming, *, design: str | None = None) -> dict[str, Any]:
    """The smallest displacement of an anchor that does it, as JSON can hold it.

    Args:
        found: what `design.reprogram` returns.
        design: text of its design file, for the hash of it; written anew by default.

    Returns:
        The record that docs/commands.md describes, in mm, N and mJ.
    """
    push = found.resistance
    rows = zip(push.fraction, push.force_0, push.force_1, push.peak, strict=True)
    return {
        **head(REPROGRAM_SCHEMA, design or found.chain),
        "title": found.chain.title,
        "by": found.by,
        "target": found.target,
        "possible": math.isfinite(found.distance),
        "before": found.before,
        "after": found.after or None,
        "distance_mm": finite(found.distance, 1e3),
        "displacement_mm": [finite(part, 1e3) for part in found.displacement],
        "place_mm": [finite(part, 1e3) for part in found.place],
        "reach_mm": finite(found.reach, 1e3),
        "method": found.method,
        "resolution": found.resolution,
        "largest_force_N": finite(push.largest),
        "work_at_0_mJ": finite(push.work_0, 1e3),
        "work_at_1_mJ": finite(push.work_1, 1e3),
        "way": [
            {
                "fraction": finite(part),
                "at_mm": [finite(part * move + 0.0, 1e3) for move in found.displacement],
                "force_at_0_N": finite(force_0),
                "force_at_1_N": finite(force_1),
                "largest_force_N": finite(peak),
            }
            for part, force_0, force_1, peak in rows
        ],
    }


def _head(chain: Chain | None, seed: int | None, *, proved: bool) -> dict[str, Any]:
    return {
        **head(DESIGN_SCHEMA, chain, seed),
        "title": "" if chain is None else chain.title,
        "possible": chain is not None,
        "proved": proved,
    }


def _cells(chain: Chain) -> list[dict[str, Any]]:
    """What has to be built; every cell has one band."""
    return [
        {
            "name": name,
            "p_mm": [finite(v, 1e3) for v in cell.bands[0].p],
            "q_mm": [finite(v, 1e3) for v in cell.bands[0].q],
            "stiffness_N_per_m": finite(cell.bands[0].stiffness),
            "rest_length_mm": finite(cell.bands[0].rest_length, 1e3),
            "lever_mm": finite(cell.lever, 1e3),
            "limit_deg": finite(math.degrees(cell.limit)),
            "F0_N": finite(cell.force_0),
            "F1_N": finite(cell.force_1),
        }
        for name, cell in zip(chain.names, chain.cells, strict=True)
    ]


def _robustness(found: Robustness) -> dict[str, Any]:
    meeting = found.meeting
    return {
        "radius_mm": finite(found.radius, 1e3),
        "limit": found.limit,
        "meet": None if meeting is None else [meeting.first, meeting.second],
        "while": None if meeting is None else meeting.way,
    }


def _about(schema: str, found: Yield | Survival, design: str | None) -> dict[str, Any]:
    chain = found.chain
    return {
        **head(schema, design or chain, found.seed),
        "title": chain.title,
        "cells": list(chain.names),
    }


def _counted(found: Yield | Survival) -> dict[str, Any]:
    low, high = found.interval
    return {
        "share": finite(found.share),
        "share_low": finite(low),
        "share_high": finite(high),
        "samples": found.n,
        "seed": found.seed,
        "successes": found.successes,
        "tolerances": _tolerances(found.tolerances),
    }


def _yield(found: Yield) -> dict[str, Any]:
    critical, table = found.critical, found.sensitivities
    return {
        "wanted": found.wanted,
        "wanted_states": None if found.states is None else list(found.states),
        **_counted(found),
        "outcomes": [{"outcome": text, "count": n} for text, n in found.outcomes.items()],
        "critical": None
        if critical is None
        else {
            "first": critical.first,
            "second": critical.second,
            "while": critical.way,
            "share": finite(critical.share),
            "narrowest": finite(critical.narrowest),
        },
        "by_engine": found.by_engine,
        "assumptions": found.assumptions,
        "gap_deviation_N": None if table is None else finite(table.deviation),
        "advice": found.advice,
        "gap_agreement": None if table is None else table.agreed,
        "sensitivities": None
        if table is None
        else [
            {"part": part, "first_order": finite(first), "total": finite(total)}
            for part, first, total in zip(
                table.parameters, table.first_order, table.total, strict=True
            )
        ],
    }


def _tolerances(tolerances: Tolerances) -> dict[str, float | None]:
    return {
        "anchor_mm": finite(tolerances.anchor, 1e3),
        "stiffness_percent": finite(tolerances.stiffness, 1e2),
        "rest_length_percent": finite(tolerances.rest_length, 1e2),
        "lever_mm": finite(tolerances.lever, 1e3),
        "friction_N": finite(tolerances.friction),
    }
