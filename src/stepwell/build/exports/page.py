"""Pages of drawings and text in millimetres, written as SVG and as PDF from the same content."""

import io
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import escape

from stepwell.base import Floats, Vec2, need
from stepwell.build.contour import Contour
from stepwell.build.exports.svg import (
    Step,
    contour_steps,
    curves,
    line_steps,
    path_data,
    plain,
    svg_head,
)

if TYPE_CHECKING:
    from reportlab.pdfgen.canvas import Canvas

# Paper sizes, width and height [mm].
PAPERS = {"A4": (210.0, 297.0), "letter": (215.9, 279.4)}
_POINT = 72.0 / 25.4  # PDF points in a millimetre


@dataclass(frozen=True, slots=True)
class Pen:
    """Line and filling of a shape: colours such as "#204060", or None; width [mm]."""

    line: str | None = "#000000"
    fill: str | None = None
    width: float = 0.2
    dashes: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class Lettering:
    """Look of a text: "start", "middle" or "end" as its anchor, angle of its line [degrees]."""

    anchor: str = "start"
    bold: bool = False
    colour: str = "#000000"
    angle: float = 0.0


@dataclass
class Page:
    """A page; the origin is its lower left corner, y points up, all lengths are in millimetres."""

    width: float
    height: float
    shapes: list[tuple[list[Step], Pen]] = field(default_factory=list)
    texts: list[tuple[float, float, str, float, Lettering]] = field(default_factory=list)
    inserted: list[tuple["Page", Vec2]] = field(default_factory=list)
    # Shapes, texts and pages in the order in which they were added.
    order: list[tuple[str, int]] = field(default_factory=list)

    def path(self, steps: list[Step], pen: Pen) -> None:
        """Add a shape; by the even-odd rule, a path within another leaves a hole."""
        self.order.append(("shape", len(self.shapes)))
        self.shapes.append((steps, pen))

    def contours(self, contours: Iterable[Contour], at: Vec2, pen: Pen, scale: float = 1.0) -> None:
        """Add contours [m] as one shape; their origin is at `at` [mm]."""
        self.path([step for one in contours for step in contour_steps(one, at, scale)], pen)

    def line(self, points: Sequence[Vec2] | Floats, pen: Pen, *, closed: bool = False) -> None:
        """Add a line through points [mm]."""
        self.path(line_steps(points, closed=closed), pen)

    def circle(self, centre: Vec2, radius: float, pen: Pen) -> None:
        """Add a circle [mm]."""
        self.contours([Contour.circle((0.0, 0.0), 1e-3 * radius)], centre, pen)

    def text(self, at: Vec2, text: str, size: float = 3.2, **look: Any) -> None:
        """Add a line of text.

        Args:
            at: start, middle or end of its base line [mm].
            text: one line.
            size: of the font [mm].
            look: as for `Lettering`.
        """
        self.order.append(("text", len(self.texts)))
        self.texts.append((at[0], at[1], text, size, Lettering(**look)))

    def insert(self, other: "Page", at: Vec2) -> None:
        """Add all content of another page, its lower left corner at `at` [mm]."""
        self.order.append(("page", len(self.inserted)))
        self.inserted.append((other, at))

    def paragraph(self, at: Vec2, text: str, width: float, size: float = 3.2, **look: Any) -> float:
        """Add a text that is broken to a width [mm]; returns the y of the line below it."""
        x, y = at
        for line in broken(text, width, size, bold=bool(look.get("bold"))):
            self.text((x, y), line, size, **look)
            y -= 1.4 * size
        return y

    def svg(self, title: str) -> str:
        """The page as an SVG file, 1:1."""
        title = f"<title>{escape(title)}</title>"
        rows = [svg_head(self.width, self.height), title, *self._svg_rows(), "</svg>"]
        return "\n".join(rows) + "\n"

    def _svg_rows(self) -> Iterator[str]:
        for kind, i in self.order:
            if kind == "page":
                page, (x, y) = self.inserted[i]
                down = self.height - y - page.height
                yield f'<g transform="translate({plain(x)} {plain(down)})">'
                yield from page._svg_rows()
                yield "</g>"
            else:
                yield self._svg_shape(i) if kind == "shape" else self._svg_text(i)

    def _svg_shape(self, i: int) -> str:
        steps, pen = self.shapes[i]
        dashes = f' stroke-dasharray="{" ".join(map(plain, pen.dashes))}"' if pen.dashes else ""
        return (
            f'<path d="{path_data(steps, self.height)}" fill="{pen.fill or "none"}" '
            f'fill-rule="evenodd" stroke="{pen.line or "none"}" '
            f'stroke-width="{plain(pen.width)}" stroke-linejoin="round"{dashes}/>'
        )

    def _svg_text(self, i: int) -> str:
        left, up, text, size, look = self.texts[i]
        x, y, turn = plain(left), plain(self.height - up), look.angle
        turned = f' transform="rotate({-turn:g} {x} {y})"' if turn else ""
        bold = ' font-weight="bold"' if look.bold else ""
        return (
            f'<text x="{x}" y="{y}" font-family="Verdana, DejaVu Sans, sans-serif" '
            f'font-size="{plain(size)}" text-anchor="{look.anchor}" '
            f'fill="{look.colour}"{bold}{turned}>{escape(text)}</text>'
        )


def pdf_bytes(pages: Sequence[Page], title: str) -> bytes:
    """Pages as a PDF file, 1:1, with its fonts; equal pages have equal files."""
    need("build")
    from reportlab import rl_config
    from reportlab.pdfgen.canvas import Canvas

    _fonts()
    content = io.BytesIO()
    canvas = Canvas(content, invariant=1, pageCompression=1)
    # Printable streams cost as much time as all the rest.
    before, rl_config.useA85 = rl_config.useA85, 0
    canvas.setTitle(title)
    canvas.setCreator("Stepwell")
    # Viewers that scale a drawing to the page's margins would make it useless.
    canvas.setViewerPreference("PrintScaling", "None")
    # Paths that several pages share are made once.
    paths: dict[int, Any] = {}
    for page in pages:
        canvas.setPageSize((page.width * _POINT, page.height * _POINT))
        canvas.scale(_POINT, _POINT)
        canvas.setLineJoin(1)
        _print(canvas, page, paths)
        canvas.showPage()
    try:
        canvas.save()
    finally:
        rl_config.useA85 = before
    return content.getvalue()


def _print(canvas: "Canvas", page: Page, paths: dict[int, Any]) -> None:
    for kind, i in page.order:
        if kind == "page":
            inner, at = page.inserted[i]
            canvas.saveState()
            canvas.translate(*at)
            _print(canvas, inner, paths)
            canvas.restoreState()
        elif kind == "text":
            _write(canvas, *page.texts[i])
        else:
            steps, pen = page.shapes[i]
            if id(steps) not in paths:
                paths[id(steps)] = _path(canvas, steps)
            _draw(canvas, paths[id(steps)], pen)


def _path(canvas: "Canvas", steps: list[Step]) -> Any:
    path = canvas.beginPath()
    for step in steps:
        if step[0] == "M":
            path.moveTo(*step[1])
        elif step[0] == "L":
            path.lineTo(*step[1])
        elif step[0] == "Z":
            path.close()
        else:
            pieces = [step] if step[0] == "C" else curves(*step[2:])
            for _, end, one, two in pieces:
                path.curveTo(*one, *two, *end)
    return path


def _draw(canvas: "Canvas", path: Any, pen: Pen) -> None:
    if pen.line:
        canvas.setStrokeColor(_colour(pen.line))
        canvas.setLineWidth(pen.width)
        canvas.setDash(list(pen.dashes))
    if pen.fill:
        canvas.setFillColor(_colour(pen.fill))
    canvas.drawPath(path, stroke=int(bool(pen.line)), fill=int(bool(pen.fill)), fillMode=0)


def _write(canvas: "Canvas", x: float, y: float, text: str, size: float, look: Lettering) -> None:
    shift = {"start": 0.0, "middle": 0.5, "end": 1.0}[look.anchor]
    left = -shift * width_of(text, size, bold=look.bold) if shift else 0.0
    canvas.setFont(_font(bold=look.bold), size)
    canvas.setFillColor(_colour(look.colour))
    if not look.angle:
        canvas.drawString(x + left, y, text)
        return
    canvas.saveState()
    canvas.translate(x, y)
    canvas.rotate(look.angle)
    canvas.drawString(left, 0.0, text)
    canvas.restoreState()


@cache
def _fonts() -> None:
    """Make ReportLab's own copies of Bitstream Vera known, which are embedded in the files."""
    import reportlab
    from reportlab.pdfbase import pdfmetrics
    from reportlab.pdfbase.ttfonts import TTFont

    folder = Path(reportlab.__file__).parent / "fonts"
    for name in ("Vera", "VeraBd"):
        pdfmetrics.registerFont(TTFont(name, str(folder / f"{name}.ttf")))


@cache
def _colour(text: str) -> Any:
    from reportlab.lib.colors import HexColor

    return HexColor(text)


def _font(*, bold: bool) -> str:
    return "VeraBd" if bold else "Vera"


def width_of(text: str, size: float, *, bold: bool = False) -> float:
    """Width of a text [mm] in a font size [mm]."""
    from reportlab.pdfbase.pdfmetrics import stringWidth

    _fonts()
    return float(stringWidth(text, _font(bold=bold), size))


def broken(text: str, width: float, size: float, *, bold: bool = False) -> list[str]:
    """The lines of a text that is at most `width` [mm] wide, broken at plain spaces."""
    lines: list[str] = []
    line = ""
    for word in text.split(" "):
        longer = f"{line} {word}".strip()
        if line and width_of(longer, size, bold=bold) > width:
            lines.append(line)
            line = word
        else:
            line = longer
    return [*lines, line] if line else lines
