"""Figures as files, as SVG text with embedded fonts, and as animations."""

import base64
import html
import io
import logging
import os
import re
from collections import defaultdict
from collections.abc import Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from PIL import Image

from stepwell.base import InputError, write_atomic
from stepwell.figures.common.style import STYLE
from stepwell.figures.common.words import font_file, letters_of

_TEXT = re.compile(r"<text(?P<look>[^>]*)>(?P<inside>.*?)</text>", re.DOTALL)
_SPAN = re.compile(r"<tspan(?P<look>[^>]*)>(?P<inside>.*?)</tspan>", re.DOTALL)
# The font shorthand, as "font: bold 7px 'A', 'B'", or single properties.
_SHORTHAND = re.compile(r"font:\s*((?:[a-z]+\s+|\d{3}\s+)*)[\d.]+px\s+([^;\"]+)")
_PROPERTY = re.compile(r"font-(family|weight|style):\s*([^;\"]+)")
_HEAVY = {"bold", "600", "700", "800", "900"}


class _Face(NamedTuple):
    """A font as SVG names it: family, weight and slant."""

    family: str
    weight: str
    slant: str


def with_embedded_fonts(svg: str) -> str:
    """The SVG with its fonts embedded, cut to the letters it shows. Its text stays text and looks
    the same if the fonts are not installed.
    """
    shown: dict[_Face, set[str]] = defaultdict(set)
    for text in _TEXT.finditer(svg):
        spans = list(_SPAN.finditer(text["inside"])) or [text]
        for span in spans:
            words = html.unescape(re.sub(r"<[^>]*>", "", span["inside"]))
            for letter in set(words) - {"\n"}:
                shown[_face_with_letter(html.unescape(span["look"]), letter)].add(letter)
    rules = "\n".join(
        _font_face_rule(face, frozenset(letters)) for face, letters in sorted(shown.items())
    )
    return svg.replace("<defs>", f'<defs>\n<style type="text/css">\n{rules}\n</style>', 1)


def _face_with_letter(look: str, letter: str) -> _Face:
    # The first of the text's families that has the letter, else the first family.
    properties = dict(_PROPERTY.findall(look))
    if shorthand := _SHORTHAND.search(look):
        kind, families = shorthand.groups()
    else:
        kind = f"{properties.get('style', '')} {properties.get('weight', '')}"
        families = properties.get("family", STYLE["font.family"][0])
    words = kind.split()
    weight = "bold" if _HEAVY & {*words} else "normal"
    slant = "italic" if "italic" in words else "oblique" if "oblique" in words else "normal"
    named = [family.strip().strip("'\"") for family in families.split(",")]
    faces = [_Face(family, weight, slant) for family in named]
    return next((face for face in faces if ord(letter) in letters_of(*face)), faces[0])


# Letters before this one are placed one after another, without rules of their font.
_COMBINED = "\u0300"


# A file and the page that shows it have the same letters.
@lru_cache(maxsize=64)
def _font_face_rule(face: _Face, letters: frozenset[str]) -> str:
    from fontTools import subset

    options: Any = subset.Options()
    options.flavor = "woff"
    options.font_number = 0
    # No time stamp in the file: the same figure gives the same bytes.
    options.recalc_timestamp = False
    options.layout_features = ["kern", "mark", "mkmk", "ccmp"]
    # Reading the rules takes most of the time.
    if max(letters) < _COMBINED:
        options.drop_tables += ["GDEF", "GPOS", "GSUB"]
    logging.getLogger("fontTools").setLevel(logging.ERROR)
    written = io.BytesIO()
    with subset.load_font(font_file(*face), options) as font:
        cutter = subset.Subsetter(options)
        cutter.populate(text="".join(sorted(letters)))
        cutter.subset(font)
        font.flavor = "woff"
        font.save(written, reorderTables=False)
    data = base64.b64encode(written.getvalue()).decode()
    look = f"font-weight: {face.weight}; font-style: {face.slant}"
    source = f"url(data:font/woff;base64,{data}) format('woff')"
    return f"@font-face {{ font-family: '{face.family}'; {look}; src: {source}; }}"


_COLOURS = 96


def write_gif(
    file: str | os.PathLike[str],
    pictures: Iterator[Image.Image],
    seen: Sequence[Image.Image],
    hundredths: int | Sequence[int],
) -> Path:
    """Write frames of one size as a GIF that repeats for ever, with the colours of `seen`.
    `hundredths` is the duration of a frame, or of each [0.01 s].
    """
    shared = _palette(seen)
    frames = (one.quantize(palette=shared, dither=Image.Dither.NONE) for one in pictures)
    each = 10 * hundredths if isinstance(hundredths, int) else [10 * one for one in hundredths]
    movie = io.BytesIO()
    # Optimized, it stores only the pixels that changed.
    look: dict[str, Any] = {"save_all": True, "duration": each, "loop": 0, "optimize": True}
    next(frames).save(movie, format="GIF", append_images=frames, **look)
    write_atomic(Path(file), movie.getvalue())
    return Path(file)


def _palette(pictures: Sequence[Image.Image]) -> Image.Image:
    """A picture whose palette all frames share."""
    sheet = Image.fromarray(np.vstack([np.asarray(picture) for picture in pictures]))
    shared = sheet.quantize(_COLOURS, method=Image.Quantize.MEDIANCUT)
    # Averaging makes the paper grey, and Pillow separates very light colours only roughly.
    colours = np.array(shared.getpalette()).reshape(-1, 3)
    colours[colours.min(axis=1) >= 248] = 255
    shared.putpalette(colours.ravel().tolist())
    return shared


_VECTOR: dict[Any, Any] = {
    # The same figure gives the same file, so that a diff of results shows only real changes.
    "svg.hashsalt": "stepwell",
    "svg.fonttype": "none",
    # Fonts in PDF as scalable outlines, cut to the letters shown: text stays text.
    "pdf.fonttype": 42,
}
# Resolution that journals require of line drawings.
PRINT_DPI = 600.0
_UNDATED = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}


def save(
    figure: Figure, file: str | os.PathLike[str], *, dpi: float = 300.0, text: bool = True
) -> None:
    """Write a figure to a .png, .svg or .pdf file, completely or not at all.

    Args:
        figure: a figure of this package.
        file: path of the file; its suffix selects the format.
        dpi: pixels per inch of a PNG, and of images within a vector file.
        text: whether the text of an SVG is text with embedded fonts, or outlines, for programs
            that ignore embedded fonts. In a PDF text is always text.

    Raises:
        ValueError: a suffix that matplotlib cannot write.
        OSError: the folder is missing or cannot be written.
    """
    suffix = Path(file).suffix.lower()
    kinds = figure.canvas.get_supported_filetypes()
    if suffix.removeprefix(".") not in kinds:
        raise InputError(f"{file}: a figure's name must end in .png, .svg or .pdf, not {suffix!r}.")
    write_atomic(Path(file), figure_bytes(figure, suffix, dpi, text=text))


def svg(figure: Figure) -> str:
    """The figure as SVG, without an XML declaration; its text is text with embedded fonts."""
    text = figure_bytes(figure, ".svg", 200.0).decode()
    return text[text.index("<svg") :]


def figure_bytes(figure: Figure, suffix: str, dpi: float, *, text: bool = True) -> bytes:
    """The bytes of a file with this suffix, at `dpi` pixels per inch; `text` as in `save`."""
    buffer = io.BytesIO()
    kind = suffix.removeprefix(".")
    words = text and suffix == ".svg"
    settings: dict[Any, Any] = {} if words else {"svg.fonttype": "path"}
    with mpl.rc_context(_VECTOR | settings):
        figure.savefig(buffer, format=kind, dpi=dpi, metadata=_UNDATED.get(suffix))
    return with_embedded_fonts(buffer.getvalue().decode()).encode() if words else buffer.getvalue()
