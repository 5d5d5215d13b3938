"""Stroke programs as plain numbers with the unit in every name, for other programs to read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stepwell.mechanism import Chain
from stepwell.results.head import head
from stepwell.results.run import (
    LONGEST_SPELLED_OUT,
    actuator_record,
    event_record,
    finite,
    told_drive,
)

if TYPE_CHECKING:
    from stepwell.sequences import Program, Turn, Unreachable

PROGRAM_SCHEMA = "stepwell.program/1"


def program_record(program: Program, *, design: str | None = None) -> dict[str, Any]:
    """A program that was found, as JSON can hold it.

    Args:
        program: any.
        design: text of the chain's design file, for the hash of it; written anew by default.

    Returns:
        The record that docs/commands.md describes, in mm, or in N under force control.
    """
    unit, factor = told_drive(program.chain)
    path = program.path
    return {
        **_head(program.chain, program.start, program.to, design),
        "arrives": program.arrives,
        "does_it": program.arrives == program.to,
        "proved": program.shortest,
        "reason": program.method,
        "strokes": program.strokes,
        f"turning_points_{unit}": [finite(point, factor) for point in program.turning_points],
        "sequence": str(program.sequence) if len(path.chain) <= LONGEST_SPELLED_OUT else None,
        "events": [event_record(event, path.chain) for event in path.events],
        "dissipated_mJ": finite(path.dissipated, 1e3),
        "turns": [_turn(turn, program.chain) for turn in program.turns],
        f"end_low_{unit}": finite(program.low, factor),
        f"end_high_{unit}": finite(program.high, factor),
        f"slack_{unit}": finite(program.slack, factor),
    }


def unreachable_record(
    chain: Chain,
    start: str | None,
    to: str | None,
    why: Unreachable,
    *,
    design: str | None = None,
) -> dict[str, Any]:
    """That no program does it, as JSON can hold it.

    Args:
        chain: what was to be driven.
        start, to: the states between which there is no way.
        why: what `chain.program` raised.
        design: text of its design file, for the hash of it; written anew by default.

    Returns:
        The record that docs/commands.md describes.
    """
    return {
        **_head(chain, start, to, design),
        "arrives": None,
        "does_it": False,
        "proved": why.proved,
        "reason": str(why),
    }


def _head(chain: Chain, start: str | None, to: str | None, design: str | None) -> dict[str, Any]:
    return {
        **head(PROGRAM_SCHEMA, design or chain),
        "title": chain.title,
        "actuator": actuator_record(chain),
        "cells": list(chain.names),
        "from": start or "0" * len(chain),
        "to": to,
    }


def _turn(turn: Turn, chain: Chain) -> dict[str, Any]:
    unit, factor = told_drive(chain)
    return {
        f"drive_{unit}": finite(turn.drive, factor),
        f"low_{unit}": finite(turn.low, factor),
        f"high_{unit}": finite(turn.high, factor),
        "branch": list(turn.branch),
    }
