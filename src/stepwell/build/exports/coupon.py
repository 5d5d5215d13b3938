"""A coupon to measure the kerf of a machine and the fit of pins before the parts are cut."""

from dataclasses import dataclass

from stepwell.base import Vec2, check
from stepwell.build.contour import MM, Contour
from stepwell.build.exports.cutting import Cutting, cutting
from stepwell.build.exports.marks import Line, stroked
from stepwell.build.part import Hole, Part

# The window, whose plug falls out: width and height [m].
WINDOW: Vec2 = (0.040, 0.020)
# Diameters of the test holes, from that of the pin [m]: -0.20 to 0.20 mm.
STEPS = tuple(5e-5 * i for i in range(-4, 5))
_EDGE, _PITCH, _ROW, _TEXT = 0.006, 0.008, 0.012, 0.0018


@dataclass(frozen=True, slots=True)
class Coupon:
    """A plate with a window and rows of test holes, one row for each pin diameter.

    Kerf along x = (window width - plug width) / 2, along y the same with the heights. A machine
    that is out of scale changes both by the same amount, so it does not count.

    Args:
        part: the plate; its window is a cutout.
        labels: lines of the texts [m].
    """

    part: Part
    labels: tuple[Line, ...]

    @property
    def cutting(self) -> Cutting:
        """Paths as drawn: a coupon is never compensated."""
        paths = cutting(self.part)
        return Cutting(self.labels, paths.inside, paths.outside)

    @property
    def reading(self) -> tuple[str, ...]:
        """How to measure the coupon, sentence by sentence."""
        width, height = (MM * side for side in WINDOW)
        return (
            "Cut coupon.dxf or coupon.svg from the same sheet, with the settings for the parts.",
            f"Measure the plug and its window with a calliper: both are drawn {width:g} x "
            f"{height:g} mm, with x along the row of the text KERF.",
            "kerf_x_mm = (window width - plug width) / 2; kerf_y_mm = (window height - plug "
            "height) / 2.",
            "Push a pin into the test holes: the number beside a hole is its drawn diameter in "
            "1/100 mm.",
            "The hole that holds the pin under hand pressure gives plate_fit_mm, the hole in which "
            "it turns without play gives lever_fit_mm: drawn diameter + kerf - pin diameter.",
            "Enter the numbers in the build file under [sheet] and [pin], and build again.",
        )


def coupon(material: str, thickness: float, pins: tuple[float, ...]) -> Coupon:
    """The coupon for a sheet and the diameters of pins [m].

    Args:
        material, thickness: of the sheet; thickness [m].
        pins: diameters of the pins [m]; equal ones share a row.
    """
    diameters = sorted({round(check.positive("pins", one, "m"), 7) for one in pins})
    width = 2.0 * _EDGE + (len(STEPS) - 1) * _PITCH
    left = (width - WINDOW[0]) / 2.0
    low = _EDGE + len(diameters) * _ROW
    labels: list[Line] = [*_text("KERF X", (width / 2.0, low + WINDOW[1] + 0.003))]
    holes = []
    for row, pin in enumerate(diameters):
        for column, step in enumerate(STEPS):
            at = (_EDGE + column * _PITCH, _EDGE + row * _ROW)
            size = pin + step
            holes.append(Hole(at, size, f"{1e5 * size:.0f}", "pin"))
            labels += _text(f"{1e5 * size:.0f}", (at[0], at[1] + size / 2.0 + 0.0025))
    x1, y1 = left + WINDOW[0], low + WINDOW[1]
    window = Contour.of([(left, low), (x1, low), (x1, y1), (left, y1)])
    corners = [(0.0, 0.0), (width, 0.0), (width, y1 + _EDGE), (0.0, y1 + _EDGE)]
    plate = Contour.rounded(corners, 0.002)
    part = Part("coupon", material, thickness, plate, tuple(holes), (window,))
    return Coupon(part, tuple(labels))


def _text(text: str, at: Vec2) -> list[Line]:
    return [tuple((x + at[0], y + at[1]) for x, y in line) for line in stroked(text, _TEXT)]
