"""The words in which a reading is printed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from stepwell.sequences.graphs import drives_text

if TYPE_CHECKING:
    from stepwell.sequences.memory.reading import MemoryReading

# Items of a list that are shown.
_SHOWN = 6


def report(reading: MemoryReading) -> str:
    """One line for each thing that was looked for."""
    graph = reading.graph
    lines = [
        f"{graph.cells} cells driven by {graph.actuator}: {len(graph.vertices)} vertices on "
        f"{reading.branches} branches",
        f"main loop            {reading.main_loop}",
        f"sub-loops            {_sub_loops(reading)}",
        f"Garden of Eden       {_gardens(reading)}",
        f"not from all at 0    {_listed(reading.unreachable)}",
        f"return-point memory  {_memory(reading)}",
        f"scrambling           {_scrambling(reading)}",
        f"accumulators         {_accumulators(reading)}",
        f"latches              {_latches(reading)}",
    ]
    if graph.ties:
        lines.append(f"ties                 {len(graph.ties)}, so other ways are possible")
    return "\n".join(lines)


def _listed(items: Sequence[str], nothing: str = "none") -> str:
    if not items:
        return nothing
    more = f" and {len(items) - _SHOWN} more" if len(items) > _SHOWN else ""
    return f"{', '.join(items[:_SHOWN])}{more}"


def _sub_loops(reading: MemoryReading) -> str:
    if reading.sub_loops is None:
        return f"{reading.sub_loop_count}"
    listed = _listed([str(loop) for loop in reading.sub_loops])
    return f"{reading.sub_loop_count}: {listed}" if reading.sub_loops else listed


def _gardens(reading: MemoryReading) -> str:
    if reading.garden_of_eden is None:
        return "not known: the graph began with one state"
    return _listed(reading.garden_of_eden)


def _memory(reading: MemoryReading) -> str:
    lapse = reading.return_point_memory.witness
    if lapse is None:
        return "holds"
    way = drives_text(reading.graph.unit, lapse.turns, " → ")
    return f"fails: {way} stands at {lapse.first} when first there and at {lapse.later} later"


def _scrambling(reading: MemoryReading) -> str:
    names = reading.graph.names
    return _listed(
        [
            f"{names[s.cells[0]]} {'up' if s.direction > 0 else 'down'} before {names[s.cells[1]]} "
            f"from {s.i_first}, after it from {s.j_first}"
            + ("" if s.reachable else " (set by hand)")
            for s in reading.scrambling
        ]
    )


def _accumulators(reading: MemoryReading) -> str:
    found = reading.counting.accumulators
    part = "" if reading.counting.exhaustive else " (searched in part)"
    counts = [
        f"{'>'.join(a.states)} in cycles of {drives_text(reading.graph.unit, (a.low, a.high))}"
        + (" (set by hand)" if a.by_hand else "")
        for a in found
    ]
    return _listed(counts) + part


def _latches(reading: MemoryReading) -> str:
    ways = [f"{a}>{b}" for latch in reading.latches for a, b, _ in latch.ways]
    return _listed(ways)
