"""Texts of figures: names that are safe to draw, quantities with units, texts cut to length."""

import logging
import math
import re
from functools import cache
from itertools import pairwise
from typing import Any, NamedTuple

from matplotlib.font_manager import FontProperties, findfont, fontManager
from matplotlib.ft2font import FT2Font

from stepwell.base import Measure, Quantity, display_unit, printable
from stepwell.mechanism import Chain


def wrapped(text: str, most: int) -> list[str]:
    """Lines of at most `most` characters, broken after a blank, a > or a comma.

    A number and its unit stay on one line.
    """
    lines = [""]
    for word in re.split(r"(?<=[ >,])(?!(?<=\d )[^\W\d_]{1,2}\b)", text):
        if lines[-1] and len(lines[-1]) + len(word.rstrip()) > most:
            lines.append("")
        lines[-1] += word
    return [line.rstrip() for line in lines]


def shortened(text: str, most: int, lines: int = 1) -> str:
    """The text cut to at most `lines` lines of `most` characters."""
    shown = [line if len(line) <= most else line[: most - 1] + "…" for line in wrapped(text, most)]
    if len(shown) > lines:
        shown[lines - 1] = shown[lines - 1][: most - 1].rstrip(" …") + "…"
    return "\n".join(shown[:lines])


def sequence_words(text: str, most: int) -> str:
    """A sequence of states such as "00>10>11>01>00"; if longer than `most` characters, the numbers
    of the cells that load and unload. Any other text is returned unchanged.
    """
    if len(text) <= most or not re.fullmatch(r"\d+(>\d+)+", text):
        return text
    words, before = "", ""
    for a, b in pairwise(text.split(">")):
        cells = "+".join(str(k) for k, (x, y) in enumerate(zip(a, b, strict=True), 1) if x != y)
        way = "loads" if sum(map(int, b)) > sum(map(int, a)) else "unloads"
        words += f" {cells}" if way == before else f", {way} {cells}"
        before = way
    return words.removeprefix(", ")


def minus(text: str) -> str:
    """Numbers with a minus sign in place of every hyphen."""
    return text.replace("-", "\N{MINUS SIGN}")


_FONT = "DejaVu Sans"  # comes with matplotlib
# Fonts with the letters of East Asia: of Linux, Windows, macOS.
_MORE = (
    *(f"Noto Sans CJK {region}" for region in ("JP", "SC", "TC", "KR")),
    *("Source Han Sans", "WenQuanYi Micro Hei", "WenQuanYi Zen Hei", "IPAexGothic", "IPAGothic"),
    *("Droid Sans Fallback", "Microsoft YaHei", "Yu Gothic", "Meiryo", "Malgun Gothic"),
    *("PingFang SC", "Hiragino Sans", "Hiragino Sans GB", "Apple SD Gothic Neo"),
    "Arial Unicode MS",
)
_MISSING = "\N{WHITE SQUARE}"
_logged: set[str] = set()


def literal(text: str) -> str:
    """The name as literal text for matplotlib, never mathematics and never hidden in a legend.
    Letters that no font has become squares, which is logged once.
    """
    lines = text.split("\n")
    shown = "\n".join("".join(map(_drawable, printable(line))) for line in lines)
    shown = shown.replace("$", r"\$")
    return f"\N{ZERO WIDTH SPACE}{shown}" if shown.startswith("_") else shown


@cache
def families() -> tuple[str, ...]:
    """The font of every figure, followed by installed fonts with more letters."""
    installed = {font.name for font in fontManager.ttflist}
    return (_FONT, *(name for name in _MORE if name in installed))


def _drawable(letter: str) -> str:
    if letter.isascii() or any(ord(letter) in letters_of(name) for name in families()):
        return letter
    # A log record instead of a warning: it must not become an error, and one line is enough.
    if not _logged:
        logging.getLogger("stepwell").warning(
            f"Figures show {_MISSING} for letters such as {letter}, which no installed font "
            f"contains: install a font with these letters, such as Noto Sans CJK."
        )
    _logged.add(letter)
    return _MISSING


@cache
def letters_of(family: str, weight: str = "normal", slant: str = "normal") -> frozenset[int]:
    """The letters that a font has."""
    return frozenset(FT2Font(font_file(family, weight, slant)).get_charmap())


def font_file(family: str, weight: str, slant: Any) -> str:
    """Path of a font's file."""
    return findfont(FontProperties(family=[family], weight=weight, style=slant))


class AxisQuantity(NamedTuple):
    """A quantity as it is drawn; `factor` converts SI to its unit."""

    word: str
    symbol: str
    sign: str
    factor: float

    @property
    def label(self) -> str:
        """Label of an axis."""
        return " ".join(part for part in (self.word, self.symbol, f"[{self.sign}]") if part)

    def value(self, number: float) -> str:
        """The value [SI] as an equation with the symbol and the unit."""
        return f"{self.symbol} = {self.number(number)} {self.sign}"

    def number(self, number: float) -> str:
        """The value [SI] in its unit with three digits, or without decimals from 1000 on."""
        shown = number * self.factor
        return minus(f"{shown:.3g}" if abs(shown) < 1000.0 else f"{shown:.0f}")


def stroke(measure: Measure) -> AxisQuantity:
    """The stroke of a chain: the sum of the travels of its cells."""
    return _quantity(measure.stroke, measure.symbols[0], measure.travel_unit)


def travel(measure: Measure) -> AxisQuantity:
    """The travel of one cell."""
    return _quantity(measure.travel, measure.symbols[1], measure.travel_unit)


def force(measure: Measure) -> AxisQuantity:
    """The force of a cell, which equals that of the actuator."""
    return _quantity(measure.force, measure.symbols[2], measure.force_unit)


def actuator(measure: Measure) -> AxisQuantity:
    """The force of the actuator, without a symbol."""
    return force(measure)._replace(word=f"Actuator {measure.force}", symbol="")


def drive(chain: Chain) -> AxisQuantity:
    """The quantity that the actuator prescribes: force, stroke, or its position behind a spring."""
    if chain.actuator_stiffness == 0:
        return actuator(chain.measure)
    if math.isinf(chain.actuator_stiffness):
        return stroke(chain.measure)
    return stroke(chain.measure)._replace(word="Actuator", symbol="")


def _quantity(word: str, symbol: str, unit: str) -> AxisQuantity:
    unit_name, factor = display_unit(unit)
    return AxisQuantity(word.capitalize(), f"${symbol}$", Quantity(word, unit_name).sign, factor)
