"""Which number decides what: a row for every number, a column for everything that was found."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from stepwell.base import InputError
from stepwell.figures.common import sheet, style
from stepwell.figures.common.words import literal, minus, shortened

if TYPE_CHECKING:
    from stepwell.studies import Decided

_ROW, _HEAD, _FOOT, _RIGHT = 5.2, 10.0, 8.0, 3.0
_LETTER, _MOST = 1.55, 46  # width of a letter of a name, letters that there is room for
_WIDEST = 26.0  # of a column
_SHARES, _SIGNS = "Share of the variance by itself;", "+ or -: more of it gives mostly more or less"
_SENTENCE = 100.0
# From this on white words are read more easily than dark ones.
_DARK = 0.9


@style.styled
def influences(found: Sequence[Decided], names: Mapping[str, str] | None = None) -> Figure:
    """How much of each thing that was found each number decides by itself.

    Args:
        found: what `studies.decided` returns.
        names: what rows and columns are called; as they are in the study by default.

    Returns:
        A figure of two columns' width: shares of the variance as shades and numbers, with a sign
        where more of the number gives mostly more or mostly less; nothing where chance alone could
        have made them. Rows are in the order of their largest share.

    Raises:
        ValueError: nothing to show.
    """
    if not found:
        raise InputError("found is empty: a study of 50 designs or more says what decides.")
    known = names or {}
    shares = {one.column: {each.name: each for each in one.sure} for one in found}
    largest = {each.name: 0.0 for each in found[0].influences}
    for column in shares.values():
        for name, one in column.items():
            largest[name] = max(largest[name], one.share)
    rows = sorted(largest, key=lambda name: -largest[name])
    told = [shortened(known.get(name, name), _MOST) for name in rows]
    left = 3.0 + _LETTER * max(map(len, told))
    tall = _ROW * len(rows)
    page = sheet.page_width(style.PAGE)
    # Under narrow columns what shares and signs mean takes two lines.
    apart = "\n" if page - left < _SENTENCE else " "
    foot = _FOOT + 3.0 * (apart == "\n")
    figure = sheet.blank(page, _HEAD + tall + foot)
    wide = min(page - left - _RIGHT, _WIDEST * len(found))
    ax = sheet.place(figure, left, foot, wide, tall)
    ax.set_xlim(-0.5, len(found) - 0.5)
    style.name_rows(ax, [literal(name) for name in told])
    ax.tick_params(axis="x", length=0, labeltop=True, labelbottom=False, pad=1.0)
    names_of = (known.get(one.column, one.column.replace("_", " ")) for one in found)
    letters = max(6, min(16, int(wide / len(found) / _LETTER)))
    heads = [shortened(name, letters, 2) for name in names_of]
    ax.set_xticks(range(len(found)), [literal(head) for head in heads])
    for spine in ax.spines.values():
        spine.set_visible(False)
    for k, one in enumerate(found):
        for i, name in enumerate(rows):
            each = shares[one.column].get(name)
            look = {
                "facecolor": style.pale(style.FAINT, 0.9),
                "edgecolor": "white",
                "linewidth": 1.5,
            }
            if each is not None:
                look["facecolor"] = style.pale(style.BLUE, 1.0 - each.share)
                sign = "" if abs(each.trend) < 0.1 else " +" if each.trend > 0 else " -"
                colour = "white" if each.share > _DARK else style.INK
                percent = f"{100 * each.share:.0f} %" if each.share >= 0.005 else "< 1 %"
                ax.text(
                    k, i, minus(percent + sign),
                    ha="center", va="center_baseline", color=colour, gid="share",
                )  # fmt: skip
            ax.add_patch(Rectangle((k - 0.5, i - 0.5), 1.0, 1.0, **look, zorder=0))
    sheet.text_at(
        figure, left, 3.0,
        minus(f"{_SHARES}{apart}{_SIGNS}"),
    )  # fmt: skip
    return figure
