"""Cutting paths of parts: kerf compensation, and the order in which a machine cuts."""

from collections.abc import Iterable
from dataclasses import dataclass

from stepwell.base import InputError, Vec2
from stepwell.build.contour import Contour, placed
from stepwell.build.exports.marks import Line, mark_lines
from stepwell.build.part import Part

# Of a part that is neither shifted nor turned.
AS_DRAWN = (0.0, 0.0, 0.0)
NO_KERF: Vec2 = (0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Cutting:
    """Paths for a machine, in the order of its work: engraving, openings, outlines.

    Args:
        engraved: open lines of marks [m].
        inside: paths of holes and cutouts [m].
        outside: paths of outlines [m].
        guides: lines that are not cut, such as the edge of a sheet [m].
    """

    engraved: tuple[Line, ...] = ()
    inside: tuple[Contour, ...] = ()
    outside: tuple[Contour, ...] = ()
    guides: tuple[Line, ...] = ()

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Least x and y, greatest x and y [m] of all paths and lines."""
        boxes = [one.bounds for one in (*self.inside, *self.outside)]
        for line in (*self.engraved, *self.guides):
            xs, ys = zip(*line, strict=True)
            boxes.append((min(xs), min(ys), max(xs), max(ys)))
        x0, y0, x1, y1 = zip(*boxes, strict=True)
        return min(x0), min(y0), max(x1), max(y1)


def cutting(
    part: Part,
    kerf: Vec2 = NO_KERF,
    at: tuple[float, float, float] = AS_DRAWN,
    *,
    marked: bool = False,
) -> Cutting:
    """Paths of the beam's centre that leave a part of the drawn size.

    Args:
        part: with finished sizes.
        kerf: width of the cut along x and along y of the machine [m]; 0 if it is not known, or if
            the cutting service compensates it. Outlines grow by half the kerf on each side,
            openings shrink by as much.
        at: shift along x and y [m], and angle [rad] by which the part is turned before.
        marked: engrave the part's mark, if it fits.

    Raises:
        ValueError: an edge or a gap is narrower than the kerf; the text names the part.
    """
    half_x, half_y = kerf[0] / 2.0, kerf[1] / 2.0

    def path(contour: Contour, sign: float) -> Contour:
        turned = contour if at == AS_DRAWN else contour.moved(*at)
        return turned.offset(sign * half_x, sign * half_y)

    try:
        inside = tuple(path(one, -1.0) for one in part.openings)
        outside = (path(part.outline, 1.0),)
    except InputError as error:
        raise InputError(f"part {part.name}: {error}") from None
    lines = mark_lines(part) if marked else ()
    engraved = tuple(tuple(placed(line, *at)) for line in lines)
    return Cutting(engraved, inside, outside)


def joined(cuttings: Iterable[Cutting]) -> Cutting:
    """Several cuttings as one: everything engraved first, then all openings, then all outlines."""
    several = list(cuttings)
    return Cutting(
        tuple(one for each in several for one in each.engraved),
        tuple(one for each in several for one in each.inside),
        tuple(one for each in several for one in each.outside),
        tuple(one for each in several for one in each.guides),
    )
