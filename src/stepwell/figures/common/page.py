"""The figure that all others are drawn on: a notebook shows it by itself."""

from __future__ import annotations

import base64
from html import escape

from matplotlib.figure import Figure

from stepwell.figures.common.write import drawn_as

# Pixels of a screen in an inch of paper at which the type of figures, 7 points, is as large as
# that of the text round them; and pixels drawn for each, so that sharp screens show it sharp.
_SCREEN, _SHARP = 144.0, 2.0
# Bytes of the longest drawing that is kept as lines; a longer one becomes an image.
_MOST = 400_000


class PageFigure(Figure):
    """A figure that shows itself in notebooks, with and without `%matplotlib inline`.

    Everywhere at one scale: one column of a page is 480 pixels wide, and no figure is wider than
    the notebook. It stands on white in a dark notebook too, as on paper.
    """

    def _repr_html_(self) -> str:
        # HTML, of all that notebooks can show, is shown before what inline backends draw: that
        # would be cut to what is on it, each figure to another scale.
        kind, drawn = "svg+xml", drawn_as(self, ".svg", _SCREEN * _SHARP)
        if len(drawn) > _MOST:
            kind, drawn = "png", drawn_as(self, ".png", _SCREEN * _SHARP)
        data = base64.b64encode(drawn).decode()
        width, height = (round(_SCREEN * inches) for inches in self.get_size_inches())
        return (
            f'<img src="data:image/{kind};base64,{data}" alt="{escape(self._words())}" '
            f'width="{width}" height="{height}" '
            'style="max-width:100%;height:auto;background:white;border-radius:4px">'
        )

    def _words(self) -> str:
        """What its axes show, for those who cannot see it."""
        axes = ((ax.get_ylabel(), ax.get_xlabel()) for ax in self.axes)
        told = dict.fromkeys(f"{y} against {x}" for y, x in axes if x and y)
        return "; ".join(" ".join(one.split()) for one in told) or "A drawing"
