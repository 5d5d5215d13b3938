"""Makes the parts of a robot one by one: places, fasteners, holes for the fasteners of a body."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from stepwell.base import ByValue, Vec2
from stepwell.build.build_file import mm
from stepwell.build.contour import Contour
from stepwell.build.part import Hole, Part
from stepwell.build.plates import Fastener
from stepwell.build.robots.plan import RobotPlan
from stepwell.build.stack import pin_length
from stepwell.robot import PartRole

# Name and number of the joint of a pin, as in `Fastener`.
Joint = tuple[int | str, int] | None


@dataclass(frozen=True, slots=True, eq=False)
class PartFrame(ByValue):
    """Where the frame of a part is in the reference pose, in the frame of the robot's body.

    Attributes:
        x, y: of its origin [m]; of an upright part x and z.
        angle: by which it is turned in its plane [rad].
        upright: whether its plane is that of x and z. Its `base` is then a y.
    """

    x: float = 0.0
    y: float = 0.0
    angle: float = 0.0
    upright: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Bought(ByValue):
    """A bought box: actuator, rod, battery or board.

    Attributes:
        name, size: for a parts list.
        body: that carries it.
        role: for its colour.
        low, high: two opposite corners [m], in the robot's body frame and the reference pose.
        mass: [kg].
    """

    name: str
    size: str
    body: str
    role: str
    low: tuple[float, float, float]
    high: tuple[float, float, float]
    mass: float


@dataclass
class Maker:
    """Collects parts, fasteners and boxes; `body` and `role` hold for what follows."""

    plan: RobotPlan
    body: str = "body"
    role: str = PartRole.BODY
    parts: list[Part] = field(default_factory=list)
    places: dict[str, PartFrame] = field(default_factory=dict)
    bodies: dict[str, str] = field(default_factory=dict)
    roles: dict[str, str] = field(default_factory=dict)
    fasteners: list[Fastener] = field(default_factory=list)
    boxes: list[Bought] = field(default_factory=list)

    def now(self, body: str, role: str) -> None:
        """Set the body and the role of what follows."""
        self.body, self.role = body, role

    def part(
        self,
        name: str,
        base: float,
        outline: Contour,
        place: PartFrame,
        *,
        holes: Iterable[Hole] = (),
        cutouts: Iterable[Contour] = (),
    ) -> None:
        """Add a part; holes for the fasteners of its body are added at the end."""
        sheet = self.plan.build_file.sheet
        mark = "".join(word[0] for word in name.split("-")).upper()
        part = Part(
            name, sheet.material, sheet.thickness, outline, tuple(holes), tuple(cutouts), mark
        )
        self.parts.append(replace(part, base=base))
        self.places[name], self.bodies[name] = place, self.body
        self.roles[name] = self.role

    def add(self, one: Fastener) -> None:
        """Add a fastener of the present body."""
        self.fasteners.append(one)

    def pin(
        self,
        name: str,
        centre: Vec2,
        ends: tuple[float, float],
        *,
        joint: tuple[str, int] | None = None,
        upright: bool = False,
        use: str = "pin",
    ) -> None:
        """Add a dowel pin from `ends[0]` [m] up, of the next standard length."""
        width = (
            self.plan.build_file.hook.diameter
            if use == "hook"
            else self.plan.build_file.pin.diameter
        )
        low, length = ends[0], pin_length(ends[1] - ends[0])
        if upright:
            low = (ends[0] + ends[1] - length) / 2.0
        size = f"ISO 8734 {mm(width)} x {mm(length)}"
        self.add(
            Fastener(
                name, use, size, width, self.body, centre, low, low + length, joint, upright=upright
            )
        )

    def shims(self, name: str, centre: Vec2, bases: Sequence[float], joint: Joint = None) -> None:
        """Add shims that keep the layers apart, their lower faces at `bases` [m]."""
        build_file = self.plan.build_file
        thick, inner = build_file.lever.shim, build_file.pin.diameter
        size = f"DIN 988 {mm(inner)} x {mm(2.0 * inner)} x {mm(thick)}"
        for base in bases if thick > 0.0 else ():
            self.add(
                Fastener(
                    name, "shim", size, 2.0 * inner, self.body, centre, base, base + thick, joint
                )
            )

    def drilled(self) -> list[Part]:
        """All parts with holes for the fasteners of their bodies, layer by layer from below."""
        made = [self._drilled(part) for part in self.parts]
        bases = sorted({round(one.base, 7) for one in made if not self.places[one.name].upright})
        made = [
            one
            if self.places[one.name].upright
            else replace(one, layer=bases.index(round(one.base, 7)))
            for one in made
        ]
        return sorted(made, key=lambda one: one.layer)

    def _drilled(self, part: Part) -> Part:
        import shapely

        place = self.places[part.name]
        area = part.outline.polygon(1e-5)
        open_ = [one.polygon(1e-5) for one in part.cutouts]
        holes = list(part.holes)
        for one in self.fasteners:
            if (
                one.block != self.bodies[part.name]
                or one.upright != place.upright
                or one.use not in ("pin", "screw", "hook", "stop")
                or one.low >= part.top - 1e-6
                or one.high <= part.base + 1e-6
            ):
                continue
            at = unplaced(one.centre, place)
            point = shapely.Point(at)
            if shapely.contains(area, point) and not any(
                shapely.contains(slot, point) for slot in open_
            ):
                holes.append(Hole(at, self._hole(one), one.name, _use(one)))
        return replace(part, holes=tuple(holes))

    def _hole(self, one: Fastener) -> float:
        build_file = self.plan.build_file
        if one.use == "screw":
            return build_file.screw.hole
        return one.diameter + build_file.pin.plate_fit


def _use(one: Fastener) -> str:
    return "pin" if one.use == "stop" else one.use


def unplaced(point: Vec2, place: PartFrame) -> Vec2:
    """A point of the place's plane in the frame of the part [m]."""
    x, y = point[0] - place.x, point[1] - place.y
    c, s = math.cos(place.angle), math.sin(place.angle)
    return c * x + s * y, c * y - s * x


def ribbon(points: Sequence[Vec2], widths: Sequence[float]) -> Contour:
    """The outline of a bent strip along a line through points [m], with round ends.

    Args:
        points: (n, 2) of its middle line [m].
        widths: (n,) at each of them [m].
    """
    at, half = np.array(points, float), np.array(widths, float) / 2.0
    ahead = np.diff(at, axis=0)
    ahead /= np.hypot(*ahead.T)[:, None]
    normal = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    left, right = [], []
    ends = at.copy()
    ends[0] -= half[0] * ahead[0]
    ends[-1] += half[-1] * ahead[-1]
    for i, point in enumerate(ends):
        before, after = normal[max(i - 1, 0)], normal[min(i, len(normal) - 1)]
        across = before + after
        across = across / (1.0 + before @ after) * half[i]
        left.append(point + across)
        right.append(point - across)
    corners = [(float(x), float(y)) for x, y in [*right, *left[::-1]]]
    count = len(at)
    round_ = {0: half[0], 2 * count - 1: half[0], count - 1: half[-1], count: half[-1]}
    # A hair less, for the sides of a strip that tapers.
    radii = [0.98 * float(round_.get(i, 0.0)) for i in range(len(corners))]
    return Contour.rounded(corners, radii)


def united(boxes: Iterable[tuple[float, float, float, float]], radius: float = 0.0) -> Contour:
    """The outline of rectangles (x0, y0, x1, y1) [m] that overlap or touch, corners rounded.

    Corners with an edge shorter than two radii stay sharp.
    """
    import shapely

    whole: Any = shapely.union_all([shapely.box(*one) for one in boxes], grid_size=1e-9)
    ring = shapely.get_coordinates(shapely.simplify(whole, 1e-9).exterior)[:-1]
    lengths = np.hypot(*(np.roll(ring, -1, axis=0) - ring).T)
    radii = [
        radius if min(lengths[i], lengths[i - 1]) > 2.5 * radius else 0.0 for i in range(len(ring))
    ]
    return Contour.rounded([(float(x), float(y)) for x, y in ring], radii)
