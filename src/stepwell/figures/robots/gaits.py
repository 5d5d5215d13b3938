"""Gaits of robots: the prediction by statics, and a parameter sweep."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from textwrap import wrap
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from stepwell.base import Floats, InputError, Quantity
from stepwell.figures.common import legends, marks, sheet, style
from stepwell.figures.common.words import literal, minus
from stepwell.figures.robots.walks import gait_words, leg_colours
from stepwell.robot import Prediction

if TYPE_CHECKING:
    from stepwell.simulation import Sweep


_ROW, _FOOT, _HEAD, _TOP = 6.0, 11.0, 6.0, 7.0
# Where names stand over the bars.
_HIGH_ROW, _HIGH_HEAD, _OVER, _NARROW = 9.0, 9.0, 0.33, 130.0
_BOLD = 2.0  # width of a letter of the title [mm]
_SHOWN = 2.5  # largest depth of the feet on the axis [mm]


@style.styled
def prediction(prediction: Prediction) -> Figure:
    """Margin of each leg to another gait, largest drag, and anchor displacements that reprogram it.

    Each leg has its margin [mN] with the uncertainty of the prediction, and the range of foot
    depths [mm] with the same gait. Each push has its largest drag [N] with the drag of the floor.
    Each antenna that reprograms a leg has its anchor displacement [mm] with an uncertainty range.
    Two columns wide.
    """
    legs = len(prediction.legs)
    pushes = sum(len(leg.pushes) for leg in prediction.legs)
    panels = (_margins, legs), (_depths, legs), (_drags, pushes), (_flips, len(prediction.flips))
    page, narrow = sheet.page_width(style.PAGE), _is_narrow()
    title = [literal(line) for line in wrap(prediction.robot.title, int(page / _BOLD))]
    # Names and remarks are at the sides of the bars, or above them on a narrow page.
    sizes = (_HIGH_ROW, _HIGH_HEAD, 8.0, ",\n") if narrow else (_ROW, _HEAD, 44.0, ", ")
    row, head, remark_width, apart = sizes
    top = _TOP + 4.0 * len(title) + 8.0 * narrow
    tall = [row * (rows + 0.8 * narrow) for _, rows in panels if rows]
    height = top + sum(tall) + len(tall) * (head + _FOOT)
    figure = sheet.blank(page, height)
    # Nothing is ever minus zero.
    advance, turn = (round(v, 2) + 0.0 for v in (prediction.advance, math.degrees(prediction.turn)))
    result = minus(
        f"predicted: {prediction.motion.value}{apart}$d/u_\\mathrm{{max}}$ = {advance:.2f}, "
        f"turn {turn:.1f}° per cycle"
    )
    look: dict[str, Any] = {"va": "top", "fontsize": 8, "weight": "bold"}
    left = 2.0 + sheet.current().indent
    sheet.text_at(figure, left, height - 1.5, "\n".join([*title, result]), **look)
    look = {"color": style.VERMILLION, "ha": "right", "va": "top"}
    lower = height - 1.5 - 8.0 * narrow
    doubt = sheet.text_at(figure, page - 2.0, lower, "this colour: uncertain", **look)
    corner = 4.0 if narrow else 2.0, _FOOT
    axes = sheet.stack(figure, corner, page - remark_width, tall, head + _FOOT)
    for ax, draw in zip(axes, [draw for draw, rows in panels if rows], strict=True):
        draw(ax, prediction)
    shown = [text for ax in figure.axes for text in ax.texts]
    doubt.set_visible(any(text.get_color() == style.VERMILLION for text in shown))
    if not narrow:
        _in_line(figure, page)
    return figure


def _in_line(figure: Figure, page: float) -> None:
    """Give the names of all panels one width, so that their axes are aligned."""
    boxes = [ax.yaxis.get_tightbbox() for ax in figure.axes]
    names = max(box.width for box in boxes if box is not None) / figure.dpi * 25.4
    left = (2.0 + names) / page
    for ax in figure.axes:
        at = ax.get_position()
        ax.set_position((left, at.y0, at.x1 - left, at.height))


def _margins(ax: Axes, prediction: Prediction) -> None:
    legs = prediction.legs
    most = _limit([value * style.MN for leg in legs for value in (leg.margin, leg.uncertainty)])
    grey = {"color": style.pale(style.FAINT, 0.6), "height": 0.4 if _is_narrow() else 0.8}
    colours = leg_colours(prediction.robot)
    for i, leg in enumerate(legs):
        colour, gid = colours[leg.name], f"uncertainty {leg.name}"
        ax.barh(i, leg.uncertainty * style.MN, **grey, zorder=1, gid=gid)
        reach = leg.margin * style.MN if math.isfinite(leg.margin) else most
        ax.plot([0.0, reach], [i, i], color=colour, linewidth=1.6, zorder=2)
        if math.isfinite(leg.margin):
            look = {"color": colour, "markersize": 5.0, "gid": f"margin {leg.name}"}
            ax.plot(reach, i, "o", **look, zorder=3)
        other = leg.nearest or "none within 2 N"
        doubt = f"\nor {', '.join(leg.alternatives)}" if leg.alternatives else ""
        _remark(ax, i, f"to {other}{doubt}", doubtful=leg.near_boundary)
    title = "Margin to another gait; shaded: uncertainty of the prediction"
    names = [f"{leg.name}: {gait_words(leg.gait)}" for leg in legs]
    _rows(ax, names, most, title, "Force on one cell [mN]")


def _depths(ax: Axes, prediction: Prediction) -> None:
    below, ends = prediction.robot.foot.below * style.MM, np.array(prediction.depths) * style.MM
    # A gait without an upper limit of depth is drawn to the end of the axis.
    most = max(min(max(2 * below, _limit(ends[:, 1].tolist())), _SHOWN), 1.2 * below) or 1.0
    colours = leg_colours(prediction.robot)
    for i, leg in enumerate(prediction.legs):
        low, high = ends[i]
        look = {"color": colours[leg.name], "zorder": 2, "gid": f"depths {leg.name}"}
        ax.barh(i, min(high, most) - low, left=low, height=0.5, **look)
        _remark(ax, i, f"{low:.2f} to {high:.2f} mm", doubtful=leg.near_boundary)
    ax.axvline(below, color=style.INK, linewidth=1.0, zorder=3, gid="below")
    title = "Foot depths with the same gait, uncertainty included; line: this robot"
    names = [f"{leg.name}: {leg.gait}" for leg in prediction.legs]
    _rows(ax, names, most, title, "Foot depth below the supports [mm]")


def _drags(ax: Axes, prediction: Prediction) -> None:
    drag = prediction.robot.floor.drag
    colours = leg_colours(prediction.robot)
    pushes = [(leg.name, push) for leg in prediction.legs for push in leg.pushes]
    most = _limit([drag, *(push.largest_drag for _, push in pushes)])
    for i, (name, push) in enumerate(pushes):
        reach = min(push.largest_drag, most)
        ax.barh(i, reach, height=0.5, color=colours[name], zorder=2, gid=f"drag {name}")
        _remark(ax, i, push.limit.value.split(":")[0], doubtful=push.safety < 1)
    ax.axvline(drag, color=style.INK, linewidth=1.0, zorder=3, gid="floor")
    names = [
        f"{name}, {'loading' if push.loading else 'unloading'}: {push.step * style.MM:.1f} mm step"
        for name, push in pushes
    ]
    title = "Largest drag overcome by each push; line: drag of this floor"
    _rows(ax, [*map(minus, names)], most, title, "Floor drag [N]")


def _flips(ax: Axes, prediction: Prediction) -> None:
    colours = leg_colours(prediction.robot)
    swings = {one.name: math.hypot(*one.moves) * style.MM for one in prediction.robot.antennas}
    full = [swings[flip.antenna] for flip in prediction.flips]
    most = _limit(full)
    for i, (flip, end) in enumerate(zip(prediction.flips, full, strict=True)):
        late = min(flip.latest * style.MM, most)
        ends, colour = [flip.earliest * style.MM, late], colours[flip.leg]
        look = {"linewidth": 4.0, "solid_capstyle": "butt", "zorder": 2}
        ax.plot(ends, [i, i], color=style.pale(colour, 0.4), **look, gid=f"range {flip.antenna}")
        look = {"color": colour, "markersize": 5.0, "zorder": 3}
        ax.plot(flip.displacement * style.MM, i, "o", **look, gid=f"flip {flip.antenna}")
        ax.plot([end, end], [i - 0.4, i + 0.4], color=style.INK, linewidth=1.0, zorder=3)
        _remark(ax, i, f"to {flip.gait}", doubtful=not math.isfinite(flip.latest))
    title = "Anchor displacement that reprograms a leg, with its range; bar: full swing"
    names = [f"{flip.antenna} antenna, {flip.leg} leg" for flip in prediction.flips]
    _rows(ax, names, most, title, "Displacement of the anchor $p$ [mm]")


def _is_narrow() -> bool:
    """Whether the page is too narrow for names and remarks at the sides of the bars."""
    return sheet.page_width(style.PAGE) < _NARROW


def _limit(values: Sequence[float]) -> float:
    """The right end of an axis that shows all finite values."""
    finite = np.array([value for value in values if math.isfinite(value)])
    return 1.12 * float(finite.max(initial=0.0)) or 1.0


def _remark(ax: Axes, row: int, text: str, *, doubtful: bool) -> None:
    look: dict[str, Any] = {"color": style.VERMILLION if doubtful else style.INK, "zorder": 5}
    look |= {"xycoords": ("axes fraction", "data"), "textcoords": "offset points"}
    if _is_narrow():
        look |= {"va": "bottom", "ha": "right", "bbox": style.on_white()}
        ax.annotate(text.replace("\n", " "), (1.0, row - _OVER), (0.0, 0.0), **look)
    else:
        look |= {"va": "center", "ha": "left", "linespacing": 0.95}
        ax.annotate(text, (1.0, row), (2.0 / 25.4 * 72.0, 0.0), **look)


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


MOST_KEYS = 8
_STOPPED = "did not walk to the end"
_LEFT, _RIGHT, _BOTTOM, _SWEEP_TOP = 16.0, 4.0, 12.0, 4.0
# A unit at the end of a key; tables of a path with names, and tables that need no name.
_UNIT = re.compile(
    r"_((?:mm|mN|mNm|mL|ms|kPa|deg|percent|g|N|s|m)(?:_(?:per|s|m|s2|m2|mm|mL|rad|deg|kPa))*)$"
)
_NAMED, _UNNAMED = {"leg", "cell", "antenna"}, {"chain", "band"}
_SYMBOLS = {"p", "q"}
# Keys that are unclear on their own.
_WORDS = {"below": "depth", "limit": "angle limit", "link": "length of a link"}
_LINE = 4.2  # a line of the key [mm]
_OUTLINED: dict[str, Any] = {"markeredgecolor": style.INK, "markeredgewidth": 0.4}


@style.styled
def sweep(result: Sweep) -> Figure:
    """Advance and turn of every robot of a sweep, coloured by the gaits of its legs.

    One key: advance and turn over it. Two keys: every robot at its values, with advance and turn as
    numbers if there is room. More keys: advance over each. Two columns wide.

    Args:
        result: a sweep over one key or more; at most the first eight keys are shown.

    Raises:
        ValueError: no robots, or no varied key.
    """
    keys = list(result.values)[:MOST_KEYS]
    if not result.trials or not keys:
        raise InputError("the sweep is empty: give at least one robot and one key.")
    shown = _read(result, keys)
    foot = _LINE * len(shown.colours) + 4.0
    figure = {1: _over_one, 2: _over_two}.get(len(keys), _over_many)(shown, foot)
    handles = [
        legends.mark(literal(gait), color=one, **_OUTLINED) for gait, one in shown.colours.items()
    ]
    legends.below(figure, handles, 1, _LEFT, labelspacing=0.35)
    return figure


class _Shown(NamedTuple):
    """Robots by number: varied values, advance and turn (n,), and the gaits with their colours."""

    values: dict[str, Floats]
    advance: Floats
    turn: Floats
    gaits: NDArray[np.str_]
    colours: dict[str, style.Colour]


def _over_one(shown: _Shown, foot: float) -> Figure:
    tall, page = 42.0, sheet.page_width(style.PAGE)
    ((key, values),) = shown.values.items()
    figure = sheet.blank(page, foot + _BOTTOM + 2 * tall + 5.0 + _SWEEP_TOP)
    foot, wide = foot + _BOTTOM, page - _LEFT - _RIGHT
    lower, upper = (sheet.place(figure, _LEFT, foot + y, wide, tall) for y in (0.0, tall + 5.0))
    _points(upper, values, shown.advance, shown, 0.5)
    _points(lower, values, shown.turn, shown, 2.0)
    upper.set(xlim=lower.get_xlim(), ylabel=r"Advance $d/u_\mathrm{max}$")
    upper.tick_params(labelbottom=False)
    lower.set(xlabel=axis_words(key), ylabel="Turn to the left [°]")
    return figure


# Width and height of the numbers at a disc [mm].
_NUMBERS = 9.0, 6.2


def _over_two(shown: _Shown, foot: float) -> Figure:
    tall, page = 92.0, sheet.page_width(style.PAGE)
    figure = sheet.blank(page, foot + _BOTTOM + tall + _SWEEP_TOP)
    wide = page - _LEFT - _RIGHT
    ax = sheet.place(figure, _LEFT, foot + _BOTTOM, wide, tall)
    x, y = shown.values.values()
    columns, rows = (max(2, len(np.unique(one))) for one in (x, y))
    # Discs that nearly touch on a grid; random draws are sized like a grid of the same number.
    if columns * rows > 4 * len(x):
        columns = rows = max(2, int(np.sqrt(len(x))) * 2)
    size = float(np.clip(min(wide / (columns + 1), tall / (rows + 1)) * 0.55, 1.0, 7.0))
    # Two lines of numbers at each disc, if there is room.
    roomy = wide / (columns + 1) > size + _NUMBERS[0] and tall / (rows + 1) > _NUMBERS[1]
    points = size * 72 / 25.4
    _discs(ax, x, y, shown, points)
    if roomy:
        look = {"textcoords": "offset points", "va": "center", "linespacing": 1.0}
        for at, d, w in zip(zip(x, y, strict=True), shown.advance, shown.turn, strict=True):
            if np.isfinite(d):
                # Nothing is ever minus zero.
                d, w = 0.0 if abs(d) < 0.005 else d, 0.0 if abs(w) < 0.05 else w
                ax.annotate(minus(f"{d:.2f}\n{w:.1f}°"), at, (points / 2 + 2, 0), **look)
        title = r"numbers: advance $d/u_\mathrm{max}$ and turn to the left per cycle"
        ax.set_title(title, fontsize=7.0, loc="right", pad=2.0)
    ax.margins(x=0.5 / columns, y=0.5 / rows)
    if roomy:
        # The numbers at the last disc stay inside the axes.
        low = ax.get_xlim()[0]
        share = max(0.5 / (columns + 1), (size / 2 + _NUMBERS[0] + 1.0) / wide)
        ax.set_xlim(low, low + (float(np.max(x)) - low) / (1.0 - share))
    xlabel, ylabel = map(axis_words, shown.values)
    ax.set(xlabel=xlabel, ylabel=ylabel)
    return figure


def _over_many(shown: _Shown, foot: float) -> Figure:
    tall, page = 40.0, sheet.page_width(style.PAGE)
    columns = 2 if page >= sheet.SIDE_BY_SIDE else 1
    step = tall + _BOTTOM + 3.0
    figure = sheet.blank(page, foot + -(-len(shown.values) // columns) * step + _SWEEP_TOP)
    pitch = (page - _RIGHT) / columns, step
    corners = sheet.grid(len(shown.values), columns, pitch, (_LEFT, foot + _BOTTOM))
    for (key, values), corner in zip(shown.values.items(), corners, strict=True):
        ax = sheet.place(figure, *corner, pitch[0] - _LEFT, tall)
        _points(ax, values, shown.advance, shown, 0.5)
        ax.set_xlabel(axis_words(key), fontsize=7.0)
        ax.set_ylabel(r"Advance $d/u_\mathrm{max}$")
    return figure


def axis_words(key: str) -> str:
    """Axis label of a key of a design file, such as "$q_x$ of outer, left leg [mm]" for
    "leg.left.chain.cell.outer.q_mm[0]".
    """
    *path, last = key.split(".")
    name, *numbers = last.replace("]", "").split("[")
    unit = _UNIT.search(name)
    words = _quantity(name[: unit.start()] if unit else name, [int(n) for n in numbers])
    owners = _owners(path)
    text = words if "$" in words else literal(words.replace("_", " "))
    text += (" of " if owners else "") + ", ".join(reversed(owners))
    sign = Quantity("", unit[1].replace("_per_", "/").replace("_", " ")).sign if unit else ""
    label = text if text.startswith("$") else text[0].upper() + text[1:]
    return label + (f" [{sign.replace('s2', 's²')}]" if sign else "")


def _quantity(word: str, numbers: Sequence[int]) -> str:
    """Text of a quantity; the last number is a component, a number before it is an index."""
    if not numbers:
        return f"${word}$" if word in _SYMBOLS else _WORDS.get(word, word)
    *count, axis = numbers
    if word in _SYMBOLS:
        return f"${word}_{'xyz'[axis]}$"
    return " ".join([word, *(str(n + 1) for n in count), f"${'xyz'[axis]}$"])


def _owners(path: Sequence[str]) -> list[str]:
    """The tables of a design file that a key is in, as text, the outermost first."""
    owners: list[str] = []
    tables = iter(path)
    for table in tables:
        one = next(tables, "") if table in _NAMED else ""
        kind = "" if table == "cell" and one != "*" else table
        if table not in _UNNAMED:
            owners.append(literal(f"{one.replace('*', 'every')} {kind}".strip()))
    return owners


def _points(ax: Axes, x: Floats, y: Floats, shown: _Shown, least: float) -> None:
    marks.zero_line(ax)
    _discs(ax, x, y, shown, 4.5 if len(x) <= 100 else 2.5)
    low, high = float(x.min()), float(x.max())
    gap = 0.03 * (high - low or 1.0)
    ax.set_xlim(low - gap, high + gap)
    # Zero is visible, and rounding errors do not fill the axes.
    low, high = ax.get_ylim()
    ax.set_ylim(min(low, -least), max(high, least))


def _discs(ax: Axes, x: Floats, y: Floats, shown: _Shown, size: float) -> None:
    # Light colours have an outline on white.
    look = {"markersize": size, **_OUTLINED, "zorder": 3, "gid": "robots"}
    for gait, colour in shown.colours.items():
        some = shown.gaits == gait
        ax.plot(x[some], y[some], "o", color=colour, **look)


def _read(sweep: Sweep, keys: list[str]) -> _Shown:
    """Values to plot of a sweep over these keys; the gaits of a robot's legs are joined to one
    text, or are one gait if all legs agree.
    """
    gaits: list[str] = []
    for trial in sweep.trials:
        alike = dict.fromkeys(gait or "none" for gait in trial.gaits)
        words = ", ".join(alike if len(alike) == 1 else trial.gaits)
        gaits.append(_STOPPED if trial.stopped else words)
    often = sorted(set(gaits), key=lambda gait: (-gaits.count(gait), gait))
    colours = style.word_colours(often, style.PATHWAY | {_STOPPED: style.FAINT})
    return _Shown(
        {key: np.asarray(sweep.values[key], float) for key in keys},
        np.array([trial.advance for trial in sweep.trials]),
        np.degrees([trial.turn for trial in sweep.trials]),
        np.array([gait if gait in colours else style.REST for gait in gaits]),
        colours,
    )
