"""The chain with two of its parameters at other values."""

from __future__ import annotations

from stepwell import files
from stepwell.studio.panels.inverse._plane import asked_parameter, unit_of
from stepwell.studio.wire import Ask, Design, View

_FARTHEST = 1e6


def answer(design: Design, ask: Ask) -> View:
    """Table `chain` of its design file; `at` has the two values in units of the bench."""
    chain = design.chain
    both = [asked_parameter(chain, ask, letter) for letter in "xy"]
    at = ask.numbers("at", 2, -_FARTHEST, _FARTHEST, least_many=2)
    ask.close()
    for parameter, value in zip(both, at, strict=True):
        chain = parameter.changed(chain, value / unit_of(parameter)[1])
    return View({"chain": files.tables_in(files.dumps(chain))["chain"]})
