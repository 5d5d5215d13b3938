"""Fonts inside an SVG, with the letters that it shows and no others."""

from __future__ import annotations

import base64
import html
import io
import logging
import re
from collections import defaultdict
from functools import cache
from typing import Any, Literal, NamedTuple

from matplotlib.font_manager import FontProperties, findfont
from matplotlib.ft2font import FT2Font

from stepwell.figures.common.style import STYLE

_TEXT = re.compile(r"<text(?P<look>[^>]*)>(?P<inside>.*?)</text>", re.DOTALL)
_SPAN = re.compile(r"<tspan(?P<look>[^>]*)>(?P<inside>.*?)</tspan>", re.DOTALL)
# Said at once, as "font: bold 7px 'A', 'B'", or property by property.
_AT_ONCE = re.compile(r"font:\s*((?:[a-z]+\s+|\d{3}\s+)*)[\d.]+px\s+([^;\"]+)")
_PROPERTY = re.compile(r"font-(family|weight|style):\s*([^;\"]+)")
_HEAVY = ("600", "700", "800", "900")


class _Face(NamedTuple):
    """A font as SVG names it: its family, its weight and its slant."""

    family: str
    weight: Literal["normal", "bold"]
    slant: Literal["normal", "italic", "oblique"]


def with_fonts(svg: str) -> str:
    """An SVG whose text is text, with each of its fonts in it, cut down to the letters it shows.

    So it looks the same where those fonts are missing, and its words can be found and edited.
    """
    shown: dict[_Face, set[str]] = defaultdict(set)
    for text in _TEXT.finditer(svg):
        spans = list(_SPAN.finditer(text["inside"])) or [text]
        for span in spans:
            words = html.unescape(re.sub(r"<[^>]*>", "", span["inside"]))
            for letter in set(words) - {"\n"}:
                shown[_face(html.unescape(span["look"]), letter)].add(letter)
    rules = "\n".join(_rule(face, letters) for face, letters in sorted(shown.items()))
    return svg.replace("<defs>", f'<defs>\n<style type="text/css">\n{rules}\n</style>', 1)


def _face(look: str, letter: str) -> _Face:
    """Of the families that a text may be set in, the first that has a letter, or the first."""
    said = dict(_PROPERTY.findall(look))
    if at_once := _AT_ONCE.search(look):
        kind, families = at_once.groups()
    else:
        kind = f"{said.get('style', '')} {said.get('weight', '')}"
        families = said.get("family", STYLE["font.family"][0])
    words = kind.split()
    weight = "bold" if "bold" in words or any(word in _HEAVY for word in words) else "normal"
    slant = "italic" if "italic" in words else "oblique" if "oblique" in words else "normal"
    named = [family.strip().strip("'\"") for family in families.split(",")]
    faces = [_Face(family, weight, slant) for family in named]
    return next((face for face in faces if ord(letter) in _letters(face)), faces[0])


@cache
def _letters(face: _Face) -> frozenset[int]:
    return frozenset(FT2Font(_file(face)).get_charmap())


def _file(face: _Face) -> str:
    return findfont(FontProperties(family=[face.family], weight=face.weight, style=face.slant))


def _rule(face: _Face, letters: set[str]) -> str:
    """What brings a font along, cut down to some letters."""
    from fontTools import subset

    options: Any = subset.Options()
    options.flavor = "woff"
    options.font_number = 0
    # The file must not tell when it was made: the same figure gives the same bytes.
    options.recalc_timestamp = False
    options.layout_features = ["kern", "mark", "mkmk", "ccmp"]
    logging.getLogger("fontTools").setLevel(logging.ERROR)
    written = io.BytesIO()
    with subset.load_font(_file(face), options) as font:
        cutter = subset.Subsetter(options)
        cutter.populate(text="".join(sorted(letters)))
        cutter.subset(font)
        font.flavor = "woff"
        font.save(written, reorderTables=False)
    data = base64.b64encode(written.getvalue()).decode()
    look = f"font-weight: {face.weight}; font-style: {face.slant}"
    source = f"url(data:font/woff;base64,{data}) format('woff')"
    return f"@font-face {{ font-family: '{face.family}'; {look}; src: {source}; }}"
