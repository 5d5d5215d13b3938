"""Figures as files, as SVG text with its fonts inside, and as pictures that move."""

import base64
import html
import io
import logging
import os
import re
from collections import defaultdict
from collections.abc import Iterator, Sequence
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
# Said at once, as "font: bold 7px 'A', 'B'", or property by property.
_AT_ONCE = re.compile(r"font:\s*((?:[a-z]+\s+|\d{3}\s+)*)[\d.]+px\s+([^;\"]+)")
_PROPERTY = re.compile(r"font-(family|weight|style):\s*([^;\"]+)")
_HEAVY = {"bold", "600", "700", "800", "900"}


class _Face(NamedTuple):
    """A font as SVG names it: its family, its weight and its slant."""

    family: str
    weight: str
    slant: str


def with_fonts(svg: str) -> str:
    """An SVG whose text is text, with its fonts, cut down to the letters it shows, in it: so it
    looks the same where those fonts are missing.
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
    # Of the families that a text may be set in, the first that has the letter, or the first.
    said = dict(_PROPERTY.findall(look))
    if at_once := _AT_ONCE.search(look):
        kind, families = at_once.groups()
    else:
        kind = f"{said.get('style', '')} {said.get('weight', '')}"
        families = said.get("family", STYLE["font.family"][0])
    words = kind.split()
    weight = "bold" if _HEAVY & {*words} else "normal"
    slant = "italic" if "italic" in words else "oblique" if "oblique" in words else "normal"
    named = [family.strip().strip("'\"") for family in families.split(",")]
    faces = [_Face(family, weight, slant) for family in named]
    return next((face for face in faces if ord(letter) in letters_of(*face)), faces[0])


def _rule(face: _Face, letters: set[str]) -> str:
    from fontTools import subset

    options: Any = subset.Options()
    options.flavor = "woff"
    options.font_number = 0
    # The file must not tell when it was made: the same figure gives the same bytes.
    options.recalc_timestamp = False
    options.layout_features = ["kern", "mark", "mkmk", "ccmp"]
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
    """Write frames of one size, in the colours of those `seen`, as a GIF that repeats for ever;
    `hundredths` is how long one lasts, or each [0.01 s].
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
    """A picture in the colours that all frames share."""
    sheet = Image.fromarray(np.vstack([np.asarray(picture) for picture in pictures]))
    shared = sheet.quantize(_COLOURS, method=Image.Quantize.MEDIANCUT)
    # Averaging greys the paper, and Pillow tells very light colours apart only roughly.
    colours = np.array(shared.getpalette()).reshape(-1, 3)
    colours[colours.min(axis=1) >= 248] = 255
    shared.putpalette(colours.ravel().tolist())
    return shared


_VECTOR: dict[Any, Any] = {
    # The same figure gives the same file, so that a diff of results shows what changed.
    "svg.hashsalt": "stepwell",
    # Outlines in SVG look the same everywhere, in programs too that leave out the fonts in it.
    "svg.fonttype": "path",
    # Fonts in PDF, as outlines that scale, cut down to the letters shown: text stays text.
    "pdf.fonttype": 42,
}
# What journals ask of line drawings.
PRINT_DPI = 600.0
_UNDATED = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}


def save(
    figure: Figure, file: str | os.PathLike[str], *, dpi: float = 300.0, text: bool = False
) -> None:
    """Write a figure whole or not at all; the suffix says how: .png, .svg or .pdf.

    Args:
        figure: any of this room's.
        file: where to.
        dpi: pixels per inch of a PNG, and of what a vector file keeps as an image.
        text: keep the words of an SVG as text, in fonts that it brings along, and not as outlines;
            in a PDF they always are.

    Raises:
        ValueError: a suffix matplotlib cannot write.
        OSError: the folder is missing or cannot be written.
    """
    suffix = Path(file).suffix.lower()
    kinds = figure.canvas.get_supported_filetypes()
    if suffix.removeprefix(".") not in kinds:
        raise InputError(f"{file}: a figure's name must end in .png, .svg or .pdf, not {suffix!r}.")
    write_atomic(Path(file), drawn_as(figure, suffix, dpi, text=text))


def svg(figure: Figure) -> str:
    """The figure as SVG text of outlines, without an XML declaration."""
    text = drawn_as(figure, ".svg", 200.0).decode()
    return text[text.index("<svg") :]


def drawn_as(figure: Figure, suffix: str, dpi: float, *, text: bool = False) -> bytes:
    """The bytes of a file with this suffix, at so many pixels per inch; `text` as for `save`."""
    buffer = io.BytesIO()
    kind = suffix.removeprefix(".")
    words = text and suffix == ".svg"
    settings: dict[Any, Any] = {"svg.fonttype": "none"} if words else {}
    with mpl.rc_context(_VECTOR | settings):
        figure.savefig(buffer, format=kind, dpi=dpi, metadata=_UNDATED.get(suffix))
    return with_fonts(buffer.getvalue().decode()).encode() if words else buffer.getvalue()
