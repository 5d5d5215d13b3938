"""Flat parts: outline, holes and cutouts of one sheet thickness, with exact mass properties."""

from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from stepwell.base import ByValue, Floats, InputError, Vec2, check
from stepwell.build.contour import SAGITTA, Contour

if TYPE_CHECKING:
    import shapely


class Use(StrEnum):
    """What a hole holds."""

    PIN = "pin"
    GRID = "grid"
    HOOK = "hook"
    SCREW = "screw"


@dataclass(frozen=True, slots=True, eq=False)
class Hole(ByValue):
    """A round hole through a part.

    Args:
        centre: in the part's frame [m].
        diameter: of the finished hole [m], > 0.
        name: such as "A3", as in hole lists; unique within its part.
        use: "pin", "grid", "hook" or "screw".
    """

    centre: Vec2
    diameter: float
    name: str
    use: str = "pin"

    def __post_init__(self):
        object.__setattr__(self, "centre", check.vector("centre", self.centre))
        object.__setattr__(self, "diameter", check.positive("diameter", self.diameter, "m"))
        object.__setattr__(self, "use", str(check.one_of("use", self.use, Use)))

    @property
    def contour(self) -> Contour:
        """The circle of the hole."""
        return _circle(self.centre, self.diameter / 2.0)


# Files and pictures of a part ask for its circles many times.
_circle = lru_cache(maxsize=8192)(Contour.circle)


@dataclass(frozen=True, slots=True, eq=False)
class Part(ByValue):
    """A flat part of one thickness, in its own frame; in a stack its plane is normal to z.

    Args:
        name: unique within a build; file names contain it.
        material: such as "acrylic".
        thickness: of the sheet [m], > 0.
        outline: outer contour.
        holes: round holes.
        cutouts: other openings, such as slots.
        mark: text engraved or printed on the part, such as "L1".
        layer: place in the stack, from 0 at the bottom.
        base: z of the part's lower face in the stack [m].

    Raises:
        ValueError: a number is out of range, or two holes have one name.
    """

    name: str
    material: str
    thickness: float
    outline: Contour
    holes: tuple[Hole, ...] = ()
    cutouts: tuple[Contour, ...] = ()
    mark: str = ""
    layer: int = 0
    base: float = 0.0

    def __post_init__(self):
        object.__setattr__(self, "thickness", check.positive("thickness", self.thickness, "m"))
        object.__setattr__(self, "holes", tuple(self.holes))
        object.__setattr__(self, "cutouts", tuple(self.cutouts))
        names = [hole.name for hole in self.holes]
        if twice := next((name for name in names if names.count(name) > 1), None):
            raise InputError(f"part {self.name}: two holes have the name {twice}: rename one.")

    @property
    def openings(self) -> tuple[Contour, ...]:
        """Contours of all holes, then of all cutouts."""
        return (*(hole.contour for hole in self.holes), *self.cutouts)

    def hole(self, name: str) -> Hole:
        """The hole of this name.

        Raises:
            ValueError: there is none.
        """
        for hole in self.holes:
            if hole.name == name:
                return hole
        known = ", ".join(hole.name for hole in self.holes)
        raise InputError(f"part {self.name} has no hole {name}: it has {known or 'none'}.")

    @property
    def area(self) -> float:
        """Area of the sheet that remains [m²], exact."""
        return self.outline.area - sum(opening.area for opening in self.openings)

    def mass(self, density: float) -> float:
        """Mass [kg] at a density [kg/m³]."""
        return self.area * self.thickness * density

    def _moments(self, x: float, y: float) -> Floats:
        """`Contour.moments` of what remains."""
        openings = sum((one.moments(x, y) for one in self.openings), np.zeros(6))
        return self.outline.moments(x, y) - openings

    @property
    def centroid(self) -> Vec2:
        """Centre of the area in the part's frame [m], exact."""
        x, y = self.outline.points[0]
        area, first, second, *_ = (float(one) for one in self._moments(x, y))
        return x + first / area, y + second / area

    def inertia(self, density: float) -> Floats:
        """(3, 3) inertia about the centre of mass [kg m²] in the axes of the part's frame, exact.

        Args:
            density: of the material [kg/m³].
        """
        area, _, _, xx, yy, xy = self._moments(*self.centroid)
        # The plate's own thickness adds A t²/12 across its plane.
        across = area * self.thickness**2 / 12.0
        rows = [[yy + across, -xy, 0.0], [-xy, xx + across, 0.0], [0.0, 0.0, xx + yy]]
        return density * self.thickness * np.array(rows)

    def polygon(self, sagitta: float = SAGITTA) -> "shapely.Polygon":
        """The part with its openings as a value of shapely; arcs as in `Contour.ring`."""
        import shapely

        return shapely.Polygon(
            self.outline.ring(sagitta), [one.ring(sagitta) for one in self.openings]
        )

    @property
    def top(self) -> float:
        """z of the part's upper face in the stack [m]."""
        return self.base + self.thickness
