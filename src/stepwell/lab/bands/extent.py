"""Between which strokes, and in which cycles, bands are fitted where nobody says so."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stepwell.base import Bools, Floats
from stepwell.lab.bands.halves import Hysteresis

# What the paper's stiffness was read from: 5 to 35 mm of cycles 5 to 9.
WINDOW = (0.005, 0.035)
CYCLES = (5, 9)
REACH = 1e-4  # [m] by which a stroke may miss the end of a window
_FEW = 20  # readings of a loading half, of which none is given away
_SLACK = 0.02  # of the largest force, below which a band is not said to be taut


def usual_cycles(loops: Sequence[Hysteresis]) -> tuple[tuple[int, int], str]:
    """First and last cycle that is fitted, and what is told where it is not the paper's.

    That is every cycle but the first, where every sample has others: rubber softens most in it.
    """
    samples = {loop.sample for loop in loops}
    first, last = CYCLES
    if not loops or {o.sample for o in loops if first <= o.cycle <= last} == samples:
        return CYCLES, ""
    top = max(loop.cycle for loop in loops)
    begin = 2 if {o.sample for o in loops if o.cycle > 1} == samples else 1
    why = f"not every sample has one of the usual {first} to {last}"
    shown = f"cycle {top} is" if begin == top else f"cycles {begin} to {top} are"
    return (begin, top), f"{shown} fitted: {why}"


def usual_window(used: Sequence[Hysteresis]) -> tuple[tuple[float, float], str]:
    """The strokes between which bands are fitted [m], and what is told where they are not usual.

    That is from where the band is taut to the end of what was measured, where a loading half does
    not reach over the paper's window or has few readings in it.
    """
    low, high = WINDOW
    inside = [np.sum((loop.stroke >= low) & (loop.stroke <= high)) for loop in used]
    over = all(np.min(o.stroke) <= low + REACH and np.max(o.stroke) >= high - REACH for o in used)
    few = bool(inside) and min(inside) < _FEW
    if not used or (over and not few):
        return WINDOW, ""
    usual = f"the usual {low * 1e3:g} to {high * 1e3:g} mm"
    why = f"{usual} hold few readings" if over else f"the stroke does not reach over {usual}"
    found = max(map(_taut_from, used)), min(float(np.max(loop.stroke)) for loop in used)
    shown = " to ".join(f"{edge * 1e3:.4g}" for edge in found)
    return found, f"{shown} mm of stroke are fitted, from where it is taut on: {why}"


def taut(force: Floats, step: float) -> Bools:
    """Whether the band pulls, at each force (n,) [N] of a loading half told in such steps [N]."""
    return force > max(_SLACK * float(np.max(force)), 0.5 * step)


def _taut_from(loop: Hysteresis) -> float:
    """The stroke of the last slack reading before the band pulls, or of the first one [m]."""
    pulls = np.flatnonzero(taut(loop.force, loop.steps[1]))
    first = int(pulls[0]) if len(pulls) else 0
    return float(loop.stroke[max(first - 1, 0)])
