"""Pictures of an assembly in oblique projection: plates as solids, new ones lifted and coloured."""

import math
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from stepwell.base import Floats, Vec2
from stepwell.build.contour import MM, Contour, placed
from stepwell.build.exports.marks import mark_lines
from stepwell.build.exports.page import Page, Pen
from stepwell.build.exports.svg import Step, image_steps, line_steps
from stepwell.build.layouts import BandPath, Layout
from stepwell.build.part import Part
from stepwell.build.plates import Fastener

# Image of the unit vector of y, and of z: seen from the front, from above.
_Y, _Z = (0.32, 0.62), (0.0, 0.85)
# New items are lifted by this height [m]; a picture's largest scale.
LIFT, LARGEST = 0.022, 1.25
_SAGITTA = 3e-5
_THINNEST = 1e-6


@dataclass(frozen=True, slots=True)
class Paint:
    """Colours of the upper face, the sides and the lines of a solid."""

    top: str
    side: str
    line: str


PLATE = Paint("#eeeeec", "#c4c4c0", "#70706c")
NEW_PLATE = Paint("#ffc46b", "#d98f1f", "#7a4a00")
METAL = Paint("#b9bec6", "#8b919b", "#555b65")
NEW_METAL = Paint("#8fc0ff", "#3d7fd6", "#123f80")
BAND, NEW_BAND = "#a05050", "#e02020"


@dataclass(frozen=True, slots=True)
class Solid:
    """A vertical solid: a contour in plan with its openings, between two heights.

    Args:
        contour, openings: in the solid's own frame [m].
        at: place of the frame: x, y [m], angle [rad].
        low, high: heights [m].
        paint: its colours.
        marks: lines on its upper face, in its frame [m].
        level: of the layer that it belongs to; what is in a plate's hole comes before the plate.
    """

    contour: Contour
    openings: tuple[Contour, ...]
    at: tuple[float, float, float]
    low: float
    high: float
    paint: Paint
    marks: tuple[tuple[Vec2, ...], ...] = ()
    level: int = 0

    def order(self) -> tuple[int, float, float]:
        """Sorting key: layer by layer from below, solids behind others first."""
        return self.level, self.low, -self.at[1]


class ObliqueView:
    """The oblique view of a layout at some angles, scaled to fit a width and a height [mm]."""

    def __init__(self, layout: Layout, angles: Sequence[float], size: Vec2):
        self.layout = layout
        self.frames = layout.frames(angles)
        self.blocks = layout.positions(angles)
        corners = []
        for part in layout.parts:
            x0, y0, x1, y1 = part.outline.moved(*self.frames[part.name]).bounds
            corners += [(x, y, z) for x in (x0, x1) for y in (y0, y1) for z in (0.0, part.top)]
        highest = max([one.high for one in layout.fasteners] + [p.top for p in layout.parts])
        above = _Z[1] * (highest - max(p.top for p in layout.parts) + LIFT)
        self._fit(corners, size, above, _Z[1] * 0.003)  # heads of screws
        # Outlines in plan, and parts around fasteners.
        self._outlines: dict[str, Any] = {}
        self._owners: dict[Vec2, set[str]] = {}
        self._tops = sorted({part.top for part in layout.parts})

    def _fit(
        self, corners: Iterable[tuple[float, float, float]], size: Vec2, above: float, below: float
    ) -> None:
        """Scale to fit all corners, and heights of their image above and below them [m]."""
        flat = np.array([flat_of(*one) for one in corners])
        low, high = flat.min(axis=0), flat.max(axis=0)
        high[1] += above
        low[1] -= below
        self.scale = min(LARGEST, *(np.array(size) / (MM * (high - low))))
        self.origin = -MM * self.scale * low
        width, height = MM * self.scale * (high - low)
        self.size = float(width), float(height)
        # The same for all pictures.
        self._drawn: dict[Any, list[tuple[list[Step], Pen]]] = {}

    def on(self, points: Floats, z: float) -> Floats:
        """(n, 2) places on the picture [mm] of points in plan [m] at a height [m]."""
        x, y = points[:, 0], points[:, 1]
        flat = np.column_stack([x + _Y[0] * y, _Y[1] * y + _Z[1] * z])
        return MM * self.scale * flat + self.origin

    def picture(
        self, placed_items: Collection[object], new: Collection[object], lift: float = LIFT
    ) -> Page:
        """The picture of earlier items in grey, and of new items in colour.

        Args:
            placed_items, new: parts, fasteners and bands of the layout.
            lift: height of new items above their places [m].
        """
        page = Page(*self.size)
        parts = [one for one in placed_items if isinstance(one, Part)]
        solids = [self._plate(one, PLATE, 0.0) for one in parts]
        for one in placed_items:
            if isinstance(one, Fastener):
                solids += self._rod(one, METAL, parts)
        self._draw(page, solids)
        for one in placed_items:
            if isinstance(one, BandPath):
                self._band(page, one, BAND, 0.0)
        self._drop_lines(page, new, lift)
        lifted = [self._plate(one, NEW_PLATE, lift) for one in new if isinstance(one, Part)]
        lifted += [s for one in new if isinstance(one, Fastener) for s in self._lifted(one, lift)]
        self._draw(page, lifted)
        for one in new:
            if isinstance(one, BandPath):
                self._band(page, one, NEW_BAND, lift / 2.0)
        return page

    def _plate(self, part: Part, paint: Paint, lift: float) -> Solid:
        low, high = part.base + lift, part.top + lift
        at = self.frames[part.name]
        level = 2 * part.layer + 1
        return Solid(part.outline, part.openings, at, low, high, paint, mark_lines(part), level)

    def centre(self, one: Fastener) -> Vec2:
        """Place of a fastener in plan [m]."""
        x, y = self.blocks[int(one.block)]
        return float(x) + one.centre[0], float(y) + one.centre[1]

    def _around(self, point: Vec2) -> set[str]:
        """Names of the parts whose outlines contain a point in plan [m]."""
        import shapely

        if not self._outlines:
            for part in self.layout.parts:
                ring = part.outline.moved(*self.frames[part.name]).ring(_SAGITTA)
                self._outlines[part.name] = shapely.Polygon(ring)
        if point not in self._owners:
            inside = shapely.contains_xy(list(self._outlines.values()), *point)
            names = zip(self._outlines, inside, strict=True)
            self._owners[point] = {name for name, within in names if within}
        return self._owners[point]

    def _circle(self, one: Fastener, low: float, high: float, paint: Paint) -> Solid:
        # Above the plate whose hole it fills, and below the next one.
        level = 2 * sum(top <= low + _THINNEST for top in self._tops)
        ring = Contour.circle((0.0, 0.0), one.diameter / 2.0)
        return Solid(ring, (), (*self.centre(one), 0.0), low, high, paint, (), level)

    def _rod(self, one: Fastener, paint: Paint, parts: Iterable[Part]) -> list[Solid]:
        """What is visible of a fastener: nothing below the upper face of the plates around it."""
        centre = self.centre(one)
        around = [part for part in parts if part.name in self._around(centre)]
        top = max((part.top for part in around), default=-math.inf)
        if one.high < top - _THINNEST or (one.high <= top + _THINNEST and one.use != "pin"):
            return []
        last = max((part.base for part in around if part.top == top), default=-math.inf)
        pieces = []
        if one.low < top:
            pieces.append(self._circle(one, max(one.low, last), min(one.high, top), paint))
        if one.high > top + _THINNEST:
            pieces.append(self._circle(one, max(one.low, top), one.high, paint))
        return pieces

    def _lifted(self, one: Fastener, lift: float) -> list[Solid]:
        return [self._circle(one, one.low + lift, one.high + lift, NEW_METAL)]

    def _drop_lines(self, page: Page, new: Iterable[object], lift: float) -> None:
        """Dashed lines from new items down to their places."""
        pen = Pen("#909090", None, 0.15, (1.2, 0.8))
        for one in new:
            if isinstance(one, Fastener):
                places, z = [self.centre(one)], one.low
            elif isinstance(one, Part):
                at = self.frames[one.name]
                ends = sorted((hole.centre for hole in one.holes), key=lambda p: (p[0], p[1]))
                places, z = placed([*ends[:1], *ends[-1:]], *at), one.base
            else:
                continue
            for place in places:
                ends = self.on(np.array([place]), z), self.on(np.array([place]), z + lift)
                page.line(np.concatenate(ends), pen)

    def _draw(self, page: Page, solids: Iterable[Solid]) -> None:
        for solid in sorted(solids, key=Solid.order):
            key = solid.contour, solid.at, solid.low, solid.high, solid.paint
            if key not in self._drawn:
                self._drawn[key] = self._shapes(solid)
            for shape in self._drawn[key]:
                page.path(*shape)

    def _shapes(self, solid: Solid) -> list[tuple[list[Step], Pen]]:
        """Sides, upper face and marks of a solid."""
        x, y, angle = solid.at
        height = round(solid.high - solid.low, 9)
        place = (x, y)
        side = [
            step
            for ring in _swept(solid.contour, angle, height)
            for step in line_steps(self.on(ring + place, solid.low), closed=True)
        ]
        image = self._image(solid.at, solid.high)
        face = [
            step for one in (solid.contour, *solid.openings) for step in image_steps(one, image)
        ]
        paint = solid.paint
        marks = [
            (line_steps([image(point) for point in line]), Pen(paint.line, None, 0.25))
            for line in solid.marks
        ]
        faces = [
            (side, Pen(paint.line, paint.side, 0.15)),
            (face, Pen(paint.line, paint.top, 0.15)),
        ]
        return faces + marks

    def _image(self, at: tuple[float, float, float], z: float) -> Callable[[Vec2], Vec2]:
        """The map from the plan of a frame [m] at a height [m] to the picture [mm]."""
        c, s, scale = math.cos(at[2]), math.sin(at[2]), MM * self.scale
        left, low = float(self.origin[0]), float(self.origin[1])

        def image(point: Vec2) -> Vec2:
            x = at[0] + c * point[0] - s * point[1]
            y = at[1] + s * point[0] + c * point[1]
            return left + scale * (x + _Y[0] * y), low + scale * (_Y[1] * y + _Z[1] * z)

        return image

    def _band(self, page: Page, one: BandPath, colour: str, lift: float) -> None:
        """A band as the loop around its hooks."""
        p, q = self.blocks[one.cell] + one.p, self.blocks[one.cell + 1] + one.q
        ends = (float(p[0]), float(p[1])), (float(q[0]), float(q[1]))
        self._loop(page, Contour.slot(*ends, one.width), (one.low + one.high) / 2.0 + lift, colour)

    def _loop(self, page: Page, loop: Contour, z: float, colour: str) -> None:
        page.line(self.on(loop.ring(_SAGITTA), z), Pen(colour, None, 0.9), closed=True)


def flat_of(x: float, y: float, z: float) -> Vec2:
    """The image of a point [m], unscaled."""
    return x + _Y[0] * y, _Y[1] * y + _Z[1] * z


def up_in_plan(height: float) -> Floats:
    """The shift in plan (2,) [m] that has the image of a height [m]."""
    return np.array([-_Y[0], 1.0]) * (_Z[1] * height / _Y[1])


@lru_cache(maxsize=1024)
def _swept(contour: Contour, angle: float, height: float) -> tuple[Floats, ...]:
    """Rings in plan whose image at the lower face is the outline of the whole solid."""
    import shapely

    ring = contour.moved(angle=angle).ring(_SAGITTA)
    # In plan, a height is a shift that has the same image.
    up = up_in_plan(height)
    both = shapely.MultiPoint(np.concatenate([ring, ring + up])).convex_hull
    if shapely.MultiPoint(ring).convex_hull.area > shapely.Polygon(ring).area * (1.0 + 1e-9):
        ahead = np.roll(ring, -1, axis=0)
        quads: Any = shapely.polygons(np.stack([ring, ahead, ahead + up, ring + up], axis=1))
        faces = [shapely.Polygon(ring), shapely.Polygon(ring + up)]
        sides = [quad for quad in quads if quad.is_valid]
        both = shapely.union_all([*faces, *sides], grid_size=1e-8)
    rings = shapely.get_exterior_ring(shapely.get_parts(both))
    return tuple(shapely.get_coordinates(one)[:-1] for one in rings)
