"""A stroke program: the shortest from one state to another, or one drawn by hand."""

from __future__ import annotations

from stepwell.base import InputError, told_in
from stepwell.mechanism import Chain
from stepwell.sequences import Program
from stepwell.studio.panels.evaluate import arrays_of, drawn, events_of, units_of
from stepwell.studio.wire import Ask, Design, View

_MOST_TURNS = 100
_FARTHEST = 1e6


def answer(design: Design, ask: Ask) -> View:
    """The program from `start` to `to`, or the one of `turning_points_mm`, with its samples."""
    chain = design.chain
    found = _found(chain, ask)
    path = drawn(found.path)
    drive = told_in(chain.drive_unit)[1]
    header = {
        "units": units_of(chain),
        "start": found.start,
        "to": found.to,
        "arrives": found.arrives,
        "does_it": found.arrives == found.to and found.hangs is None,
        "proved": found.shortest,
        "reason": found.reason,
        "turning_points_mm": [point * drive for point in found.turning_points],
        "turns": [
            {"drive_mm": t.drive * drive, "low_mm": t.low * drive, "high_mm": t.high * drive}
            for t in found.turns
        ],
        "states": list(found.sequence.states),
        "sequence": str(found.sequence),
        "events": events_of(found.path.events, path),
    }
    return View(header, arrays_of(path))


def _found(chain: Chain, ask: Ask) -> Program:
    start = ask.text("start", len(chain), chain.first_state)
    if ask.has("turning_points_mm"):
        drive = told_in(chain.drive_unit)[1]
        points = ask.numbers("turning_points_mm", _MOST_TURNS, -_FARTHEST, _FARTHEST)
        ask.close()
        return Program.given(chain, [point / drive for point in points], start=start)
    to = ask.text("to", len(chain))
    ask.close()
    for key, state in (("start", start), ("to", to)):
        last = chain.last_state
        if len(state) != len(last) or not all(
            "0" <= a <= b for a, b in zip(state, last, strict=True)
        ):
            raise InputError(f"ask.{key} = {state!r}: must be one digit a cell, up to {last}.")
    return chain.program(to, start=start)
