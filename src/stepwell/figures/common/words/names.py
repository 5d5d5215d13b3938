"""Names as figures draw them: letter by letter, in a font that has the letters."""

from __future__ import annotations

import logging
from functools import cache

from matplotlib.font_manager import FontProperties, findfont, fontManager
from matplotlib.ft2font import FT2Font

from stepwell.base import printable

_FONT = "DejaVu Sans"  # comes with matplotlib
# Fonts with the letters of East Asia: of Linux, Windows, macOS.
_MORE = (
    *(f"Noto Sans CJK {region}" for region in ("JP", "SC", "TC", "KR")),
    "Source Han Sans",
    "WenQuanYi Micro Hei",
    "WenQuanYi Zen Hei",
    "IPAexGothic",
    "IPAGothic",
    "Droid Sans Fallback",
    "Microsoft YaHei",
    "Yu Gothic",
    "Meiryo",
    "Malgun Gothic",
    "PingFang SC",
    "Hiragino Sans",
    "Hiragino Sans GB",
    "Apple SD Gothic Neo",
    "Arial Unicode MS",
)
_MISSING = "\N{WHITE SQUARE}"


def literal(text: str) -> str:
    """A name for matplotlib, which never takes it for mathematics nor leaves it out of a legend.

    Letters that no font has are drawn as squares, and that is said once.
    """
    lines = text.split("\n")
    shown = "\n".join("".join(map(_drawable, printable(line))) for line in lines)
    shown = shown.replace("$", r"\$")
    return f"\N{ZERO WIDTH SPACE}{shown}" if shown.startswith("_") else shown


@cache
def families() -> tuple[str, ...]:
    """The font of every figure, and after it those found here that have more letters."""
    found = {font.name for font in fontManager.ttflist}
    return (_FONT, *(name for name in _MORE if name in found))


def _drawable(letter: str) -> str:
    if letter.isascii() or any(ord(letter) in _letters(name) for name in families()):
        return letter
    _say_so(letter)
    return _MISSING


@cache
def _letters(family: str) -> frozenset[int]:
    return frozenset(FT2Font(findfont(FontProperties(family=[family]))).get_charmap())


_said: set[str] = set()


def _say_so(letter: str) -> None:
    # A log record, and no warning: it must not become an error, and one line is enough.
    if not _said:
        logging.getLogger("stepwell").warning(
            "Figures show %s for letters such as %s, which no font found here has: install one "
            "that has them, such as Noto Sans CJK.",
            _MISSING,
            letter,
        )
    _said.add(letter)
