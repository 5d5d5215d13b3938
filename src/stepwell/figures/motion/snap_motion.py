"""Travels over time while a chain snaps, with masses and dampers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from stepwell.base import Floats, InputError
from stepwell.figures.common import legends, style, words
from stepwell.figures.common.sheet import canvas, keep_inside
from stepwell.figures.common.words import literal

if TYPE_CHECKING:
    from stepwell.mechanism import Chain
    from stepwell.statics import InertialLanding

# One a landing, the first one thin and below: it is what the others are compared with.
_LOOKS = (
    {"linewidth": 1.0, "linestyle": (0, (3.2, 1.6))},
    {"linewidth": 1.4, "linestyle": "-"},
    {"linewidth": 1.2, "linestyle": ":"},
)
# Between two steps of the integration travels are parabolas; so many points on each.
_POINTS = 6
# A motion begins where a cell has gone this share of its way, and has ended where none is
# further than a tenth of it from where it rests; a quarter more is shown.
_STILL, _MORE = 2e-3, 1.25


@style.styled
def snap_motion(
    chain: Chain, landings: Mapping[str, InertialLanding], *, ax: Axes | None = None
) -> Figure:
    """Travel of each cell over time during a snap, several landings in one frame.

    Time counts from where a cell has gone two thousandths of its way: near a fold what comes
    before hangs on how gently the snap is set off.

    Args:
        chain: what snaps.
        landings: of one snap, with their history, by what to call them; three at most.
        ax: axes to draw into; a new figure of one column's width by default.

    Returns:
        The figure: travel [mm], or what it is in the chain's measure, against time [ms].

    Raises:
        ValueError: no landing or more than three, or one without a history.
    """
    if not 1 <= len(landings) <= len(_LOOKS):
        raise InputError(
            f"landings has {len(landings)}: one to {len(_LOOKS)} can be told apart by their lines."
        )
    own = ax is None
    full = np.array([cell.full_travel for cell in chain.cells])
    y, colours, until = words.travel(chain.measure), style.cell_colours(len(chain)), 0.0
    moved = np.zeros(len(chain), bool)
    for name, landing in landings.items():
        time, travel = _curve(name, landing, full)
        until = max(until, _MORE * time[-1])
        moved |= np.ptp(travel, axis=0) > _STILL * full
    # Room for the rows of the legend.
    top = 2.5 + 3.8 * -(-(np.count_nonzero(moved) + len(landings)) // 3)
    figure, ax = canvas(ax, (style.COLUMN, 50.0 + top), (13.0, 10.0, 2.0, top))
    looks = _LOOKS if len(landings) > 1 else _LOOKS[1:]
    for look, (name, landing) in zip(looks, landings.items(), strict=False):
        time, travel = _curve(name, landing, full)
        # It rests from then on.
        time, travel = np.append(time, until), np.vstack([travel, travel[-1]])
        for i in np.flatnonzero(moved):
            ax.plot(time * 1e3, travel[:, i] * y.factor, color=colours[i], **look)
    ax.set(xlabel="Time [ms]", ylabel=y.label)
    ax.set_xlim(0.0, until * 1e3)
    ax.margins(y=0.08)
    # Those that lie in the frame, which they do not widen.
    ax.set_ylim(ax.get_ylim())
    for stop in {
        end * y.factor for i in np.flatnonzero(moved).tolist() for end in _stops(chain, i)
    }:
        ax.axhline(stop, color=style.FAINT, linewidth=0.4, zorder=0)
    lines: list[Line2D] = [
        legends.line(literal(chain.names[i]), colours[i]) for i in np.flatnonzero(moved)
    ]
    for look, name in zip(looks, landings, strict=False):
        lines.append(Line2D([], [], color=style.FAINT, label=literal(name), **look))
    if own:
        keep_inside(ax)
    legends.above(ax, lines, columns=3)
    return figure


def _stops(chain: Chain, cell: int) -> list[float]:
    """Travels at which a cell is stopped [m]."""
    one = chain.cells[cell]
    return [end for end, there in zip((one.low, one.high), one.stopped, strict=True) if there]


def _curve(name: str, landing: InertialLanding, full: Floats) -> tuple[Floats, Floats]:
    """Times [s] from where the motion is seen until it has ended, and travels there [m]."""
    history = landing.history
    if history is None:
        raise InputError(f"landings[{name!r}] has no history: ask for it with history=True.")
    off = np.max(np.abs(history.travel - history.travel[0]) / full, axis=1) > _STILL
    far = np.max(np.abs(history.travel - history.travel[-1]) / full, axis=1) > 0.1 * _STILL
    first = max(int(np.argmax(off)) - 1, 0)
    last = min(int(np.flatnonzero(far)[-1]) + 1 if far.any() else 1, len(off) - 1)
    part = slice(first, last + 1)
    t, s, v = history.time[part], history.travel[part], history.speed[part]
    share = np.linspace(0.0, 1.0, _POINTS, endpoint=False)[:, None, None]
    h = np.diff(t)[:, None]
    # A parabola on each step, from where it begins: a blow at its end has another speed.
    begin = h * v[:-1]
    inside = s[:-1] + share * (begin + share * (np.diff(s, axis=0) - begin))
    times = t[:-1, None] + h * share[:, 0, 0]
    travel = np.vstack([inside.transpose(1, 0, 2).reshape(-1, s.shape[1]), s[-1]])
    return np.append(times.ravel(), t[-1]) - t[0], travel
