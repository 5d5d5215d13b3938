"""Recordings of a test machine behind the curves of the model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.typing import LineStyleType

from stepwell.base import InputError, Measure
from stepwell.figures.common import FAINT, LOADING, MM, UNLOADING, legends, literal, pale

if TYPE_CHECKING:
    from stepwell.lab import Recording

# One a recording; the pale colours tell loading from unloading.
_DASHES: tuple[LineStyleType, ...] = ("-", (0, (4, 1.5)), (0, (1, 1.2)), (0, (6, 1.5, 1, 1.5)))
_WIDTH, _PALE = 1.0, 0.5


def draw_recorded(ax: Axes, recordings: Sequence[Recording], measure: Measure) -> list[Artist]:
    """Measured force over stroke, each half in the pale colour of its direction.

    Args:
        ax: axes whose data are mm and N.
        recordings: as many as lines can be told apart, 4.
        measure: of the chain.

    Returns:
        What a legend should list: the name of each.

    Raises:
        ValueError: too many, or a chain whose travel is no length.
    """
    if recordings and measure is not Measure.TRAVEL:
        raise InputError(
            f"measured: recordings are forces over strokes [N, mm], and this chain has "
            f"{measure.force} over {measure.stroke}."
        )
    if len(recordings) > len(_DASHES):
        raise InputError(
            f"measured has {len(recordings)} recordings: at most {len(_DASHES)} can be told apart."
        )
    found: list[Artist] = []
    for one, dashes in zip(recordings, _DASHES, strict=False):
        for half in one.halves:
            loads = one.direction_of(half) == "loading"
            colour = pale(LOADING if loads else UNLOADING, _PALE)
            look = {"color": colour, "linewidth": _WIDTH, "linestyle": dashes, "zorder": 2}
            ax.plot(one.stroke[half] * MM, one.force[half], **look, gid="measured")
        name = f"measured: {literal(one.name)}"
        found.append(legends.line(name, pale(FAINT, 0.1), _WIDTH, linestyle=dashes))
    return found
