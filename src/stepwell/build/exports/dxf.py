"""DXF drawings of cutting paths: 1:1 in millimetres, lines, arcs and circles only."""

import io
import logging
from collections.abc import Iterable
from itertools import pairwise
from typing import TYPE_CHECKING, Literal

from stepwell.base import need
from stepwell.build.contour import MM, Contour
from stepwell.build.exports.cutting import Cutting

if TYPE_CHECKING:
    from ezdxf.document import Drawing
    from ezdxf.layouts.layout import Modelspace

Version = Literal["R2010", "R12"]
# Layers in cutting order, each with its AutoCAD colour; laser programs order their work by either.
LAYERS = {"ENGRAVE": 5, "CUT_INSIDE": 1, "CUT_OUTSIDE": 3, "GUIDE": 8}
_SILENT = logging.NullHandler()
# The one layer of a part's file, for cutting services.
CUT = "CUT"


def dxf_text(paths: Cutting, version: Version = "R2010", *, layered: bool = False) -> str:
    """The text of a DXF file with these paths.

    Circles are CIRCLE, other contours closed polylines with bulges: LWPOLYLINE in R2010, POLYLINE
    in R12. Straight marks and guides are LINE. Units are millimetres; R12 has no header for them.

    Args:
        paths: of a part or a sheet [m].
        version: "R2010", or "R12" for old programs.
        layered: use a layer for each step of the work, as for sheets. Otherwise all cuts are on one
            layer, and nothing is engraved, as cutting services ask.
    """
    need("build")
    from ezdxf._options import options

    # Without time stamps and random identifiers: equal parts have equal files.
    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        return _text(paths, version, layered)
    finally:
        options.write_fixed_meta_data_for_testing = before


def _text(paths: Cutting, version: Version, layered: bool) -> str:
    document = _document(version, list(LAYERS) if layered else [CUT])
    space = document.modelspace()
    on = {name: name if layered else CUT for name in LAYERS}
    if layered:
        _lines(space, paths.engraved, "ENGRAVE")
    for contours, layer in ((paths.inside, "CUT_INSIDE"), (paths.outside, "CUT_OUTSIDE")):
        for contour in contours:
            _contour(space, contour, on[layer])
    if layered:
        _lines(space, paths.guides, "GUIDE")
    x0, y0, x1, y1 = (MM * one for one in paths.bounds)
    document.header["$EXTMIN"], document.header["$EXTMAX"] = (x0, y0, 0.0), (x1, y1, 0.0)
    text = io.StringIO()
    document.write(text)
    return text.getvalue()


def _document(version: Version, layers: Iterable[str]) -> "Drawing":
    from ezdxf import units
    from ezdxf.filemanagement import new

    # The header of R12 has no units, of which ezdxf would warn on standard error.
    logging.getLogger("ezdxf").addHandler(_SILENT)
    document = new(version, units=units.MM)
    document.header["$MEASUREMENT"] = 1
    for name in layers:
        document.layers.add(name, color=LAYERS.get(name, 7))
    return document


def _contour(space: "Modelspace", contour: Contour, layer: str) -> None:
    on = {"layer": layer}
    if circle := contour.as_circle():
        (x, y), radius = circle
        space.add_circle((MM * x, MM * y), MM * radius, dxfattribs=on)
        return
    corners = [
        (MM * x, MM * y, b) for (x, y), b in zip(contour.points, contour.bulges, strict=True)
    ]
    if space.doc.dxfversion > "AC1009":
        space.add_lwpolyline(corners, format="xyb", close=True, dxfattribs=on)
    else:
        space.add_polyline2d(corners, format="xyb", close=True, dxfattribs=on)


def _lines(
    space: "Modelspace", lines: Iterable[tuple[tuple[float, float], ...]], layer: str
) -> None:
    for line in lines:
        for (x0, y0), (x1, y1) in pairwise(line):
            space.add_line((MM * x0, MM * y0), (MM * x1, MM * y1), dxfattribs={"layer": layer})
