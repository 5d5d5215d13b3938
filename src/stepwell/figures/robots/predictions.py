"""What statics says about a robot's gait, and how sure it is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from textwrap import wrap
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepwell.figures.common import sheet, style
from stepwell.figures.common.words import literal, minus
from stepwell.figures.robots.walk_reading import gait_words, leg_colours

if TYPE_CHECKING:
    from stepwell.robot import Prediction

_MN = 1e3  # millinewtons in a newton
_ROW, _FOOT, _HEAD, _TOP = 6.0, 11.0, 6.0, 7.0
# Where names stand over the bars.
_HIGH_ROW, _HIGH_HEAD, _OVER, _NARROW = 9.0, 9.0, 0.33, 130.0
_BOLD = 2.0  # width of a letter of the title [mm]
_SHOWN = 2.5  # depth of the feet that the axis goes to [mm]


@style.styled
def prediction(prediction: Prediction) -> Figure:
    """How far each leg is from another gait, what drag its foot overcomes, what flips it.

    Args:
        prediction: of any robot.

    Returns:
        A figure of two columns' width: for each leg the margin [mN] beside what the prediction
        does not know, and the depths of the feet [mm] at which its gait stays; for each push
        the largest drag [N] beside the floor's; for each antenna that flips a leg the
        displacement of its anchor [mm], with the range it may lie in.
    """
    pushes = [(leg, push) for leg in prediction.legs for push in leg.pushes]
    panels = [(_margins, len(prediction.legs)), (_depths, len(prediction.legs))]
    panels += [(_drags, len(pushes))] if pushes else []
    panels += [(_flips, len(prediction.flips))] if prediction.flips else []
    page, narrow = sheet.page_width(style.PAGE), _is_narrow()
    title = [literal(line) for line in wrap(prediction.robot.title, int(page / _BOLD))]
    # Names and remarks stand beside bars, or over them where that is too narrow.
    row, head, beside = (_HIGH_ROW, _HIGH_HEAD, 8.0) if narrow else (_ROW, _HEAD, 44.0)
    top = _TOP + 4.0 * len(title) + 8.0 * narrow
    rows_of = [rows + 0.8 * narrow for _, rows in panels]
    height = top + sum(head + row * rows + _FOOT for rows in rows_of)
    figure = sheet.blank(page, height)
    # Nothing is ever minus zero.
    advance, turn = (round(v, 2) + 0.0 for v in (prediction.advance, math.degrees(prediction.turn)))
    says = (
        f"predicted: {prediction.motion.value}, $d/u_\\mathrm{{max}}$ = {advance:.2f}, "
        f"turn {turn:.1f}° per cycle"
    )
    says = says.replace(", $d", ",\n$d") if narrow else says
    words = "\n".join([*title, minus(says)])
    sheet.text_at(
        figure, 2.0 + sheet.indent(), height - 1.5, words, va="top", fontsize=8, weight="bold"
    )
    doubtful = {"color": style.VERMILLION, "ha": "right", "va": "top"}
    doubt = sheet.text_at(
        figure, page - 2.0, height - 1.5 - 8.0 * narrow, "in this colour: in doubt", **doubtful
    )
    bottom = height - top
    for (draw, _), rows in zip(panels, rows_of, strict=True):
        bottom -= head + row * rows
        ax = sheet.place(figure, 4.0 if narrow else 2.0, bottom, page - beside, row * rows)
        draw(ax, prediction)
        bottom -= _FOOT
    shown = [text for ax in figure.axes for text in ax.texts]
    doubt.set_visible(any(text.get_color() == style.VERMILLION for text in shown))
    if narrow:
        return figure
    # One width of names for all, so that the panels stand in line.
    dpi = figure.dpi / 25.4
    boxes = [ax.yaxis.get_tightbbox() for ax in figure.axes]
    names = max(box.width / dpi for box in boxes if box is not None)
    for ax in figure.axes:
        at = ax.get_position()
        left = (2.0 + names) / page
        ax.set_position((left, at.y0, at.x1 - left, at.height))
    return figure


def _margins(ax: Axes, found: Prediction) -> None:
    legs = found.legs
    ends = [value * _MN for leg in legs for value in (leg.margin, leg.uncertainty)]
    most = _limit(ends)
    colours = leg_colours(found.robot)
    for i, leg in enumerate(legs):
        colour = colours[leg.name]
        look = {"color": style.pale(style.FAINT, 0.6), "gid": f"uncertainty {leg.name}"}
        tall = 0.4 if _is_narrow() else 0.8
        ax.barh(i, leg.uncertainty * _MN, height=tall, zorder=1, **look)
        reach = leg.margin * _MN if math.isfinite(leg.margin) else most
        ax.plot([0.0, reach], [i, i], color=colour, linewidth=1.6, zorder=2)
        if math.isfinite(leg.margin):
            (dot,) = ax.plot(reach, i, "o", color=colour, markersize=5.0, zorder=3)
            dot.set_gid(f"margin {leg.name}")
        other = leg.nearest or "none within 2 N"
        doubt = f"\nor {', '.join(leg.alternatives)}" if leg.alternatives else ""
        _remark(ax, i, f"to {other}{doubt}", doubtful=leg.near_boundary)
    title = "Margin to another gait; shaded: what the prediction does not know"
    names = [f"{leg.name}: {gait_words(leg.gait)}" for leg in legs]
    _rows(ax, names, most, title, "Force on one cell [mN]")


def _depths(ax: Axes, found: Prediction) -> None:
    below, ends = found.robot.foot.below * style.MM, np.array(found.depths) * style.MM
    # A gait that stays until the feet cannot be lifted any more is shown as far as the others.
    most = max(min(max(2 * below, _limit(ends[:, 1].tolist())), _SHOWN), 1.2 * below) or 1.0
    colours = leg_colours(found.robot)
    for i, leg in enumerate(found.legs):
        low, high = ends[i]
        look = {"color": colours[leg.name], "zorder": 2, "gid": f"depths {leg.name}"}
        ax.barh(i, min(high, most) - low, left=low, height=0.5, **look)
        _remark(ax, i, f"{low:.2f} to {high:.2f} mm", doubtful=leg.near_boundary)
    ax.axvline(below, color=style.INK, linewidth=1.0, zorder=3, gid="below")
    title = "Depths of the feet at which the gait surely stays; line: this robot's"
    names = [f"{leg.name}: {leg.gait}" for leg in found.legs]
    _rows(ax, names, most, title, "Feet below the supports [mm]")


def _drags(ax: Axes, found: Prediction) -> None:
    drag = found.robot.floor.drag
    colours = leg_colours(found.robot)
    pushes = [(leg.name, push) for leg in found.legs for push in leg.pushes]
    most = _limit([drag, *(push.largest_drag for _, push in pushes)])
    for i, (name, push) in enumerate(pushes):
        reach = min(push.largest_drag, most)
        ax.barh(i, reach, height=0.5, color=colours[name], zorder=2, gid=f"drag {name}")
        _remark(ax, i, push.limit.value.split(":")[0], doubtful=push.safety < 1)
    ax.axvline(drag, color=style.INK, linewidth=1.0, zorder=3, gid="floor")
    names = [
        f"{name}, {'out' if push.loading else 'back'}: {push.step * style.MM:.1f} mm step"
        for name, push in pushes
    ]
    title = "Largest drag that each push overcomes; line: the floor's drag"
    _rows(ax, [*map(minus, names)], most, title, "Drag of the floor [N]")


def _flips(ax: Axes, found: Prediction) -> None:
    colours = leg_colours(found.robot)
    swings = {one.name: math.hypot(*one.moves) * style.MM for one in found.robot.antennas}
    full = [swings[flip.antenna] for flip in found.flips]
    most = _limit(full)
    for i, (flip, end) in enumerate(zip(found.flips, full, strict=True)):
        late = min(flip.latest * style.MM, most)
        ends, colour = [flip.earliest * style.MM, late], colours[flip.leg]
        look = {"linewidth": 4.0, "solid_capstyle": "butt", "zorder": 2}
        ax.plot(ends, [i, i], color=style.pale(colour, 0.4), **look, gid=f"range {flip.antenna}")
        look = {"color": colour, "markersize": 5.0, "zorder": 3}
        ax.plot(flip.displacement * style.MM, i, "o", **look, gid=f"flip {flip.antenna}")
        ax.plot([end, end], [i - 0.4, i + 0.4], color=style.INK, linewidth=1.0, zorder=3)
        _remark(ax, i, f"to {flip.gait}", doubtful=not math.isfinite(flip.latest))
    title = "Displacement that flips a leg, with its range; bar: full swing"
    names = [f"{flip.antenna} antenna, {flip.leg} leg" for flip in found.flips]
    _rows(ax, names, most, title, "Displacement of the anchor $p$ [mm]")


def _is_narrow() -> bool:
    """Whether names and remarks have no room beside the bars."""
    return sheet.page_width(style.PAGE) < _NARROW


def _limit(values: Sequence[float]) -> float:
    """The right end of an axis that shows all finite values."""
    finite = np.array([value for value in values if math.isfinite(value)])
    return 1.12 * float(finite.max(initial=0.0)) or 1.0


def _remark(ax: Axes, row: int, text: str, *, doubtful: bool) -> None:
    narrow = _is_narrow()
    ax.annotate(
        text.replace("\n", " ") if narrow else text,
        (1.0, row - _OVER * narrow),
        (0.0 if narrow else 2.0 / 25.4 * 72.0, 0.0),
        xycoords=("axes fraction", "data"),
        textcoords="offset points",
        va="bottom" if narrow else "center",
        ha="right" if narrow else "left",
        linespacing=0.95,
        color=style.VERMILLION if doubtful else style.INK,
        bbox=style.on_white() if narrow else None,
        zorder=5,
    )


def _rows(ax: Axes, names: Sequence[str], most: float, title: str, xlabel: str) -> None:
    narrow = _is_narrow()
    style.name_rows(ax, [*map(literal, names)], 0.9 if narrow else 0.5)
    if narrow:
        ax.set_yticks([])
        look = {"transform": ax.get_yaxis_transform(), "va": "bottom"}
        for row, name in enumerate(names):
            ax.text(0.0, row - _OVER, literal(name), **look)
        title = title.replace("; ", ";\n")
    ax.set(xlim=(0.0, most), xlabel=xlabel)
    ax.set_title(title, loc="left")
    ax.spines[["top", "right"]].set_visible(False)
