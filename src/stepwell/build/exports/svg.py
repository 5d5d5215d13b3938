"""SVG drawings of cutting paths, for hobby cutters: 1:1, arcs as arcs."""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any
from xml.sax.saxutils import escape, quoteattr

from stepwell.base import Floats, Vec2
from stepwell.build.contour import MM, Contour, arc
from stepwell.build.exports.cutting import Cutting
from stepwell.build.exports.marks import Line

# Colours of the steps of the work, as laser programs expect them: one colour, one setting.
COLOURS = {
    "ENGRAVE": "#0000ff",
    "CUT_INSIDE": "#ff0000",
    "CUT_OUTSIDE": "#00a000",
    "GUIDE": "#808080",
}
_HAIRLINE = 0.1  # [mm]
# Steps of a path [mm]: "M" and "L" with a point; "A" with end, centre, radius, first angle and
# signed angle of turning [rad]; "C" with end and both control points; "Z".
Step = tuple[Any, ...]
# Largest angle of one Bézier curve of an arc: its deviation is below 3e-4 of the radius [rad].
_QUARTER = math.pi / 2.0


def svg_text(paths: Cutting, title: str, *, margin: float = 0.0) -> str:
    """The text of an SVG file with these paths, in millimetres, y up.

    Groups are in cutting order and named as the layers of DXF files.

    Args:
        paths: of a part or a sheet [m].
        title: shown by viewers.
        margin: around the paths [m].
    """
    x0, y0, x1, y1 = (MM * one for one in paths.bounds)
    edge = MM * margin
    at, top = (edge - x0, 0.0), y1 + edge
    width, height = x1 - x0 + 2.0 * edge, y1 - y0 + 2.0 * edge

    def closed(contours: Iterable[Contour]) -> list[str]:
        return [path_data(contour_steps(one, at), top) for one in contours]

    def opened(lines: Iterable[Line]) -> list[str]:
        moved = ([(MM * x + at[0], MM * y) for x, y in line] for line in lines)
        return [path_data(line_steps(one), top) for one in moved]

    groups = {
        "ENGRAVE": opened(paths.engraved),
        "CUT_INSIDE": closed(paths.inside),
        "CUT_OUTSIDE": closed(paths.outside),
        "GUIDE": opened(paths.guides),
    }
    rows = [
        svg_head(width, height),
        f"<title>{escape(title)}</title>",
        *(
            f'<g id="{name}" fill="none" stroke="{COLOURS[name]}" stroke-width="{_HAIRLINE}">\n'
            + "\n".join(f"<path d={quoteattr(one)}/>" for one in drawn)
            + "\n</g>"
            for name, drawn in groups.items()
            if drawn
        ),
        "</svg>",
    ]
    return "\n".join(rows) + "\n"


def svg_head(width: float, height: float) -> str:
    """The opening tag of an SVG file of this size [mm], 1:1, with one unit a millimetre."""
    w, h = plain(width), plain(height)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{w}mm" height="{h}mm" '
        f'viewBox="0 0 {w} {h}">'
    )


def contour_steps(contour: Contour, at: Vec2 = (0.0, 0.0), scale: float = 1.0) -> list[Step]:
    """The path of a contour [m] on a page [mm], its origin at `at` [mm]."""
    factor = MM * scale

    def on(point: Vec2) -> Vec2:
        return at[0] + factor * point[0], at[1] + factor * point[1]

    steps: list[Step] = [("M", on(contour.points[0]))]
    edges = contour.edges()
    for i, (start, end, bulge) in enumerate(edges):
        if bulge != 0.0:
            centre, radius, first, span = arc(start, end, bulge)
            steps.append(("A", on(end), on(centre), factor * radius, first, span))
        elif i < len(edges) - 1:  # the last straight edge is drawn by closing
            steps.append(("L", on(end)))
    return [*steps, ("Z",)]


def curves(centre: Vec2, radius: float, first: float, span: float) -> Iterator[Step]:
    """An arc as Bézier curves of a quarter of a turn at most."""
    x, y = centre
    count = math.ceil(abs(span) / _QUARTER - 1e-9)
    part = span / count
    reach = 4.0 / 3.0 * math.tan(part / 4.0) * radius
    for k in range(count):
        a, b = first + k * part, first + (k + 1) * part
        (ca, sa), (cb, sb) = (math.cos(a), math.sin(a)), (math.cos(b), math.sin(b))
        x0, y0, x1, y1 = x + radius * ca, y + radius * sa, x + radius * cb, y + radius * sb
        yield "C", (x1, y1), (x0 - reach * sa, y0 + reach * ca), (x1 + reach * sb, y1 - reach * cb)


def image_steps(contour: Contour, image: Callable[[Vec2], Vec2]) -> list[Step]:
    """The path of the image [mm] of a contour [m] under an affine map; arcs become curves."""
    steps: list[Step] = [("M", image(contour.points[0]))]
    for start, end, bulge in contour.edges():
        if bulge == 0.0:
            steps.append(("L", image(end)))
            continue
        for _, *points in curves(*arc(start, end, bulge)):
            steps.append(("C", *map(image, points)))
    return [*steps, ("Z",)]


def line_steps(points: Sequence[Vec2] | Floats, *, closed: bool = False) -> list[Step]:
    """The path through points [mm]."""
    steps: list[Step] = [
        ("L" if i else "M", (float(x), float(y))) for i, (x, y) in enumerate(points)
    ]
    return [*steps, ("Z",)] if closed else steps


def path_data(steps: Iterable[Step], top: float) -> str:
    """Path data of SVG, y down from `top` [mm]."""
    words = []
    for step in steps:
        if step[0] == "Z":
            words.append("Z")
            continue
        at = f"{plain(step[1][0])} {plain(top - step[1][1])}"
        if step[0] == "C":
            controls = [f"{plain(x)} {plain(top - y)}" for x, y in step[2:]]
            words.append(f"C{controls[0]} {controls[1]} {at}")
        elif step[0] == "A":
            _, _, _, radius, _, span = step
            r = plain(radius)
            # y points down, so an arc that turns left has the sweep flag 0.
            words.append(f"A{r} {r} 0 {int(abs(span) > math.pi + 1e-9)} {int(span < 0.0)} {at}")
        else:
            words.append(f"{step[0]}{at}")
    return "".join(words)


def contour_path(contour: Contour) -> str:
    """Path data of SVG [mm], y down, of a contour [m] in its own frame."""
    return path_data(contour_steps(contour), 0.0)


def plain(value: float) -> str:
    """A length [mm] to a tenth of a micrometre."""
    return f"{value:.4f}".rstrip("0").rstrip(".") if abs(value) >= 5e-5 else "0"
