"""Style of all figures: sizes in millimetres, and colours with one meaning everywhere."""

from collections.abc import Callable, Mapping, Sequence
from functools import wraps
from typing import Any, ParamSpec, TypeVar

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.typing import ColorType, LineStyleType

from stepwell.base import UNITS
from stepwell.figures.common.words import families
from stepwell.sequences import Pathway

# Millimetres in a metre, millijoules in a joule, millinewtons in a newton.
MM, MJ, MN = (UNITS[unit].per_si for unit in ("mm", "mJ", "mN"))
# Widths of one and of two columns of a journal page [mm].
COLUMN = 85.0
PAGE = 180.0
# Height of a page for figures [mm].
PAGE_HEIGHT = 247.0

# Colours that are distinct for every kind of colour vision (Okabe & Ito 2008).
BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
YELLOW, BLUE, VERMILLION, PURPLE = "#F0E442", "#0072B2", "#D55E00", "#CC79A7"

LOADING, UNLOADING = BLUE, VERMILLION
INK, FAINT, BLOCK, FIXED_BLOCK = "#222222", "#8A8A8A", "#DCDCDC", "#A8A8A8"
# Bought boxes of a robot: actuator, battery, board.
BOUGHT = "#4D4D4D"
# Shade of the phases of an element.
PHASE = "#E9E9E9"

# A cell keeps its colour in a chain of any length, inner first. Blue and vermillion are reserved
# for loading and unloading. Colours 7 to 18 are darker, then lighter variants, found by a search
# for the largest differences under normal and colour-deficient vision.
_CELLS = (
    *(GREEN, PURPLE, ORANGE, SKY, "#7A6A00", BLACK),
    *("#00704F", "#6F0A4F", "#855829", "#254782", "#403700", "#5C6975"),
    *("#6ECC83", "#DEBBD2", "#F2BE52", "#B5CBFD", "#B9904B", "#AFB0A0"),
)
# The dashes change every six cells, for readers with colour-deficient vision.
_CELL_DASHES: tuple[LineStyleType, ...] = ("-", (0, (4, 1.5)), (0, (6, 1.5, 1, 1.5)), (0, (1, 1.2)))
_HUES = 6

# By the sequence of a pathway, because a map read from a file has only sequences.
PATHWAY = {
    Pathway.CLOCKWISE.value: ORANGE,
    Pathway.COUNTERCLOCKWISE.value: SKY,
    Pathway.VIA_01.value: YELLOW,
    Pathway.VIA_10.value: "#8F8F8F",
}

STYLE: dict[Any, Any] = {
    "axes.edgecolor": INK,
    "axes.grid": False,
    "axes.labelcolor": INK,
    "axes.labelpad": 3.0,
    "axes.labelsize": 8.0,
    "axes.linewidth": 0.7,
    "axes.titlesize": 8.0,
    "axes.unicode_minus": True,
    "figure.dpi": 150.0,
    "figure.facecolor": "white",
    # By name instead of a generic family, because the user's settings may redefine the latter.
    "font.family": list(families()),
    "font.size": 7.0,
    "legend.fontsize": 7.0,
    "legend.frameon": False,
    "legend.handlelength": 1.8,
    "legend.borderaxespad": 0.0,
    "legend.borderpad": 0.0,
    "legend.columnspacing": 1.4,
    "lines.linewidth": 1.4,
    "lines.solid_capstyle": "round",
    "mathtext.fontset": "dejavusans",
    "savefig.dpi": 300.0,
    "text.color": INK,
    "text.usetex": False,
    "xtick.color": INK,
    "xtick.labelsize": 7.0,
    "xtick.major.width": 0.7,
    "ytick.color": INK,
    "ytick.labelsize": 7.0,
    "ytick.major.width": 0.7,
}

Colour = str | tuple[float, float, float]
P = ParamSpec("P")
R = TypeVar("R")


def styled(draw: Callable[P, R]) -> Callable[P, R]:
    """Run a drawing function in this style without changing matplotlib's global settings."""

    @wraps(draw)
    def inside(*args: P.args, **kwargs: P.kwargs) -> R:
        with mpl.rc_context(STYLE):
            return draw(*args, **kwargs)

    return inside


def name_rows(ax: Axes, names: Sequence[str], edge: float = 0.5) -> None:
    """Name rows 0, 1, ... from the top, with `edge` rows beyond the first and last."""
    ax.set_yticks(range(len(names)), names)
    ax.tick_params(axis="y", length=0)
    ax.set_ylim(len(names) - 1 + edge, -edge)


def pale(colour: str, amount: float = 0.62) -> tuple[float, float, float]:
    """The colour mixed with white: 0 leaves it, 1 is white."""
    return tuple(c + (1.0 - c) * amount for c in to_rgb(colour))  # pyright: ignore[reportReturnType]


# Label of all words without a colour of their own.
REST = "any other"
_WORDS = (BLUE, GREEN, VERMILLION, PURPLE, "#7A6A00", INK)


def word_colours(often: Sequence[str], known: Mapping[str, str]) -> dict[str, Colour]:
    """A colour for each of the most frequent words; the others share one colour and one name."""
    spare = iter(_WORDS)
    colours = {word: known[word] if word in known else next(spare, "") for word in often}
    own: dict[str, Colour] = {word: colour for word, colour in colours.items() if colour}
    return own | ({REST: pale(FAINT, 0.5)} if len(own) < len(often) else {})


def cell_colours(count: int) -> list[str]:
    """One colour per cell, inner first; colours repeat after 18 cells."""
    return [_CELLS[i % len(_CELLS)] for i in range(count)]


def cell_dashes(count: int) -> list[LineStyleType]:
    """One line style per cell, inner first; with its colour it is unique among 20 cells."""
    return [_CELL_DASHES[i // _HUES % len(_CELL_DASHES)] for i in range(count)]


def hollow(size: float, colour: ColorType = INK, **look: Any) -> dict[str, Any]:
    """The look of a mark with a white face."""
    return {"markersize": size, "markerfacecolor": "white", "markeredgecolor": colour} | look


def on_white(pad: float = 0.1, alpha: float | None = None) -> dict[str, Any]:
    """A white background for text on lines."""
    box = {"boxstyle": f"square,pad={pad}", "facecolor": "white", "linewidth": 0}
    return box if alpha is None else box | {"alpha": alpha}


def on_black(*, wide: bool = False) -> dict[str, Any]:
    """The look of a number in a black disc, or of several in a black box."""
    shape = "round,pad=0.2" if wide else "circle,pad=0.15"
    box = {"boxstyle": shape, "facecolor": BLACK, "linewidth": 0}
    return {"color": "white", "fontweight": "bold", "bbox": box}


def direction_colour(direction: float) -> str:
    """Blue while the drive rises, vermillion while it falls."""
    return LOADING if direction >= 0 else UNLOADING
