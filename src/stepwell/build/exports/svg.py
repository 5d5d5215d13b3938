"""SVG drawings of cutting paths, for hobby cutters: 1:1, arcs as arcs."""

from xml.sax.saxutils import escape, quoteattr

from stepwell.build.contour import Contour, arc
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


def svg_text(paths: Cutting, title: str, *, margin: float = 0.0) -> str:
    """The text of an SVG file with these paths, in millimetres, y up.

    Groups are in cutting order and named as the layers of DXF files.

    Args:
        paths: of a part or a sheet [m].
        title: shown by viewers.
        margin: around the paths [m].
    """
    x0, y0, x1, y1 = (1e3 * one for one in paths.bounds)
    edge = 1e3 * margin
    left, top = x0 - edge, y1 + edge
    width, height = x1 - x0 + 2.0 * edge, y1 - y0 + 2.0 * edge
    groups = {
        "ENGRAVE": [line_path(line, left, top) for line in paths.engraved],
        "CUT_INSIDE": [contour_path(one, left, top) for one in paths.inside],
        "CUT_OUTSIDE": [contour_path(one, left, top) for one in paths.outside],
        "GUIDE": [line_path(line, left, top) for line in paths.guides],
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


def contour_path(contour: Contour, left: float = 0.0, top: float = 0.0) -> str:
    """Path data of a contour [mm] seen from the point (`left`, `top`) [mm], y down."""

    def at(point: tuple[float, float]) -> str:
        return f"{plain(1e3 * point[0] - left)} {plain(top - 1e3 * point[1])}"

    parts = [f"M{at(contour.points[0])}"]
    edges = contour.edges()
    for i, (start, end, bulge) in enumerate(edges):
        if bulge == 0.0:
            if i < len(edges) - 1:  # Z draws the last straight edge
                parts.append(f"L{at(end)}")
            continue
        _, radius, _, span = arc(start, end, bulge)
        r = plain(1e3 * radius)
        # y points down, so an arc that turns left has the sweep flag 0.
        parts.append(f"A{r} {r} 0 {int(abs(span) > 3.14159265)} {int(bulge < 0.0)} {at(end)}")
    return "".join(parts) + "Z"


def line_path(line: Line, left: float = 0.0, top: float = 0.0) -> str:
    """Path data of an open line [mm] seen from the point (`left`, `top`) [mm], y down."""
    return "M" + "L".join(f"{plain(1e3 * x - left)} {plain(top - 1e3 * y)}" for x, y in line)


def plain(value: float) -> str:
    """A length [mm] to a tenth of a micrometre."""
    return f"{value:.4f}".rstrip("0").rstrip(".") if abs(value) >= 5e-5 else "0"
