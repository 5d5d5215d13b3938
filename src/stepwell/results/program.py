"""Stroke programs as plain numbers with the unit in every name, for other programs to read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stepwell.base import Quantity, Schema, record, told_in
from stepwell.mechanism import Chain
from stepwell.results.head import head
from stepwell.results.run import LONGEST_SPELLED_OUT, actuator_record, event_records
from stepwell.sequences.programs import turn_schema

if TYPE_CHECKING:
    from stepwell.sequences import Program, Unreachable


def drive_schema(unit: str) -> Schema:
    """What is told of the drives of a program; `unit` is that in which they are."""
    return (
        Quantity("turning_points", unit),
        Quantity("end_low", unit, read="low"),
        Quantity("end_high", unit, read="high"),
        Quantity("slack", unit),
    )


def program_record(program: Program, *, design: str | None = None) -> dict[str, Any]:
    """A program that was found, as docs/commands.md describes it."""
    path, chain = program.path, program.chain
    unit, _ = told_in(chain.drive_unit)
    points, *ends = drive_schema(unit)
    return {
        **_head(chain, program.start, program.to, design),
        "arrives": program.arrives,
        "does_it": program.arrives == program.to,
        "proved": program.shortest,
        "reason": program.method,
        "strokes": program.strokes,
        **record([points], program),
        "sequence": str(program.sequence) if len(chain) <= LONGEST_SPELLED_OUT else None,
        "events": event_records(path.events, chain),
        **record([Quantity("dissipated", "mJ")], path),
        "turns": [record(turn_schema(unit), turn) for turn in program.turns],
        **record(ends, program),
    }


def unreachable_record(
    chain: Chain,
    start: str | None,
    to: str | None,
    why: Unreachable,
    *,
    design: str | None = None,
) -> dict[str, Any]:
    """That no program does it, as docs/commands.md describes it.

    Args:
        start, to: the states between which there is no way.
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
        **head("stepwell.program/1", design or chain),
        "title": chain.title,
        "actuator": actuator_record(chain),
        "cells": list(chain.names),
        "from": start or "0" * len(chain),
        "to": to,
    }
