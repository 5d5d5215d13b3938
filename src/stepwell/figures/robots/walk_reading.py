"""What a figure has to find in a walk, and axes over its time or its cycles."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from stepwell.base import Bools, Floats, InputError
from stepwell.figures.common import marks, style
from stepwell.figures.common.sheet import page_width

if TYPE_CHECKING:
    from stepwell.robot import Robot
    from stepwell.simulation import Walk


# How the whole robot moves in a cycle, in the order of legends.
FORWARD, BACKWARD, IDLE = "forward", "backward", "in place"
LEFT, RIGHT = "turning left", "turning right"
MOTION = {
    FORWARD: style.INK,
    LEFT: style.BLUE,
    RIGHT: style.VERMILLION,
    BACKWARD: style.ORANGE,
    IDLE: style.FAINT,
}
PRESSED = style.PURPLE

_MORE = (style.GREEN, style.BLUE, style.VERMILLION, style.INK)


class Rest(NamedTuple):
    """From when to when [s] a leg rests in a state."""

    begin: float
    end: float
    state: str


def leg_colours(robot: Robot) -> dict[str, str]:
    """One colour a leg, by its name; neither blue nor vermillion, which have other meanings."""
    names = [leg.name for leg in robot.legs]
    return dict(zip(names, style.cell_colours(len(names)), strict=True))


def first_cycle(walk: Walk) -> int:
    """How many cycles the actuator had gone through before the first whole one of the walk."""
    return round(walk.starts[0] / walk.robot.drive.period) if len(walk.starts) else 0


def cycle_samples(walk: Walk) -> NDArray[np.intp]:
    """The sample at the start of every cycle and at the end of the last; none without a cycle."""
    return np.minimum(np.searchsorted(walk.time, walk.starts - 1e-9), len(walk.time) - 1)


def intervals(time: Floats, held: Bools) -> list[tuple[float, float]]:
    """The first and the last time of every stretch of samples in which `held` is true."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], held, [False]])))
    return [(float(time[first]), float(time[end - 1])) for first, end in edges.reshape(-1, 2)]


def standing(force: Floats) -> Bools:
    """Whether a foot or support that carries these forces [N] stands, of the same shape."""
    from stepwell.simulation import LOADED

    return force > LOADED


def resting(walk: Walk, leg: str, some: slice) -> list[Rest]:
    """The states that a leg rests in, one after another, as `Walk.gait` counts them."""
    found: list[Rest] = []
    for time in walk.time[some].tolist():
        state = walk.state(leg, time)
        if state is None:
            continue
        if found and found[-1].state == state:
            found[-1] = found[-1]._replace(end=time)
        else:
            found.append(Rest(time, time, state))
    return found


def direction(gait: str) -> int:
    """+1 for a forward step, -1 for a backward one, 0 for none.

    Forward: the last cell, which lifts the foot, moves last on the way out and last on the
    way back.
    """
    states = gait.split(">")
    if len(states[0]) < 2:
        return 0
    ones = "1" * (len(states[0]) - 1)
    out, back = ones + "0", "0" * len(ones) + "1"
    if out not in states or back not in states or ones + "1" not in states:
        return 0
    return 1 if states.index(out) < states.index(back) else -1


def gait_words(gait: str) -> str:
    """A gait with the direction of its step."""
    return gait + {1: ", forward", -1: ", backward", 0: ""}[direction(gait)]


def motions(walk: Walk) -> list[str]:
    """How the robot as a whole moves in each cycle, from the gaits of its legs."""
    gaits = walk.gaits
    found: list[str] = []
    for cycle in range(walk.cycles):
        steps: dict[int, list[int]] = {1: [], -1: []}
        for leg in walk.robot.legs:
            steps[leg.side].append(direction(gaits[leg.name][cycle]))
        left, right = (float(np.mean(steps[side])) if steps[side] else 0.0 for side in (1, -1))
        if left != right:
            found.append(LEFT if right > left else RIGHT)
        else:
            found.append(FORWARD if left > 0 else BACKWARD if left < 0 else IDLE)
    return found


def gait_colours(walk: Walk) -> dict[str, str]:
    """A colour for every gait string that occurs, directed ones first."""
    occur = {gait for gaits in walk.gaits.values() for gait in gaits}
    found = {gait: colour for gait, colour in style.PATHWAY.items() if gait in occur}
    longer = {1: style.ORANGE, -1: style.SKY, 0: style.YELLOW}
    step = {gait: direction(gait) for gait in occur}
    rest = sorted(occur - set(found), key=lambda gait: (-abs(step[gait]), -step[gait], gait))
    spare = iter(_MORE * (len(rest) // len(_MORE) + 1))
    for gait in rest:
        colour = longer[step[gait]] if len(gait.split(">")[0]) > 2 else ""
        found[gait] = colour if colour and colour not in found.values() else next(spare)
    return found


DASHED = {"color": style.FAINT, "linewidth": 0.5, "linestyle": (0, (4, 3))}


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
    if page_width(style.PAGE) < style.PAGE:
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
        ax.text(0.5, 0.5, "no whole cycle", bbox=style.on_white(0.2), **middle)
    return first + 1 + np.arange(walk.cycles)
