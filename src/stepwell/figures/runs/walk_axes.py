"""Axes over the time or the cycles of a walk."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from stepwell.base import InputError
from stepwell.figures.common import FAINT, PAGE, marks, on_white, page_width
from stepwell.figures.runs.walk_reading import first_cycle

if TYPE_CHECKING:
    from stepwell.simulation import Walk

DASHED = {"color": FAINT, "linewidth": 0.5, "linestyle": (0, (4, 3))}


def refuse_empty(walk: Walk) -> None:
    """Refuse a walk that ended before its first sample."""
    if len(walk.time) == 0:
        why = f" {walk.stopped}" if walk.stopped else ""
        raise InputError(f"the walk has no samples, so there is nothing to draw.{why}")


def last_cycles(walk: Walk, cycles: float) -> slice:
    """The samples of the last so many cycles; refuses a walk without samples, and no cycles."""
    if not cycles > 0:
        raise InputError(f"cycles = {cycles}: must be > 0.")
    refuse_empty(walk)
    begin = walk.time[-1] - cycles * walk.robot.drive.period
    return slice(int(np.searchsorted(walk.time, begin - 1e-9)), len(walk.time))


def show_time(ax: Axes, walk: Walk, some: slice, zorder: float) -> None:
    """Limits at the first and the last of these samples, a tenth of a period apart at least.

    The starts of cycles between them are dashed.
    """
    time = walk.time[some]
    ax.set_xlim(time[0], max(time[-1], time[0] + 0.1 * walk.robot.drive.period))
    if page_width(PAGE) < PAGE:
        # Moments of a short walk have many digits.
        ax.xaxis.set_major_locator(MaxNLocator(nbins=5, steps=[1, 2, 5, 10]))
    for start in walk.starts:
        if time[0] < start < time[-1]:
            ax.axvline(start, **DASHED, zorder=zorder)


def number_cycles(ax: Axes, walk: Walk) -> NDArray[np.intp]:
    """An axis for bars over whole cycles, and their numbers (cycles,); says if there is none."""
    first = first_cycle(walk)
    marks.zero_line(ax)
    ax.set(xlim=(first + 0.4, first + max(walk.cycles, 1) + 0.6), xlabel="Cycle")
    ax.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1, nbins=8))
    if not walk.cycles:
        ax.set_xticks([])
        middle = {"transform": ax.transAxes, "ha": "center", "va": "center"}
        ax.text(0.5, 0.5, "no whole cycle", bbox=on_white(0.2), **middle)
    return first + 1 + np.arange(walk.cycles)
