"""Pictures of a robot's assembly in oblique projection: flat and upright parts as solids."""

from collections.abc import Iterable

import numpy as np

from stepwell.base import Vec2
from stepwell.build.contour import MM, Contour
from stepwell.build.exports import picture
from stepwell.build.exports.page import Page, Pen
from stepwell.build.exports.picture import ObliqueView, Paint, Solid
from stepwell.build.exports.svg import Step, line_steps
from stepwell.build.part import Part
from stepwell.build.plates import Fastener
from stepwell.build.robots.making import Bought
from stepwell.build.robots.robot_layout import RobotBand, RobotLayout

_SAGITTA = 3e-5
# Openings of this area and larger are seen through [m²].
_WINDOW = 1e-4
_Item = Part | Fastener | Bought


class RobotView(ObliqueView):
    """The oblique view of a robot at rest, scaled to fit a width and a height [mm]."""

    def __init__(self, layout: RobotLayout, size: Vec2):
        self.robot = layout
        places = layout.frames(layout.pose())
        self.places = places
        self.frames = {name: (one.x, one.y, one.angle) for name, one in places.items()}
        corners = []
        for part in layout.parts:
            place = places[part.name]
            x0, y0, x1, y1 = part.outline.moved(place.x, place.y, place.angle).bounds
            low, high = (part.base, part.top)
            if place.upright:
                y0, low, y1, high = low, y0, high, y1
            corners += [(x, y, z) for x in (x0, x1) for y in (y0, y1) for z in (low, high)]
        self._fit(corners, size, picture.LIFT, 0.0)
        self._tops = sorted({part.top for part in layout.parts if not places[part.name].upright})

    def centre(self, one: Fastener) -> Vec2:
        """Place of a fastener in plan [m]."""
        return one.centre

    def _around(self, point: Vec2) -> set[str]:
        return set()

    def picture(
        self, placed_items: Iterable[object], new: Iterable[object], lift: float = 0.0
    ) -> Page:
        """The picture of earlier items in grey, and of new items in colour, at their places.

        Args:
            placed_items, new: parts, fasteners, boxes and bands of the layout.
            lift: unused; parts of a robot are put in from all sides.
        """
        page = Page(*self.size)
        solids: list[tuple[tuple[float, float], _Item, bool]] = []
        bands: list[tuple[RobotBand, bool]] = []
        for items, fresh in ((placed_items, False), (new, True)):
            for one in items:
                if isinstance(one, RobotBand):
                    bands.append((one, fresh))
                elif isinstance(one, Part | Fastener | Bought):
                    solids.append((self._depth(one), one, fresh))
        for _, one, fresh in sorted(solids, key=lambda row: row[0]):
            for steps, pen in self._shapes_of(one, fresh=fresh):
                page.path(steps, pen)
        for band, fresh in bands:
            self._stretched(page, band, fresh=fresh)
        return page

    def _depth(self, one: _Item) -> tuple[float, float]:
        """Sorting key: from below, and within a layer from the rear."""
        high = self.robot.plan.heights
        if isinstance(one, Bought):
            # The rod is inside of the housing.
            rod = one.name == "rod"
            return (high.slide + 5e-6, 0.0) if rod else (one.low[2] + 1e-5, 0.0)
        upright = one.upright if isinstance(one, Fastener) else self.places[one.name].upright
        if not upright:
            low = one.base if isinstance(one, Part) else one.low
            return low, -(self.frames[one.name][1] if isinstance(one, Part) else one.centre[1])
        at = one.base if isinstance(one, Part) else one.low
        if isinstance(one, Part):
            _, y0, _, y1 = one.outline.moved(*self.frames[one.name]).bounds
        else:
            y0 = y1 = one.centre[1]
        if y1 > high.slide + 6e-3:  # stands on the body plate or on the carriage
            return high.slide + (2e-4 if at < 0.0 else 0.0), -at
        # A V hangs from its rail: a far one is behind the T-foot, a near one before it.
        return (y0 - 1.0 if at > 0.0 else high.flange - 1e-4), -at

    def _shapes_of(self, one: _Item, *, fresh: bool) -> list[tuple[list[Step], Pen]]:
        metal = picture.NEW_METAL if fresh else picture.METAL
        if isinstance(one, Part):
            paint = picture.NEW_PLATE if fresh else picture.PLATE
            if self.places[one.name].upright:
                at = self.frames[one.name]
                return self._standing(one.outline, one.openings, at, one, paint)
            return self._plate_shapes(self._plate(one, paint, 0.0))
        if isinstance(one, Bought):
            (x0, y0, z0), (x1, y1, z1) = one.low, one.high
            box = Contour.of([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
            return self._shapes(Solid(box, (), (0.0, 0.0, 0.0), z0, z1, metal))
        if one.upright:
            ring = Contour.circle((0.0, 0.0), one.diameter / 2.0)
            return self._standing(ring, (), (*one.centre, 0.0), one, metal)
        return self._shapes(self._circle(one, one.low, one.high, metal))

    def _plate_shapes(self, solid: Solid) -> list[tuple[list[Step], Pen]]:
        """A plate; what is behind its large openings can be seen through them."""
        import shapely

        shapes = self._shapes(solid)
        (x, y, angle), up = solid.at, picture.up_in_plan(solid.high - solid.low)
        for opening in solid.openings:
            if opening.area < _WINDOW:
                continue
            ring = opening.moved(x, y, angle).ring(_SAGITTA)
            through = shapely.Polygon(ring).intersection(shapely.Polygon(ring + up))
            for piece in shapely.get_parts(through):
                corners = shapely.get_coordinates(piece.exterior)[:-1]
                shapes[0][0].extend(line_steps(self.on(corners, solid.low), closed=True))
        return shapes

    def _standing(
        self,
        outline: Contour,
        openings: Iterable[Contour],
        at: tuple[float, float, float],
        one: Part | Fastener,
        paint: Paint,
    ) -> list[tuple[list[Step], Pen]]:
        """Sides and front face of a solid whose plane is that of x and z."""
        import shapely

        ends = (one.base, one.top) if isinstance(one, Part) else (one.low, one.high)

        def image(contour: Contour, y: float) -> np.ndarray:
            x, z = contour.moved(*at).ring(_SAGITTA).T
            flat = [picture.flat_of(a, y, b) for a, b in zip(x, z, strict=True)]
            return MM * self.scale * np.array(flat) + self.origin

        front, rear = (image(outline, y) for y in ends)
        ahead = np.roll(np.arange(len(front)), -1)
        quads = [
            shapely.Polygon([front[i], front[j], rear[j], rear[i]])
            for i, j in zip(range(len(front)), ahead, strict=True)
        ]
        whole = shapely.union_all(
            [shapely.Polygon(rear), *(one for one in quads if one.is_valid)], grid_size=1e-6
        )
        side: list[Step] = []
        for piece in shapely.get_parts(whole):
            if piece.geom_type == "Polygon":
                side += line_steps(shapely.get_coordinates(piece.exterior)[:-1], closed=True)
        face = line_steps(front, closed=True)
        for opening in openings:
            face += line_steps(image(opening, ends[0]), closed=True)
        return [(side, Pen(paint.line, paint.side, 0.15)), (face, Pen(paint.line, paint.top, 0.15))]

    def _stretched(self, page: Page, one: RobotBand, *, fresh: bool) -> None:
        """A band as the loop around its hooks."""
        colour = picture.NEW_BAND if fresh else picture.BAND
        loop = Contour.slot(one.p, one.q, one.width)
        self._loop(page, loop, (one.low + one.high) / 2.0, colour)
