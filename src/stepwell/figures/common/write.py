"""Figures as files and as SVG text."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from stepwell.base import InputError, write_atomic
from stepwell.figures.common.fonts import with_fonts

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
        text: keep the words of an SVG as text that can be found and edited, in fonts that the
            file brings along, and not as outlines; in a PDF they always are.

    Raises:
        ValueError: a suffix matplotlib cannot write.
        OSError: the folder is missing or cannot be written.
    """
    suffix = Path(file).suffix.lower()
    kinds = figure.canvas.get_supported_filetypes()
    if suffix.removeprefix(".") not in kinds:
        raise InputError(f"{file}: a figure's name must end in .png, .svg or .pdf, not {suffix!r}.")
    write_atomic(Path(file), _drawn(figure, suffix, dpi, text=text))


def svg(figure: Figure) -> str:
    """The figure as SVG text of outlines, without an XML declaration."""
    text = _drawn(figure, ".svg", 200.0).decode()
    return text[text.index("<svg") :]


def _drawn(figure: Figure, suffix: str, dpi: float, *, text: bool = False) -> bytes:
    buffer = io.BytesIO()
    kind = suffix.removeprefix(".")
    words = text and suffix == ".svg"
    settings: dict[Any, Any] = {"svg.fonttype": "none"} if words else {}
    with mpl.rc_context(_VECTOR | settings):
        figure.savefig(buffer, format=kind, dpi=dpi, metadata=_UNDATED.get(suffix))
    return with_fonts(buffer.getvalue().decode()).encode() if words else buffer.getvalue()
