"""A stroke program: the shortest from one state to another, or one drawn by hand."""

from __future__ import annotations

import tomllib
from typing import Any

from stepwell.base import InputError, told_in
from stepwell.files import WrittenProgram
from stepwell.mechanism import Chain
from stepwell.sequences import Program, ProgramMethod
from stepwell.studio.panels.motions._drawn import (
    arrays_of,
    drawn,
    events_of,
    program_told,
    units_of,
)
from stepwell.studio.wire import Ask, Design, View

_MOST_TURNS = 100
_FARTHEST = 1e6


def answer(design: Design, ask: Ask) -> View:
    """The program from `start` to `to`, or the one of `turning_points_mm`, with its samples."""
    found = program_of(design.chain, ask)
    ask.close()
    path = drawn(found.path)
    header = {"units": units_of(found.chain), **program_told(found)}
    return View(
        {**header, "events": events_of(found.path.events, path), "written": _written(found)},
        arrays_of(path),
    )


def program_of(chain: Chain, ask: Ask) -> Program:
    """The program that is asked for.

    Raises:
        ValueError: states that are none of this chain, or between which no program leads.
    """
    start = _state(chain, ask, "start", chain.first_state)
    if ask.has("turning_points_mm"):
        drive = told_in(chain.drive_unit)[1]
        points = ask.numbers("turning_points_mm", _MOST_TURNS, -_FARTHEST, _FARTHEST)
        to = _state(chain, ask, "to") if ask.has("to") else None
        return Program.given(chain, [point / drive for point in points], start=start, to=to)
    return chain.program(_state(chain, ask, "to"), start=start)


def _state(chain: Chain, ask: Ask, key: str, default: str | None = None) -> str:
    state, last = ask.text(key, len(chain), default), chain.last_state
    if len(state) == len(last) and all("0" <= a <= b for a, b in zip(state, last, strict=True)):
        return state
    raise InputError(f"ask.{key} = {state!r}: must be one digit a cell, up to {last}.")


def _written(found: Program) -> dict[str, Any]:
    """The table [program] of a design file; of one that was planned with tidy numbers."""
    if found.method is ProgramMethod.GIVEN:
        kept = WrittenProgram(found.start, found.turning_points, found.to)
    else:
        kept = WrittenProgram.of(found)
    return tomllib.loads(kept.text(found.chain))["program"]
